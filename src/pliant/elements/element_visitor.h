#pragma once

#include <memory>
#include <vector>

#include "pliant/core/system/element_set.h"

namespace pliant {

class AttachmentSet;
class BendingSet;
class CellShearSet;
class ClusterSet;
class ClusterSource;
class FiberSet;
class SpringSet;
class TetrahedronSet;
class TriangleStrainSet;

/// Sees element sets as what they are, for those who need the elements themselves, as a device that
/// computes the same forces elsewhere. Sets of other kinds do not accept visitors
/// (ElementSet::accept()).
class ElementVisitor {
 public:
  virtual ~ElementVisitor() = default;
  virtual void see(const AttachmentSet& /*set*/) {}
  virtual void see(const BendingSet& /*set*/) {}
  virtual void see(const CellShearSet& /*set*/) {}
  virtual void see(const ClusterSet& /*set*/) {}
  virtual void see(const ClusterSource& /*set*/) {}
  virtual void see(const FiberSet& /*set*/) {}
  virtual void see(const SpringSet& /*set*/) {}
  virtual void see(const TetrahedronSet& /*set*/) {}
  virtual void see(const TriangleStrainSet& /*set*/) {}
};

/// The set as one of type `Set`, or null.
template <class Set>
const Set* as(const ElementSet& elements) {
  class Finder final : public ElementVisitor {
   public:
    using ElementVisitor::see;
    void see(const Set& set) override { found = &set; }
    const Set* found = nullptr;
  } finder;
  elements.accept(finder);
  return finder.found;
}

/// Calls use(set) for those of type `Set`.
template <class Set, class Use>
void for_each(const std::vector<std::unique_ptr<ElementSet>>& elements, const Use& use) {
  for (const auto& set : elements) {
    if (const Set* found = as<Set>(*set)) use(*found);
  }
}

}  // namespace pliant
