#include <algorithm>

#include "pliant/core/world.h"

namespace pliant {

StepSeries World::make_series(int steps, int follow) const {
  StepSeries series;
  series.continues = is_continued_;
  series.step_time = series.dt = dt_;
  series.obstacles = &obstacles_;
  series.max_speed = finite_check_.max_speed;
  series.max_distance = finite_check_.max_distance;
  // What the first step begins with is not what a step left.
  if (steps_ == 0 || bodies_.size() != 1 || !drivers_.empty() || !applied_forces_.empty() ||
      !field_ramps_.empty()) {
    return series;
  }
  const Body& body = bodies_.front();
  series.steps = steps + follow;
  const auto joins = [&] {
    if (!body.solver || !body.model->join_series(series)) return false;
    return body.solver_dt == series.dt &&
           std::all_of(body.effects.begin(), body.effects.end(),
                       [&](const auto& effect) { return effect->join_series(series); });
  };
  if (!joins()) series.steps = 0;
  const int all = series.steps;
  series.steps = std::min(steps, all);
  series.follow = all - series.steps;
  return series;
}

int World::limit_of(const StepSeries& series) const {
  if (series.steps < 2 || groups_.front()->integrated() != nullptr) return 0;
  return bodies_.front().solver->series_limit(bodies_.front().model->system(), series);
}

int World::series_limit(int wanted) { return limit_of(make_series(wanted, 0)); }

void World::begin_series(int steps) {
  is_continued_ = false;
  begin_series(steps, 0, Wanted::kState);
}

void World::begin_series(int steps, int follow, Wanted wanted) {
  const Timer timer;
  Body& body = bodies_.front();
  if (at_hand_ == Wanted::kState) motion_step_ = steps_;
  // Effects look at the time that the last step's report tells.
  series_ = make_series(steps, follow);
  series_.surface = body.model->surface_points();
  const bool is_made_here = wanted == Wanted::kSurface && body.model->surface_changes();
  series_.wanted = is_made_here ? Wanted::kMotion : wanted;
  const std::uint64_t last = steps_ + static_cast<std::uint64_t>(steps);
  body.report.begin(last, static_cast<double>(last) * dt_, dt_);
  next_reactions_.assign(obstacles_.size(), Reaction());
  body.parts = series_.parts;
  body.solver->begin_series(body.model->system(), series_, body.report);
  body.report.seconds = timer.seconds();
}

int World::finish_series() {
  const Timer timer;
  Body& body = bodies_.front();
  StepReport& report = body.report;
  const int taken = body.solver->finish_series(body.model->system(), next_reactions_, report);
  if (taken == 0) return 0;
  at_hand_ = body.solver->brought();
  body.model->set_seen_surface(at_hand_ == Wanted::kSurface ? body.solver->seen_surface()
                                                            : nullptr);
  steps_ += static_cast<std::uint64_t>(taken);
  time_ = static_cast<double>(steps_) * dt_;
  if (at_hand_ >= Wanted::kMotion) motion_step_ = steps_;
  report.step = steps_;
  report.time = time_;
  body.model->after_series(series_, taken);
  for (const auto& effect : body.effects) effect->add_reactions(next_reactions_);
  reactions_.swap(next_reactions_);
  if (series_.parts > 1) report.add_metric("parts", series_.parts);
  report.seconds = (report.seconds + timer.seconds()) / taken;
  return taken;
}

bool World::advance(int count) {
  return advance(count, std::max(count, 1), [](const World&) { return true; });
}

bool World::advance(int count, int every, const Look& look, const Wants& wants) {
  try {
    is_continued_ = false;  // an error may have ended the last call
    const bool is_finite = advance_watched(count, every, look, wants);
    is_continued_ = false;
    return bring_state() && is_finite;
  } catch (...) {
    bring_state();
    throw;
  }
}

bool World::advance_watched(int count, int every, const Look& look, const Wants& wants) {
  bool goes_on = true;
  for (int done = 0; done < count && goes_on;) {
    const int wanted = std::min(every - done % every, count - done);
    const int series = limit_of(make_series(wanted, 0));
    int taken = 0;
    if (series >= 2) {
      // What remains of these, or those up to the look after the next one.
      const int rest = series < wanted ? wanted - series : std::min(every, count - done - series);
      const Wanted seen = series < wanted ? Wanted::kNothing : wants();
      begin_series(series, rest, rest > 0 ? seen : Wanted::kState);
      taken = finish_series();
      is_continued_ = taken == series;
    }
    if (taken > 0) {
      done += taken;
      if (done % every == 0 || done == count) goes_on = look(*this);
      continue;
    }
    // What a series could not do, its steps do one by one.
    if (!bring_state()) return false;
    for (const int end = done + std::max(series, 1); done < end && goes_on; ++done) {
      is_continued_ = false;
      if (!step()) return false;
      goes_on = look(*this);
    }
  }
  return true;
}

bool World::bring_state() {
  if (at_hand_ == Wanted::kState) return true;
  Body& body = bodies_.front();
  body.model->set_seen_surface(nullptr);
  at_hand_ = Wanted::kState;
  if (body.solver->bring_state(body.model->system())) return true;
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
