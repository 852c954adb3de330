#include "pliant/ros/services.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/step/body_integration.h"
#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/ros/conversions.h"
#include "pliant/solvers/device/backend.h"
#include "pliant/solvers/time/time_integrations.h"

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

/// What would only warn in a scene is refused where somebody asks for it now.
void require_backend(const ParameterText& parameters) {
  const auto backend = parameters.find(backend_parameter().name);
  if (backend == parameters.end() || backend->second != "cuda") return;
  const std::string reason = why_no_cuda();
  if (!reason.empty()) {
    throw InputError("backend 'cuda': " + reason + "; use backend 'cpu' or 'auto'");
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

Services::Services(ros::NodeHandle& node, const FrameTransformer& frames,
                   SimulationThread& simulation)
    : simulation_(simulation), frames_(frames) {
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
  servers_.push_back(
      advertise<ClearForces>(node, "clear_forces", [this](auto& request, auto& response) {
        fill(simulation_.ask([&](Simulation& s) { return s.clear_forces(request.body); }),
             response);
      }));
  servers_.push_back(advertise<Attach>(
      node, "attach", [this](auto& request, auto& response) { attach(request, response); }));
  servers_.push_back(advertise<Detach>(node, "detach", [this](auto& request, auto& response) {
    fill(simulation_.change([&](Simulation& s) { return s.detach(request.name, request.body); }),
         response);
  }));
  servers_.push_back(advertise<SetField>(
      node, "set_field", [this](auto& request, auto& response) { set_field(request, response); }));
  servers_.push_back(advertise<SwitchSolver>(
      node, "switch_solver",
      [this](auto& request, auto& response) { switch_solver(request, response); }));
  servers_.push_back(advertise<ListSolvers>(
      node, "list_solvers",
      [this](auto& request, auto& response) { list_solvers(request, response); }));
}

Services::FrameAt Services::find_frame(const std::string& frame) {
  const std::vector<std::string>& links = simulation_.link_names();
  const bool is_link =
      frame != frames_.target() && std::find(links.begin(), links.end(), frame) != links.end();
  if (is_link) return [frame](const Simulation& s) { return s.link_pose(frame); };
  const Eigen::Isometry3d pose = frames_.from(frame, links);
  return [pose](const Simulation&) { return pose; };
}

std::vector<std::string> Services::names() const {
  std::vector<std::string> names;
  for (const ros::ServiceServer& server : servers_) names.push_back(server.getService());
  return names;
}

void Services::apply_force(ApplyForce::Request& request, ApplyForce::Response& response) {
  const FrameAt frame = find_frame(request.reference_frame);
  const auto apply = [&](Simulation& s) {
    const Eigen::Isometry3d pose = frame(s);
    AppliedForce force;
    force.point = pose * to_vector(request.reference_point);
    force.force = pose.linear() * to_vector(request.force);
    force.radius = request.radius;
    force.duration = request.duration.toSec();
    return s.apply_force(force, request.start_time, request.body);
  };
  fill(simulation_.ask(apply), response);
}

Region Services::region_near(const std::string& service, const geometry_msgs::Point& point,
                             double radius) {
  Region region;
  region.kind = Region::Kind::kSphere;
  region.center = to_vector(point);
  region.radius = radius;
  if (!region.center.allFinite()) throw InputError(service + ": 'reference_point' must be finite");
  if (!(region.radius > 0.0 && std::isfinite(region.radius))) {
    throw InputError(service + ": 'radius' is " + std::to_string(region.radius) +
                     ", but must be positive and finite [m]");
  }
  return region;
}

void Services::attach(Attach::Request& request, Attach::Response& response) {
  Region region = region_near("attach", request.reference_point, request.radius);
  if (!(request.stiffness > 0.0 && std::isfinite(request.stiffness))) {
    throw InputError("attach: 'stiffness' is " + std::to_string(request.stiffness) +
                     ", but must be positive and finite [N/m]");
  }
  const FrameAt frame = find_frame(request.reference_frame);
  const std::string to = request.to.empty() ? "world" : request.to;
  const auto attach = [&](Simulation& s) {
    region.center = frame(s) * region.center;
    return s.attach(request.name, region, to, request.stiffness, request.body);
  };
  fill(simulation_.change(attach), response);
}

void Services::set_field(SetField::Request& request, SetField::Response& response) {
  FieldRequest field;
  field.field = request.field;
  field.region = region_near("set_field", request.reference_point, request.radius);
  field.value = request.value;
  field.duration = request.duration.toSec();
  const FrameAt frame = find_frame(request.reference_frame);
  const auto set = [&](Simulation& s) {
    field.region.center = frame(s) * field.region.center;
    return s.set_field(field, request.body);
  };
  fill(simulation_.change(set), response);
}

void Services::switch_solver(SwitchSolver::Request& request, SwitchSolver::Response& response) {
  ParameterText parameters = parameter_text(request);
  const bool has_parameters = !parameters.empty() || !request.backend.empty();
  if (!request.name.empty() || request.time_integration.empty() || has_parameters) {
    add_backend(request.name, request.backend, parameters);
    const std::vector<ParameterSpec>& known = find_solver(request.name).parameters;
    parse_parameters(known, parameters, "switch_solver");
    require_backend(parameters);
  }
  const auto swap = [&](Simulation& s) {
    return s.switch_solver(request.name, parameters, request.body, request.time_integration);
  };
  fill(simulation_.change(swap), response);
}

void Services::list_solvers(ListSolvers::Request& request, ListSolvers::Response& response) {
  const BodyNames& names = simulation_.names();
  const std::vector<std::size_t> meant = names.find("list_solvers", request.body);
  const Answer answer = simulation_.ask([&](Simulation& simulation) {
    for (const std::size_t b : meant) {
      response.bodies.push_back(names.name(b));
      const Body& body = simulation.world().bodies()[b];
      response.currents.emplace_back(body.solver->name());
      response.current_time_integrations.emplace_back(time_integration_of(body));
    }
    return Answer{true, "", simulation.world().time()};
  });
  fill(answer, response);
  if (!answer.success) return;
  response.current = response.currents.front();
  for (const auto& entry : time_integrations().entries()) {
    const bool suits_all = std::all_of(meant.begin(), meant.end(), [&](std::size_t b) {
      return std::find(entry.models.begin(), entry.models.end(), names.model(b)) !=
             entry.models.end();
    });
    if (suits_all) response.time_integrations.push_back(entry.name);
  }
  for (const SolverRegistry::Entry& entry : all_solvers().entries()) {
    std::vector<std::size_t> suited;
    for (const std::size_t b : meant) {
      const std::vector<std::string>& models = entry.models;
      const bool suits = std::find(models.begin(), models.end(), names.model(b)) != models.end();
      if (suits) suited.push_back(b);
    }
    if (suited.empty()) continue;
    response.solvers.push_back(solver_info(entry));
    for (const std::size_t b : suited) response.solvers.back().bodies.push_back(names.name(b));
    if (!response.message.empty()) response.message += '\n';
    const std::string whose = suited.size() < meant.size() ? " for " + names.text(suited) : "";
    response.message += entry.name + whose + ": " + entry.description;
  }
}

}  // namespace pliant
