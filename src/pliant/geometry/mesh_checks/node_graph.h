#pragma once

#include <string>
#include <vector>

namespace pliant {

/// The nodes of a scene file, each with those that it holds or instances. Readers expand it to a
/// tree, one copy a path from the root.
class NodeGraph {
 public:
  int add(std::string name);
  void add_child(int parent, int child);
  int size() const { return static_cast<int>(names_.size()); }

  /// Throws InputError "mesh '<path>': ..." for nodes that hold themselves, a tree of more than
  /// 200,000 nodes, or one deeper than 500.
  void check(const std::string& path) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<int>> children_;
};

}  // namespace pliant
