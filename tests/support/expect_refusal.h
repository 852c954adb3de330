#ifndef PLIANT_TESTS_UNIT_GEOMETRY_EXPECT_REFUSAL_H_
#define PLIANT_TESTS_UNIT_GEOMETRY_EXPECT_REFUSAL_H_

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pliant/math/error.h"

namespace pliant {

// Expects that `call` throws an InputError whose message holds all `parts`.
template <typename Call>
void expect_refusal(const Call& call, const std::vector<std::string>& parts) {
  try {
    call();
    ADD_FAILURE() << "not refused; expected: " << ::testing::PrintToString(parts);
  } catch (const InputError& error) {
    for (const std::string& part : parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << "'" << part << "' is not in: " << error.what();
    }
  }
}

}  // namespace pliant

#endif  // PLIANT_TESTS_UNIT_GEOMETRY_EXPECT_REFUSAL_H_
