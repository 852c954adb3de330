#include "pliant/ros/simulation_thread.h"

#include <fmt/format.h>

#include <algorithm>

namespace pliant {
namespace {

// How often it looks whether the robot's first joint states are there.
constexpr auto kIdlePeriod = std::chrono::milliseconds(20);

}  // namespace

SimulationThread::SimulationThread(Simulation& simulation, Publications& publications)
    : simulation_(simulation), publications_(publications), thread_([this] { run(); }) {}

SimulationThread::~SimulationThread() { stop(); }

void SimulationThread::stop() {
  queue_.close();
  if (thread_.joinable()) thread_.join();
}

void SimulationThread::run() {
  using Clock = Simulation::Clock;
  while (!queue_.closed()) {
    queue_.run_pending();
    publications_.publish_due(simulation_);
    const auto next_step = simulation_.next_step();
    const Clock::time_point now = Clock::now();
    if (next_step && *next_step <= now) {
      make_step();
    } else {
      const Clock::time_point wake = next_step ? *next_step : now + kIdlePeriod;
      queue_.wait_until(std::min(wake, publications_.next_due()));
    }
  }
  simulation_.shut_down();
}

void SimulationThread::make_step() {
  const auto seen = [this] {
    publications_.add_step(simulation_);
    publications_.publish_due(simulation_);
  };
  const auto wants = [this] {
    return publications_.wanted(simulation_.world(), simulation_.seconds_between_looks());
  };
  const bool went_well = simulation_.make_step(seen, wants);
  if (!went_well) publications_.hurry();
}

Answer SimulationThread::pause() {
  return queue_.call([this](const Reply& reply) {
    simulation_.pause(reply);
    publications_.hurry();
  });
}

Answer SimulationThread::resume() {
  return queue_.call([this](const Reply& reply) {
    simulation_.resume(reply);
    publications_.hurry();
  });
}

Answer SimulationThread::reset() {
  return queue_.call([this](const Reply& reply) {
    simulation_.reset(reply);
    publications_.restart();
    publications_.hurry();
  });
}

Answer SimulationThread::step(int steps) {
  return queue_.call([this, steps](const Reply& reply) { simulation_.step(steps, reply); });
}

Answer SimulationThread::apply_force(const AppliedForce& force, const ros::Time& start) {
  return queue_.call([this, force, start](const Reply& reply) {
    World& world = simulation_.world();
    const double delay = start.isZero() ? 0.0 : std::max(0.0, (start - simulation_.now()).toSec());
    AppliedForce request = force;
    request.start = world.time() + delay;
    world.applied_forces().add(request);
    const std::string end =
        request.duration < 0.0 ? "for good" : fmt::format("for {:g} s", request.duration);
    reply->set_value({true,
                      fmt::format("{:g} N at ({:g}, {:g}, {:g}) m from {:.6g} s on, {}",
                                  request.force.stableNorm(), request.point.x(), request.point.y(),
                                  request.point.z(), request.start,
                                  request.duration == 0.0 ? "for one step" : end),
                      world.time()});
  });
}

Answer SimulationThread::clear_forces() {
  return queue_.call([this](const Reply& reply) {
    World& world = simulation_.world();
    const std::size_t count = world.applied_forces().active().size();
    world.applied_forces().clear();
    reply->set_value({true, fmt::format("{} cleared", count), world.time()});
  });
}

Answer SimulationThread::switch_solver(const std::string& name, const ParameterText& parameters,
                                       const std::string& body) {
  return queue_.call([this, name, parameters, body](const Reply& reply) {
    reply->set_value(simulation_.switch_solver(name, parameters, body));
    publications_.hurry();
  });
}

Answer SimulationThread::attach(const std::string& name, const Region& region,
                                const std::string& to, double stiffness) {
  return queue_.call([this, name, region, to, stiffness](const Reply& reply) {
    reply->set_value(simulation_.attach(name, region, to, stiffness));
    publications_.hurry();
  });
}

Answer SimulationThread::detach(const std::string& name) {
  return queue_.call([this, name](const Reply& reply) {
    reply->set_value(simulation_.detach(name));
    publications_.hurry();
  });
}

Answer SimulationThread::set_field(const FieldRequest& request) {
  return queue_.call([this, request](const Reply& reply) {
    const World& world = simulation_.world();
    const int count = simulation_.world().set_field(request);
    const std::string how =
        request.duration == 0.0 ? "at once" : fmt::format("within {:g} s", request.duration);
    reply->set_value({true,
                      fmt::format("'{}' of {} vertices becomes {:g} {}", request.field, count,
                                  request.value, how),
                      world.time()});
    publications_.hurry();
  });
}

Answer SimulationThread::current_solver() {
  return queue_.call([this](const Reply& reply) {
    reply->set_value({true, simulation_.solver(), simulation_.world().time()});
  });
}

}  // namespace pliant
