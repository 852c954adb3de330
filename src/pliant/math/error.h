#ifndef PLIANT_MATH_ERROR_H_
#define PLIANT_MATH_ERROR_H_

#include <stdexcept>
#include <string>
#include <vector>

namespace pliant {

// The one exception for bad input: a scene, mesh, parameter, file or request that is refused before
// anything changes. The message says what is wrong, where, and what would be allowed.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message);
};

// The name in `allowed` that a user who typed `name` most likely meant: the smallest edit distance
// (insert, delete, replace, swap of neighbours; case ignored), the first of equals. Empty when
// nothing is near.
std::string nearest_name(const std::string& name, const std::vector<std::string>& allowed);

// "unknown solver 'xpdb': allowed are jacobi, verlet, xpbd; did you mean 'xpbd'?"
std::string unknown_name_message(const std::string& kind, const std::string& name,
                                 const std::vector<std::string>& allowed);

}  // namespace pliant

#endif  // PLIANT_MATH_ERROR_H_
