#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "support/solvers/matrices.h"
#include "unit/elements/element_examples.h"

namespace pliant {

template <class Set>
class AnElementSet : public testing::Test {
 protected:
  /// A state so far from rest that everything is strained, and so near that no spring is short and
  /// no tetrahedron inverted.
  Positions crumpled() { return rest_ + random_.positions(n_, 0.02); }
  Forces forces(const Positions& x) const { return forces_of(*set_, x); }

  Random random_{11};
  ElementExample example_ = make_example<Set>(3);
  Positions rest_ = example_.rest;
  int n_ = static_cast<int>(rest_.cols());
  std::unique_ptr<ElementSet>& set_ = example_.set;
};

struct NameOfSet {
  template <class Set>
  static std::string GetName(int) {
    return std::string(make_example<Set>(2).set->name());
  }
};

using AllSets =
    testing::Types<SpringSet, CellShearSet, BendingSet, TetrahedronSet, VolumeSet, StrainLimitSet,
                   FiberSet, TriangleStrainSet, ClusterSet, OrientedClusterSet, AttachmentSet>;
// Those that act between particles alone: no attachments. Oriented particles have the other half of
// the angular momentum, see oriented_cluster_set_test.cpp.
using InternalSets = testing::Types<SpringSet, CellShearSet, BendingSet, TetrahedronSet, VolumeSet,
                                    StrainLimitSet, FiberSet, TriangleStrainSet, ClusterSet>;
}  // namespace pliant
