#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/core/body.h"
#include "pliant/core/body/applied_force.h"
#include "pliant/core/body/field_ramps.h"
#include "pliant/core/checkpoint.h"
#include "pliant/core/group.h"
#include "pliant/core/obstacle.h"
#include "pliant/core/step/finite_check.h"
#include "pliant/core/system/body_pairs.h"
#include "pliant/core/system/near_bodies.h"

namespace pliant {

struct Energies {
  double kinetic = 0.0;    ///< [J]
  double elastic = 0.0;    ///< [J]
  double potential = 0.0;  ///< of gravity and of air [J]
  double total() const { return kinetic + elastic + potential; }
};

/// Bodies, obstacles and time. Not thread-safe: one thread steps it and changes it.
class World {
 public:
  explicit World(double time_step);

  double time() const { return time_; }           ///< [s]
  double time_step() const { return dt_; }        ///< [s]
  std::uint64_t steps() const { return steps_; }  ///< since the start or the last reset

  std::deque<Body>& bodies() { return bodies_; }
  const std::deque<Body>& bodies() const { return bodies_; }
  std::vector<Obstacle>& obstacles() { return obstacles_; }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  /// Per obstacle, of the last step.
  const std::vector<Reaction>& reactions() const { return reactions_; }
  AppliedForces& applied_forces() { return applied_forces_; }
  FiniteCheck& finite_check() { return finite_check_; }
  /// Set before effects are added.
  BodyPairs& body_pairs() { return body_pairs_; }
  const BodyPairs& body_pairs() const { return body_pairs_; }

  /// All obstacles are added before the first body.
  void add_obstacle(Obstacle obstacle) { obstacles_.push_back(std::move(obstacle)); }
  void add_driver(std::unique_ptr<ObstacleDriver> driver);
  /// Whether a step may be taken again because bodies press on what moves.
  bool yields() const;
  /// Takes a body whose model is set; its effects and solver follow by add_effect, set_solver.
  Body& add_body(std::string name, std::unique_ptr<Model> model);

  /// Lets these bodies, which nothing moves yet, be moved together, so that effects can act between
  /// them. Their systems are projective.
  void group(std::vector<Body*> bodies, LockstepFactory make_lockstep);

  /// Throws InputError for an unknown effect, a bad parameter, or one that is there already.
  void add_effect(Body& body, const EffectRegistry& registry, const std::string& name,
                  const ParameterText& parameters, const std::string& where);
  /// Swaps the solver of all bodies of a body's group between two steps; positions, velocities and
  /// time stay. Throws InputError for an unknown or unsuitable solver or a bad parameter, and then
  /// nothing changed.
  void set_solver(Body& body, const SolverRegistry& registry, const std::string& name,
                  const ParameterText& parameters, const std::string& where);
  /// The same of some bodies of one group alone; the others keep theirs. Throws InputError also
  /// where their solvers cannot go together.
  void set_solver(const std::vector<Body*>& bodies, const SolverRegistry& registry,
                  const std::string& name, const ParameterText& parameters,
                  const std::string& where);
  /// Swaps the time integration of all bodies of a body's group between two steps; all else stays;
  /// after implicit Euler the first step is of first order. Throws InputError, and then nothing
  /// changed, for an unknown one, and where a model or a solver of theirs has an integration of its
  /// own.
  void set_time_integration(Body& body, const TimeIntegrationRegistry& registry,
                            const std::string& name);
  /// What reset() goes back to: the present positions, velocities and fixed particles, at time 0.
  void set_initial_state();
  /// Sets a field of some particles, at once or little by little; a reset forgets it. Returns the
  /// number of particles. Throws InputError as FieldRamps::begin does.
  int set_field(const FieldRequest& request) { return field_ramps_.begin(request, bodies_, time_); }
  /// Tell the solvers that masses, fixed particles or elements changed.
  void system_changed();

  /// One time step of every body. Returns false when a body was not finite: the world is then as
  /// it was before the step, and that body's report says what happened.
  bool step();
  /// `count` steps, of which nobody sees but the last: a solver that keeps the body where it
  /// computes takes many of them in one resident run. Returns false as step() does, when that many
  /// were not taken; the step that was not is undone.
  bool advance(int count);
  /// Sees the world after every `every` steps and the last one, and after each that was taken
  /// alone; returns whether to go on. The next steps may be under way already: they change nothing
  /// that it sees.
  using Observer = std::function<bool(const World&)>;
  /// What is read back for the next call of the observer; asked before the steps that lead to it.
  using NextReadback = std::function<Readback()>;
  /// advance() with an observer, and no more steps once it says so. What is not read back may stay
  /// where a solver computes: the observer then sees that part as it was at an earlier time
  /// (at_hand()). On return all is at hand.
  bool advance(
      int count, int every, const Observer& observe,
      const NextReadback& next_readback = [] { return Readback::kState; });
  /// What of the bodies is that of time(): all, unless an observer is called for which less was
  /// read back. A changing surface (Model::surface_changes()) comes with the motion.
  Readback at_hand() const { return at_hand_; }
  /// How many of the next `steps` can be one resident run; below 2: none. Then begin_resident_run()
  /// for as many at most and finish_resident_run(), which returns how many it took. 0: they have to
  /// be taken one by one, and the world is as it was.
  int resident_limit(int steps);
  void begin_resident_run(int steps);
  int finish_resident_run();
  /// A step in two halves, between which a batch of worlds runs what their solvers share
  /// (solver_batch.h). Only a world of one body does anything in the first.
  void begin_step();
  bool finish_step();
  /// What the bodies' reports say of a step that was undone; empty after one that was not.
  std::string failure() const;
  /// Back to the first state, bit for bit; applied forces are cleared.
  void reset();
  /// The present state, from which load() goes on bit for bit. Reactions are not part of it.
  Checkpoint save() const;
  /// Goes back to a saved state; solvers stay. Throws InputError, and then nothing changed, when
  /// the checkpoint is of another scene or time step, or what it keeps is damaged.
  void load(const Checkpoint& checkpoint);
  Energies energies() const;

 private:
  void take(const Checkpoint& checkpoint);
  ResidentRun make_resident_run(int steps, int follow) const;
  int limit_of(const ResidentRun& run) const;
  bool advance_observed(int count, int every, const Observer& observe,
                        const NextReadback& next_readback);
  void begin_resident_run(int steps, int follow, Readback readback);
  bool read_back_state();
  void move_obstacles(double time);
  void begin_single_group();
  bool finish_groups();
  /// Whether a driver puts its obstacles elsewhere after the step; not after the `last` try.
  bool drivers_yield(bool last);
  /// Takes the step again, with obstacles where they are now.
  bool take_again();
  /// Whether a step that failed can be taken with obstacles that stay where they were, and was.
  bool take_held_back();
  void begin_group(Group& group);
  bool finish_group(Group& group);
  bool finish_substeps(Group& group);
  void begin_substep(Group& group);
  bool finish_substep(Group& group);
  bool end_solved(Body& body, double dt);
  static void prepare_group(Group& group, double dt);
  void begin_substeps(Group& group, int substeps);
  void place_obstacles(int substep, int substeps);
  void add_reactions(const Group& group);
  void undo(std::size_t stepped_groups);
  void undo_groups(std::size_t stepped_groups);
  static void undo(Body& body);
  /// Whether what its effects do after a step has to be kept from before.
  bool keeps(const Body& body) const;
  static void keep(Body& body);
  static void go_back(Body& body);
  int index_of(const Body& body) const;

  double dt_;
  double time_ = 0.0;
  std::uint64_t steps_ = 0;
  std::deque<Body> bodies_;                     // a deque, since effects refer to their body
  std::vector<std::unique_ptr<Group>> groups_;  // each body is in one of them
  std::vector<Obstacle> obstacles_;
  std::vector<std::unique_ptr<ObstacleDriver>> drivers_;
  std::vector<Reaction> reactions_;
  std::vector<Reaction> next_reactions_, substep_reactions_;  // of the running step, of a substep
  std::vector<std::pair<Eigen::Isometry3d, Eigen::Isometry3d>> obstacle_steps_;  // start, end
  AppliedForces applied_forces_;
  FieldRamps field_ramps_;
  FiniteCheck finite_check_;
  BodyPairs body_pairs_;
  NearBodies near_bodies_;
  ResidentRun resident_run_;   // the running one
  bool is_continued_ = false;  // nobody changes anything between the last run and the next
  Readback at_hand_ = Readback::kState;
  std::uint64_t motion_step_ = 0;  // after which positions and velocities were last at hand
};

}  // namespace pliant
