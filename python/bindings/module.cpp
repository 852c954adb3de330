// The module pliant._pliant: Simulator and Batch of include/pliant as Python sees them.
#include "handles.h"

namespace pliant {

std::string text_of_value(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  const auto as_list = py::cpp_function([](const py::object& array) {
    if (py::hasattr(array, "tolist")) return array.attr("tolist")();
    throw py::type_error("a scene holds texts, numbers, lists and dicts, but not " +
                         py::repr(py::type::of(array)).cast<std::string>());
  });
  return py::module_::import("json")
      .attr("dumps")(value, py::arg("default") = as_list)
      .cast<std::string>();
}

SceneArgument scene_of(const py::object& scene) {
  if (!py::isinstance<py::dict>(scene)) {
    return {py::module_::import("os").attr("fspath")(scene).cast<std::string>(), {}};
  }
  // A line an entry, so that messages can say which.
  const py::object items = py::reinterpret_borrow<py::dict>(scene).attr("items")();
  std::string text = "{";
  for (const py::handle& item : items) {
    const auto entry = item.cast<std::pair<py::object, py::object>>();
    const py::object dumps = py::module_::import("json").attr("dumps");
    text += (text.size() > 1 ? ",\n" : "\n") + dumps(py::str(entry.first)).cast<std::string>() +
            ": " +
            (py::isinstance<py::str>(entry.second) ? dumps(entry.second).cast<std::string>()
                                                   : text_of_value(entry.second));
  }
  return {"scene", text + "\n}\n"};
}

namespace {

std::map<std::string, std::string> texts_of(const py::handle& values) {
  std::map<std::string, std::string> texts;
  if (values.is_none()) return texts;
  for (const auto& [name, value] : values.cast<py::dict>()) {
    texts[name.cast<std::string>()] = text_of_value(value);
  }
  return texts;
}

}  // namespace

SimulatorOptions options_of(const py::kwargs& keywords) {
  SimulatorOptions options;
  for (const auto& [name, value] : keywords) {
    const auto keyword = name.cast<std::string>();
    if (keyword == "values") {
      options.values = texts_of(value);
    } else if (keyword == "solver") {
      options.solver = value.cast<std::string>();
    } else if (keyword == "solver_parameters") {
      options.solver_parameters = texts_of(value);
    } else if (keyword == "time_integration") {
      options.time_integration = value.cast<std::string>();
    } else if (keyword == "time_step") {
      options.time_step = value.cast<std::optional<double>>();
    } else if (keyword == "threads") {
      options.threads = value.cast<std::optional<int>>();
    } else if (keyword == "urdf") {
      options.urdf = value.cast<std::string>();
    } else if (keyword == "robot_follows_keyframes") {
      options.robot_follows_keyframes = value.cast<bool>();
    } else {
      throw py::type_error(
          unknown_name_message("keyword", keyword,
                               {"values", "solver", "solver_parameters", "time_integration",
                                "time_step", "threads", "urdf", "robot_follows_keyframes"}));
    }
  }
  return options;
}

py::array view_of(const Eigen::Matrix3Xd& numbers, const std::shared_ptr<Owner>& owner) {
  const py::capsule base(new std::shared_ptr<Owner>(owner),
                         [](void* kept) { delete static_cast<std::shared_ptr<Owner>*>(kept); });
  py::array_t<double> view({numbers.cols(), Eigen::Index{3}}, numbers.data(), base);
  view.attr("flags").attr("writeable") = false;
  return std::move(view);
}

}  // namespace pliant

PYBIND11_MODULE(_pliant, module) {
  namespace py = pybind11;
  py::register_exception<pliant::InputError>(module, "InputError", PyExc_ValueError);
  py::register_exception<pliant::StepError>(module, "StepError", PyExc_RuntimeError);
  pliant::add_simulator(module);
  pliant::add_batch(module);
}
