#include <algorithm>

#include "pliant/core/world.h"

namespace pliant {

StepSeries World::make_series(int steps) const {
  StepSeries series;
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
  series.steps = steps;
  const auto joins = [&] {
    if (!body.solver || !body.model->join_series(series)) return false;
    return body.solver_dt == series.dt &&
           std::all_of(body.effects.begin(), body.effects.end(),
                       [&](const auto& effect) { return effect->join_series(series); });
  };
  if (!joins()) series.steps = 0;
  return series;
}

int World::series_limit(int wanted) {
  const StepSeries series = make_series(wanted);
  if (series.steps < 2) return 0;
  return bodies_.front().solver->series_limit(bodies_.front().model->system(), series);
}

void World::begin_series(int steps) {
  const Timer timer;
  Body& body = bodies_.front();
  series_ = make_series(steps);  // effects look at the time that the last step's report tells
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
  steps_ += static_cast<std::uint64_t>(taken);
  time_ = static_cast<double>(steps_) * dt_;
  report.step = steps_;
  report.time = time_;
  body.model->after_series(series_, taken);
  for (const auto& effect : body.effects) effect->add_reactions(next_reactions_);
  reactions_.swap(next_reactions_);
  if (series_.parts > 1) report.add_figure("parts", series_.parts);
  report.seconds = (report.seconds + timer.seconds()) / taken;
  return taken;
}

bool World::advance(int count) {
  for (int done = 0; done < count;) {
    const int series = series_limit(count - done);
    if (series >= 2) {
      begin_series(series);
      const int taken = finish_series();
      done += taken;
      if (taken > 0) continue;
    }
    // What a series could not do, its steps do one by one.
    for (const int end = done + std::max(series, 1); done < end; ++done) {
      if (!step()) return false;
    }
  }
  return true;
}

}  // namespace pliant
