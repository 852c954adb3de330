#include "pliant/elements/cloth/bending_set.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/elements/cloth/bending_relaxation.h"
#include "pliant/elements/coloring.h"
#include "pliant/elements/solids/strain_damping_set.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kGrain = 128;  // in less, threads cost more than they save
constexpr int kSumGrain = 1024;

BendingStiffness checked(double warp, double weft) {
  for (const double stiffness : {warp, weft}) {
    if (std::isfinite(stiffness) && stiffness > 0.0) continue;
    throw InputError(fmt::format("bending stiffness is {} N m, but must be positive", stiffness));
  }
  return {warp, weft};
}

/// 1 + A, A positive semi-definite, of whose lower triangle `a` holds the rows, becomes L D Lᵀ: L
/// below its diagonal of ones, where 1 / D stands. No pivot is below 1 but by round-off.
template <int R>
void factorize(double* a) {
  for (int r = 0; r < R; ++r) {
    double* row = a + row_of(r);
    double pivot = 1.0 + row[r];
    for (int c = 0; c < r; ++c) {
      double entry = row[c];
      const double* other = a + row_of(c);
      for (int k = 0; k < c; ++k) entry -= row[k] * other[k];
      row[c] = entry;  // times its pivot, until the row is done
    }
    for (int c = 0; c < r; ++c) {
      const double scaled = row[c] * a[row_of(c) + c];
      pivot -= scaled * row[c];
      row[c] = scaled;
    }
    row[r] = 1.0 / std::max(pivot, 1.0);
  }
}

}  // namespace

BendingSet::BendingSet(const TriangleMesh& rest, double stiffness)
    : BendingSet(rest, Eigen::Vector3d::UnitX(), stiffness, stiffness) {}

BendingSet::BendingSet(const TriangleMesh& rest, const Eigen::Vector3d& warp, double warp_stiffness,
                       double weft_stiffness)
    : BendingSet(bending_of(hinges_of_mesh(rest, warp, checked(warp_stiffness, weft_stiffness))),
                 static_cast<int>(rest.vertices.cols())) {}

BendingSet::BendingSet(const GridOptions& grid, double warp_stiffness, double weft_stiffness,
                       bool to_edges)
    : grid_(grid), grid_stiffness_(checked(warp_stiffness, weft_stiffness)), to_edges_(to_edges) {
  color(bending_of(hinges_of_grid(grid, grid_stiffness_, to_edges)), grid.columns * grid.rows);
  add_up(grid.columns * grid.rows);
}

BendingSet::BendingSet(BendingStencils stencils, int particles) {
  color(std::move(stencils), particles);
  add_up(particles);
}

std::unique_ptr<BendingSet> BendingSet::plates(const TriangleMesh& rest,
                                               const Eigen::Vector3d& warp, double warp_stiffness,
                                               double weft_stiffness) {
  const BendingStiffness stiffness = checked(warp_stiffness, weft_stiffness);
  std::unique_ptr<BendingSet> set(new BendingSet(bending_of_mesh(rest, warp, stiffness),
                                                 static_cast<int>(rest.vertices.cols())));
  set->find_near(hinges_of_mesh(rest, warp, stiffness));
  return set;
}

// `stencils` go when what is sorted is there: a million vertices have gigabytes of all that is made
// meanwhile.
void BendingSet::color(BendingStencils stencils, int particles) {
  const Coloring coloring = color_elements(stencils.vertices, stencils.firsts, particles);
  begins_ = coloring.begins;
  stencils_.rows = stencils.rows;
  stencils_.vertices.reserve(stencils.vertices.size());
  stencils_.weights.reserve(stencils.weights.size());
  stencils_.firsts.reserve(stencils.firsts.size());
  for (int e : coloring.order) {
    const auto at = static_cast<std::size_t>(e);
    const int first = stencils.firsts[at], end = stencils.firsts[at + 1];
    const auto take = [&](const auto& from, int each, auto& to) {
      to.insert(to.end(), from.begin() + each * first, from.begin() + each * end);
    };
    take(stencils.vertices, 1, stencils_.vertices);
    take(stencils.weights, stencils.rows, stencils_.weights);
    stencils_.firsts.push_back(static_cast<int>(stencils_.vertices.size()));
    if (!stencils.triangles.empty()) stencils_.triangles.push_back(stencils.triangles[at]);
  }
}

void BendingSet::add_up(int particles) {
  const BendingStencils& s = stencils_;
  // Where each particle stands in the pieces, piece by piece.
  std::vector<int> begins(static_cast<std::size_t>(particles) + 1, 0);
  for (const int i : s.vertices) ++begins[static_cast<std::size_t>(i) + 1];
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  std::vector<std::pair<int, int>> of(s.vertices.size());
  std::vector<int> next(begins.begin(), begins.end() - 1);
  for (int e = 0; e < size(); ++e) {
    const auto at = static_cast<std::size_t>(e);
    for (int k = s.firsts[at]; k < s.firsts[at + 1]; ++k) {
      const int i = s.vertices[static_cast<std::size_t>(k)];
      of[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = {e, k};
    }
  }
  std::vector<std::pair<int, double>> entries;
  for (int i = 0; i < particles; ++i) {
    entries.clear();
    for (int o = begins[static_cast<std::size_t>(i)]; o < begins[static_cast<std::size_t>(i) + 1];
         ++o) {
      const auto [e, own] = of[static_cast<std::size_t>(o)];
      add_entries(i, e, own, entries);
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const auto& l, const auto& r) { return l.first < r.first; });
    for (std::size_t k = 0; k < entries.size(); ++k) {
      const bool is_new = k == 0 || entries[k].first != entries[k - 1].first;
      if (is_new) {
        rows_.columns.push_back(entries[k].first);
        rows_.values.push_back(0.0);
      }
      rows_.values.back() += entries[k].second;
    }
    rows_.begins.push_back(static_cast<int>(rows_.columns.size()));
  }
  rows_.begins.shrink_to_fit();
  rows_.columns.shrink_to_fit();
  rows_.values.shrink_to_fit();
}

void BendingSet::add_entries(int i, int e, int own,
                             std::vector<std::pair<int, double>>& entries) const {
  const BendingStencils& s = stencils_;
  const auto at = static_cast<std::size_t>(e);
  for (int k = s.firsts[at]; k < s.firsts[at + 1]; ++k) {
    const int other = s.vertices[static_cast<std::size_t>(k)];
    if (other == i) continue;
    double product = 0.0;  // with the same bits in both rows of a pair
    for (int r = 0; r < s.rows; ++r) {
      product += s.weights[static_cast<std::size_t>(s.rows * own + r)] *
                 s.weights[static_cast<std::size_t>(s.rows * k + r)];
    }
    entries.emplace_back(other, -product);
  }
}

// Solvers that relax piece by piece visit each pair of a piece, though forces are summed in rows.
double BendingSet::work() const {
  double sum = 0.0;
  for (int e = 0; e < size(); ++e) {
    const auto at = static_cast<std::size_t>(e);
    const double count = stencils_.firsts[at + 1] - stencils_.firsts[at];
    sum += count * count;
  }
  return sum;
}

double BendingSet::energy(const Positions& x) const {
  return parallel_reduce(
      0, size(), kSumGrain,
      [&](int begin, int end) { return bending_energy(stencils_, x.data(), begin, end); },
      [](double a, double b) { return a + b; });
}

void BendingSet::add_forces(const Positions& x, Forces& f) const {
  parallel_for(0, static_cast<int>(rows_.begins.size()) - 1, kGrain, [&](int begin, int end) {
    add_bending_forces(rows_, x.data(), begin, end, f.data());
  });
}

void BendingSet::find_near(const std::vector<BendingHinge>& hinges) {
  std::vector<std::pair<int, int>> pairs;
  for (const BendingHinge& hinge : hinges) {
    for (const int i : hinge.vertices) {
      for (const int j : hinge.vertices) {
        if (i != j) pairs.emplace_back(i, j);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  is_near_.resize(rows_.columns.size());
  for (std::size_t i = 0; i + 1 < rows_.begins.size(); ++i) {
    for (auto k = static_cast<std::size_t>(rows_.begins[i]);
         k < static_cast<std::size_t>(rows_.begins[i + 1]); ++k) {
      is_near_[k] = std::binary_search(pairs.begin(), pairs.end(),
                                       std::make_pair(static_cast<int>(i), rows_.columns[k]));
    }
  }
}

void BendingSet::add_to_system(SystemMatrix& a) const {
  for (std::size_t i = 0; i + 1 < rows_.begins.size(); ++i) {
    double sum = 0.0;
    for (auto k = static_cast<std::size_t>(rows_.begins[i]);
         k < static_cast<std::size_t>(rows_.begins[i + 1]); ++k) {
      if (!is_near(k)) continue;
      a.add(static_cast<int>(i), rows_.columns[k], -rows_.values[k]);
      sum += rows_.values[k];
    }
    if (sum != 0.0) a.add(static_cast<int>(i), static_cast<int>(i), sum);
  }
  if (!is_near_.empty()) add_far_pairs(a);
}

// Since |x_i - x_j|² <= 2 |x_i - x_k|² + 2 |x_k - x_j|²; the mean of that over all k that are near
// to both, so that it does not hang on their numbers.
void BendingSet::add_far_pairs(SystemMatrix& a) const {
  const auto add_pair = [&](int i, int j, double stiffness) {
    a.add(i, i, stiffness);
    a.add(j, j, stiffness);
    a.add(i, j, -stiffness);
    a.add(j, i, -stiffness);
  };
  for (std::size_t i = 0; i + 1 < rows_.begins.size(); ++i) {
    for (auto k = static_cast<std::size_t>(rows_.begins[i]);
         k < static_cast<std::size_t>(rows_.begins[i + 1]); ++k) {
      const int row = static_cast<int>(i), column = rows_.columns[k];
      const double value = rows_.values[k];
      if (column < row || is_near(k) || value < 0.0) continue;
      const std::vector<int> between = near_to_both(row, column);
      if (between.empty()) add_pair(row, column, value);
      for (const int other : between) {
        const double share = 2.0 * value / static_cast<double>(between.size());
        add_pair(row, other, share);
        add_pair(other, column, share);
      }
    }
  }
}

std::vector<int> BendingSet::near_to_both(int i, int j) const {
  const auto near_to = [&](int of) {
    std::vector<int> result;
    for (auto k = static_cast<std::size_t>(rows_.begins[static_cast<std::size_t>(of)]);
         k < static_cast<std::size_t>(rows_.begins[static_cast<std::size_t>(of) + 1]); ++k) {
      if (is_near(k)) result.push_back(rows_.columns[k]);
    }
    return result;
  };
  const std::vector<int> of_i = near_to(i), of_j = near_to(j);
  std::vector<int> both;
  std::set_intersection(of_i.begin(), of_i.end(), of_j.begin(), of_j.end(),
                        std::back_inserter(both));
  return both;
}

void BendingSet::add_stiffness(const Positions&, Definiteness, StiffnessMatrix& k) const {
  const auto add = [&](std::size_t row, int column, double stiffness) {
    k.add_isotropic(static_cast<int>(row), column, stiffness);
  };
  for (std::size_t i = 0; i + 1 < rows_.begins.size(); ++i) {
    double sum = 0.0;
    for (auto e = static_cast<std::size_t>(rows_.begins[i]);
         e < static_cast<std::size_t>(rows_.begins[i + 1]); ++e) {
      add(i, rows_.columns[e], -rows_.values[e]);
      sum += rows_.values[e];
    }
    if (sum != 0.0) add(i, static_cast<int>(i), sum);
  }
}

std::vector<StrainMeasure> BendingSet::strains_of_grid() const {
  std::vector<StrainMeasure> strains;
  for (const BendingHinge& hinge : hinges_of_grid(*grid_, grid_stiffness_, to_edges_)) {
    StrainMeasure strain;
    strain.kind = StrainMeasure::kCurvature;
    strain.particles.assign(hinge.vertices.begin(), hinge.vertices.end());
    strain.first.assign(hinge.weights.begin(), hinge.weights.end());
    // The fourth vertex of a line lies beside it.
    if (hinge.weights[3] == 0.0) strain.normal = {0, 2, 1, 3};
    strain.stiffness = hinge.stiffness;
    strains.push_back(strain);
  }
  return strains;
}

std::vector<StrainMeasure> BendingSet::strains_of_hinges() const {
  std::vector<StrainMeasure> strains;
  for (std::size_t e = 0; e + 1 < stencils_.firsts.size(); ++e) {
    StrainMeasure strain;
    strain.kind = StrainMeasure::kCurvature;
    const auto first = static_cast<std::ptrdiff_t>(stencils_.firsts[e]);
    const auto end = static_cast<std::ptrdiff_t>(stencils_.firsts[e + 1]);
    strain.particles.assign(stencils_.vertices.begin() + first, stencils_.vertices.begin() + end);
    strain.first.assign(stencils_.weights.begin() + first, stencils_.weights.begin() + end);
    strain.stiffness = 1.0;  // its root is in the weights
    strains.push_back(strain);
  }
  return strains;
}

std::vector<StrainMeasure> BendingSet::strains_of_triangles() const {
  std::vector<StrainMeasure> strains;
  const auto rows = static_cast<std::size_t>(stencils_.rows);
  for (std::size_t e = 0; e < stencils_.triangles.size(); ++e) {
    StrainMeasure strain;
    strain.kind = StrainMeasure::kCurvature;
    strain.stiffness = 1.0;  // its root is in the weights
    const auto first = static_cast<std::size_t>(stencils_.firsts[e]);
    const auto end = static_cast<std::size_t>(stencils_.firsts[e + 1]);
    strain.particles.assign(stencils_.vertices.begin() + static_cast<std::ptrdiff_t>(first),
                            stencils_.vertices.begin() + static_cast<std::ptrdiff_t>(end));
    int corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found =
          std::find(strain.particles.begin(), strain.particles.end(), stencils_.triangles[e][k]);
      corners[k] = static_cast<int>(found - strain.particles.begin());
      if (found == strain.particles.end()) strain.particles.push_back(stencils_.triangles[e][k]);
    }
    strain.normal = {corners[0], corners[1], corners[0], corners[2]};
    for (std::size_t r = 0; r < rows; ++r) {
      strain.first.assign(strain.particles.size(), 0.0);
      for (std::size_t k = first; k < end; ++k) {
        strain.first[k - first] = stencils_.weights[rows * k + r];
      }
      strains.push_back(strain);
    }
  }
  return strains;
}

void BendingSet::add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const {
  std::vector<StrainMeasure> strains;
  if (grid_) {
    strains = strains_of_grid();
  } else {
    strains = stencils_.triangles.empty() ? strains_of_hinges() : strains_of_triangles();
  }
  sets.push_back(std::make_unique<StrainDampingSet>(strains, time));
}

void BendingSet::reset_multipliers() { std::fill(multipliers_.begin(), multipliers_.end(), 0.0); }

template <int R>
void BendingSet::find_factors(const Eigen::VectorXd& inverse_mass, double dt2) {
  if (factors_.dt2 == dt2 && factors_.inverse_mass == inverse_mass) return;
  factors_.dt2 = dt2;
  factors_.inverse_mass = inverse_mass;
  const BendingStencils& s = stencils_;
  constexpr std::size_t kEach = R * (R + 1) / 2;
  factors_.values.assign(kEach * static_cast<std::size_t>(size()), 0.0);
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for (int e = begin; e < end; ++e) {
      const auto at = static_cast<std::size_t>(e);
      double* values = factors_.values.data() + kEach * at;
      for (auto k = static_cast<std::size_t>(s.firsts[at]);
           k < static_cast<std::size_t>(s.firsts[at + 1]); ++k) {
        const double own = dt2 * inverse_mass[s.vertices[k]];
        const double* w = s.weights.data() + R * k;
        double* value = values;
        for (int r = 0; r < R; ++r) {
          for (int q = 0; q <= r; ++q) *value++ += own * w[r] * w[q];
        }
      }
      factorize<R>(values);
    }
  });
}

void BendingSet::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  const double dt2 = dt * dt;
  if (stencils_.rows == 1) {
    find_factors<1>(inverse_mass, dt2);
  } else {
    find_factors<3>(inverse_mass, dt2);
  }
  // Solvers that do not relax need none.
  if (multipliers_.empty()) {
    multipliers_.assign(static_cast<std::size_t>(3 * stencils_.rows * size()), 0.0);
  }
  const BendingRelaxation relaxation = {
      stencils_, factors_.values.data(), multipliers_.data(), inverse_mass.data(), dt2, x.data()};
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    parallel_for(begins_[c], begins_[c + 1], kGrain,
                 [&](int begin, int end) { relaxation.relax(begin, end); });
  }
}

}  // namespace pliant
