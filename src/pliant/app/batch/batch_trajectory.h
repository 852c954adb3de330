#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "pliant/app/batch/batch_rows.h"
#include "pliant/geometry/io/numpy_file.h"

namespace pliant {

/// What a batch records of each scene between its start and its end.
struct TrajectoryOptions {
  std::uint64_t every = 0;  ///< a frame each so many steps, the first at the start; 0: none
  std::vector<std::string> fields;

  bool has(const std::string& field) const {
    return std::find(fields.begin(), fields.end(), field) != fields.end();
  }
};

/// Of "every:N" and "fields:a,b". Throws InputError with the fields that there are.
TrajectoryOptions parse_trajectory(const std::vector<std::string>& texts);

constexpr const char* kContacts = "contacts";  ///< the field
constexpr const char* kContactTable = "trajectory_contacts.csv";
constexpr const char* kContactHeader =
    "scene,frame,time,body,vertex,other,point_x,point_y,point_z,normal_x,normal_y,normal_z,"
    "force_x,force_y,force_z\n";

/// The files of a trajectory: trajectory_BODY_FIELD.npy (scene, frame, particle or vertex, axis)
/// and trajectory_wrenches.npy (scene, frame, link or obstacle, [force, torque]). What a scene
/// lacks is NaN: one that was refused or has other bodies, and the frames after one stopped.
/// Contacts, of which each frame has another number, are rows of a table: kContactTable.
class BatchTrajectory {
 public:
  /// Of scenes like `first` that take so many steps; the first `kept` of them are there already.
  /// Throws InputError.
  /// `are_there`: they go on with the files in the folder, even where none is kept.
  BatchTrajectory(const TrajectoryOptions& options, const BatchRows& rows, const World& first,
                  std::uint64_t steps, const std::string& folder, std::size_t kept, bool are_there);

  /// Whether a frame is due after so many steps; `steps_until()` the next one is.
  bool is_due(std::uint64_t step) const { return every_ > 0 && step % every_ == 0; }
  std::uint64_t steps_until(std::uint64_t step) const { return every_ - step % every_; }
  bool is_none() const { return every_ == 0; }
  /// The present state of the `item`th scene; several threads may, each for other scenes.
  void add(std::size_t item, std::uint64_t step, const World& world, bool has_stopped) const;
  bool has_contacts() const { return has_contacts_; }
  /// The contacts of a scene after so many steps, as rows.
  std::string contact_rows(std::size_t scene, std::uint64_t step, const World& world) const;
  void leave_out(std::size_t item) const;
  void publish(std::size_t items) const;

 private:
  enum class Field { kPositions, kVelocities, kPoints, kWrenches };
  struct File {
    Field field;
    std::string body;
    std::size_t numbers = 0;  // of a frame
    GrowingNpy npy;
  };
  /// Empty: the world has no such numbers.
  std::vector<double> numbers_of(const File& file, const World& world) const;

  std::uint64_t every_ = 0;
  bool has_contacts_ = false;
  const BatchRows& rows_;
  std::vector<File> files_;
};

}  // namespace pliant
