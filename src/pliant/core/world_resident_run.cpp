#include <algorithm>

#include "pliant/core/world.h"

namespace pliant {

ResidentRun World::make_resident_run(int steps, int follow) const {
  ResidentRun run;
  run.continues = is_continued_;
  run.step_time = run.dt = dt_;
  run.obstacles = &obstacles_;
  run.max_speed = finite_check_.max_speed;
  run.max_distance = finite_check_.max_distance;
  // What the first step begins with is not what a step left.
  if (steps_ == 0 || bodies_.size() != 1 || !drivers_.empty() || !applied_forces_.empty() ||
      !field_ramps_.empty()) {
    return run;
  }
  const Body& body = bodies_.front();
  run.steps = steps + follow;
  const auto joins = [&] {
    if (!body.solver || !body.model->join_resident_run(run)) return false;
    return body.solver_dt == run.dt &&
           std::all_of(body.effects.begin(), body.effects.end(),
                       [&](const auto& effect) { return effect->join_resident_run(run); });
  };
  if (!joins()) run.steps = 0;
  const int all = run.steps;
  run.steps = std::min(steps, all);
  run.follow = all - run.steps;
  return run;
}

int World::limit_of(const ResidentRun& run) const {
  if (run.steps < 2 || groups_.front()->integrated() != nullptr) return 0;
  return bodies_.front().solver->resident_limit(bodies_.front().model->system(), run);
}

int World::resident_limit(int steps) { return limit_of(make_resident_run(steps, 0)); }

void World::begin_resident_run(int steps) {
  is_continued_ = false;
  begin_resident_run(steps, 0, Readback::kState);
}

void World::begin_resident_run(int steps, int follow, Readback readback) {
  const Timer timer;
  Body& body = bodies_.front();
  if (at_hand_ == Readback::kState) motion_step_ = steps_;
  // Effects look at the time that the last step's report tells.
  resident_run_ = make_resident_run(steps, follow);
  resident_run_.surface = body.model->surface_points();
  const bool is_made_here = readback == Readback::kSurface && body.model->surface_changes();
  resident_run_.readback = is_made_here ? Readback::kMotion : readback;
  const std::uint64_t last = steps_ + static_cast<std::uint64_t>(steps);
  body.report.begin(last, static_cast<double>(last) * dt_, dt_);
  next_reactions_.assign(obstacles_.size(), Reaction());
  body.substeps = resident_run_.substeps;
  body.solver->begin_resident_run(body.model->system(), resident_run_, body.report);
  body.report.seconds = timer.seconds();
}

int World::finish_resident_run() {
  const Timer timer;
  Body& body = bodies_.front();
  StepReport& report = body.report;
  const int taken = body.solver->finish_resident_run(body.model->system(), next_reactions_, report);
  if (taken == 0) return 0;
  at_hand_ = body.solver->available();
  body.model->set_seen_surface(at_hand_ == Readback::kSurface ? body.solver->seen_surface()
                                                              : nullptr);
  steps_ += static_cast<std::uint64_t>(taken);
  time_ = static_cast<double>(steps_) * dt_;
  if (at_hand_ >= Readback::kMotion) motion_step_ = steps_;
  report.step = steps_;
  report.time = time_;
  body.model->after_resident_run(resident_run_, taken);
  for (const auto& effect : body.effects) effect->add_reactions(next_reactions_);
  reactions_.swap(next_reactions_);
  if (resident_run_.substeps > 1) report.add_metric("substeps", resident_run_.substeps);
  report.seconds = (report.seconds + timer.seconds()) / taken;
  return taken;
}

bool World::advance(int count) {
  return advance(count, std::max(count, 1), [](const World&) { return true; });
}

bool World::advance(int count, int every, const Observer& observe,
                    const NextReadback& next_readback) {
  try {
    is_continued_ = false;  // an error may have ended the last call
    const bool is_finite = advance_observed(count, every, observe, next_readback);
    is_continued_ = false;
    return read_back_state() && is_finite;
  } catch (...) {
    read_back_state();
    throw;
  }
}

bool World::advance_observed(int count, int every, const Observer& observe,
                             const NextReadback& next_readback) {
  bool goes_on = true;
  for (int done = 0; done < count && goes_on;) {
    const int due = std::min(every - done % every, count - done);
    const int resident = limit_of(make_resident_run(due, 0));
    int taken = 0;
    if (resident >= 2) {
      // What remains of these, or those up to the observation after the next one.
      const int rest = resident < due ? due - resident : std::min(every, count - done - resident);
      const Readback readback = resident < due ? Readback::kNothing : next_readback();
      begin_resident_run(resident, rest, rest > 0 ? readback : Readback::kState);
      taken = finish_resident_run();
      is_continued_ = taken == resident;
    }
    if (taken > 0) {
      done += taken;
      if (done % every == 0 || done == count) goes_on = observe(*this);
      continue;
    }
    // What a resident run could not do is done step by step.
    if (!read_back_state()) return false;
    for (const int end = done + std::max(resident, 1); done < end && goes_on; ++done) {
      is_continued_ = false;
      if (!step()) return false;
      goes_on = observe(*this);
    }
  }
  return true;
}

bool World::read_back_state() {
  if (at_hand_ == Readback::kState) return true;
  Body& body = bodies_.front();
  body.model->set_seen_surface(nullptr);
  at_hand_ = Readback::kState;
  if (body.solver->read_back_state(body.model->system())) return true;
  // It is lost: what was seen already is made again. The step before is not known.
  Particles& particles = body.particles();
  particles.x_start = particles.x;
  particles.v_start = particles.v;
  const std::uint64_t end = steps_;
  steps_ = motion_step_;
  time_ = static_cast<double>(steps_) * dt_;
  while (steps_ < end) {
    if (!step()) return false;
  }
  return true;
}

}  // namespace pliant
