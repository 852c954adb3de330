#pragma once

#include <typeinfo>

namespace pliant {

/// What a part of a body offers to other parts, by type: a capability, as Wettable, or a service,
/// as the contacts of an effect. Whoever asks needs to know neither who offers it nor by what name,
/// and another package may add parts that offer the same.
class Offers {
 public:
  virtual ~Offers() = default;

  /// Null where it is not offered.
  template <class Service>
  Service* find() {
    return static_cast<Service*>(offer(typeid(Service)));
  }
  template <class Service>
  const Service* find() const {
    return const_cast<Offers*>(this)->find<Service>();
  }

 protected:
  /// A pointer to exactly the type that is asked for, as offer_as() makes it; or null.
  virtual void* offer(const std::type_info& /*type*/) { return nullptr; }
};

/// For overrides of Offers::offer(): `self` as the one of `Services` that is asked for.
template <class... Services, class Self>
void* offer_as(Self* self, const std::type_info& type) {
  void* found = nullptr;
  ((type == typeid(Services) ? void(found = static_cast<Services*>(self)) : void()), ...);
  return found;
}

}  // namespace pliant
