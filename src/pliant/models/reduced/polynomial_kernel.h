#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace pliant {

/// Eight numbers that are added and multiplied at once. Sums run over lanes in the same order on
/// every processor, so that results do not depend on how wide its registers are.
using Lanes __attribute__((vector_size(64))) = double;
constexpr int kLanes = 8;
constexpr int lanes_for(int numbers) { return (numbers + kLanes - 1) / kLanes; }

/// Memory at multiples of their size, which is more than compilers promise for narrow processors.
template <class T>
struct LaneAllocator {
  using value_type = T;
  T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), kAlignment));
  }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, kAlignment); }
  friend bool operator==(const LaneAllocator&, const LaneAllocator&) { return true; }
  friend bool operator!=(const LaneAllocator&, const LaneAllocator&) { return false; }

 private:
  static constexpr std::align_val_t kAlignment{sizeof(Lanes)};
};
using LaneVector = std::vector<Lanes, LaneAllocator<Lanes>>;

/// Rows of coefficients, each of `lanes` Lanes, one after the other.
struct CoefficientRows {
  const Lanes* begin;
  int rows;
  int lanes;
};

/// The arrays of Lanes are LaneVectors'. dots[row] = C[row] · s and sum += Σ weights[row] C[row],
/// reading C once.
void contract(const CoefficientRows& c, const double* weights, const Lanes* s, Lanes* sum,
              double* dots);

/// Largest rank of a reduced body.
constexpr int kMaxRank = 100;

/// Intermediate results of add_force(): one Lanes more than the pairs of coordinates fill.
struct ForceSpace {
  LaneVector s, sum;
};

/// r += the gradient of the cubic and quartic terms, which it returns the value of. `blocks` are
/// the coefficients in the order of QuarticPotential::index(), each row padded to whole Lanes; q
/// and r have 2 kLanes numbers of room beyond rank, 0 in q.
double add_force(const Lanes* blocks, int rank, const double* q, double* r, ForceSpace& space);

/// As contract(), and targets[row] += scale C[row], rows of targets lying `stride` Lanes apart.
void contract_and_spread(const CoefficientRows& c, const double* weights, double scale,
                         const Lanes* s, Lanes* sum, Lanes* targets, std::ptrdiff_t stride,
                         double* dots);

/// The sum of all lanes; what reading them alone costs.
double sum_lanes(const Lanes* lanes, std::size_t count);

}  // namespace pliant
