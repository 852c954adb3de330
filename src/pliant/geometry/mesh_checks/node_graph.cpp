#include "pliant/geometry/mesh_checks/node_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// A node takes assimp more than a kilobyte, and a call of a function a level.
constexpr double kMostNodes = 200'000;
constexpr int kMostLevels = 500;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

}  // namespace

int NodeGraph::add(std::string name) {
  names_.push_back(std::move(name));
  children_.emplace_back();
  return size() - 1;
}

void NodeGraph::add_child(int parent, int child) { children_[at(parent)].push_back(child); }

void NodeGraph::check(const std::string& path) const {
  enum class State : char { kNew, kOpen, kDone };
  std::vector<State> states(names_.size(), State::kNew);
  std::vector<double> nodes(names_.size(), 1.0);  // of the tree below each, itself included
  std::vector<int> levels(names_.size(), 1);
  std::vector<char> is_child(names_.size(), 0);
  for (const std::vector<int>& children : children_) {
    for (const int child : children) is_child[at(child)] = 1;
  }
  double all = 0.0;
  std::vector<std::pair<int, std::size_t>> open;  // a node, and its next child
  for (int root = 0; root < size(); ++root) {
    if (states[at(root)] == State::kNew) {
      states[at(root)] = State::kOpen;
      open.emplace_back(root, 0);
    }
    while (!open.empty()) {
      auto& [node, next] = open.back();
      if (next < children_[at(node)].size()) {
        const int child = children_[at(node)][next];
        if (states[at(child)] == State::kOpen) {
          throw InputError(
              fmt::format("mesh '{}': node '{}' holds itself", path, names_[at(child)]));
        }
        if (states[at(child)] == State::kNew) {
          states[at(child)] = State::kOpen;
          open.emplace_back(child, 0);
          continue;
        }
        nodes[at(node)] += nodes[at(child)];
        levels[at(node)] = std::max(levels[at(node)], 1 + levels[at(child)]);
        ++next;
        continue;
      }
      if (levels[at(node)] > kMostLevels) {
        throw InputError(
            fmt::format("mesh '{}': nodes are nested deeper than {}", path, kMostLevels));
      }
      states[at(node)] = State::kDone;
      open.pop_back();
    }
    if (is_child[at(root)] == 0) all += nodes[at(root)];
    if (all > kMostNodes) {
      throw InputError(fmt::format("mesh '{}': its nodes and their instances are more than {:.0f}",
                                   path, kMostNodes));
    }
  }
}

}  // namespace pliant
