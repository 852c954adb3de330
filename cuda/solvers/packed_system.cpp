#include "cuda/solvers/packed_system.h"

#include <algorithm>
#include <map>
#include <utility>

#include "cuda/solvers/vertex_blocks.h"
#include "pliant/elements/attachment_set.h"
#include "pliant/elements/bending_set.h"
#include "pliant/elements/cluster_set.h"
#include "pliant/elements/fiber_set.h"
#include "pliant/elements/spring_set.h"
#include "pliant/elements/tetrahedron_set.h"
#include "pliant/elements/triangle_strain_set.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

class Packer {
 public:
  Packer(const ProjectiveSystem& system, int block) : system_(system) {
    packed_.particles = system.particles.size();
    packed_.block = block;
    packed_.blocks = (packed_.particles + block - 1) / block;
    packed_.scene_begins = {0, packed_.blocks};
    packed_.order = order_in_blocks(system.particles.x, block);
    packed_.place.resize(packed_.order.size());
    for (std::size_t i = 0; i < packed_.order.size(); ++i) {
      packed_.place[static_cast<std::size_t>(packed_.order[i])] = static_cast<int>(i);
    }
  }

  PackedSystem pack() {
    add_springs();
    add_bending();
    add_simplices();
    pack_clusters(system_, packed_);
    return std::move(packed_);
  }

 private:
  int place(int particle) const { return packed_.place[static_cast<std::size_t>(particle)]; }
  template <class Set, class Use>
  void for_each(const Use& use) const {
    for (const auto& set : system_.elements) {
      if (const auto* found = dynamic_cast<const Set*>(set.get())) use(*found);
    }
  }

  void add_springs() {
    EntryRows rows(packed_.order.size());
    bool any = false;
    for_each<SpringSet>([&](const SpringSet& set) {
      for (const Spring& s : set.springs()) {
        any = true;
        const int i = place(s.i), j = place(s.j);
        const auto l = static_cast<float>(s.rest_length), k = static_cast<float>(s.stiffness);
        rows[static_cast<std::size_t>(i)].push_back({j, l, k});
        rows[static_cast<std::size_t>(j)].push_back({i, l, k});
      }
    });
    if (any) packed_.springs = sliced(rows);
  }

  void add_bending() {
    // E = 1/2 k |Σ w x|², whose weights add up to nothing: f_i = Σ_j k w_i w_j (x_i - x_j).
    std::vector<std::map<int, double>> coefficients(packed_.order.size());
    bool any = false;
    for_each<BendingSet>([&](const BendingSet& set) {
      any = true;
      for (const BendingSet::Hinge& hinge : set.hinges()) {
        for (std::size_t r = 0; r < 4; ++r) {
          for (std::size_t c = 0; c < 4; ++c) {
            const double entry = -hinge.stiffness * hinge.weights[r] * hinge.weights[c];
            if (r == c || entry == 0.0) continue;
            const auto row = static_cast<std::size_t>(place(hinge.vertices[r]));
            coefficients[row][place(hinge.vertices[c])] += entry;
          }
        }
      }
    });
    if (!any) return;
    EntryRows rows(coefficients.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (const auto& [j, value] : coefficients[i]) {
        rows[i].push_back({j, 0.0f, static_cast<float>(value)});
      }
    }
    packed_.quadratic = sliced(rows);
  }

  /// One element as it comes from its set.
  struct Flat {
    std::array<int, 4> places;
    std::array<float, 9> shape;
    float weight, ratio;
    int material;
  };

  template <int D>
  Flat flat(const Simplex<D>& s, double ratio, int material) const {
    Flat result = {
        {-1, -1, -1, -1}, {}, static_cast<float>(s.weight), static_cast<float>(ratio), material};
    for (std::size_t a = 0; a <= D; ++a) result.places[a] = place(s.vertices[a]);
    for (int a = 1; a <= D; ++a) {
      for (int d = 0; d < D; ++d) {
        result.shape[static_cast<std::size_t>(D * (a - 1) + d)] = static_cast<float>(s.shape(d, a));
      }
    }
    return result;
  }

  void add_simplices() {
    std::vector<Flat> tetrahedra, fibers, triangles;
    for_each<TetrahedronSet>([&](const TetrahedronSet& set) {
      for (const auto& s : set.simplices().elements) {
        tetrahedra.push_back(flat<3>(s, set.law().ratio, 0));
      }
    });
    for_each<FiberSet>([&](const FiberSet& set) {
      for (const auto& s : set.simplices().elements) fibers.push_back(flat<3>(s, 0.0, 0));
    });
    for_each<TriangleStrainSet>([&](const TriangleStrainSet& set) {
      const int material = add_material(set.law().material);
      for (const auto& s : set.simplices().elements) {
        triangles.push_back(flat<2>(s, 0.0, material));
      }
    });
    counts_.assign(packed_.order.size(), 0);
    pack(tetrahedra, 4, 9, packed_.tetrahedra);
    pack(fibers, 4, 9, packed_.fibers);
    pack(triangles, 3, 4, packed_.triangles);
    place_slots();
  }

  int add_material(const MembraneMaterial& m) {
    const auto f = [](double value) { return static_cast<float>(value); };
    packed_.materials.push_back({f(m.warp), f(m.weft), f(m.shear), f(m.limit), f(m.warp_limits.min),
                                 f(m.warp_limits.max), f(m.weft_limits.min), f(m.weft_limits.max)});
    return static_cast<int>(packed_.materials.size()) - 1;
  }

  /// Lists the elements of each block; a corner's slot is its number among those of its particle
  /// for now.
  void pack(const std::vector<Flat>& elements, int corners, int shape_numbers,
            PackedSimplices& out) {
    out.corners = corners;
    out.shape_numbers = shape_numbers;
    std::vector<std::vector<int>> lists(static_cast<std::size_t>(packed_.blocks));
    for (std::size_t e = 0; e < elements.size(); ++e) {
      for (int a = 0; a < corners; ++a) {
        auto& list = lists[static_cast<std::size_t>(block_of(elements[e].places[a]))];
        if (list.empty() || list.back() != static_cast<int>(e)) list.push_back(static_cast<int>(e));
      }
    }
    std::size_t total = 0;
    for (const auto& list : lists) total += list.size();
    out.shape.resize(total * static_cast<std::size_t>(shape_numbers));
    out.begins = {0};
    for (std::size_t b = 0; b < lists.size(); ++b) {
      for (int e : lists[b])
        add(elements[static_cast<std::size_t>(e)], static_cast<int>(b), total, out);
      out.begins.push_back(out.size());
    }
  }

  void add(const Flat& element, int block, std::size_t total, PackedSimplices& out) {
    const std::size_t number = out.vertices.size();
    Int4 vertices = {};
    UShort4 slots = {};
    for (int a = 0; a < 4; ++a) {
      const int at = element.places[static_cast<std::size_t>(a)];
      const bool is_own = a < out.corners && block_of(at) == block;
      vertices.v[a] = std::max(at, 0);
      slots.v[a] = is_own ? static_cast<unsigned short>(counts_[static_cast<std::size_t>(at)]++)
                          : PackedSimplices::kNoSlot;
    }
    out.vertices.push_back(vertices);
    out.slots.push_back(slots);
    for (int k = 0; k < out.shape_numbers; ++k) {
      out.shape[static_cast<std::size_t>(k) * total + number] =
          element.shape[static_cast<std::size_t>(k)];
    }
    out.weight.push_back(element.weight);
    out.ratio.push_back(element.ratio);
    out.material.push_back(element.material);
  }

  /// A particle's slots follow one another.
  void place_slots() {
    const int stride = packed_.block + 1;
    packed_.slot_begins.assign(static_cast<std::size_t>(packed_.blocks * stride), 0);
    for (int b = 0; b < packed_.blocks; ++b) {
      int slot = 0;
      for (int k = 0; k <= packed_.block; ++k) {
        packed_.slot_begins[static_cast<std::size_t>(b * stride + k)] = slot;
        const int i = b * packed_.block + k;
        if (k < packed_.block && i < packed_.particles) {
          slot += counts_[static_cast<std::size_t>(i)];
        }
      }
      packed_.most_slots = std::max(packed_.most_slots, slot);
    }
    for (PackedSimplices* simplices : {&packed_.tetrahedra, &packed_.fibers, &packed_.triangles}) {
      for (std::size_t e = 0; e < simplices->vertices.size(); ++e) {
        for (int a = 0; a < simplices->corners; ++a) {
          unsigned short& slot = simplices->slots[e].v[a];
          if (slot == PackedSimplices::kNoSlot) continue;
          const int at = simplices->vertices[e].v[a];
          slot = static_cast<unsigned short>(slot + first_slot(at));
        }
      }
    }
  }

  int block_of(int place) const { return place / packed_.block; }
  int first_slot(int place) const {
    const int b = block_of(place);
    return packed_
        .slot_begins[static_cast<std::size_t>(b * (packed_.block + 1) + place - b * packed_.block)];
  }

  const ProjectiveSystem& system_;
  PackedSystem packed_;
  std::vector<int> counts_;  // slots of each place
};

template <class... Sets>
bool is_one_of(const ElementSet& set) {
  return ((dynamic_cast<const Sets*>(&set) != nullptr) || ...);
}

}  // namespace

std::string why_not_packed(const ProjectiveSystem& system) {
  const ClusterSet* clusters = nullptr;
  for (const auto& set : system.elements) {
    if (!is_one_of<SpringSet, BendingSet, TetrahedronSet, FiberSet, TriangleStrainSet,
                   AttachmentSet>(*set) &&
        !is_cluster_set(*set, clusters)) {
      return "elements '" + std::string(set->name()) + "' are computed by the CPU only";
    }
  }
  return {};
}

void pack_clusters(const ProjectiveSystem& system, PackedSystem& packed) {
  packed.clusters = {};
  for (const auto& set : system.elements) {
    const ClusterSet* clusters = nullptr;
    if (!is_cluster_set(*set, clusters) || clusters == nullptr) continue;
    append_clusters(list_clusters(*clusters, packed.place, packed.particles), 0, packed.particles,
                    packed.clusters);
  }
}

std::vector<long> structure_of(const ProjectiveSystem& system) {
  std::vector<long> structure = {system.particles.size()};
  for (const auto& set : system.elements) {
    if (is_one_of<AttachmentSet>(*set)) continue;
    const ClusterSet* clusters = nullptr;
    if (!is_cluster_set(*set, clusters)) return {};
    structure.push_back(clusters == nullptr ? 0 : clusters->version());
  }
  return structure;
}

PackedSystem pack(const ProjectiveSystem& system, int block) {
  const std::string reason = why_not_packed(system);
  if (!reason.empty()) throw InputError(reason);
  return Packer(system, block).pack();
}

}  // namespace pliant
