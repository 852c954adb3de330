#include "pliant/solvers/linear/elimination_tree.h"

#include <algorithm>

namespace pliant {
namespace {
// Of the whole work, that two threads have to save at least, for what each of their loops costs.
constexpr double kWorthwhile = 0.15;
// Products with blocks that a solve takes, below which two threads lose time.
constexpr double kLeast = 1000.0;
// Smaller subtrees than this share of the whole are taken as they are.
constexpr double kSmall = 0.02;
}  // namespace

EliminationTree::EliminationTree(const std::vector<std::vector<int>>& columns)
    : parent_(columns.size(), -1), children_(columns.size()), work_(columns.size()) {
  for (std::size_t j = 0; j < columns.size(); ++j) {
    // A product with each block.
    const double own = 1.0 + static_cast<double>(columns[j].size());
    work_[j] += own;
    whole_ += own;
    if (columns[j].empty()) continue;
    const auto parent = static_cast<std::size_t>(columns[j].front());
    parent_[j] = columns[j].front();
    children_[parent].push_back(static_cast<int>(j));
    work_[parent] += work_[j];
  }
}

EliminationTree::Choice EliminationTree::share_out(std::vector<int> roots, double above) const {
  const auto work = [&](int j) { return work_[static_cast<std::size_t>(j)]; };
  std::sort(roots.begin(), roots.end(),
            [&](int a, int b) { return work(a) != work(b) ? work(a) > work(b) : a < b; });
  Choice choice;
  double shares[2] = {0.0, 0.0};
  for (const int root : roots) {
    const bool is_second = shares[1] < shares[0];
    shares[is_second ? 1 : 0] += work(root);
    choice.is_second.push_back(is_second);
  }
  choice.roots = std::move(roots);
  choice.longest = above + std::max(shares[0], shares[1]);
  return choice;
}

EliminationTree::Groups EliminationTree::number(const Choice& choice) const {
  enum Place { kFirst, kSecond, kAfter };
  std::vector<Place> places(parent_.size(), kAfter);
  for (std::size_t k = 0; k < choice.roots.size(); ++k) {
    places[static_cast<std::size_t>(choice.roots[k])] = choice.is_second[k] ? kSecond : kFirst;
  }
  for (std::size_t j = parent_.size(); j-- > 0;) {
    if (places[j] == kAfter && parent_[j] >= 0) {
      places[j] = places[static_cast<std::size_t>(parent_[j])];
    }
  }
  Groups groups;
  groups.number_of.resize(parent_.size());
  int next = 0;
  for (const Place place : {kFirst, kSecond, kAfter}) {
    for (std::size_t j = 0; j < parent_.size(); ++j) {
      if (places[j] == place) groups.number_of[j] = next++;
    }
    if (place == kFirst) groups.first = next;
    if (place == kSecond) groups.second = next;
  }
  return groups;
}

EliminationTree::Groups EliminationTree::split() const {
  std::vector<int> roots;
  for (std::size_t j = 0; j < parent_.size(); ++j) {
    if (parent_[j] < 0) roots.push_back(static_cast<int>(j));
  }
  Choice all;
  all.roots = roots;
  all.is_second.assign(roots.size(), false);
  Choice best;
  best.longest = (1.0 - kWorthwhile) * whole_;
  bool any = false;
  double above = 0.0;
  // Opens the largest subtree, again and again.
  while (whole_ >= kLeast && !roots.empty()) {
    Choice choice = share_out(roots, above);
    const auto largest = static_cast<std::size_t>(choice.roots.front());
    roots = choice.roots;
    if (choice.longest < best.longest) {
      best = std::move(choice);
      any = true;
    }
    if (work_[largest] <= kSmall * whole_) break;
    roots.erase(roots.begin());
    double below = 0.0;
    for (const int child : children_[largest]) {
      roots.push_back(child);
      below += work_[static_cast<std::size_t>(child)];
    }
    above += work_[largest] - below;
    if (above > best.longest) break;
  }
  return number(any ? best : all);
}

}  // namespace pliant
