#include "pliant/ros/running/simulation_thread.h"

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
  const auto next_readback = [this] {
    return publications_.readback(simulation_.world(), simulation_.seconds_between_observations());
  };
  const bool went_well =
      simulation_.make_step(seen, next_readback, publications_.wants_single_steps());
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

Answer SimulationThread::ask(const Request& request) {
  return queue_.call([&](const Reply& reply) { reply->set_value(request(simulation_)); });
}

Answer SimulationThread::change(const Request& request) {
  return queue_.call([&](const Reply& reply) {
    reply->set_value(request(simulation_));
    publications_.hurry();
  });
}

}  // namespace pliant
