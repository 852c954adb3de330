#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "pliant/simulator_batch.h"

namespace pliant {

namespace py = pybind11;

/// What Python objects and views share: whichever of them is left last lets go of the worlds.
struct Owner {
  std::optional<Simulator> alone;
  std::optional<SimulatorBatch> batch;
  std::atomic_flag is_in_use = ATOMIC_FLAG_INIT;
};

/// While it lives no other thread of Python gets at the owner's worlds: they would be changed by
/// two at once, now that the interpreter's lock is let go of during steps.
class Use {
 public:
  explicit Use(Owner& owner) : owner_(owner) {
    if (owner.is_in_use.test_and_set()) {
      throw std::runtime_error("another thread uses this simulator: one at a time may");
    }
  }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;
  ~Use() { owner_.is_in_use.clear(); }

 private:
  Owner& owner_;
};

/// A simulator as Python holds it: alone, or one of a batch.
struct SimulatorHandle {
  std::shared_ptr<Owner> owner;
  Simulator* simulator = nullptr;
  bool is_of_batch = false;
};

struct BatchHandle {
  std::shared_ptr<Owner> owner;
};

/// A scene as Python gives it: a file's path, or a dict whose text `json` makes.
struct SceneArgument {
  std::string name;
  std::optional<std::string> text;
};
SceneArgument scene_of(const py::object& scene);
/// Of keyword arguments; a value that is no text becomes one as `json` writes it. Throws TypeError
/// for a keyword that there is not.
SimulatorOptions options_of(const py::kwargs& keywords);
/// A value of a scene file: text as it is, all else as `json` writes it.
std::string text_of_value(const py::handle& value);

/// n x 3 numbers that belong to the owner: read-only, and what keeps its worlds alive.
py::array view_of(const Eigen::Matrix3Xd& numbers, const std::shared_ptr<Owner>& owner);
/// n x 3 numbers of Python's own.
template <class Number>
py::array copy_of(const Eigen::Matrix<Number, 3, Eigen::Dynamic>& numbers) {
  return py::array_t<Number>({numbers.cols(), Eigen::Index{3}}, numbers.data());
}
inline py::array copy_of(const Eigen::Vector3d& numbers) {
  return py::array_t<double>(3, numbers.data());
}

void add_simulator(py::module_& module);
void add_batch(py::module_& module);

}  // namespace pliant
