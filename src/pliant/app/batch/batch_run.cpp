#include "pliant/app/batch/batch_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <limits>
#include <map>
#include <optional>

#include "pliant/app/batch/batch_checkpoint.h"
#include "pliant/app/batch/batch_hash.h"
#include "pliant/app/batch/batch_rows.h"
#include "pliant/app/batch/batch_warnings.h"
#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/progress_bar.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/io/numpy_file.h"
#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr std::size_t kMostTold = 10;
constexpr std::size_t kMostTried = 1000;  // rows, for one that is accepted

using BatchGroup = std::vector<std::vector<SceneValue>>;

/// Of this process [bytes].
double resident_bytes() {
  double pages = 0.0, ignored = 0.0;
  std::ifstream("/proc/self/statm") >> ignored >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// How many scenes there may be at once, from what those before took.
class GroupSize {
 public:
  explicit GroupSize(double memory) : memory_(memory), base_(resident_bytes()) {}

  std::size_t value() const { return value_; }
  void note(std::size_t scenes) {
    constexpr std::size_t kGrowth = 8, kMost = 4096;
    const double each = (resident_bytes() - base_) / static_cast<double>(scenes);
    each_ = std::max(each_, each);
    const double fits = each_ > 0.0 ? memory_ / each_ : static_cast<double>(kMost);
    const auto most = static_cast<double>(std::min(kGrowth * value_, kMost));
    value_ = static_cast<std::size_t>(std::clamp(fits, 1.0, most));
  }

 private:
  double memory_, base_;
  double each_ = 0.0;  // the most that a scene took [bytes]
  std::size_t value_ = 16;
};

/// The first scene of the table that is accepted: what it has, all files have a place for.
LoadedScene load_first(const BatchInput& input, SceneTable& table) {
  std::string refusal;
  std::optional<LoadedScene> scene;
  for (std::size_t row = 0; row < std::min(table.size(), kMostTried) && !scene; ++row) {
    try {
      scene = load_scene(input.scene, with_values(input.overrides, table.next()));
    } catch (const InputError& error) {
      if (refusal.empty()) refusal = error.what();
    }
  }
  table.rewind();
  if (!scene) throw InputError(refusal);
  return std::move(*scene);
}

/// What a batch tells at its end.
struct BatchCounts {
  std::size_t scenes = 0, stopped = 0, refused = 0, on_gpu = 0, other_particles = 0;
  std::vector<std::string> told;  // of those that stopped or were refused, the first ones
  std::map<std::string, int> warnings;
  double seconds = 0.0;  // of steps

  void tell(std::size_t scene, const std::string& text) {
    if (told.size() < kMostTold) told.push_back(fmt::format("scene {}: {}", scene, text));
  }
};

class BatchRun {
 public:
  BatchRun(const BatchInput& input, SceneTable& table, const BatchOutput& output)
      : input_(input),
        table_(table),
        output_(output),
        first_(load_first(input, table)),
        rows_(*first_.world, table.paths()),
        steps_(input.steps(first_.spec.time_step)) {
    for (const std::string& warning : first_.warnings) {
      std::cerr << "warning: " << input.scene << ": " << warning << std::endl;
    }
    if (!output.folder.empty()) open_files();
  }

  int run() {
    // Only its numbers are asked for from here on.
    first_.world.reset();
    for (std::size_t row = 0; row < input_.begin + done_; ++row) table_.next();
    catch_interrupts();
    ProgressBar bar(output_.progress);
    GroupSize size(output_.memory);
    while (done_ < count()) {
      const std::size_t wanted = unfinished_ ? unfinished_->texts.size() : size.value();
      BatchGroup group(std::min(wanted, count() - done_));
      for (auto& row : group) row = table_.next();
      if (!run_group(group, bar, size)) break;
      done_ += group.size();
    }
    bar.clear();
    return tell();
  }

 private:
  std::size_t count() const { return input_.end - input_.begin; }
  bool writes() const { return folder_.has_value(); }
  bool is_recorded(std::uint64_t step) const {
    return step == steps_ || (output_.every > 0 && step % output_.every == 0);
  }

  void open_files() {
    const BatchFolder::Inputs inputs = {
        batch_hash(first_.spec, table_.path(),
                   fmt::format("{} steps {} every {} trajectory {} {}", input_.settings, steps_,
                               output_.every, output_.trajectory.every,
                               fmt::join(output_.trajectory.fields, ","))),
        input_.begin, input_.end};
    std::vector<BatchFolder::Table> tables = {{"scenes.csv", rows_.header()},
                                              {kWarningTable, kWarningHeader}};
    if (output_.trajectory.has(kContacts)) tables.push_back({kContactTable, kContactHeader});
    folder_.emplace(output_.folder, inputs, std::move(tables), output_.start);
    done_ = folder_->finished();
    count_warnings(read_bytes(output_.folder + "/" + kWarningTable), counts_.warnings);
    const std::string unfinished = folder_->unfinished();
    if (!unfinished.empty()) unfinished_ = unfinished_group(unfinished, folder_->state());
    for (const Body& body : first_.world->bodies()) {
      positions_.push_back(
          {body.name, GrowingNpy(output_.folder + "/positions_" + body.name + ".npy",
                                 {static_cast<std::size_t>(body.particles().size()), 3}, done_,
                                 unfinished_.has_value())});
    }
    trajectory_.emplace(output_.trajectory, rows_, *first_.world, steps_, output_.folder, done_,
                        unfinished_.has_value());
  }

  /// Whether they were finished; not where the user interrupted.
  bool run_group(const BatchGroup& group, ProgressBar& bar, GroupSize& size) {
    Batch batch(input_.scene, input_.overrides, group, Batch::Refused::kKeep);
    std::vector<SceneText> texts(group.size());
    std::uint64_t step = 0;
    if (unfinished_) {
      step = take_up(batch, texts);
    } else {
      add_frames(batch, 0, texts);
    }
    Timer since_kept;
    while (step < steps_) {
      const bool is_due = output_.checkpoint > 0.0 && step > 0 &&
                          (interrupted() || since_kept.seconds() > output_.checkpoint);
      if (is_due) {
        note_warnings(batch, texts);
        folder_->keep_unfinished(bytes_of(step, texts, batch));
        since_kept = Timer();
      }
      if (interrupted()) return false;
      const std::uint64_t portion = portion_after(step);
      const Timer own;
      step_batch(batch, portion);
      counts_.seconds += own.seconds();
      step += portion;
      if (writes() && is_recorded(step)) add_rows(batch, group, texts);
      add_frames(batch, step, texts);
      const double share = static_cast<double>(step) / static_cast<double>(steps_);
      bar.update(static_cast<double>(done_) + share * static_cast<double>(group.size()),
                 static_cast<double>(count()), fmt::format("of {} scenes", count()));
    }
    size.note(group.size());
    note_warnings(batch, texts);
    take_in(batch, texts);
    if (writes()) store(batch, group, texts);
    return true;
  }

  /// Puts the scenes to where they were when the batch was cut off; returns their steps.
  std::uint64_t take_up(Batch& batch, std::vector<SceneText>& texts) {
    if (unfinished_->steps >= steps_ || unfinished_->texts.size() != texts.size()) {
      throw InputError(folder_->state() + ": it is of another batch: remove it");
    }
    restore(*unfinished_, folder_->state(), batch);
    texts = std::move(unfinished_->texts);
    const std::uint64_t steps = unfinished_->steps;
    unfinished_.reset();
    return steps;
  }

  /// What touches is known of single steps alone, not of a GPU's resident runs.
  void step_batch(Batch& batch, std::uint64_t steps) const {
    const bool ends_alone = trajectory_ && trajectory_->has_contacts();
    if (ends_alone && steps > 1) batch.step(static_cast<int>(steps - 1));
    batch.step(ends_alone ? 1 : static_cast<int>(steps));
  }

  /// Until something is recorded; Ctrl-C is heard after each portion.
  std::uint64_t portion_after(std::uint64_t step) const {
    std::uint64_t count = std::min<std::uint64_t>(20, steps_ - step);
    if (output_.every > 0) count = std::min(count, output_.every - step % output_.every);
    if (trajectory_ && !trajectory_->is_none()) {
      count = std::min(count, trajectory_->steps_until(step));
    }
    return count;
  }

  template <class Use>
  static void for_each_scene(const Batch& batch, const Use& use) {
    parallel_for(0, batch.size(), 1, [&](int begin, int end) {
      for (int s = begin; s < end; ++s) use(s, static_cast<std::size_t>(s));
    });
  }

  void add_rows(const Batch& batch, const BatchGroup& group, std::vector<SceneText>& texts) {
    for_each_scene(batch, [&](int s, std::size_t k) {
      if (!batch.refusal(s).empty()) return;
      texts[k].rows +=
          rows_.rows(input_.begin + done_ + k, group[k], batch.world(s), batch.failure(s));
    });
  }

  void add_frames(const Batch& batch, std::uint64_t step, std::vector<SceneText>& texts) {
    if (!trajectory_ || !trajectory_->is_due(step)) return;
    for_each_scene(batch, [&](int s, std::size_t k) {
      if (!batch.refusal(s).empty()) return;
      const bool has_stopped = !batch.failure(s).empty();
      trajectory_->add(done_ + k, step, batch.world(s), has_stopped);
      if (!trajectory_->has_contacts() || has_stopped) return;
      texts[k].contacts +=
          trajectory_->contact_rows(input_.begin + done_ + k, step, batch.world(s));
    });
  }

  /// On the disk before the folder says that they are there.
  void store(const Batch& batch, const BatchGroup& group, std::vector<SceneText>& texts) {
    std::vector<std::string> all(trajectory_->has_contacts() ? 3 : 2);
    for (int s = 0; s < batch.size(); ++s) {
      const auto k = static_cast<std::size_t>(s);
      if (!batch.refusal(s).empty()) {
        texts[k].rows = rows_.refused(input_.begin + done_ + k, group[k], batch.refusal(s));
        trajectory_->leave_out(done_ + k);
      }
      store_positions(batch, s);
      all[0] += texts[k].rows;
      all[1] += warning_rows(input_.begin + done_ + k, texts[k].warnings);
      if (trajectory_->has_contacts()) all[2] += texts[k].contacts;
    }
    const std::size_t finished = done_ + group.size();
    for (const auto& [body, file] : positions_) file.publish(finished);
    trajectory_->publish(finished);
    folder_->add(all);
    folder_->publish(finished);
  }

  void store_positions(const Batch& batch, int s) {
    const std::size_t item = done_ + static_cast<std::size_t>(s);
    bool is_alike = true;
    for (const auto& [name, file] : positions_) {
      const Eigen::Matrix3Xd* found = nullptr;
      if (batch.refusal(s).empty()) {
        for (const Body& body : batch.world(s).bodies()) {
          if (body.name == name) found = &body.particles().x;
        }
      }
      if (found != nullptr && static_cast<std::size_t>(found->size()) == file.item_size()) {
        file.write(item, 0, found->data(), file.item_size());
        continue;
      }
      is_alike = is_alike && !batch.refusal(s).empty();
      file.leave_out(item);
    }
    counts_.other_particles += is_alike ? 0 : 1;
  }

  static void note_warnings(const Batch& batch, std::vector<SceneText>& texts) {
    for (int s = 0; s < batch.size(); ++s) {
      if (!batch.refusal(s).empty()) continue;
      const std::set<std::string>& own = batch.step_warnings(s);
      texts[static_cast<std::size_t>(s)].warnings.insert(own.begin(), own.end());
    }
  }

  void take_in(const Batch& batch, const std::vector<SceneText>& texts) {
    for (int s = 0; s < batch.size(); ++s) {
      ++counts_.scenes;
      const std::size_t scene = input_.begin + done_ + static_cast<std::size_t>(s);
      if (!batch.refusal(s).empty()) {
        ++counts_.refused;
        counts_.tell(scene, batch.refusal(s));
        continue;
      }
      counts_.stopped += batch.failure(s).empty() ? 0 : 1;
      if (!batch.failure(s).empty()) counts_.tell(scene, batch.failure(s));
      const auto& bodies = batch.world(s).bodies();
      const auto is_there = [](const Body& body) { return body.report.backend == "cuda"; };
      counts_.on_gpu += std::any_of(bodies.begin(), bodies.end(), is_there) ? 1 : 0;
      const SceneText& text = texts[static_cast<std::size_t>(s)];
      for (const std::string& warning : text.warnings) ++counts_.warnings[warning];
    }
  }

  int tell() {
    if (!output_.quiet) {
      if (writes()) {
        fmt::print("written: {}/scenes.csv and {} file{} of positions\n", output_.folder,
                   positions_.size(), positions_.size() == 1 ? "" : "s");
      }
      fmt::print(
          "{}: {} scenes, {} steps of {:g} s each, in {:.3f} s: {:.4g} scene-steps a second; "
          "{} on the GPU, {} stopped, {} refused\n",
          first_.spec.name, counts_.scenes, steps_, first_.spec.time_step, counts_.seconds,
          static_cast<double>(steps_ * (counts_.scenes - counts_.refused)) /
              std::max(counts_.seconds, 1e-12),
          counts_.on_gpu, counts_.stopped, counts_.refused);
      for (const auto& [text, scenes] : counts_.warnings) {
        fmt::print("warning ({} scene{}): {}\n", scenes, scenes == 1 ? "" : "s", text);
      }
    }
    std::fflush(stdout);
    tell_errors();
    if (done_ < count()) return kInterrupted;
    return counts_.stopped + counts_.refused > 0 ? kNotFinite : kOk;
  }

  void tell_errors() const {
    for (const std::string& text : counts_.told) std::cerr << "error: " << text << "\n";
    if (counts_.stopped + counts_.refused > counts_.told.size()) {
      std::cerr << "... and more; see the columns failure and refused\n";
    }
    if (counts_.other_particles > 0) {
      std::cerr << fmt::format(
          "note: {} scenes have other numbers of particles than the first: there positions are "
          "NaN\n",
          counts_.other_particles);
    }
    if (done_ < count()) {
      std::cerr << fmt::format("interrupted: {} of {} scenes are finished{}\n", done_, count(),
                               writes() ? "; --resume goes on with the others" : "");
    }
  }

  const BatchInput& input_;
  SceneTable& table_;
  const BatchOutput& output_;
  LoadedScene first_;
  BatchRows rows_;
  std::uint64_t steps_;
  std::size_t done_ = 0;  // scenes
  std::optional<BatchFolder> folder_;
  std::optional<UnfinishedGroup> unfinished_;  // that the next group is
  std::vector<std::pair<std::string, GrowingNpy>> positions_;
  std::optional<BatchTrajectory> trajectory_;
  BatchCounts counts_;
};

}  // namespace

int run_batch(const BatchInput& input, SceneTable& table, const BatchOutput& output) {
  return BatchRun(input, table, output).run();
}

}  // namespace pliant
