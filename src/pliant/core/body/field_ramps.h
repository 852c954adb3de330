#pragma once

#include <deque>
#include <string>
#include <vector>

#include "pliant/core/body/region.h"

namespace pliant {

struct Body;

/// A field of some particles that is to become `value`, as a user asks for it.
struct FieldRequest {
  std::string field;      ///< its name
  Region region;          ///< in world, of the particles as they are when it is asked for
  double value = 0.0;     ///< in the field's unit
  double duration = 0.0;  ///< from what it is to `value`, evenly [s]; 0: at once
  int body = -1;          ///< index of the only one whose particles are meant; -1: all
};

/// Fields of particles on their way to values that users asked for. The last request for a particle
/// counts.
class FieldRamps {
 public:
  /// Of `bodies` at the simulated `time` [s]. Returns the number of particles. Throws InputError,
  /// and then nothing changed, for a field that no body has or that may not be set, a value or
  /// duration out of range, and a region without particles.
  int begin(const FieldRequest& request, std::deque<Body>& bodies, double time);
  /// Sets what is due at `time` [s], after a step.
  void advance(std::deque<Body>& bodies, double time);
  void clear() { ramps_.clear(); }
  bool empty() const { return ramps_.empty(); }

 private:
  struct Start {
    int particle;
    double value;
  };
  struct Ramp {
    std::size_t body;
    std::string field;
    double value, begin, end;
    std::vector<Start> from;
  };
  void forget(const Ramp& replaced);

  std::vector<Ramp> ramps_;
};

/// The names of all fields of `bodies` that may be set; of one of them where `body` is its index.
std::vector<std::string> settable_field_names(const std::deque<Body>& bodies, int body = -1);

/// Whether a body has a field of that name, be it one that may not be set.
bool has_field(const Body& body, const std::string& name);

}  // namespace pliant
