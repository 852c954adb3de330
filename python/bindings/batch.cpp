// pliant.Batch: many simulators side by side.
#include "handles.h"

namespace pliant {
namespace {

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Rows = std::vector<std::map<std::string, std::string>>;

/// A number of equal copies, or what differs between them.
Rows rows_of(const py::object& rows) {
  if (py::isinstance<py::int_>(rows)) {
    const int count = rows.cast<int>();
    if (count < 1) throw InputError("rows is " + std::to_string(count) + ", but must be >= 1");
    return Rows(static_cast<std::size_t>(count));
  }
  Rows texts;
  for (const py::handle& row : rows) {
    texts.emplace_back();
    for (const auto& [path, value] : row.cast<py::dict>()) {
      texts.back()[path.cast<std::string>()] = text_of_value(value);
    }
  }
  return texts;
}

BatchHandle make_batch(const py::object& scene, const py::object& rows,
                       const py::kwargs& keywords) {
  const SceneArgument argument = scene_of(scene);
  const SimulatorOptions options = options_of(keywords);
  const Rows texts = rows_of(rows);
  auto owner = std::make_shared<Owner>();
  const py::gil_scoped_release release;
  owner->batch.emplace(
      argument.text ? SimulatorBatch::from_text(*argument.text, argument.name, texts, options)
                    : SimulatorBatch(argument.name, texts, options));
  return {std::move(owner)};
}

int checked(const BatchHandle& self, int index) {
  const int size = self.owner->batch->size();
  if (index < -size || index >= size) {
    throw py::index_error("simulator " + std::to_string(index) + ": the batch has " +
                          std::to_string(size));
  }
  return index < 0 ? index + size : index;
}

void set_joints(SimulatorBatch& batch, const Array& actions) {
  if (actions.ndim() != 2) {
    throw InputError("actions have " + std::to_string(actions.ndim()) +
                     " dimensions, but 2: a row a simulator, a column a joint");
  }
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      rows(actions.data(), actions.shape(0), actions.shape(1));
  batch.set_joint_positions(rows);
}

void step_batch(BatchHandle& self, const std::optional<Array>& actions, int count) {
  const Use use(*self.owner);
  if (actions) set_joints(*self.owner->batch, *actions);
  const py::gil_scoped_release release;
  self.owner->batch->step(count);
}

void reset_batch(BatchHandle& self, const std::optional<int>& index) {
  SimulatorBatch& batch = *self.owner->batch;
  const int begin = index ? checked(self, *index) : 0;
  const int end = index ? begin + 1 : batch.size();
  const Use use(*self.owner);
  const py::gil_scoped_release release;
  for (int s = begin; s < end; ++s) batch.reset(s);
}

using Gather = void (SimulatorBatch::*)(const std::string&, double*) const;

/// Into `out`, where that is given: of the right shape, and rows first.
template <Gather gather>
py::array numbers_of(const BatchHandle& self, const std::string& body, const py::object& out) {
  const Use use(*self.owner);
  const SimulatorBatch& batch = *self.owner->batch;
  const auto scenes = static_cast<py::ssize_t>(batch.size());
  const auto particles = static_cast<py::ssize_t>(batch.at(0).positions(body).cols());
  const bool is_given = !out.is_none();
  if (is_given && !py::isinstance<py::array_t<double, py::array::c_style>>(out)) {
    throw InputError("out must be an array of float64, rows first");
  }
  auto numbers = is_given ? py::reinterpret_borrow<py::array_t<double>>(out)
                          : py::array_t<double>({scenes, particles, py::ssize_t{3}});
  if (numbers.ndim() != 3 || numbers.shape(0) != scenes || numbers.shape(1) != particles ||
      numbers.shape(2) != 3) {
    throw InputError("out must have the shape (" + std::to_string(scenes) + ", " +
                     std::to_string(particles) + ", 3)");
  }
  double* data = numbers.mutable_data();
  const py::gil_scoped_release release;
  (batch.*gather)(body, data);
  return std::move(numbers);
}

py::array joint_positions(const BatchHandle& self) {
  const Use use(*self.owner);
  const SimulatorBatch& batch = *self.owner->batch;
  const auto joints = static_cast<py::ssize_t>(batch.at(0).joint_names().size());
  py::array_t<double> all({static_cast<py::ssize_t>(batch.size()), joints});
  for (int s = 0; s < batch.size(); ++s) {
    const std::vector<double> own = batch.at(s).joint_positions();
    std::copy(own.begin(), own.end(), all.mutable_data() + s * joints);
  }
  return std::move(all);
}

std::vector<std::string> failures(const BatchHandle& self) {
  const Use use(*self.owner);
  std::vector<std::string> all;
  for (int s = 0; s < self.owner->batch->size(); ++s) {
    all.push_back(self.owner->batch->failure(s));
  }
  return all;
}

}  // namespace

void add_batch(py::module_& module) {
  py::class_<BatchHandle>(module, "Batch")
      .def(py::init(&make_batch), py::arg("scene"), py::arg("rows"))
      .def("__len__", [](const BatchHandle& self) { return self.owner->batch->size(); })
      .def("__getitem__",
           [](BatchHandle& self, int index) {
             const int s = checked(self, index);
             return SimulatorHandle{self.owner, &self.owner->batch->at(s), true};
           })
      .def("step", &step_batch, py::arg("actions") = py::none(), py::arg("count") = 1)
      .def("reset", &reset_batch, py::arg("index") = py::none())
      .def_property_readonly("failures", &failures)
      .def_property_readonly("joint_names",
                             [](const BatchHandle& self) {
                               const Use use(*self.owner);
                               return self.owner->batch->at(0).joint_names();
                             })
      .def_property_readonly("joint_positions", &joint_positions)
      .def("positions", &numbers_of<&SimulatorBatch::positions>, py::arg("body"),
           py::arg("out") = py::none())
      .def("velocities", &numbers_of<&SimulatorBatch::velocities>, py::arg("body"),
           py::arg("out") = py::none());
}

}  // namespace pliant
