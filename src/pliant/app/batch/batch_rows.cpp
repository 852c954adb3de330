#include "pliant/app/batch/batch_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/scene/yaml/table_cell.h"

namespace pliant {
namespace {

constexpr const char* kColumns =
    ",body,step,time,iterations,residual,error,impulse_imbalance,energy_gained,contacts,kinetic,"
    "elastic,potential,center_x,center_y,center_z,lowest_z,highest_z";
constexpr int kCells = 17;  // of these

}  // namespace

BatchRows::BatchRows(const World& first, const std::vector<std::string>& paths)
    : names_(zero_wrenches(first.obstacles())), header_("scene") {
  for (const std::string& path : paths) header_ += "," + table_cell(path);
  header_ += kColumns + wrench_columns(names_) + ",failure,refused\n";
}

std::string BatchRows::begin_of_row(std::size_t scene, const std::vector<SceneValue>& values) {
  std::string text = std::to_string(scene);
  for (const SceneValue& value : values) text += "," + table_cell(value.text);
  return text;
}

std::string BatchRows::rows(std::size_t scene, const std::vector<SceneValue>& values,
                            const World& world, const std::string& failure) const {
  const std::string begin = begin_of_row(scene, values);
  const std::string wrenches = wrench_cells(wrenches_of(world));
  const Energies energies = world.energies();
  std::string text;
  for (const Body& body : world.bodies()) {
    const StepReport& report = body.report;
    const Particles& p = body.particles();
    const Eigen::Vector3d center = p.center_of_mass();
    text += begin;
    text += fmt::format(
        ",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}{},{},\n", table_cell(body.name),
        world.steps(), world.time(), report.iterations, report.residual, text_of(report.error),
        text_of(report.impulse_imbalance), text_of(report.energy_gained), report.contacts,
        energies.kinetic, energies.elastic, energies.potential, center[0], center[1], center[2],
        p.x.row(2).minCoeff(), p.x.row(2).maxCoeff(), wrenches, table_cell(failure));
  }
  return text;
}

std::string BatchRows::refused(std::size_t scene, const std::vector<SceneValue>& values,
                               const std::string& refusal) const {
  constexpr std::size_t kWrenchCells = 6;
  const std::size_t empty = kCells + kWrenchCells * names_.size() + 1;
  return begin_of_row(scene, values) + std::string(empty, ',') + "," + table_cell(refusal) + "\n";
}

std::vector<Wrench> BatchRows::wrenches_of(const World& world) const {
  WrenchAverage average(world.obstacles());
  average.add(world.obstacles(), world.reactions());
  std::vector<Wrench> wrenches = names_;
  for (const Wrench& own : average.take()) {
    const auto same = [&](const Wrench& known) { return known.name == own.name; };
    const auto found = std::find_if(wrenches.begin(), wrenches.end(), same);
    if (found != wrenches.end()) *found = own;
  }
  return wrenches;
}

}  // namespace pliant
