#include "pliant/scene/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "pliant/geometry/mesh_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

bool is_frame(const fs::path& path) {
  return path.extension() == ".ply" || path.extension() == ".obj";
}

/// Files of an earlier recording in `directory`.
std::vector<fs::path> old_files(const fs::path& directory) {
  std::vector<fs::path> files;
  for (const char* name : {"steps.csv", "steps.csv.part"}) {
    if (fs::exists(directory / name)) files.push_back(directory / name);
  }
  if (!fs::is_directory(directory / "frames")) return files;
  for (const auto& entry : fs::directory_iterator(directory / "frames")) {
    if (is_frame(entry.path())) files.push_back(entry.path());
  }
  return files;
}

void prepare_folder(const fs::path& directory, bool overwrite) {
  const std::vector<fs::path> old = old_files(directory);
  if (!old.empty() && !overwrite) {
    throw InputError(
        fmt::format("{}: a recording is there already ({}); choose another folder or "
                    "overwrite it",
                    directory.string(), old.front().string()));
  }
  for (const fs::path& file : old) fs::remove(file);
  fs::create_directories(directory / "frames");
}

/// Before one column of seconds a phase.
constexpr const char* kColumns =
    "step,time,body,solver,iterations,residual,ended_by,contacts,kinetic,elastic,potential,"
    "step_seconds";

/// Copies rows of `from`, with zeros for the phases that were met only after they were written.
bool copy_rows(std::FILE* from, std::size_t columns, std::FILE* to) {
  std::rewind(from);
  std::size_t commas = 0;
  for (int c = std::getc(from); c != EOF; c = std::getc(from)) {
    if (c == ',') ++commas;
    if (c == '\n') {
      for (; commas + 1 < columns; ++commas) std::fputs(",0", to);
      commas = 0;
    }
    std::putc(c, to);
  }
  return std::ferror(from) == 0 && std::ferror(to) == 0;
}

double potential_energy(const Body& body) {
  double energy = 0.0;
  for (const auto& effect : body.effects) energy += effect->potential_energy(body);
  return energy;
}

/// Three columns.
std::string energies_of(const Body& body) {
  const System& system = body.model->system();
  return fmt::format("{},{},{}", system.kinetic_energy(), system.elastic_energy(),
                     potential_energy(body));
}

}  // namespace

Recording::Recording(std::string directory, const RecordingSpec& options, bool overwrite)
    : directory_(std::move(directory)), options_(options) {
  try {
    prepare_folder(directory_, overwrite);
  } catch (const fs::filesystem_error& error) {
    throw InputError(
        fmt::format("{}: cannot be used for a recording: {}", directory_, error.code().message()));
  }
  rows_.reset(std::fopen((directory_ + "/steps.csv.part").c_str(), "w+"));
  if (rows_ == nullptr) {
    throw InputError(
        fmt::format("{}/steps.csv.part: cannot be written: {}", directory_, std::strerror(errno)));
  }
}

Recording::~Recording() {
  try {
    finish();
  } catch (const InputError&) {
    // A destructor cannot report; callers who care call finish().
  }
}

void Recording::add_frame(const World& world) {
  const bool is_there = frames_ > 0 && last_frame_step_ == world.steps();
  if (options_.every == 0 || is_there) return;
  const bool obj = options_.format == FrameFormat::kObj;
  for (const Body& body : world.bodies()) {
    const TriangleMesh mesh = body.model->surface();
    const std::string path = fmt::format("{}/frames/{}_{:06}.{}", directory_, body.name,
                                         world.steps(), obj ? "obj" : "ply");
    if (obj) {
      write_obj(path, mesh);
    } else {
      std::map<std::string, Eigen::VectorXd> fields;
      if (!options_.surface_alone) fields = body.model->point_fields();
      for (auto& [name, values] : fields) values = body.model->on_surface(values);
      write_ply(path, mesh, fields);
    }
    ++frames_;
  }
  last_frame_step_ = world.steps();
}

void Recording::add_step(const World& world) {
  const bool is_due =
      options_.every > 0 && world.steps() % static_cast<std::uint64_t>(options_.every) == 0;
  if (steps_between() > 1 && !is_due) return;
  for (const Body& body : world.bodies()) add_row(world, body);
  if (is_due) add_frame(world);
}

std::size_t Recording::phase_column(std::string_view phase) {
  const auto found = std::find(phases_.begin(), phases_.end(), phase);
  if (found != phases_.end()) return static_cast<std::size_t>(found - phases_.begin());
  phases_.emplace_back(phase);
  return phases_.size() - 1;
}

void Recording::add_row(const World& world, const Body& body) {
  const StepReport& report = body.report;
  row_.clear();
  fmt::format_to(std::back_inserter(row_), "{},{},{},{},{},{},{},{},{},{}", world.steps(),
                 world.time(), body.name, report.solver, report.iterations, report.residual,
                 to_string(report.ended_by), report.contacts,
                 options_.surface_alone ? ",," : energies_of(body), report.seconds);
  std::fill(phase_seconds_.begin(), phase_seconds_.end(), 0.0);
  for (const PhaseTime& phase : report.phases) {
    const std::size_t column = phase_column(phase.name);
    phase_seconds_.resize(phases_.size(), 0.0);
    phase_seconds_[column] += phase.seconds;
  }
  for (double seconds : phase_seconds_) {
    fmt::format_to(std::back_inserter(row_), ",{}", seconds);
  }
  row_ += '\n';
  if (std::fwrite(row_.data(), 1, row_.size(), rows_.get()) != row_.size()) {
    throw InputError(
        fmt::format("{}/steps.csv.part: cannot be written: {}", directory_, std::strerror(errno)));
  }
}

void Recording::finish() {
  if (finished_) return;
  finished_ = true;
  std::string header = kColumns;
  for (const std::string& phase : phases_) header += "," + phase;
  const auto columns = static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1;
  const std::string path = directory_ + "/steps.csv";
  std::unique_ptr<std::FILE, FileCloser> table(std::fopen((path + ".tmp").c_str(), "w"));
  const bool written = table != nullptr && std::fprintf(table.get(), "%s\n", header.c_str()) > 0 &&
                       copy_rows(rows_.get(), columns, table.get()) &&
                       std::fflush(table.get()) == 0;
  if (!written || std::rename((path + ".tmp").c_str(), path.c_str()) != 0) {
    throw InputError(fmt::format("{}: cannot be written: {}; its rows are in {}.part", path,
                                 std::strerror(errno), path));
  }
  rows_.reset();
  std::remove((path + ".part").c_str());
}

}  // namespace pliant
