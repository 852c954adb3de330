// pliant.Simulator and what it answers.
#include "handles.h"

namespace pliant {
namespace {

using Point = std::array<double, 3>;

Eigen::Vector3d vector_of(const Point& point) { return {point[0], point[1], point[2]}; }

/// A method of Simulator for Python. Nothing of Python is touched in it, so that the interpreter's
/// lock may be let go of.
template <class Result, class... Arguments>
auto method(Result (Simulator::*own)(Arguments...)) {
  return [own](SimulatorHandle& self, Arguments... arguments) -> std::decay_t<Result> {
    const Use use(*self.owner);
    return (self.simulator->*own)(std::forward<Arguments>(arguments)...);
  };
}
template <class Result, class... Arguments>
auto method(Result (Simulator::*own)(Arguments...) const) {
  return [own](const SimulatorHandle& self, Arguments... arguments) -> std::decay_t<Result> {
    const Use use(*self.owner);
    return (self.simulator->*own)(std::forward<Arguments>(arguments)...);
  };
}

SimulatorHandle make_simulator(const py::object& scene, const py::kwargs& keywords) {
  const SceneArgument argument = scene_of(scene);
  const SimulatorOptions options = options_of(keywords);
  auto owner = std::make_shared<Owner>();
  const py::gil_scoped_release release;
  owner->alone.emplace(argument.text ? Simulator::from_text(*argument.text, argument.name, options)
                                     : Simulator(argument.name, options));
  Simulator* simulator = &*owner->alone;
  return {std::move(owner), simulator, false};
}

void step_alone(SimulatorHandle& self, int count) {
  if (self.is_of_batch) {
    throw InputError("this simulator is one of a batch: step the batch");
  }
  const Use use(*self.owner);
  self.simulator->step(count);
}

void reset_alone(SimulatorHandle& self) {
  if (self.is_of_batch) {
    throw InputError("this simulator is one of a batch: call the batch's reset(index)");
  }
  const Use use(*self.owner);
  self.simulator->reset();
}

py::array link_pose(const SimulatorHandle& self, const std::string& link) {
  const Use use(*self.owner);
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> pose =
      self.simulator->link_pose(link).matrix();
  return py::array_t<double>({4, 4}, pose.data());
}

std::string file_of(const py::object& path) {
  return py::module_::import("os").attr("fspath")(path).cast<std::string>();
}

void write_state(const Simulator::State& self, const py::object& path) {
  self.write(file_of(path));
}

Simulator::State read_state(const py::object& path) {
  return Simulator::State::read(file_of(path));
}

void add_answers(py::module_& module) {
  using Report = Simulator::Report;
  py::class_<Report>(module, "Report")
      .def_readonly("solver", &Report::solver)
      .def_readonly("iterations", &Report::iterations)
      .def_readonly("error", &Report::error)
      .def_readonly("contacts", &Report::contacts)
      .def_readonly("seconds", &Report::seconds)
      .def_readonly("warnings", &Report::warnings)
      .def_readonly("time_integration", &Report::time_integration)
      .def_readonly("first_order", &Report::first_order);
  using Wrench = Simulator::Wrench;
  py::class_<Wrench>(module, "Wrench")
      .def_readonly("name", &Wrench::name)
      .def_readonly("is_link", &Wrench::is_link)
      .def_property_readonly("force", [](const Wrench& self) { return copy_of(self.force); })
      .def_property_readonly("torque", [](const Wrench& self) { return copy_of(self.torque); });
  using Contact = Simulator::Contact;
  py::class_<Contact>(module, "Contact")
      .def_readonly("body", &Contact::body)
      .def_readonly("vertex", &Contact::vertex)
      .def_readonly("other", &Contact::other)
      .def_property_readonly("point", [](const Contact& self) { return copy_of(self.point); })
      .def_property_readonly("normal", [](const Contact& self) { return copy_of(self.normal); })
      .def_property_readonly("force", [](const Contact& self) { return copy_of(self.force); });
  py::class_<Simulator::State>(module, "State")
      .def_property_readonly("time", &Simulator::State::time)
      .def("write", &write_state, py::arg("path"))
      .def_static("read", &read_state, py::arg("path"));
}

}  // namespace

void add_simulator(py::module_& module) {
  add_answers(module);
  const py::call_guard<py::gil_scoped_release> unlocked;
  using Handle = SimulatorHandle;
  py::class_<Handle> simulator(module, "Simulator");
  simulator.def(py::init(&make_simulator), py::arg("scene"))
      .def_property_readonly("warnings", method(&Simulator::warnings))
      .def_property_readonly("time", method(&Simulator::time))
      .def_property_readonly("time_step", method(&Simulator::time_step))
      .def("step", &step_alone, py::arg("count") = 1, unlocked)
      .def("reset", &reset_alone, unlocked)
      .def("save", method(&Simulator::save), unlocked)
      .def("load", method(&Simulator::load), py::arg("state"), unlocked);
  simulator.def_property_readonly("bodies", method(&Simulator::bodies))
      .def(
          "vertices",
          [](const Handle& self, const std::string& body) {
            const Use use(*self.owner);
            return copy_of<double>(self.simulator->vertices(body));
          },
          py::arg("body"))
      .def(
          "triangles",
          [](const Handle& self, const std::string& body) {
            const Use use(*self.owner);
            return copy_of<int>(self.simulator->triangles(body));
          },
          py::arg("body"))
      .def(
          "positions",
          [](const Handle& self, const std::string& body) {
            const Use use(*self.owner);
            return view_of(self.simulator->positions(body), self.owner);
          },
          py::arg("body"))
      .def(
          "velocities",
          [](const Handle& self, const std::string& body) {
            const Use use(*self.owner);
            return view_of(self.simulator->velocities(body), self.owner);
          },
          py::arg("body"))
      .def(
          "field",
          [](const Handle& self, const std::string& body, const std::string& name) {
            const Use use(*self.owner);
            const Eigen::VectorXd field = self.simulator->field(body, name);
            return py::array_t<double>(field.size(), field.data());
          },
          py::arg("body"), py::arg("name"))
      .def("report", method(&Simulator::report), py::arg("body"));
  simulator
      .def(
          "apply_force",
          [](Handle& self, const std::string& body, const Point& point, double radius,
             const Point& force, double duration) {
            const Use use(*self.owner);
            self.simulator->apply_force(body, vector_of(point), radius, vector_of(force), duration);
          },
          py::arg("body"), py::arg("point"), py::arg("radius"), py::arg("force"),
          py::arg("duration"))
      .def("clear_forces", method(&Simulator::clear_forces))
      .def(
          "attach",
          [](Handle& self, const std::string& body, const std::string& name, const Point& point,
             double radius, const std::string& holder, double stiffness) {
            const Use use(*self.owner);
            return self.simulator->attach(body, name, vector_of(point), radius, holder, stiffness);
          },
          py::arg("body"), py::arg("name"), py::arg("point"), py::arg("radius"),
          py::arg("holder") = "world", py::arg("stiffness") = 1000.0)
      .def("detach", method(&Simulator::detach), py::arg("body"), py::arg("name"))
      .def("attachments", method(&Simulator::attachments), py::arg("body"))
      .def("contacts", method(&Simulator::contacts))
      .def("wrenches", method(&Simulator::wrenches));
  simulator.def_property_readonly("joint_names", method(&Simulator::joint_names))
      .def_property_readonly("joint_positions",
                             [](const Handle& self) {
                               const Use use(*self.owner);
                               const std::vector<double> joints = self.simulator->joint_positions();
                               return py::array_t<double>(static_cast<py::ssize_t>(joints.size()),
                                                          joints.data());
                             })
      .def("set_joint_positions", method(&Simulator::set_joint_positions), py::arg("positions"))
      .def(
          "joint_limits",
          [](const Handle& self, const std::string& joint) {
            const Use use(*self.owner);
            const Simulator::JointLimits limits = self.simulator->joint_limits(joint);
            return std::make_pair(limits.lower, limits.upper);
          },
          py::arg("joint"))
      .def("link_pose", &link_pose, py::arg("link"));
}

}  // namespace pliant
