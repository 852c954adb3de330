#include "pliant/ros/services.h"

#include <cmath>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/ros/conversions.h"
#include "pliant/solvers/backend.h"

namespace pliant {
namespace {

template <class Response>
void fill(const Answer& answer, Response& response) {
  response.success = answer.success;
  response.message = answer.message;
}

/// Advertises `handle(request, response)`; what it throws becomes the answer.
template <class Service, class Handler>
ros::ServiceServer advertise(ros::NodeHandle& node, const std::string& name, Handler handle) {
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  const boost::function<bool(Request&, Response&)> callback = [handle](Request& request,
                                                                       Response& response) {
    try {
      handle(request, response);
    } catch (const std::exception& error) {
      response.success = false;
      response.message = error.what();
    }
    // False would hide the message from the caller.
    return true;
  };
  return node.advertiseService(name, callback);
}

ParameterText parameter_text(const SwitchSolver::Request& request) {
  if (request.keys.size() != request.values.size()) {
    throw InputError("'keys' has " + std::to_string(request.keys.size()) +
                     " entries and 'values' " + std::to_string(request.values.size()) +
                     ", but they must be as many");
  }
  ParameterText text;
  for (std::size_t k = 0; k < request.keys.size(); ++k) {
    if (!text.emplace(request.keys[k], request.values[k]).second) {
      throw InputError("'keys' names '" + request.keys[k] + "' twice");
    }
  }
  return text;
}

/// The backend is a parameter of the solvers that have a choice.
void add_backend(const std::string& solver, const std::string& backend, ParameterText& text) {
  if (backend.empty()) return;
  const ParameterSpec known = backend_parameter();
  const auto& choices = known.choices;
  if (std::find(choices.begin(), choices.end(), backend) == choices.end()) {
    throw InputError(unknown_name_message("backend", backend, choices));
  }
  std::string others;
  for (const SolverRegistry::Entry& entry : all_solvers().entries()) {
    for (const ParameterSpec& parameter : entry.parameters) {
      if (parameter.name != known.name) continue;
      if (entry.name == solver) {
        text[known.name] = backend;
        return;
      }
      others += ' ' + entry.name;
    }
  }
  if (backend == "cuda") {
    throw InputError("backend 'cuda': solver '" + solver +
                     "' runs on the cpu only; these run on a GPU:" + others);
  }
}

SolverInfo solver_info(const SolverRegistry::Entry& entry) {
  SolverInfo info;
  info.name = entry.name;
  info.description = entry.description;
  for (const ParameterSpec& spec : entry.parameters) {
    ParameterInfo parameter;
    parameter.name = spec.name;
    parameter.unit = spec.unit;
    parameter.range = spec.range_text();
    parameter.default_value = spec.default_value;
    parameter.meaning = spec.meaning;
    info.parameters.push_back(parameter);
  }
  return info;
}

}  // namespace

Services::Services(ros::NodeHandle& node, std::string model, const std::string& frame,
                   SimulationThread& simulation)
    : model_(std::move(model)), simulation_(simulation), frames_(frame) {
  using std_srvs::Trigger;
  const auto add_trigger = [&](const std::string& name, Answer (SimulationThread::*call)()) {
    servers_.push_back(advertise<Trigger>(
        node, name, [this, call](Trigger::Request&, Trigger::Response& response) {
          fill((simulation_.*call)(), response);
        }));
  };
  add_trigger("pause", &SimulationThread::pause);
  add_trigger("resume", &SimulationThread::resume);
  add_trigger("reset", &SimulationThread::reset);
  servers_.push_back(
      advertise<Step>(node, "step", [this](Step::Request& request, Step::Response& response) {
        const Answer answer = simulation_.step(request.steps);
        fill(answer, response);
        response.sim_time = answer.sim_time;
      }));
  servers_.push_back(advertise<ApplyForce>(
      node, "apply_force",
      [this](auto& request, auto& response) { apply_force(request, response); }));
  servers_.push_back(advertise<ClearForces>(node, "clear_forces", [this](auto&, auto& response) {
    fill(simulation_.clear_forces(), response);
  }));
  servers_.push_back(advertise<Attach>(
      node, "attach", [this](auto& request, auto& response) { attach(request, response); }));
  servers_.push_back(advertise<Detach>(node, "detach", [this](auto& request, auto& response) {
    fill(simulation_.detach(request.name), response);
  }));
  servers_.push_back(advertise<SetField>(
      node, "set_field", [this](auto& request, auto& response) { set_field(request, response); }));
  servers_.push_back(advertise<SwitchSolver>(
      node, "switch_solver",
      [this](auto& request, auto& response) { switch_solver(request, response); }));
  servers_.push_back(advertise<ListSolvers>(
      node, "list_solvers", [this](auto&, auto& response) { list_solvers(response); }));
}

void Services::apply_force(ApplyForce::Request& request, ApplyForce::Response& response) {
  const Eigen::Isometry3d frame = frames_.from(request.reference_frame);
  AppliedForce force;
  force.point = frame * to_vector(request.reference_point);
  force.force = frame.linear() * to_vector(request.force);
  force.radius = request.radius;
  force.duration = request.duration.toSec();
  fill(simulation_.apply_force(force, request.start_time), response);
}

Region Services::region_near(const std::string& service, const std::string& frame,
                             const geometry_msgs::Point& point, double radius) {
  Region region;
  region.kind = Region::Kind::kSphere;
  region.center = frames_.from(frame) * to_vector(point);
  region.radius = radius;
  if (!region.center.allFinite()) throw InputError(service + ": 'reference_point' must be finite");
  if (!(region.radius > 0.0 && std::isfinite(region.radius))) {
    throw InputError(service + ": 'radius' is " + std::to_string(region.radius) +
                     ", but must be positive and finite [m]");
  }
  return region;
}

void Services::attach(Attach::Request& request, Attach::Response& response) {
  const Region region =
      region_near("attach", request.reference_frame, request.reference_point, request.radius);
  if (!(request.stiffness > 0.0 && std::isfinite(request.stiffness))) {
    throw InputError("attach: 'stiffness' is " + std::to_string(request.stiffness) +
                     ", but must be positive and finite [N/m]");
  }
  const std::string to = request.to.empty() ? "world" : request.to;
  fill(simulation_.attach(request.name, region, to, request.stiffness), response);
}

void Services::set_field(SetField::Request& request, SetField::Response& response) {
  FieldRequest field;
  field.field = request.field;
  field.region =
      region_near("set_field", request.reference_frame, request.reference_point, request.radius);
  field.value = request.value;
  field.duration = request.duration.toSec();
  fill(simulation_.set_field(field), response);
}

void Services::switch_solver(SwitchSolver::Request& request, SwitchSolver::Response& response) {
  ParameterText parameters = parameter_text(request);
  add_backend(request.name, request.backend, parameters);
  fill(simulation_.switch_solver(request.name, parameters, request.body), response);
}

void Services::list_solvers(ListSolvers::Response& response) {
  const Answer current = simulation_.current_solver();
  response.success = current.success;
  if (!current.success) {
    response.message = current.message;
    return;
  }
  response.current = current.message;
  for (const SolverRegistry::Entry& entry : all_solvers().entries()) {
    const std::vector<std::string>& models = entry.models;
    if (std::find(models.begin(), models.end(), model_) == models.end()) continue;
    response.solvers.push_back(solver_info(entry));
    if (!response.message.empty()) response.message += '\n';
    response.message += entry.name + ": " + entry.description;
  }
}

}  // namespace pliant
