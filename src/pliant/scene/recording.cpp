#include "pliant/scene/recording.h"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/yaml/table_cell.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

/// Whether a name is BODY_NUMBER.ply or .obj, as frames are called: other surfaces stay.
bool is_frame(const fs::path& path) {
  if (path.extension() != ".ply" && path.extension() != ".obj") return false;
  const std::string name = path.stem().string();
  const std::size_t digits =
      name.size() - 1 - std::min(name.find_last_not_of("0123456789"), name.size() - 1);
  return digits >= 6 && digits < name.size() && name[name.size() - digits - 1] == '_';
}

/// Files of an earlier recording in `directory`.
std::vector<fs::path> old_files(const fs::path& directory) {
  std::vector<fs::path> files;
  for (const char* name : {"steps.csv", "steps.csv.part"}) {
    // A link that leads nowhere is one too.
    if (fs::exists(fs::symlink_status(directory / name))) files.push_back(directory / name);
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

/// Before the wrenches' columns, and one column of seconds a phase.
constexpr const char* kColumns =
    "step,time,body,solver,time_integration,first_order,iterations,residual,error,impulse_"
    "imbalance,energy_gained,ended_by,"
    "contacts,kinetic,elastic,potential,step_seconds";

/// Copies rows of `from`, with zeros for the phases that were met only after they were written.
/// Returns whether all could be read.
bool copy_rows(std::FILE* from, std::size_t columns, AtomicFile& to) {
  constexpr std::size_t kBlock = 1 << 16;
  std::rewind(from);
  std::size_t commas = 0;
  bool is_quoted = false;
  std::string block;
  for (int c = std::getc(from); c != EOF; c = std::getc(from)) {
    if (c == '"') is_quoted = !is_quoted;
    if (c == ',' && !is_quoted) ++commas;
    if (c == '\n' && !is_quoted) {
      for (; commas + 1 < columns; ++commas) block += ",0";
      commas = 0;
    }
    block += static_cast<char>(c);
    if (block.size() < kBlock) continue;
    to.write(block);
    block.clear();
  }
  to.write(block);
  return std::ferror(from) == 0;
}

/// A new file to write and read. Null where it cannot be; a link is not followed.
std::FILE* open_new(const std::string& path) {
  const int descriptor =
      open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  return descriptor < 0 ? nullptr : fdopen(descriptor, "w+");
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
  rows_.reset(open_new(directory_ + "/steps.csv.part"));
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
  const std::string wrenches = wrenches_of(world);
  for (const Body& body : world.bodies()) add_row(world, body, wrenches);
  if (is_due) add_frame(world);
}

std::size_t Recording::phase_column(std::string_view phase) {
  const auto found = std::find(phases_.begin(), phases_.end(), phase);
  if (found != phases_.end()) return static_cast<std::size_t>(found - phases_.begin());
  phases_.emplace_back(phase);
  return phases_.size() - 1;
}

std::string Recording::wrenches_of(const World& world) {
  if (!wrenches_) wrenches_.emplace(world.obstacles());
  wrenches_->add(world.obstacles(), world.reactions());
  return wrench_cells(wrenches_->take());
}

void Recording::add_row(const World& world, const Body& body, const std::string& wrenches) {
  const StepReport& report = body.report;
  row_.clear();
  fmt::format_to(std::back_inserter(row_), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}{}",
                 world.steps(), world.time(), table_cell(body.name), report.solver,
                 report.time_integration, report.first_order, report.iterations, report.residual,
                 text_of(report.error), text_of(report.impulse_imbalance),
                 text_of(report.energy_gained), to_string(report.ended_by), report.contacts,
                 options_.surface_alone ? ",," : energies_of(body), report.seconds, wrenches);
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
  auto columns = static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1;
  if (wrenches_) {
    header += wrench_columns(wrenches_->means());
    columns += 6 * wrenches_->means().size();
  }
  for (const std::string& phase : phases_) header += "," + phase;
  columns += phases_.size();
  const std::string path = directory_ + "/steps.csv";
  // Before it is read again: that would forget an error, and the rows that it lost.
  if (std::fflush(rows_.get()) != 0) {
    throw InputError(fmt::format("{}.part: cannot be written: {}", path, std::strerror(errno)));
  }
  try {
    AtomicFile table(path);
    table.write(header + "\n");
    if (!copy_rows(rows_.get(), columns, table)) {
      throw InputError(fmt::format("cannot read '{}.part'", path));
    }
    table.publish();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}; its rows are in {}.part", error.what(), path));
  }
  rows_.reset();
  std::remove((path + ".part").c_str());
}

}  // namespace pliant
