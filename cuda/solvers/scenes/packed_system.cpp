#include "cuda/solvers/scenes/packed_system.h"

#include <algorithm>
#include <map>
#include <utility>

#include "cuda/solvers/blocks/vertex_blocks.h"
#include "pliant/elements/attachment_set.h"
#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/cloth/cell_shear_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/elements/cloth/triangle_strain_set.h"
#include "pliant/elements/clusters/cluster_set.h"
#include "pliant/elements/solids/fiber_set.h"
#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

class Packer {
 public:
  Packer(const ProjectiveSystem& system, int block, int passes) : system_(system) {
    packed_.particles = system.particles.size();
    packed_.block = block;
    packed_.passes = passes;
    packed_.blocks = (packed_.particles + block - 1) / block;
    packed_.scene_begins = {0, packed_.blocks};
    packed_.order = order_in_blocks(system.particles.x, block);
    packed_.place.resize(packed_.order.size());
    for (std::size_t i = 0; i < packed_.order.size(); ++i) {
      packed_.place[static_cast<std::size_t>(packed_.order[i])] = static_cast<int>(i);
    }
  }

  PackedSystem pack() {
    const SlicedRows springs = spring_rows(), cells = cell_rows(), bending = bending_rows();
    find_simplices();
    find_borders({&springs, &cells, &bending});
    if (!springs.empty()) packed_.springs = localized(springs, packed_.borders);
    if (!cells.empty()) packed_.cells = localized_cells(cells, packed_.borders);
    if (!bending.empty()) packed_.quadratic = localized(bending, packed_.borders);
    pack_simplices();
    pack_clusters(system_, packed_);
    return std::move(packed_);
  }

 private:
  int place(int particle) const { return packed_.place[static_cast<std::size_t>(particle)]; }
  template <class Set, class Use>
  void for_each(const Use& use) const {
    pliant::for_each<Set>(system_.elements, use);
  }

  SlicedRows spring_rows() const {
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
    return any ? sliced(rows) : SlicedRows();
  }

  /// By threes: the opposite corner, then the ends of the other diagonal.
  SlicedRows cell_rows() const {
    EntryRows rows(packed_.order.size());
    bool any = false;
    for_each<CellShearSet>([&](const CellShearSet& set) {
      for (const ShearCell& cell : set.cells()) {
        any = true;
        const auto k = static_cast<float>(cell.stiffness);
        for (std::size_t c = 0; c < 4; ++c) {
          const auto at = [&](std::size_t turn) { return place(cell.corners[(c + turn) % 4]); };
          auto& row = rows[static_cast<std::size_t>(at(0))];
          row.push_back({at(2), 0.0f, k});
          row.push_back({at(1), 0.0f, k});
          row.push_back({at(3), 0.0f, k});
        }
      }
    });
    return any ? sliced(rows, 3 * SlicedRows::kShortUnroll) : SlicedRows();
  }

  SlicedRows bending_rows() const {
    std::vector<std::map<int, double>> coefficients(packed_.order.size());
    bool any = false;
    for_each<BendingSet>([&](const BendingSet& set) {
      any = true;
      const BendingRows& rows = set.rows();
      for (std::size_t i = 0; i + 1 < rows.begins.size(); ++i) {
        auto& row = coefficients[static_cast<std::size_t>(place(static_cast<int>(i)))];
        for (auto k = static_cast<std::size_t>(rows.begins[i]);
             k < static_cast<std::size_t>(rows.begins[i + 1]); ++k) {
          row[place(rows.columns[k])] += rows.values[k];
        }
      }
    });
    if (!any) return {};
    EntryRows rows(coefficients.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (const auto& [j, value] : coefficients[i]) {
        rows[i].push_back({j, 0.0f, static_cast<float>(value)});
      }
    }
    return sliced(rows);
  }

  /// One element as it comes from its set.
  struct Flat {
    std::array<int, 4> places;
    std::array<float, 12> numbers;  ///< PackedSimplices::numbers
  };
  struct Simplices {
    int corners, quads;
    std::vector<Flat> elements;
    std::vector<std::vector<int>> lists;  ///< those of each block
  };

  template <int D>
  Flat flat(const Simplex<D>& s, double ratio, int material) const {
    Flat result = {{-1, -1, -1, -1}, {}};
    for (std::size_t a = 0; a <= D; ++a) result.places[a] = place(s.vertices[a]);
    std::size_t next = 0;
    for (int a = 1; a <= D; ++a) {
      for (int d = 0; d < D; ++d) result.numbers[next++] = static_cast<float>(s.shape(d, a));
    }
    result.numbers[next++] = static_cast<float>(s.weight);
    result.numbers[next] = D == 3 ? static_cast<float>(ratio) : static_cast<float>(material);
    return result;
  }

  void find_simplices() {
    for_each<TetrahedronSet>([&](const TetrahedronSet& set) {
      for (const auto& s : set.simplices().elements) {
        tetrahedra_.elements.push_back(flat<3>(s, set.law().ratio, 0));
      }
    });
    for_each<FiberSet>([&](const FiberSet& set) {
      for (const auto& s : set.simplices().elements) fibers_.elements.push_back(flat<3>(s, 0.0, 0));
    });
    for_each<TriangleStrainSet>([&](const TriangleStrainSet& set) {
      const int material = add_material(set.law().material);
      for (const auto& s : set.simplices().elements) {
        triangles_.elements.push_back(flat<2>(s, 0.0, material));
      }
    });
    for (Simplices* simplices : {&tetrahedra_, &fibers_, &triangles_}) list_by_blocks(*simplices);
  }

  void find_borders(std::initializer_list<const SlicedRows*> all_rows) {
    std::vector<std::vector<int>> read(static_cast<std::size_t>(packed_.blocks));
    bool any = false;
    for (const SlicedRows* rows : all_rows) {
      any = any || !rows->empty();
      const int slices_of_block = packed_.block / SlicedRows::kSlice;
      for (std::size_t slice = 0; slice + 1 < rows->begins.size(); ++slice) {
        auto& places = read[slice / static_cast<std::size_t>(slices_of_block)];
        const auto first = rows->neighbors.begin();
        places.insert(places.end(), first + rows->begins[slice], first + rows->begins[slice + 1]);
      }
    }
    for (const Simplices* simplices : {&tetrahedra_, &fibers_, &triangles_}) {
      any = any || !simplices->elements.empty();
      for (std::size_t b = 0; b < simplices->lists.size(); ++b) {
        for (int e : simplices->lists[b]) {
          const auto& places = simplices->elements[static_cast<std::size_t>(e)].places;
          read[b].insert(read[b].end(), places.begin(), places.begin() + simplices->corners);
        }
      }
    }
    if (any) packed_.borders = BlockBorders(packed_.block, std::move(read));
  }

  void pack_simplices() {
    counts_.assign(packed_.order.size() * passes(), 0);
    pack(tetrahedra_, packed_.tetrahedra);
    pack(fibers_, packed_.fibers);
    pack(triangles_, packed_.triangles);
    place_slots();
  }

  int add_material(const MembraneMaterial& m) {
    const auto f = [](double value) { return static_cast<float>(value); };
    packed_.materials.push_back({f(m.warp), f(m.weft), f(m.shear), f(m.limit), f(m.warp_limits.min),
                                 f(m.warp_limits.max), f(m.weft_limits.min), f(m.weft_limits.max)});
    return static_cast<int>(packed_.materials.size()) - 1;
  }

  void list_by_blocks(Simplices& simplices) const {
    simplices.lists.resize(static_cast<std::size_t>(packed_.blocks));
    for (std::size_t e = 0; e < simplices.elements.size(); ++e) {
      for (int a = 0; a < simplices.corners; ++a) {
        const int at = simplices.elements[e].places[static_cast<std::size_t>(a)];
        auto& list = simplices.lists[static_cast<std::size_t>(block_of(at))];
        if (list.empty() || list.back() != static_cast<int>(e)) list.push_back(static_cast<int>(e));
      }
    }
  }

  /// A corner's slot is its number among those of its particle for now.
  void pack(const Simplices& from, PackedSimplices& out) {
    out.corners = from.corners;
    out.quads = from.quads;
    std::size_t total = 0;
    for (const auto& list : from.lists) total += list.size();
    out.numbers.resize(total * static_cast<std::size_t>(from.quads));
    out.begins = {0};
    for (std::size_t b = 0; b < from.lists.size(); ++b) {
      const std::vector<int>& list = from.lists[b];
      std::size_t next = 0;
      for (std::size_t pass = 0; pass < passes(); ++pass) {
        for (; next < (pass + 1) * list.size() / passes(); ++next) {
          const auto e = static_cast<std::size_t>(list[next]);
          add(from.elements[e], static_cast<int>(b), pass, total, out);
        }
        out.begins.push_back(out.size());
      }
    }
  }

  std::size_t passes() const { return static_cast<std::size_t>(packed_.passes); }
  /// Slots of a place in a pass.
  int& count(int place, std::size_t pass) {
    return counts_[static_cast<std::size_t>(place) * passes() + pass];
  }

  void add(const Flat& element, int block, std::size_t pass, std::size_t total,
           PackedSimplices& out) {
    const std::size_t number = out.places.size();
    UShort4 places = {}, slots = {};
    for (int a = 0; a < 4; ++a) {
      const int at = element.places[static_cast<std::size_t>(a)];
      const bool is_own = a < out.corners && block_of(at) == block;
      places.v[a] = a < out.corners ? packed_.borders.number(block, at) : 0;
      slots.v[a] =
          is_own ? static_cast<unsigned short>(count(at, pass)++) : PackedSimplices::kNoSlot;
    }
    out.places.push_back(places);
    out.slots.push_back(slots);
    const auto& n = element.numbers;
    for (std::size_t q = 0; q < static_cast<std::size_t>(out.quads); ++q) {
      out.numbers[q * total + number] = {n[4 * q], n[4 * q + 1], n[4 * q + 2], n[4 * q + 3]};
    }
  }

  /// A particle's slots follow one another.
  void place_slots() {
    for (int b = 0; b < packed_.blocks; ++b) {
      for (std::size_t pass = 0; pass < passes(); ++pass) {
        int slot = 0;
        for (int k = 0; k <= packed_.block; ++k) {
          packed_.slot_begins.push_back(slot);
          const int i = b * packed_.block + k;
          if (k < packed_.block && i < packed_.particles) slot += count(i, pass);
        }
        packed_.most_slots = std::max(packed_.most_slots, slot);
      }
    }
    for (PackedSimplices* simplices : {&packed_.tetrahedra, &packed_.fibers, &packed_.triangles}) {
      for (std::size_t part = 0; part + 1 < simplices->begins.size(); ++part) {
        const int* first =
            packed_.slot_begins.data() + static_cast<std::ptrdiff_t>(part) * (packed_.block + 1);
        for (int e = simplices->begins[part]; e < simplices->begins[part + 1]; ++e) {
          const auto at = static_cast<std::size_t>(e);
          for (int a = 0; a < simplices->corners; ++a) {
            unsigned short& slot = simplices->slots[at].v[a];
            if (slot == PackedSimplices::kNoSlot) continue;
            slot = static_cast<unsigned short>(slot + first[simplices->places[at].v[a]]);
          }
        }
      }
    }
  }

  int block_of(int place) const { return place / packed_.block; }

  const ProjectiveSystem& system_;
  PackedSystem packed_;
  Simplices tetrahedra_ = {4, 3, {}, {}}, fibers_ = {4, 3, {}, {}}, triangles_ = {3, 2, {}, {}};
  std::vector<int> counts_;  // slots of each place and pass
};

template <class... Sets>
bool is_one_of(const ElementSet& set) {
  return ((as<Sets>(set) != nullptr) || ...);
}

}  // namespace

std::string why_not_packed(const ProjectiveSystem& system) {
  const ClusterSet* clusters = nullptr;
  for (const auto& set : system.elements) {
    if (!is_one_of<SpringSet, CellShearSet, BendingSet, TetrahedronSet, FiberSet, TriangleStrainSet,
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

void pack_spins(const ProjectiveSystem& system, const PackedSystem& packed,
                std::vector<float>& spins) {
  spins.clear();
  if (!packed.clusters.is_oriented) return;
  for (const auto& set : system.elements) {
    const ClusterSet* clusters = nullptr;
    if (!is_cluster_set(*set, clusters) || clusters == nullptr) continue;
    list_spins(*clusters, packed.clusters, spins);
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

PackedSystem pack(const ProjectiveSystem& system, int block, int passes) {
  const std::string reason = why_not_packed(system);
  if (!reason.empty()) throw InputError(reason);
  return Packer(system, block, passes).pack();
}

}  // namespace pliant
