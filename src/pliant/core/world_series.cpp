#include <algorithm>

#include "pliant/core/world.h"

namespace pliant {

StepSeries World::make_series(int steps) const {
  StepSeries series;
  series.dt = dt_;
  series.obstacles = &obstacles_;
  // What the first step begins with is not what a step left.
  if (steps_ == 0 || bodies_.size() != 1 || !drivers_.empty() || !applied_forces_.empty() ||
      !field_ramps_.empty()) {
    return series;
  }
  const Body& body = bodies_.front();
  if (!body.solver || body.solver_dt != dt_ || body.model->acts_around_steps()) return series;
  for (const auto& effect : body.effects) {
    if (!effect->join_series(series)) return series;
  }
  series.steps = steps;
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
  const std::uint64_t last = steps_ + static_cast<std::uint64_t>(steps);
  body.report.begin(last, static_cast<double>(last) * dt_, dt_);
  body.parts = 1;
  next_reactions_.assign(obstacles_.size(), Reaction());
  series_steps_ = steps;
  body.solver->begin_series(body.model->system(), make_series(steps), body.report);
  body.report.seconds = timer.seconds();
}

bool World::finish_series() {
  const Timer timer;
  Body& body = bodies_.front();
  if (!body.solver->finish_series(body.model->system(), next_reactions_, body.report)) return false;
  steps_ += static_cast<std::uint64_t>(series_steps_);
  time_ = static_cast<double>(steps_) * dt_;
  reactions_.swap(next_reactions_);
  body.report.seconds = (body.report.seconds + timer.seconds()) / series_steps_;
  return true;
}

bool World::advance(int count) {
  for (int done = 0; done < count;) {
    const int series = series_limit(count - done);
    if (series >= 2) {
      begin_series(series);
      if (finish_series()) {
        done += series;
        continue;
      }
    }
    // What a series could not do, its steps do one by one.
    for (const int end = done + std::max(series, 1); done < end; ++done) {
      if (!step()) return false;
    }
  }
  return true;
}

}  // namespace pliant
