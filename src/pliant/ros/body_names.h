#pragma once

#include <deque>
#include <string>
#include <vector>

#include "pliant/core/body.h"

namespace pliant {

/// Its characters but those that ROS allows in a name replaced by `_`, and `prefix` before one that
/// does not begin with a letter.
std::string graph_name_of(const std::string& name, const std::string& prefix = "body_");
/// Of each name, so that no two are the same: of those that would be, later ones are numbered.
std::vector<std::string> graph_names_of(const std::vector<std::string>& names,
                                        const std::string& prefix);

/// What the users of a node call the bodies of its scene. It never changes: any thread may read it.
class BodyNames {
 public:
  explicit BodyNames(const std::deque<Body>& bodies);

  std::size_t size() const { return entries_.size(); }
  /// As the scene calls it.
  const std::string& name(std::size_t body) const { return entries_[body].name; }
  /// As its topics call it: no two bodies have the same.
  const std::string& graph_name(std::size_t body) const { return entries_[body].graph_name; }
  const std::string& model(std::size_t body) const { return entries_[body].model; }

  /// Indices of the bodies that are meant by a name of either kind; empty: all. Throws InputError
  /// for an unknown one, with the nearest name; `where` begins its message.
  std::vector<std::size_t> find(const std::string& where, const std::string& name) const;
  /// "'towel'", "'towel', 'jelly'", or of several that are all that there are "all 3 bodies".
  std::string text(const std::vector<std::size_t>& bodies) const;
  /// What a user should know of names that ROS does not allow, one line each.
  std::vector<std::string> replaced() const;

 private:
  struct Entry {
    std::string name, graph_name, model;
  };
  void refuse(const std::string& where, const std::string& name) const;

  std::vector<Entry> entries_;
};

}  // namespace pliant
