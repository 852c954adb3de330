#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/geometry/io/folder_lock.h"
#include "pliant/geometry/io/growing_file.h"
#include "pliant/scene/robot/wrenches.h"
#include "pliant/scene/scene_spec.h"

namespace pliant {

/// Writes what a world does into a folder:
///   steps.csv              one row a step and body, or a frame and body; energies are left empty
///                          where the surface alone is recorded; wrenches (wrenches.h) are those
///                          of all bodies together, the same in each body's row
///   frames/BODY_000120.ply (or .obj) the surface of each body after step 120, with its point
///   fields
/// A file under its own name is complete: steps are collected in steps.csv.part until finish(),
/// each with its row as soon as it is done. The folder is this recording's alone until then.
class Recording {
 public:
  /// Makes the folder. Throws InputError when that fails, when another process records there, when
  /// it holds a recording already and `overwrite` is false, or files with a recording's names that
  /// none wrote. With `overwrite` the old steps.csv and frames are removed first.
  Recording(std::string directory, const RecordingSpec& options, bool overwrite);
  /// Finishes, if that was not done; errors are then lost.
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// Adds the frame of the present state whatever `every` says, unless it is there; none when
  /// `every` is 0.
  void add_frame(const World& world);
  /// Adds a row for each body's last step, and a frame when one is due. Throws InputError when
  /// writing fails.
  void add_step(const World& world);
  /// Writes steps.csv. Throws InputError when that fails.
  void finish();

  /// It observes the last of each so many steps.
  int steps_between() const {
    return options_.frames_alone && options_.every > 0 ? options_.every : 1;
  }
  /// What it needs of the bodies then.
  Readback readback() const {
    return options_.surface_alone ? Readback::kSurface : Readback::kMotion;
  }
  int frames() const { return frames_; }  ///< number of surface files written
  const std::string& directory() const { return directory_; }

 private:
  void add_row(const World& world, const Body& body, const std::string& wrenches);
  /// What bodies did to links and obstacles in the world's last step, as cells of a row.
  std::string wrenches_of(const World& world);
  std::size_t phase_column(std::string_view phase);
  /// The columns as they are known by now: phases may follow.
  std::string header() const;

  std::string directory_;
  RecordingSpec options_;
  std::optional<WrenchAverage> wrenches_;  // empty before the first step
  std::vector<std::string> phases_;        // columns, in the order they were met
  std::vector<double> phase_seconds_;
  FolderLock lock_;
  std::optional<GrowingFile> rows_;  // steps.csv.part
  std::string rows_text_;            // of the step
  std::uint64_t last_frame_step_ = 0;
  int frames_ = 0;
  bool finished_ = false;
};

}  // namespace pliant
