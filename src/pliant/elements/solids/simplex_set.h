#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/core/system/element_set.h"
#include "pliant/elements/entries_of_particles.h"
#include "pliant/elements/solids/simplex.h"
#include "pliant/math/small_solve.h"

namespace pliant {

/// Elements whose stresses are computed together, where lanes of vector registers are at hand.
constexpr int kStressBlock = 16;

/// The energies of a law whose stress is the difference from the nearest matrix, Ψ = 1/2 |Ψ'|².
template <class Law>
void energies_of_stresses(const Law& law, const Eigen::Matrix3d* g, int count, double* energy) {
  Eigen::Matrix3d stress[kStressBlock];
  law.stresses(g, count, stress);
  for (int k = 0; k < count; ++k) energy[k] = 0.5 * stress[k].squaredNorm();
}

/// Of the pairs of an element's vertices, first (0, 0), (0, 1), ..., then (1, 1) and so on.
template <int D>
using VertexBlocks = std::array<Eigen::Matrix3d, (D + 1) * (D + 2) / 2>;

/// How the force on vertex r of `s` answers to vertex c, r <= c: d²Ψ/dxᵣdx꜀ at G, the weight left
/// out. From the law's tangent, unless there is an overload of the law.
template <class Law, int D>
void find_vertex_blocks(const Law& law, const Simplex<D>& s, const Gradient<D>& g,
                        Definiteness definiteness, VertexBlocks<D>& blocks) {
  const Eigen::Matrix<double, 3 * D, 3 * D> tangent = law.tangent(g, definiteness);
  auto block = blocks.begin();
  for (int r = 0; r <= D; ++r) {
    for (int c = r; c <= D; ++c, ++block) {
      block->setZero();
      for (int i = 0; i < D; ++i) {
        for (int j = 0; j < D; ++j) {
          *block += s.shape(i, r) * s.shape(j, c) * tangent.template block<3, 3>(3 * i, 3 * j);
        }
      }
    }
  }
}

/// Of `count` elements, up to kStressBlock: one by one, unless there is an overload of the law.
template <class Law, int D>
void find_vertex_blocks(const Law& law, const Simplex<D>* simplices, const Gradient<D>* g,
                        int count, Definiteness definiteness, VertexBlocks<D>* blocks) {
  for (int k = 0; k < count; ++k) {
    find_vertex_blocks(law, simplices[k], g[k], definiteness, blocks[k]);
  }
}

/// ΔΛ (I + mobility H) = missing, with the stiffness H that the law has at G.
template <class Law, int D>
Gradient<D> solve_at(const Law& law, const Gradient<D>& g,
                     const Eigen::Matrix<double, D, D>& mobility, const Gradient<D>& missing) {
  using Square = Eigen::Matrix<double, 3 * D, 3 * D>;
  using Flat = Eigen::Matrix<double, 3 * D, 1>;
  const Square tangent = law.tangent(g, Definiteness::kProjected);
  Square system = Square::Identity();
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) {
      for (int k = 0; k < D; ++k) {
        system.template block<3, 3>(3 * r, 3 * c) +=
            tangent.template block<3, 3>(3 * r, 3 * k) * mobility(k, c);
      }
    }
  }
  const Flat delta = solve_pivoted<3 * D, 1>(system, Eigen::Map<const Flat>(missing.data()));
  return Eigen::Map<const Gradient<D>>(delta.data());
}

/// What sets of tetrahedra and of triangles share, E = Σₑ weightₑ Ψ(Gₑ). `Law` is the energy of
/// one element per weight:
///   static constexpr int kDimension;                     D: 3 for tetrahedra, 2 for triangles
///   void stresses(const Gradient<D>* g, int count, Gradient<D>* p) const;  dΨ/dG of up to kBlock
///   void energies(const Gradient<D>* g, int count, double* energy) const;  Ψ of up to kBlock
///   Matrix<3D, 3D> tangent(g, definiteness) const;  d²Ψ/dG² over G's entries by columns; not
///       needed where find_vertex_blocks() has an overload and D is 3
///   Matrix<D, 1> bound() const;                     B, with d²Ψ/dG² <= diag(B) per column
/// Every law is 1/2 B |G - P(G)|² with P(G) = G - Ψ' B⁻¹ held while an element is relaxed. Laws are
/// functions of G alone: nothing is kept from call to call, so that results depend on no history.
template <class Law>
class SimplexSet : public ElementSet {
 public:
  static constexpr int D = Law::kDimension;

  std::string_view name() const override { return name_; }
  int size() const override { return static_cast<int>(simplices_.elements.size()); }
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

  const Simplices<D>& simplices() const { return simplices_; }
  const Law& law() const { return law_; }

 protected:
  SimplexSet(std::string name, Simplices<D> simplices, Law law)
      : name_(std::move(name)), simplices_(std::move(simplices)), law_(law) {
    multipliers_.resize(simplices_.elements.size(), Gradient<D>::Zero());
  }

 private:
  static constexpr int kGrain = 32, kSumGrain = 256;
  static constexpr int kBlock = kStressBlock;
  static constexpr int kStiffnessChunk = 512;  // elements whose blocks the cache has room for
  static constexpr double kSliver = 0.5;       // squared cosine between what moves warp and weft

  /// Calls body(first, count, G) for blocks of the elements from `begin` to `end`.
  template <class Body>
  void for_blocks(int begin, int end, const Positions& x, const Body& body) const {
    for (int first = begin; first < end; first += kBlock) {
      const int count = std::min(kBlock, end - first);
      const Simplex<D>* block = simplices_.elements.data() + first;
      Gradient<D> g[kBlock];
      for (int k = 0; k < count; ++k) g[k] = block[k].gradient(x);
      body(static_cast<std::size_t>(first), count, g);
    }
  }
  /// Calls body(e, G, stress) for the elements from `begin` to `end`.
  template <class Body>
  void for_range(int begin, int end, const Positions& x, const Body& body) const {
    for_blocks(begin, end, x, [&](std::size_t first, int count, const Gradient<D>* g) {
      Gradient<D> stress[kBlock];
      law_.stresses(g, count, stress);
      for (int k = 0; k < count; ++k) body(first + static_cast<std::size_t>(k), g[k], stress[k]);
    });
  }
  /// The same for all, colour by colour.
  template <class Body>
  void for_each(const Positions& x, const Body& body) const {
    for (std::size_t c = 0; c + 1 < simplices_.begins.size(); ++c) {
      parallel_for(simplices_.begins[c], simplices_.begins[c + 1], kGrain,
                   [&](int begin, int end) { for_range(begin, end, x, body); });
    }
  }
  const Simplex<D>& element(int e) const {
    return simplices_.elements[static_cast<std::size_t>(e)];
  }
  void list_corners() const;
  static void add_blocks(const Simplex<D>& s, const VertexBlocks<D>& blocks, StiffnessMatrix& k);
  void collect_forces(const Positions& x, Forces& f) const;
  void relax(const Simplex<D>& s, const Gradient<D>& g, const Gradient<D>& stress,
             const Eigen::VectorXd& inverse_mass, double dt2, Gradient<D>& multiplier,
             Positions& x) const;
  /// ΔΛ of what is missing.
  auto answer(const Gradient<D>& g, const Eigen::Matrix<double, D, D>& mobility,
              const Gradient<D>& missing) const -> Gradient<D>;
  /// Whether warp and weft move as one, as in slivers: a force along one, answered with B, is taken
  /// for one along the other too, which has no stiffness that way. Elements that share particles
  /// then drive each other on (of slivers, each sweep made four times as much energy).
  static bool is_sliver(const Eigen::Matrix<double, D, D>& mobility);

  std::string name_;
  Simplices<D> simplices_;
  Law law_;
  std::vector<Gradient<D>> multipliers_;  // weight times stress, of the dimension of energy [J]
  // Of several threads: empty before.
  mutable EntriesOfParticles corners_;
  mutable std::vector<Gradient<D>> stresses_;  // weighted [J]
};

template <class Law>
double SimplexSet<Law>::energy(const Positions& x) const {
  return parallel_reduce(
      0, size(), kSumGrain,
      [&](int begin, int end) {
        double sum = 0.0;
        for_blocks(begin, end, x, [&](std::size_t first, int count, const Gradient<D>* g) {
          double each[kBlock];
          law_.energies(g, count, each);
          const Simplex<D>* block = simplices_.elements.data() + first;
          for (int k = 0; k < count; ++k) sum += block[k].weight * each[k];
        });
        return sum;
      },
      std::plus<>());
}

template <class Law>
void SimplexSet<Law>::add_forces(const Positions& x, Forces& f) const {
  if (size() > kSumGrain && has_free_threads()) {
    collect_forces(x, f);
    return;
  }
  for_range(0, size(), x, [&](std::size_t e, const Gradient<D>&, const Gradient<D>& stress) {
    const Simplex<D>& s = simplices_.elements[e];
    // fₐ = -w Ψ'(G) gₐ
    s.scatter(
        -s.weight * stress, [](int) { return 1.0; }, f);
  });
}

template <class Law>
void SimplexSet<Law>::list_corners() const {
  std::vector<int> vertices;
  vertices.reserve(simplices_.elements.size() * (D + 1));
  for (const Simplex<D>& s : simplices_.elements) {
    vertices.insert(vertices.end(), s.vertices.begin(), s.vertices.end());
  }
  corners_ = EntriesOfParticles(vertices, D + 1);
  stresses_.resize(simplices_.elements.size());
}

/// The same by several threads. A particle adds in the order of the elements: the same bits.
template <class Law>
void SimplexSet<Law>::collect_forces(const Positions& x, Forces& f) const {
  if (stresses_.empty()) list_corners();
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for (int first = begin; first < end; first += kBlock) {
      const int count = std::min(kBlock, end - first);
      const int* numbers = corners_.order.data() + first;
      Gradient<D> g[kBlock], stress[kBlock];
      for (int k = 0; k < count; ++k) g[k] = element(numbers[k]).gradient(x);
      law_.stresses(g, count, stress);
      for (int k = 0; k < count; ++k) {
        stresses_[static_cast<std::size_t>(numbers[k])] = -element(numbers[k]).weight * stress[k];
      }
    }
  });
  parallel_for(0, static_cast<int>(corners_.particles.size()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      Eigen::Vector3d sum = f.col(corners_.particles[at]);
      for (int k = corners_.begins[at]; k < corners_.begins[at + 1]; ++k) {
        const int entry = corners_.entries[static_cast<std::size_t>(k)];
        const int e = entry / (D + 1);
        sum += stresses_[static_cast<std::size_t>(e)] * element(e).shape.col(entry % (D + 1));
      }
      f.col(corners_.particles[at]) = sum;
    }
  });
}

template <class Law>
void SimplexSet<Law>::add_to_system(SystemMatrix& a) const {
  const Eigen::Matrix<double, D, 1> bound = law_.bound();
  for (const Simplex<D>& s : simplices_.elements) {
    const auto entries = (s.weight * (s.shape.transpose() * bound.asDiagonal() * s.shape)).eval();
    for (int r = 0; r <= D; ++r) {
      for (int c = 0; c <= D; ++c) a.add(s.vertices[r], s.vertices[c], entries(r, c));
    }
  }
}

template <class Law>
void SimplexSet<Law>::add_stiffness(const Positions& x, Definiteness definiteness,
                                    StiffnessMatrix& k) const {
  // A matrix takes its blocks one after the other, in one order; several threads find them.
  const int chunk = has_free_threads() ? kStiffnessChunk : kBlock;
  // One for all sets that a thread assembles: more than a small body takes in all.
  static thread_local std::vector<VertexBlocks<D>> memory(kStiffnessChunk);
  std::vector<VertexBlocks<D>>& all_blocks = memory;  // of this thread, for the others too
  for (int first = 0; first < size(); first += chunk) {
    const int last = std::min(size(), first + chunk);
    parallel_for(first, last, kGrain, [&](int begin, int end) {
      for_blocks(begin, end, x, [&](std::size_t e, int count, const Gradient<D>* g) {
        find_vertex_blocks(law_, simplices_.elements.data() + e, g, count, definiteness,
                           all_blocks.data() + (e - static_cast<std::size_t>(first)));
      });
    });
    for (int e = first; e < last; ++e) {
      add_blocks(element(e), all_blocks[static_cast<std::size_t>(e - first)], k);
    }
  }
}

template <class Law>
void SimplexSet<Law>::add_blocks(const Simplex<D>& s, const VertexBlocks<D>& blocks,
                                 StiffnessMatrix& k) {
  auto block = blocks.begin();
  for (int r = 0; r <= D; ++r) {
    for (int c = r; c <= D; ++c, ++block) {
      const Eigen::Matrix3d weighted = s.weight * *block;
      k.add(s.vertices[r], s.vertices[c], weighted);
      if (r != c) k.add(s.vertices[c], s.vertices[r], weighted.transpose());
    }
  }
}

template <class Law>
void SimplexSet<Law>::reset_multipliers() {
  for (Gradient<D>& multiplier : multipliers_) multiplier.setZero();
}

template <class Law>
void SimplexSet<Law>::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  // Elements of a block share no particle: none moves what another has read.
  for_each(x, [&](std::size_t e, const Gradient<D>& g, const Gradient<D>& stress) {
    relax(simplices_.elements[e], g, stress, inverse_mass, dt * dt, multipliers_[e], x);
  });
}

template <class Law>
void SimplexSet<Law>::relax(const Simplex<D>& s, const Gradient<D>& g, const Gradient<D>& stress,
                            const Eigen::VectorXd& inverse_mass, double dt2,
                            Gradient<D>& multiplier, Positions& x) const {
  // With the force -Λ gₐ on each vertex, G moves by -h² Λ M, M = Σₐ wₐ gₐ gₐᵀ, and the stress by H
  // times that: ΔΛ (I + h² w M H) = w Ψ' - Λ, H = B as a rule.
  Eigen::Matrix<double, D, D> mobility = Eigen::Matrix<double, D, D>::Zero();
  for (int a = 0; a <= D; ++a) {
    mobility += inverse_mass[s.vertices[a]] * s.shape.col(a) * s.shape.col(a).transpose();
  }
  const Gradient<D> missing = s.weight * stress - multiplier;
  if (missing.isZero(0.0)) return;  // at rest, or within limits
  mobility *= dt2 * s.weight;
  const Gradient<D> delta = answer(g, mobility, missing);
  multiplier += delta;
  s.scatter(
      delta, [&](int i) { return -dt2 * inverse_mass[i]; }, x);
}

template <class Law>
auto SimplexSet<Law>::answer(const Gradient<D>& g, const Eigen::Matrix<double, D, D>& mobility,
                             const Gradient<D>& missing) const -> Gradient<D> {
  if constexpr (D == 2) {
    if (is_sliver(mobility)) return solve_at(law_, g, mobility, missing);
  }
  const Eigen::Matrix<double, D, D> system =
      Eigen::Matrix<double, D, D>::Identity() + mobility * law_.bound().asDiagonal();
  // Pivoting: cofactors of a stiff element with fixed vertices would cancel.
  return solve_pivoted<D, 3>(system.transpose(), missing.transpose()).transpose();
}

template <class Law>
bool SimplexSet<Law>::is_sliver(const Eigen::Matrix<double, D, D>& mobility) {
  return mobility(0, 1) * mobility(0, 1) > kSliver * mobility(0, 0) * mobility(1, 1);
}

}  // namespace pliant
