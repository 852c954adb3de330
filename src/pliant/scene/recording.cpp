#include "pliant/scene/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/io/mesh_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/yaml/table_cell.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

/// Before the wrenches' columns, and one column of seconds a phase.
constexpr const char* kFirstColumns = "step,time,body,solver,";
constexpr const char* kColumns =
    "step,time,body,solver,time_integration,first_order,iterations,residual,error,impulse_"
    "imbalance,energy_gained,ended_by,"
    "contacts,kinetic,elastic,potential,step_seconds";

/// Whether a name is BODY_NUMBER.ply or .obj, as frames are called: other surfaces stay.
bool is_named_as_frame(const fs::path& path) {
  if (path.extension() != ".ply" && path.extension() != ".obj") return false;
  const std::string name = path.stem().string();
  const std::size_t digits =
      name.size() - 1 - std::min(name.find_last_not_of("0123456789"), name.size() - 1);
  return digits >= 6 && digits < name.size() && name[name.size() - digits - 1] == '_';
}

/// What a frame says of itself, so that nobody else's surface is taken for one.
std::string mark_of(const std::string& frame) {
  return "frame " + frame + " of a Pliant recording";
}

/// Whether a recording wrote that file: a link is none, nor is a table with other columns.
bool is_own(const fs::path& path) {
  if (!fs::is_regular_file(fs::symlink_status(path))) return false;
  std::string begin(512, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  if (is_named_as_frame(path))
    return begin.find(mark_of(path.stem().string())) != std::string::npos;
  return begin.rfind(kFirstColumns, 0) == 0 || (begin.empty() && path.extension() == ".part");
}

/// Files in `directory` that have the names of a recording's.
std::vector<fs::path> old_files(const fs::path& directory) {
  std::vector<fs::path> files;
  for (const char* name : {"steps.csv", "steps.csv.part"}) {
    // A link that leads nowhere is one too.
    if (fs::exists(fs::symlink_status(directory / name))) files.push_back(directory / name);
  }
  if (!fs::is_directory(directory / "frames")) return files;
  for (const auto& entry : fs::directory_iterator(directory / "frames")) {
    if (is_named_as_frame(entry.path())) files.push_back(entry.path());
  }
  return files;
}

void prepare_folder(const fs::path& directory, bool overwrite) {
  const std::vector<fs::path> old = old_files(directory);
  for (const fs::path& file : old) {
    if (is_own(file)) continue;
    throw InputError(fmt::format(
        "{}: '{}' is there and no recording wrote it: choose another folder, or move it away",
        directory.string(), file.string()));
  }
  if (!old.empty() && !overwrite) {
    throw InputError(
        fmt::format("{}: a recording is there already ({}); choose another folder or "
                    "overwrite it",
                    directory.string(), old.front().string()));
  }
  for (const fs::path& file : old) fs::remove(file);
  fs::create_directories(directory / "frames");
}

/// Copies the rows of `from`, which follow its line of columns, with zeros for the phases that were
/// met only after they were written.
void copy_rows(const GrowingFile& from, std::size_t columns, AtomicFile& to) {
  constexpr std::size_t kBlock = 1 << 16;
  std::size_t commas = 0, place = 0;
  bool is_quoted = false, is_header = true;
  std::string block(kBlock, '\0'), rows;
  for (std::size_t size = 0; (size = from.read_at(place, block)) > 0; place += size) {
    rows.clear();
    for (const char c : std::string_view(block).substr(0, size)) {
      if (is_header) {
        is_header = c != '\n';
        continue;
      }
      if (c == '"') is_quoted = !is_quoted;
      if (c == ',' && !is_quoted) ++commas;
      if (c == '\n' && !is_quoted) {
        for (; commas + 1 < columns; ++commas) rows += ",0";
        commas = 0;
      }
      rows += c;
    }
    to.write(rows);
  }
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
    fs::create_directories(directory_);
    lock_ = FolderLock(directory_);
    prepare_folder(directory_, overwrite);
  } catch (const fs::filesystem_error& error) {
    throw InputError(
        fmt::format("{}: cannot be used for a recording: {}", directory_, error.code().message()));
  }
  rows_.emplace(GrowingFile::create(directory_ + "/steps.csv.part"));
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
    const std::string frame = fmt::format("{}_{:06}", body.name, world.steps());
    const std::string path = fmt::format("{}/frames/{}.{}", directory_, frame, obj ? "obj" : "ply");
    if (obj) {
      write_obj(path, mesh, mark_of(frame));
    } else {
      std::map<std::string, Eigen::VectorXd> fields;
      if (!options_.surface_alone) fields = body.model->point_fields();
      for (auto& [name, values] : fields) values = body.model->on_surface(values);
      write_ply(path, mesh, fields, mark_of(frame));
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
  rows_text_.clear();
  for (const Body& body : world.bodies()) add_row(world, body, wrenches);
  // At once: a process that is killed leaves all steps but the last one.
  if (rows_->size() == 0) rows_text_.insert(0, header() + "\n");
  try {
    rows_->append(rows_text_);
  } catch (const InputError& error) {
    finished_ = true;  // a table without its last rows is none
    throw InputError(fmt::format("{}; the rows of the steps before are there", error.what()));
  }
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
  fmt::format_to(std::back_inserter(rows_text_), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}{}",
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
    fmt::format_to(std::back_inserter(rows_text_), ",{}", seconds);
  }
  rows_text_ += '\n';
}

std::string Recording::header() const {
  std::string columns = kColumns;
  if (wrenches_) columns += wrench_columns(wrenches_->means());
  for (const std::string& phase : phases_) columns += "," + phase;
  return columns;
}

void Recording::finish() {
  if (finished_) return;
  finished_ = true;
  // A wrench's name may hold a comma, in a cell with quotes.
  auto columns = 1 + std::count(kColumns, kColumns + std::strlen(kColumns), ',');
  if (wrenches_) columns += 6 * static_cast<std::ptrdiff_t>(wrenches_->means().size());
  columns += static_cast<std::ptrdiff_t>(phases_.size());
  const std::string path = directory_ + "/steps.csv";
  try {
    AtomicFile table(path);
    table.write(header() + "\n");
    copy_rows(*rows_, static_cast<std::size_t>(columns), table);
    table.publish();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}; its rows are in {}.part", error.what(), path));
  }
  rows_.reset();
  std::error_code ignored;
  fs::remove(path + ".part", ignored);
}

}  // namespace pliant
