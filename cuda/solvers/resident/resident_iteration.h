#pragma once

#include "cuda/solvers/resident/resident_block.h"

/// All iterations of a step of a body so small that all of its blocks run at the same time.
namespace pliant {

/// Each block keeps what it reads of its elements in shared memory; positions at borders alone go
/// through the memory of all. A block begins an iteration when its neighbours have ended the last
/// one; all of a scene wait for each other where the control looks, and each decides by itself what
/// all decide. Neighbours are so mutually: a block is never two iterations ahead of one that reads
/// what it writes. Of systems with one pass, without clusters and without contacts whose points
/// share particles.
struct IterateInRounds : ResidentBlock {
  enum Phase {
    kGather,
    kSum,
    kDecide,
    kBring,
    kForces,
    kCollect,
    kFinish,
    kSumOwn,
    kTell,
    kPhases
  };
  static constexpr int kMostThreads = 640;
  using Sums = BlockSum<kMeasures>;
  using SceneSums = SceneSum<kMeasures>;
  const int* begins;  ///< first block of each scene, and the end
  int blocks;
  Fixed* board;  ///< kPackets a block, of no version

  static constexpr int kPackets = 4;
  /// The last one asks the control alone.
  int rounds() const { return plan.iterations + 1; }

  /// Alike for all threads of a block, whichever of them asks first.
  PLIANT_HOST_DEVICE bool has(int round, int phase, float* shared) const {
    if (phase == kBring) return true;
    if (round == 0 && phase < kBring) return phase == kGather;
    const KeptBlock kept = kept_in(shared);
    if (kept.scene().control.done_at >= 0) return false;
    const KeptInterval& interval = kept.interval();
    const int end = interval.first + interval.count;
    if (phase < kBring) return round == end;
    if (phase == kForces) return forces.elements.slot_begins != nullptr;
    return phase < kSumOwn || round + 1 == end;
  }

  PLIANT_HOST_DEVICE void operator()(int round, int phase, int block, int thread,
                                     float* shared) const {
    const BlockElements of(forces.elements, forces.layout, block);
    if (round == 0 && phase == kGather) return keep(of, thread, shared);
    const KeptBlock kept = kept_in(shared);
    const int done_at = kept.scene().control.done_at;
    if (phase == kGather) {
      gather(kept, round, block, thread);
    } else if (phase == kSum) {
      for (int t = thread; t < SceneSums::kThreads; t += forces.threads) {
        SceneSums::add(1, nullptr, 0, 0, t, kept.scene_sums());
      }
    } else if (phase == kDecide) {
      if (thread == 0) decide(kept, round, block);
    } else if (phase == kBring) {
      if (done_at < 0) bring(kept, of, round, thread);
      if (done_at == round) save_rotations(kept, of, thread);
    } else if (phase == kForces) {
      simplices(kept, thread);
    } else if (phase == kCollect) {
      for (int t = thread; t < collectors(); t += forces.threads) collect(kept, t);
    } else if (phase == kFinish) {
      move(kept, round, block, thread);
    } else if (phase == kSumOwn) {
      Sums::first(shared + forces.layout.before_sums(), forces.layout.block, thread);
    } else if (phase == kTell) {
      tell(kept, round, block, thread);
    }
  }

  /// Threads that have something to collect.
  PLIANT_HOST_DEVICE int collectors() const {
    const int rows = (has_springs() ? 1 : 0) + (at.most.quadratic > 0 ? 1 : 0);
    return (rows + (forces.elements.slot_begins != nullptr ? 3 : 0)) * forces.layout.block;
  }

 private:
  PLIANT_HOST_DEVICE bool has_springs() const { return at.most.springs > 0 || at.most.cells > 0; }
  PLIANT_HOST_DEVICE static Fixed packed_floats(const float* v) {
#ifdef __CUDA_ARCH__
    return {__float_as_int(v[0]), __float_as_int(v[1]), __float_as_int(v[2]), 0.0f};
#else
    Fixed bits;
    std::memcpy(&bits, v, 3 * sizeof(float));
    return bits;
#endif
  }

  PLIANT_HOST_DEVICE void simplices(const KeptBlock& kept, int thread) const {
    const SimplexForces onto = {forces.layout.positions(kept.shared), kept.scene().rules.quantum,
                                kept.shared + forces.layout.before_slots()};
    if (at.most.tetrahedra > 0) onto.tetrahedra(kept.tetrahedra(), thread, forces.threads);
    if (at.most.fibers > 0) onto.fibers(kept.fibers(), thread, forces.threads);
    if (at.most.triangles > 0) {
      onto.triangles(kept.triangles(), forces.elements.materials, thread, forces.threads);
    }
  }

  /// Own places from where the block keeps them; the next positions for others as well.
  struct OwnPlaces {
    const KeptBlock& kept;
    Fixed* published;
    int first, version;

    PLIANT_HOST_DEVICE Fixed predicted(int i) const {
      return kept.own(kept.at.predicted)[i - first];
    }
    PLIANT_HOST_DEVICE float mobility(int i) const {
      return kept.shared[kept.at.mobility + i - first];
    }
    PLIANT_HOST_DEVICE Fixed previous(int i) const { return kept.own(kept.at.last)[i - first]; }
    PLIANT_HOST_DEVICE void set_next(int i, const Fixed& x) const {
      Fixed& y = kept.layout.positions(kept.shared)[i - first];
      kept.own(kept.at.last)[i - first] = y;
      y = x;
      publish(published + i, x, version);
    }
    PLIANT_HOST_DEVICE Fixed projected(int i) const {
      return kept.own(kept.at.projected)[i - first];
    }
    PLIANT_HOST_DEVICE void set_projected(int i, const Fixed& x) const {
      kept.own(kept.at.projected)[i - first] = x;
    }
  };

  /// Forces on the own places, each kind in the order of BlockForces::unbalanced(): of rows a
  /// thread a place, of slots three.
  PLIANT_HOST_DEVICE void collect(const KeptBlock& kept, int t) const {
    const int block = forces.layout.block;
    const GatheredForces from = {forces.layout.positions(kept.shared), kept.scene().rules.quantum};
    if (has_springs()) {
      if (t < block) {
        return put(from.springs(kept.springs(), kept.cells(), t), kept.collected(0) + 3 * t);
      }
      t -= block;
    }
    if (at.most.quadratic > 0) {
      if (t < block) return put(from.quadratic(kept.quadratic(), t), kept.collected(1) + 3 * t);
      t -= block;
    }
    const auto* begins = reinterpret_cast<const int*>(kept.shared + at.slot_begins);
    kept.collected(2)[t] =
        GatheredForces::slots(kept.shared + forces.layout.before_slots(), begins, t / 3, t % 3);
  }
  PLIANT_HOST_DEVICE static void put(const Float3& f, float* to) {
    to[0] = f.x;
    to[1] = f.y;
    to[2] = f.z;
  }
  PLIANT_HOST_DEVICE Float3 unbalanced(const KeptBlock& kept, const OwnPlaces& places, int i,
                                       int own) const {
    const Fixed& y = forces.layout.positions(kept.shared)[own];
    Float3 r =
        held_force(finish.accelerate.arrays, i, y, places.predicted(i), kept.scene().rules.quantum);
    const auto add = [&](int kind) {
      const float* f = kept.collected(kind) + 3 * own;
      r += Float3{f[0], f[1], f[2]};
    };
    if (has_springs()) add(0);
    if (at.most.quadratic > 0) add(1);
    if (forces.elements.slot_begins != nullptr) add(2);
    return r;
  }

  PLIANT_HOST_DEVICE void move(const KeptBlock& kept, int round, int block, int thread) const {
    const StepArrays& arrays = finish.accelerate.arrays;
    if (thread >= forces.layout.block) return;
    const KeptInterval& interval = kept.interval();
    const Turn turn = {round % 2, round - interval.first,
                       round + 1 == interval.first + interval.count};
    float* sums = kept.shared + forces.layout.before_sums() + thread * kMeasures;
    if (turn.measured) Sums::clear(sums);
    const int first = block * forces.layout.block, i = first + thread;
    if (i >= arrays.particles) return;
    const int to = 1 - turn.from;
    const OwnPlaces places = {kept, arrays.x[to], first, round + 1};
    const Fixed y = forces.layout.positions(kept.shared)[thread];
    finish(kept.scene(), turn, i, y, unbalanced(kept, places, i, thread), sums, places);
  }

  // What blocks tell each other of their sums: two packets each, those of two looks in turn.
  PLIANT_HOST_DEVICE Fixed* packets(const KeptBlock& kept, int block) const {
    return board + 2 * (kept.interval().looks % 2 * blocks + block);
  }
  PLIANT_HOST_DEVICE void tell(const KeptBlock& kept, int round, int block, int thread) const {
    if (thread >= 2) return;
    const float* sums = kept.shared + forces.layout.before_sums();
    float packet[3] = {0.0f, 0.0f, 0.0f};
    for (int k = 0; k < 3 && 3 * thread + k < kMeasures; ++k) {
      packet[k] = Sums::of_parts(sums, 3 * thread + k);
    }
    // Who knows these may read the states that the block saved.
    fence_versions();
    publish(packets(kept, block) + thread, packed_floats(packet), round + 1);
  }
  PLIANT_HOST_DEVICE void gather(const KeptBlock& kept, int round, int block, int thread) const {
    static_assert(kMeasures <= 6);
    const int number = finish.accelerate.arrays.number_of(block);
    for (int t = thread; t < SceneSums::kThreads; t += forces.threads) {
      double sums[kMeasures] = {};
      for (int b = begins[number] + t; b < begins[number + 1]; b += SceneSums::kThreads) {
        const Fixed* from = packets(kept, b);
        const Fixed one = await(from, round), other = await(from + 1, round);
        const int bits[6] = {one.x, one.y, one.z, other.x, other.y, other.z};
        for (int m = 0; m < kMeasures; ++m) sums[m] += version_bits(bits[m]);
      }
      for (int m = 0; m < kMeasures; ++m) kept.scene_sums()[t * kMeasures + m] = sums[m];
    }
    fence_versions();
  }
  PLIANT_HOST_DEVICE void decide(const KeptBlock& kept, int round, int block) const {
    const int number = finish.accelerate.arrays.number_of(block), next = plan.length(round);
    double total[kMeasures];
    SceneSums::total(kept.scene_sums(), total);
    StepControl control = kept.scene().control;
    const StepRules rules = kept.scene().rules;
    StepDecision{round, next, plan.is_last(round)}({control, rules}, total);
    kept.scene().control = control;
    KeptInterval& interval = kept.interval();
    interval = {round, next, interval.looks + 1};
    if (control.done_at >= 0 && block == begins[number]) {
      finish.accelerate.arrays.control[number] = control;
    }
  }
};

}  // namespace pliant
