#include "pliant/elements/stencil_set.h"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/elements/solids/simplex_set.h"
#include "pliant/math/small_solve.h"

namespace pliant {

template <class Law>
StencilSet<Law>::StencilSet(std::string name, StencilPlaces places, double stiffness)
    : name_(std::move(name)), places_(std::move(places)), stiffness_(stiffness) {
  take_parts();
}

template <class Law>
void StencilSet<Law>::take_parts() {
  const auto count = static_cast<std::size_t>(size());
  multipliers_.assign(count, Eigen::Matrix3d::Zero());
  stresses_.resize(count);
  particles_.clear();
  begins_.clear();
  const GradientStencils& all = parts();
  owners_.resize(static_cast<std::size_t>(all.entries()));
  entries_.resize(owners_.size());
  for (int part = 0; part < all.size(); ++part) {
    for (int k = all.begin(part); k < all.end(part); ++k) {
      owners_[static_cast<std::size_t>(k)] = part;
      entries_[static_cast<std::size_t>(k)] = k;
    }
  }
  std::stable_sort(entries_.begin(), entries_.end(),
                   [&](int a, int b) { return all.particle(a) < all.particle(b); });
  for (std::size_t k = 0; k < entries_.size(); ++k) {
    const int particle = all.particle(entries_[k]);
    if (!particles_.empty() && particles_.back() == particle) continue;
    particles_.push_back(particle);
    begins_.push_back(static_cast<int>(k));
  }
  begins_.push_back(static_cast<int>(entries_.size()));
}

template <class Law>
void* StencilSet<Law>::offer(const std::type_info& type) {
  // Parts of pressures are vertices, but of a set that damps plain tetrahedra.
  const bool is_of_vertices = std::is_same_v<Law, PressureLaw> && places_.parts != places_.bound;
  return is_of_vertices ? offer_as<LeavesOutPinned>(this, type) : nullptr;
}

template <class Law>
bool StencilSet<Law>::leave_out_pinned(const Particles& particles) {
  bool changed = false;
  const GradientStencils& tetrahedra = *places_.bound;
  for (int k = 0; k < tetrahedra.entries(); ++k) {
    const auto i = static_cast<std::size_t>(tetrahedra.particle(k));
    const bool is_pinned = particles.is_fixed(static_cast<int>(i));
    if (is_pinned == (i < pinned_.size() && pinned_[i])) continue;
    pinned_.resize(static_cast<std::size_t>(particles.size()));
    pinned_[i] = is_pinned;
    changed = true;
  }
  if (!changed) return false;
  places_.parts = std::make_shared<const GradientStencils>(vertex_means(tetrahedra, pinned_));
  take_parts();
  if (!law_.remembered.empty()) law_.resize(size());
  return true;
}

template <class Law>
template <class Use>
void StencilSet<Law>::for_range(int begin, int end, const Positions& x, const Use& use) const {
  for (int first = begin; first < end; first += kStressBlock) {
    const int count = std::min(kStressBlock, end - first);
    Eigen::Matrix3d g[kStressBlock], stress[kStressBlock];
    for (int k = 0; k < count; ++k) g[k] = parts().gradient(first + k, x);
    law_.stresses(first, g, count, stress);
    for (int k = 0; k < count; ++k) use(first + k, g[k], stress[k]);
  }
}

template <class Law>
double StencilSet<Law>::energy(const Positions& x) const {
  return parallel_reduce(
      0, size(), kSumGrain,
      [&](int begin, int end) {
        double sum = 0.0;
        for_range(begin, end, x, [&](int part, const Eigen::Matrix3d&, const Eigen::Matrix3d& p) {
          sum += weight(part) * law_.energy(p);
        });
        return sum;
      },
      std::plus<>());
}

template <class Law>
void StencilSet<Law>::add_forces(const Positions& x, Forces& f) const {
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for_range(begin, end, x, [&](int part, const Eigen::Matrix3d&, const Eigen::Matrix3d& p) {
      stresses_[static_cast<std::size_t>(part)] = weight(part) * p;
    });
  });
  // Each particle collects its own, so that parts need no colours.
  parallel_for(0, static_cast<int>(particles_.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      for (int k = begins_[at]; k < begins_[at + 1]; ++k) {
        const int entry = entries_[static_cast<std::size_t>(k)];
        const int owner = owners_[static_cast<std::size_t>(entry)];
        f.col(particles_[at]) -= stresses_[static_cast<std::size_t>(owner)] * parts().shape(entry);
      }
    }
  });
}

template <class Law>
void StencilSet<Law>::add_to_system(SystemMatrix& a) const {
  const GradientStencils& bound = *places_.bound;
  for (int part = 0; part < bound.size(); ++part) {
    const double stiffness = scale_ * stiffness_ * bound.volume(part) * Law::kBound;
    for (int r = bound.begin(part); r < bound.end(part); ++r) {
      for (int c = bound.begin(part); c < bound.end(part); ++c) {
        a.add(bound.particle(r), bound.particle(c), stiffness * bound.shape(r).dot(bound.shape(c)));
      }
    }
  }
}

template <class Law>
double StencilSet<Law>::work() const {
  // A rotation, and twice each entry, as beside the 16 of a tetrahedron.
  constexpr double kRotation = 8.0;
  return kRotation * size() + 2.0 * parts().entries();
}

template <class Law>
void StencilSet<Law>::add_stiffness(const Positions& x, Definiteness definiteness,
                                    StiffnessMatrix& k) const {
  const GradientStencils& all = parts();
  for (int part = 0; part < all.size(); ++part) {
    const Matrix9d tangent = weight(part) * law_.tangent(part, all.gradient(part, x), definiteness);
    for (int r = all.begin(part); r < all.end(part); ++r) {
      Eigen::Matrix<double, 3, 9> row = Eigen::Matrix<double, 3, 9>::Zero();
      for (int i = 0; i < 3; ++i) row += all.shape(r)[i] * tangent.middleRows<3>(3 * i);
      for (int c = all.begin(part); c < all.end(part); ++c) {
        Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
        for (int j = 0; j < 3; ++j) block += all.shape(c)[j] * row.middleCols<3>(3 * j);
        k.add(all.particle(r), all.particle(c), block);
      }
    }
  }
}

template <class Law>
void StencilSet<Law>::add_damping(double time,
                                  std::vector<std::unique_ptr<ElementSet>>& sets) const {
  sets.push_back(std::make_unique<ViscousStencilSet<Law>>(places_, stiffness_, time));
}

template <class Law>
void StencilSet<Law>::reset_multipliers() {
  for (Eigen::Matrix3d& multiplier : multipliers_) multiplier.setZero();
}

template <class Law>
void StencilSet<Law>::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  const GradientStencils& all = parts();
  for (int part = 0; part < all.size(); ++part) {
    // As SimplexSet: ΔΛ (I + h² w b M) = w Ψ' − Λ, M = Σ wₖ gₖ gₖᵀ; one part after the other.
    const Eigen::Matrix3d g = all.gradient(part, x);
    Eigen::Matrix3d stress, mobility = Eigen::Matrix3d::Zero();
    law_.stresses(part, &g, 1, &stress);
    for (int k = all.begin(part); k < all.end(part); ++k) {
      mobility += inverse_mass[all.particle(k)] * all.shape(k) * all.shape(k).transpose();
    }
    const double own = weight(part);
    Eigen::Matrix3d& multiplier = multipliers_[static_cast<std::size_t>(part)];
    const Eigen::Matrix3d missing = own * stress - multiplier;
    if (missing.isZero(0.0)) continue;
    const Eigen::Matrix3d system =
        Eigen::Matrix3d::Identity() + dt * dt * own * Law::kBound * mobility;
    const Eigen::Matrix3d delta = solve_pivoted<3, 3>(system, missing.transpose()).transpose();
    multiplier += delta;
    for (int k = all.begin(part); k < all.end(part); ++k) {
      const int i = all.particle(k);
      x.col(i) -= dt * dt * inverse_mass[i] * (delta * all.shape(k));
    }
  }
}

template <class Law>
void ViscousStencilSet<Law>::begin_step(const Particles& p) {
  const GradientStencils& all = this->parts();
  const double share = p.inertia.is_used ? p.inertia.share : 0.0;
  Positions before;
  if (share > 0.0) before = p.x_start - p.history_before.moved;
  parallel_for(0, all.size(), kStressBlock, [&](int begin, int end) {
    for (int part = begin; part < end; ++part) {
      const Eigen::Matrix3d g = all.gradient(part, p.x_start);
      if (share > 0.0) {
        this->law().remember(part, g, all.gradient(part, before), share);
      } else {
        this->law().remember(part, g);
      }
    }
  });
}

template class StencilSet<ShearLaw>;
template class StencilSet<PressureLaw>;
template class ViscousStencilSet<ShearLaw>;
template class ViscousStencilSet<PressureLaw>;

}  // namespace pliant
