#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pliant/simulator.h"

namespace pliant {

/// Many simulators of one scene that are stepped side by side, for learning and for studies. Each
/// does what it does alone, to the last bit, for any number of threads and of others.
///
/// Units and errors are those of Simulator. Not thread-safe: one thread at a time uses a batch and
/// its simulators; the batch itself takes as many threads as SimulatorOptions::threads says.
class SimulatorBatch {
 public:
  /// A simulator for each of `rows`, which are values beside those of `options` (an empty map: the
  /// scene as it is). Throws InputError: of the first that is refused.
  SimulatorBatch(const std::string& scene_file,
                 const std::vector<std::map<std::string, std::string>>& rows,
                 const SimulatorOptions& options = {});
  /// The same of a scene file's text, as Simulator::from_text().
  static SimulatorBatch from_text(const std::string& text, const std::string& name,
                                  const std::vector<std::map<std::string, std::string>>& rows,
                                  const SimulatorOptions& options = {});
  /// One that was moved from can only be destroyed or assigned to.
  SimulatorBatch(SimulatorBatch&&) noexcept;
  SimulatorBatch& operator=(SimulatorBatch&&) noexcept;  ///< likewise
  ~SimulatorBatch();

  int size() const;  ///< how many simulators there are
  /// Where it is in the batch. It is not stepped by itself where its solver runs on a GPU. Throws
  /// InputError for an index that there is not.
  Simulator& at(int index);
  const Simulator& at(int index) const;  ///< the same to look at

  /// `count` steps of each that has not stopped. One whose step is not finite stops, at its last
  /// finite state, and stops no other.
  void step(int count = 1);
  /// Why that one stopped; "": it goes on.
  const std::string& failure(int index) const;
  /// Back to the start; one that stopped goes on.
  void reset(int index);

  /// Where the joints of all of them shall be at the end of the next step [m] or [rad]: a row a
  /// simulator, a column a joint of Simulator::joint_names(). Throws InputError, and then nothing
  /// changed, as Simulator::set_joint_positions() does.
  void set_joint_positions(const Eigen::Ref<const Eigen::MatrixXd>& positions);
  /// Writes the positions [m] of a body's particles, of one simulator after the other, to
  /// `numbers`: size() x n x 3 of them. Throws InputError where the simulators have other numbers
  /// of particles.
  void positions(const std::string& body, double* numbers) const;
  /// The same of the velocities [m/s].
  void velocities(const std::string& body, double* numbers) const;

 private:
  struct Data;
  explicit SimulatorBatch(std::unique_ptr<Data> data);
  std::unique_ptr<Data> data_;
};

}  // namespace pliant
