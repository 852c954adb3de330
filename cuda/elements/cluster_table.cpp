#include "cuda/elements/cluster_table.h"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {

std::size_t at(int k) { return static_cast<std::size_t>(k); }

struct Entry {
  int number;
  Float4 load;
};

/// Rows of entries in slices; `row(i, entries)` fills a row. Rows end with ~number of their first
/// entry, or of 0.
template <class Row>
void slice(int count, int unroll, const Row& row, std::vector<int>& begins,
           std::vector<int>& numbers, std::vector<Float4>* loads) {
  constexpr int kSlice = SlicedRowsLayout::kSlice;
  std::vector<std::vector<Entry>> rows(static_cast<std::size_t>(kSlice));
  begins.assign(1, 0);
  for (int first = 0; first < count; first += kSlice) {
    std::size_t width = 0;
    for (int lane = 0; lane < kSlice; ++lane) {
      rows[at(lane)].clear();
      if (first + lane < count) row(first + lane, rows[at(lane)]);
      width = std::max(width, rows[at(lane)].size());
    }
    width = (width + at(unroll) - 1) / at(unroll) * at(unroll);
    for (std::size_t k = 0; k < width; ++k) {
      for (const auto& entries : rows) {
        const int fill = entries.empty() ? 0 : std::max(entries.front().number, 0);
        const Entry entry = k < entries.size() ? entries[k] : Entry{~fill, {}};
        numbers.push_back(entry.number);
        if (loads != nullptr) loads->push_back(entry.load);
      }
    }
    begins.push_back(static_cast<int>(numbers.size()));
  }
}

class Layout {
 public:
  Layout(const ClusterList& list, int places, int chunk)
      : list_(list), places_(places), chunk_(chunk) {}

  ClusterTable make() {
    t_.clusters = list_.size();
    for (int c = 0; c < list_.size(); ++c) (is_small(c) ? order_ : large_).push_back(c);
    t_.small = static_cast<int>(order_.size());
    order_.insert(order_.end(), large_.begin(), large_.end());
    t_.rest = list_.rest;
    add_clusters();
    add_members();
    add_pulls();
    t_.order = order_;
    return std::move(t_);
  }

 private:
  int begin(int c) const { return list_.begins[at(c)]; }
  int end(int c) const { return list_.begins[at(c + 1)]; }
  bool is_small(int c) const { return end(c) - begin(c) <= chunk_; }
  bool has_loads() const { return list_.rest.empty(); }

  void add_clusters() {
    for (int n = 0; n < t_.clusters; ++n) {
      const int c = order_[at(n)];
      t_.stiffness.push_back(list_.stiffness[at(c)]);
      const int origin = list_.members[at(begin(c))];
      Fixed frame = has_loads() ? Fixed{0, 0, 0, 0.0f} : list_.rest[at(origin)];
      frame.w = list_.quanta[at(c)];
      t_.motions.push_back({frame, {}, {}});
      if (n >= t_.small) t_.first_chunks.push_back(static_cast<int>(chunks_.size()));
      for (int first = begin(c); first < end(c); first += chunk_) {
        chunks_.push_back({first, std::min(end(c), first + chunk_)});
        t_.origins.push_back(origin);
        t_.owners.push_back(n);
      }
    }
    t_.chunks = static_cast<int>(chunks_.size());
    t_.first_chunks.push_back(t_.chunks);
  }

  void add_members() {
    const auto row = [&](int chunk, std::vector<Entry>& entries) {
      for (int k = chunks_[at(chunk)].first; k < chunks_[at(chunk)].second; ++k) {
        entries.push_back({list_.members[at(k)], list_.loads[at(k)]});
      }
    };
    slice(t_.chunks, ClustersView::kUnroll, row, t_.begins, t_.members,
          has_loads() ? &t_.loads : nullptr);
  }

  void add_pulls() {
    std::vector<int> begins(at(places_) + 1, 0);
    for (int i : list_.members) ++begins[at(i) + 1];
    for (int i = 0; i < places_; ++i) begins[at(i + 1)] += begins[at(i)];
    std::vector<int> next(begins.begin(), begins.end() - 1), member(list_.members.size()),
        cluster(list_.members.size());
    for (int n = 0; n < t_.clusters; ++n) {
      for (int k = begin(order_[at(n)]); k < end(order_[at(n)]); ++k) {
        const int to = next[at(list_.members[at(k)])]++;
        member[at(to)] = k;
        cluster[at(to)] = n;
      }
    }
    const auto row = [&](int i, std::vector<Entry>& entries) {
      for (int k = begins[at(i)]; k < begins[at(i + 1)]; ++k) {
        entries.push_back({cluster[at(k)], list_.loads[at(member[at(k)])]});
      }
    };
    slice(places_, ClustersView::kUnroll, row, t_.pull_begins, t_.pull_clusters,
          has_loads() ? &t_.pull_loads : nullptr);
  }

  const ClusterList& list_;
  int places_, chunk_;
  ClusterTable t_;
  std::vector<int> order_, large_;
  std::vector<std::pair<int, int>> chunks_;
};

}  // namespace

ClusterTable lay_out(const ClusterList& list, int places, int chunk) {
  return Layout(list, places, chunk).make();
}

}  // namespace pliant
