#pragma once

#include "cuda/solvers/blocks/shared_memory_load.h"

/// All iterations of a step in one persistent kernel, for a body so small that all of its blocks
/// run at the same time.
namespace pliant {

/// Each block keeps what it reads of its elements in shared memory; positions at borders alone go
/// through the memory of all. A block begins an iteration when its neighbours have ended the last
/// one; all of a scene wait for each other where the control looks, and each decides by itself what
/// all decide. Neighbours are so mutually: a block is never two iterations ahead of one that reads
/// what it writes. Of systems with one pass, without clusters and without contacts whose points
/// share particles.
struct PersistentIteration : SharedMemoryLoad {
  enum Phase {
    kReadSums,
    kSum,
    kDecide,
    kRead,
    kForces,
    kCollect,
    kFinish,
    kSumOwn,
    kPost,
    kPhases
  };
  static constexpr int kMostThreads = 640;
  using Sums = BlockSum<kMeasures>;
  using SceneSums = SceneSum<kMeasures>;
  const int* begins;  ///< first block of each scene, and the end
  int blocks;
  Fixed* mailboxes;  ///< kPackets a block, of no version

  static constexpr int kPackets = 4;
  /// Those of the kernel, of which the last one asks the control alone.
  int iterations() const { return plan.iterations + 1; }

  /// Alike for all threads of a block, whichever of them asks first.
  PLIANT_HOST_DEVICE bool has(int iteration, int phase, float* shared) const {
    if (phase == kRead) return true;
    if (iteration == 0 && phase < kRead) return phase == kReadSums;
    const SharedMemoryBlock memory = memory_of(shared);
    if (memory.scene().control.done_at >= 0) return false;
    const ControlInterval& interval = memory.interval();
    const int end = interval.first + interval.count;
    if (phase < kRead) return iteration == end;
    if (phase == kForces) return forces.elements.slot_begins != nullptr;
    return phase < kSumOwn || iteration + 1 == end;
  }

  PLIANT_HOST_DEVICE void operator()(int iteration, int phase, int block, int thread,
                                     float* shared) const {
    const BlockElements of(forces.elements, forces.layout, block);
    if (iteration == 0 && phase == kReadSums) return load(of, thread, shared);
    const SharedMemoryBlock memory = memory_of(shared);
    const int done_at = memory.scene().control.done_at;
    if (phase == kReadSums) {
      read_sums(memory, iteration, block, thread);
    } else if (phase == kSum) {
      for (int t = thread; t < SceneSums::kThreads; t += forces.threads) {
        SceneSums::add(1, nullptr, 0, 0, t, memory.scene_sums());
      }
    } else if (phase == kDecide) {
      if (thread == 0) decide(memory, iteration, block);
    } else if (phase == kRead) {
      if (done_at < 0) read_positions(memory, of, iteration, thread);
      if (done_at == iteration) save_rotations(memory, of, thread);
    } else if (phase == kForces) {
      simplices(memory, thread);
    } else if (phase == kCollect) {
      for (int t = thread; t < collectors(); t += forces.threads) collect(memory, t);
    } else if (phase == kFinish) {
      move(memory, iteration, block, thread);
    } else if (phase == kSumOwn) {
      Sums::first(shared + forces.layout.before_sums(), forces.layout.block, thread);
    } else if (phase == kPost) {
      post_sums(memory, iteration, block, thread);
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

  PLIANT_HOST_DEVICE void simplices(const SharedMemoryBlock& memory, int thread) const {
    const SimplexForces onto = {forces.layout.positions(memory.shared),
                                memory.scene().rules.quantum,
                                memory.shared + forces.layout.before_slots()};
    if (at.most.tetrahedra > 0) onto.tetrahedra(memory.tetrahedra(), thread, forces.threads);
    if (at.most.fibers > 0) onto.fibers(memory.fibers(), thread, forces.threads);
    if (at.most.triangles > 0) {
      onto.triangles(memory.triangles(), forces.elements.materials, thread, forces.threads);
    }
  }

  /// Own places in the block's shared memory; the next positions are posted for other blocks too.
  struct OwnPlaces {
    const SharedMemoryBlock& memory;
    Fixed* posted;
    int first, version;

    PLIANT_HOST_DEVICE Fixed predicted(int i) const {
      return memory.own(memory.at.predicted)[i - first];
    }
    PLIANT_HOST_DEVICE float mobility(int i) const {
      return memory.shared[memory.at.mobility + i - first];
    }
    PLIANT_HOST_DEVICE Fixed previous(int i) const { return memory.own(memory.at.last)[i - first]; }
    PLIANT_HOST_DEVICE void set_next(int i, const Fixed& x) const {
      Fixed& y = memory.layout.positions(memory.shared)[i - first];
      memory.own(memory.at.last)[i - first] = y;
      y = x;
      post(posted + i, x, version);
    }
    PLIANT_HOST_DEVICE Fixed projected(int i) const {
      return memory.own(memory.at.projected)[i - first];
    }
    PLIANT_HOST_DEVICE void set_projected(int i, const Fixed& x) const {
      memory.own(memory.at.projected)[i - first] = x;
    }
  };

  /// Forces on the own places, each kind in the order of BlockForces::unbalanced(): of rows a
  /// thread a place, of slots three.
  PLIANT_HOST_DEVICE void collect(const SharedMemoryBlock& memory, int t) const {
    const int block = forces.layout.block;
    const GatheredForces from = {forces.layout.positions(memory.shared),
                                 memory.scene().rules.quantum};
    if (has_springs()) {
      if (t < block) {
        return put(from.springs(memory.springs(), memory.cells(), t), memory.collected(0) + 3 * t);
      }
      t -= block;
    }
    if (at.most.quadratic > 0) {
      if (t < block) return put(from.quadratic(memory.quadratic(), t), memory.collected(1) + 3 * t);
      t -= block;
    }
    const auto* begins = reinterpret_cast<const int*>(memory.shared + at.slot_begins);
    memory.collected(2)[t] =
        GatheredForces::slots(memory.shared + forces.layout.before_slots(), begins, t / 3, t % 3);
  }
  PLIANT_HOST_DEVICE static void put(const Float3& f, float* to) {
    to[0] = f.x;
    to[1] = f.y;
    to[2] = f.z;
  }
  PLIANT_HOST_DEVICE Float3 unbalanced(const SharedMemoryBlock& memory, const OwnPlaces& places,
                                       int i, int own) const {
    const Fixed& y = forces.layout.positions(memory.shared)[own];
    Float3 r = held_force(finish.accelerate.arrays, i, y, places.predicted(i),
                          memory.scene().rules.quantum);
    const auto add = [&](int kind) {
      const float* f = memory.collected(kind) + 3 * own;
      r += Float3{f[0], f[1], f[2]};
    };
    if (has_springs()) add(0);
    if (at.most.quadratic > 0) add(1);
    if (forces.elements.slot_begins != nullptr) add(2);
    return r;
  }

  PLIANT_HOST_DEVICE void move(const SharedMemoryBlock& memory, int iteration, int block,
                               int thread) const {
    const StepArrays& arrays = finish.accelerate.arrays;
    if (thread >= forces.layout.block) return;
    const ControlInterval& interval = memory.interval();
    const Turn turn = {iteration % 2, iteration - interval.first,
                       iteration + 1 == interval.first + interval.count};
    float* sums = memory.shared + forces.layout.before_sums() + thread * kMeasures;
    if (turn.measured) Sums::clear(sums);
    const int first = block * forces.layout.block, i = first + thread;
    if (i >= arrays.particles) return;
    const int to = 1 - turn.from;
    const OwnPlaces places = {memory, arrays.x[to], first, iteration + 1};
    const Fixed y = forces.layout.positions(memory.shared)[thread];
    finish(memory.scene(), turn, i, y, unbalanced(memory, places, i, thread), sums, places);
  }

  // Mailboxes of a block's sums: two packets, those of two looks of the control in turn.
  PLIANT_HOST_DEVICE Fixed* packets(const SharedMemoryBlock& memory, int block) const {
    return mailboxes + 2 * (memory.interval().looks % 2 * blocks + block);
  }
  PLIANT_HOST_DEVICE void post_sums(const SharedMemoryBlock& memory, int iteration, int block,
                                    int thread) const {
    if (thread >= 2) return;
    const float* sums = memory.shared + forces.layout.before_sums();
    float packet[3] = {0.0f, 0.0f, 0.0f};
    for (int k = 0; k < 3 && 3 * thread + k < kMeasures; ++k) {
      packet[k] = Sums::of_parts(sums, 3 * thread + k);
    }
    // Who knows these may read the states that the block saved.
    fence_versions();
    post(packets(memory, block) + thread, packed_floats(packet), iteration + 1);
  }
  PLIANT_HOST_DEVICE void read_sums(const SharedMemoryBlock& memory, int iteration, int block,
                                    int thread) const {
    static_assert(kMeasures <= 6);
    const int number = finish.accelerate.arrays.number_of(block);
    for (int t = thread; t < SceneSums::kThreads; t += forces.threads) {
      double sums[kMeasures] = {};
      for (int b = begins[number] + t; b < begins[number + 1]; b += SceneSums::kThreads) {
        const Fixed* from = packets(memory, b);
        const Fixed one = await(from, iteration), other = await(from + 1, iteration);
        const int bits[6] = {one.x, one.y, one.z, other.x, other.y, other.z};
        for (int m = 0; m < kMeasures; ++m) sums[m] += version_bits(bits[m]);
      }
      for (int m = 0; m < kMeasures; ++m) memory.scene_sums()[t * kMeasures + m] = sums[m];
    }
    fence_versions();
  }
  PLIANT_HOST_DEVICE void decide(const SharedMemoryBlock& memory, int iteration, int block) const {
    const int number = finish.accelerate.arrays.number_of(block), next = plan.length(iteration);
    double total[kMeasures];
    SceneSums::total(memory.scene_sums(), total);
    StepControl control = memory.scene().control;
    const StepRules rules = memory.scene().rules;
    StepDecision{iteration, next, plan.is_last(iteration)}({control, rules}, total);
    memory.scene().control = control;
    ControlInterval& interval = memory.interval();
    interval = {iteration, next, interval.looks + 1};
    if (control.done_at >= 0 && block == begins[number]) {
      finish.accelerate.arrays.control[number] = control;
    }
  }
};

}  // namespace pliant
