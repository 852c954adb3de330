#include "pliant/simulator_batch.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/api/simulator_data.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/core/world.h"
#include "pliant/scene/world_batch.h"

namespace pliant {

using Rows = std::vector<std::map<std::string, std::string>>;

struct SimulatorBatch::Data {
  std::unique_ptr<WorldBatch> stepper;  // outlives the simulators' worlds
  std::vector<Simulator> simulators;

  Data(const std::string& path, const std::string* text, const Rows& rows,
       const SimulatorOptions& options);
  std::size_t checked(int index) const;
  /// The same of each simulator, one after the other.
  void gather(const std::string& body, const Eigen::Matrix3Xd Particles::*of,
              double* numbers) const;
};

SimulatorBatch::Data::Data(const std::string& path, const std::string* text, const Rows& rows,
                           const SimulatorOptions& options) {
  if (rows.empty()) throw InputError("SimulatorBatch: 'rows' is empty, but needs at least one");
  std::vector<std::unique_ptr<Simulator::Data>> made(rows.size());
  // Which one is refused first must not depend on threads.
  std::vector<std::string> refusals(rows.size());
  const auto make = [&](std::size_t row) {
    try {
      SimulatorOptions own = options;
      for (const auto& [value_path, value] : rows[row]) own.values[value_path] = value;
      SceneOverrides overrides = overrides_of(own, text);
      overrides.keeps_threads = row > 0;
      made[row] = std::make_unique<Simulator::Data>(load_scene(path, overrides));
    } catch (const InputError& error) {
      refusals[row] = error.what();
    }
  };
  make(0);
  parallel_for(1, static_cast<int>(rows.size()), 1, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) make(static_cast<std::size_t>(row));
  });
  for (const std::string& refusal : refusals) {
    if (!refusal.empty()) throw InputError(refusal);
  }
  std::vector<World*> worlds;
  for (auto& data : made) {
    worlds.push_back(&data->world());
    simulators.push_back(Simulator(std::move(data)));
  }
  stepper = std::make_unique<WorldBatch>(worlds);
}

std::size_t SimulatorBatch::Data::checked(int index) const {
  const int count = static_cast<int>(simulators.size());
  if (index >= 0 && index < count) return static_cast<std::size_t>(index);
  throw InputError(fmt::format("simulator {}: the batch has 0 to {}", index, count - 1));
}

void SimulatorBatch::Data::gather(const std::string& body, const Eigen::Matrix3Xd Particles::*of,
                                  double* numbers) const {
  const auto values = [&](std::size_t s) -> const Eigen::Matrix3Xd& {
    return simulators[s].data_->body(body).particles().*of;
  };
  const Eigen::Index count = values(0).size();
  for (std::size_t s = 1; s < simulators.size(); ++s) {
    if (values(s).size() == count) continue;
    throw InputError(fmt::format(
        "body '{}' has {} particles in simulator 0 and {} in {}: ask each simulator for its own",
        body, count / 3, values(s).cols(), s));
  }
  parallel_for(0, static_cast<int>(simulators.size()), 16, [&](int begin, int end) {
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      std::copy_n(values(s).data(), count, numbers + static_cast<Eigen::Index>(s) * count);
    }
  });
}

SimulatorBatch::SimulatorBatch(const std::string& scene_file, const Rows& rows,
                               const SimulatorOptions& options)
    : data_(std::make_unique<Data>(scene_file, nullptr, rows, options)) {}

SimulatorBatch::SimulatorBatch(std::unique_ptr<Data> data) : data_(std::move(data)) {}

SimulatorBatch SimulatorBatch::from_text(const std::string& text, const std::string& name,
                                         const Rows& rows, const SimulatorOptions& options) {
  return SimulatorBatch(std::make_unique<Data>(name, &text, rows, options));
}

SimulatorBatch::SimulatorBatch(SimulatorBatch&&) noexcept = default;
SimulatorBatch& SimulatorBatch::operator=(SimulatorBatch&&) noexcept = default;
SimulatorBatch::~SimulatorBatch() = default;

int SimulatorBatch::size() const { return static_cast<int>(data_->simulators.size()); }

Simulator& SimulatorBatch::at(int index) { return data_->simulators[data_->checked(index)]; }
const Simulator& SimulatorBatch::at(int index) const {
  return data_->simulators[data_->checked(index)];
}

void SimulatorBatch::step(int count) {
  if (count < 0) throw InputError(fmt::format("step: count is {}, but must be >= 0", count));
  data_->stepper->step(count);
}

const std::string& SimulatorBatch::failure(int index) const {
  data_->checked(index);
  return data_->stepper->failure(index);
}

void SimulatorBatch::reset(int index) {
  at(index).reset();
  data_->stepper->go_on(index);
}

void SimulatorBatch::set_joint_positions(const Eigen::Ref<const Eigen::MatrixXd>& positions) {
  const std::vector<std::string> names = at(0).joint_names();
  const auto joints = static_cast<Eigen::Index>(names.size());
  if (positions.rows() != size() || positions.cols() != joints) {
    throw InputError(
        fmt::format("set_joint_positions: {} rows and {} columns, but there are {} simulators and "
                    "{} joints",
                    positions.rows(), positions.cols(), size(), joints));
  }
  std::vector<std::vector<std::vector<double>>> changed;
  for (int s = 0; s < size(); ++s) {
    const Simulator::Data& data = *at(s).data_;
    changed.push_back(data.joints());
    for (Eigen::Index j = 0; j < joints; ++j) {
      data.change(names[static_cast<std::size_t>(j)], positions(s, j), changed.back());
    }
  }
  for (int s = 0; s < size(); ++s) {
    at(s).data_->set_joints(std::move(changed[static_cast<std::size_t>(s)]));
  }
}

void SimulatorBatch::positions(const std::string& body, double* numbers) const {
  data_->gather(body, &Particles::x, numbers);
}

void SimulatorBatch::velocities(const std::string& body, double* numbers) const {
  data_->gather(body, &Particles::v, numbers);
}

}  // namespace pliant
