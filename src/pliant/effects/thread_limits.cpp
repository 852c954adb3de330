#include "pliant/effects/thread_limits.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pliant/core/parallel.h"
#include "pliant/elements/coloring.h"
#include "pliant/elements/spring_set.h"
#include "pliant/elements/triangle_strain_set.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kGrain = 2048;  // in less, threads cost more than they save
// Of the way to a limit that several sweeps go: limits are convex, so that any share below 2 comes
// nearer to all that fulfils them.
constexpr double kShare = 1.8;

/// Springs along threads, or null.
const SpringSet* threads_of(const ElementSet& set) {
  const auto* springs = dynamic_cast<const SpringSet*>(&set);
  return springs != nullptr && springs->name() == "stretch" ? springs : nullptr;
}

/// Ways between neighbours along warp and weft: what lies across them may shear to no more.
std::vector<ClothEdge> edges_of(const std::vector<std::unique_ptr<ElementSet>>& elements) {
  std::vector<ClothEdge> edges;
  for (const auto& set : elements) {
    if (const SpringSet* springs = threads_of(*set)) {
      for (const Spring& s : springs->springs()) edges.push_back({s.i, s.j, s.rest_length});
    }
    const auto* triangles = dynamic_cast<const TriangleStrainSet*>(set.get());
    if (triangles == nullptr) continue;
    for (const Simplex<2>& t : triangles->simplices().elements) {
      Eigen::Matrix<double, 2, 3> corners;  // along warp and weft [m]
      corners << Eigen::Vector2d::Zero(), t.shape.rightCols<2>().transpose().inverse();
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        edges.push_back({t.vertices[static_cast<std::size_t>(k)],
                         t.vertices[static_cast<std::size_t>(next)],
                         (corners.col(next) - corners.col(k)).lpNorm<1>()});
      }
    }
  }
  return edges;
}

}  // namespace

ThreadLimits::ThreadLimits(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles,
                           double max)
    : max_(max), tethers_(edges_of(elements), particles, max) {
  take_springs(elements);
  take_triangles(elements);
  if (threads_.empty()) {
    throw InputError(
        "effect 'strain_limit': this cloth has no threads that stretch; give stretch_warp or "
        "stretch_weft");
  }
  sort(particles);
  pulls_.resize(threads_.size(), Eigen::Vector3d::Zero());
}

void ThreadLimits::take_springs(const std::vector<std::unique_ptr<ElementSet>>& elements) {
  for (const auto& set : elements) {
    const SpringSet* springs = threads_of(*set);
    if (springs == nullptr) continue;
    for (const Spring& s : springs->springs()) {
      threads_.push_back({{s.i, s.j, s.i}, {-1.0, 1.0, 0.0}, s.rest_length});
    }
  }
}

void ThreadLimits::take_triangles(const std::vector<std::unique_ptr<ElementSet>>& elements) {
  for (const auto& set : elements) {
    const auto* triangles = dynamic_cast<const TriangleStrainSet*>(set.get());
    if (triangles == nullptr) continue;
    for (const Simplex<2>& t : triangles->simplices().elements) {
      for (int k = 0; k < 2; ++k) {
        // Weights of at most 1 make it a length.
        const double length = 1.0 / t.shape.row(k).cwiseAbs().maxCoeff();
        const Eigen::RowVector3d w = length * t.shape.row(k);
        threads_.push_back({t.vertices, {w[0], w[1], w[2]}, length});
      }
    }
  }
}

void ThreadLimits::sort(int particles) {
  std::vector<int> vertices, begins = {0};
  for (const Thread& thread : threads_) {
    const auto count =
        thread.weights[2] == 0.0 && thread.particles[2] == thread.particles[0] ? 2 : 3;
    vertices.insert(vertices.end(), thread.particles.begin(), thread.particles.begin() + count);
    begins.push_back(static_cast<int>(vertices.size()));
  }
  const Coloring coloring = color_elements(vertices, begins, particles);
  begins_ = coloring.begins;
  std::vector<Thread> sorted;
  sorted.reserve(threads_.size());
  for (const int t : coloring.order) sorted.push_back(threads_[static_cast<std::size_t>(t)]);
  threads_.swap(sorted);
}

void ThreadLimits::reset_multipliers() {
  tethers_.reset_multipliers();
  for (Eigen::Vector3d& pull : pulls_) pull.setZero();
}

double ThreadLimits::project(std::size_t t, double share, const Eigen::VectorXd& mobility,
                             Positions& x) {
  const Thread& thread = threads_[t];
  const Eigen::Vector3d along = thread.along(x);
  const double squared = along.squaredNorm(), limit = max_ * thread.length;
  if (squared <= limit * limit) return 0.0;
  double own = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    own += thread.weights[k] * thread.weights[k] * mobility[thread.particles[k]];
  }
  const double length = std::sqrt(squared);
  if (own == 0.0) return 0.0;
  const Eigen::Vector3d force = (share * (length - limit) / (own * length)) * along;
  pulls_[t] += force;
  for (std::size_t k = 0; k < 3; ++k) {
    const int i = thread.particles[k];
    x.col(i) -= (mobility[i] * thread.weights[k]) * force;
  }
  return (length - limit) / thread.length;
}

double ThreadLimits::sweep(double share, const Eigen::VectorXd& mobility, Positions& x) {
  tethers_.relax(mobility, x);
  double largest = 0.0;
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    const int first = begins_[c], last = begins_[c + 1];
    const int blocks = (last - first + kGrain - 1) / kGrain;
    block_largest_.assign(static_cast<std::size_t>(blocks), 0.0);
    parallel_for(0, blocks, 1, [&](int begin, int end) {
      for (int b = begin; b < end; ++b) {
        double& own = block_largest_[static_cast<std::size_t>(b)];
        const int stop = std::min(last, first + (b + 1) * kGrain);
        for (int t = first + b * kGrain; t < stop; ++t) {
          own = std::max(own, project(static_cast<std::size_t>(t), share, mobility, x));
        }
      }
    });
    for (const double own : block_largest_) largest = std::max(largest, own);
  }
  return largest;
}

double ThreadLimits::relax(const Eigen::VectorXd& mobility, int sweeps, double tolerance,
                           Positions& x) {
  const double first = sweep(1.0, mobility, x);
  double largest = first;
  for (int k = 1; k < sweeps && largest > tolerance; ++k) largest = sweep(kShare, mobility, x);
  return first;
}

void ThreadLimits::add_forces(Forces& f) const {
  tethers_.add_forces(f);
  for (std::size_t t = 0; t < threads_.size(); ++t) {
    if (pulls_[t].isZero(0.0)) continue;
    const Thread& thread = threads_[t];
    for (std::size_t k = 0; k < 3; ++k) {
      f.col(thread.particles[k]) -= thread.weights[k] * pulls_[t];
    }
  }
}

void ThreadLimits::add_rows(const Positions& x, CouplingRows& rows) const {
  for (std::size_t t = 0; t < threads_.size(); ++t) {
    if (pulls_[t].isZero(0.0)) continue;
    const Thread& thread = threads_[t];
    const Eigen::Vector3d along = thread.along(x);
    const double length = along.norm();
    if (!(length > 0.0)) continue;
    rows.begin_row(max_ * thread.length - length, 0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      if (thread.weights[k] == 0.0) continue;
      rows.add(thread.particles[k], thread.weights[k] / length * along);
    }
  }
}

int ThreadLimits::active() const {
  return static_cast<int>(std::count_if(
      pulls_.begin(), pulls_.end(), [](const Eigen::Vector3d& pull) { return !pull.isZero(0.0); }));
}

double ThreadLimits::largest_strain(const Positions& x) const {
  double largest = -1.0;
  for (const Thread& thread : threads_) {
    largest = std::max(largest, thread.along(x).norm() / thread.length - 1.0);
  }
  return largest;
}

}  // namespace pliant
