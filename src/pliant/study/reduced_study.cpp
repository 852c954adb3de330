#include "pliant/study/reduced_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/timer.h"
#include "pliant/geometry/atomic_file.h"

namespace pliant {
namespace {

std::vector<StudyIntegrator> compared_integrators() {
  // 1/(2π): explicit where h ω < 1, the other reading of "the sampling frequency".
  return {{"imex", "imex", {}},
          {"imex_plain", "imex", {{"stiffening", "1"}, {"limit", "2"}}},
          {"imex_thesis", "imex_thesis", {}},
          {"imex_thesis_rad", "imex_thesis", {{"split", fmt::format("{}", 0.5 / M_PI)}}},
          {"newmark_1", "newmark", {{"iterations", "1"}, {"tolerance", "0"}}},
          {"newmark", "newmark", {}}};
}

double energy(const ReducedSystem& system) {
  return system.elastic_energy() + system.kinetic_energy();
}

/// One run's row, and its energies a hundred times a second where `trace` asks for them.
std::string run_row(const StudyBody& body, const ReducedRunOptions& options, double scale,
                    std::string* trace) {
  double peak = 0.0;
  std::uint64_t step = 0;
  const auto every = static_cast<std::uint64_t>(std::max(1.0, std::round(0.01 / options.h)));
  const ReducedRun run = run_reduced(body, options, [&](const ReducedSystem& system, double time) {
    if (++step % every == 0) {
      peak = std::max(peak, relative_displacement(body, system.q));
      if (trace != nullptr) {
        *trace += fmt::format("{},{:.6g},{:.9g},{:.9g}\n", options.integrator.label, time,
                              energy(system), system.linear_energy(body.high));
      }
    }
    return true;
  });
  return fmt::format(
      "{},{},{},{},{},{:.4g},{},{:.4g},{:.4g},{},{:.4g}\n", body.example.name,
      to_string(options.load), options.damping, scale, options.integrator.label, options.force,
      run.blew_up ? "blew_up" : "finished", run.end,
      static_cast<double>(run.iterations) / static_cast<double>(run.steps + run.blew_up),
      run.warned, peak);
}

/// Mean total and high energy within the first and last `window` seconds.
struct EnergyMeans {
  double total[2] = {}, high[2] = {};
  std::uint64_t count[2] = {};
  void add(int end, double total_energy, double high_energy) {
    total[end] += total_energy;
    high[end] += high_energy;
    ++count[end];
  }
  double change(const double (&sums)[2]) const {
    return sums[1] / static_cast<double>(count[1]) / (sums[0] / static_cast<double>(count[0])) -
           1.0;
  }
};

/// Least seconds of `repeats` runs, a step.
double step_seconds(const StudyBody& body, const ReducedRunOptions& options, int repeats,
                    ReducedRun& run) {
  double best = 1e300;
  for (int k = 0; k < repeats; ++k) {
    run = run_reduced(body, options);
    best = std::min(best, run.seconds / static_cast<double>(std::max<std::uint64_t>(1, run.steps)));
  }
  return best;
}

void write(const ReducedStudyOptions& options, const std::string& name, const std::string& text) {
  write_file_atomically(options.folder + "/" + name, text);
}

}  // namespace

bool study_reduced_runs(const ReducedStudyOptions& options, const std::vector<double>& dampings,
                        const StudyProgress& progress) {
  std::string rows =
      "body,load,damping,scale,integrator,force_n,status,end_s,iterations,warned,peak_share\n";
  double done = 0.0;
  const double total = static_cast<double>(options.bodies.size() * dampings.size() * 3);
  for (const std::string& name : options.bodies) {
    if (!progress(done, total, name)) return false;
    const StudyBody body = make_study_body(name, options.share);
    for (const double damping : dampings) {
      for (int k = 0; k < 3; ++k, ++done) {
        std::string trace = "integrator,time_s,total_j,high_j\n";
        for (const double scale : {1.0, 2.0, 4.0}) {
          for (const StudyIntegrator& integrator : compared_integrators()) {
            if (!progress(done, total, name + " " + integrator.label)) return false;
            const ReducedRunOptions run{integrator, kReducedLoads[k], scale * body.amplitudes[k],
                                        damping,    kThesisStep,      options.duration};
            rows += run_row(body, run, scale, scale == 1.0 ? &trace : nullptr);
          }
        }
        write(options,
              fmt::format("energy_{}_{}_{}.csv", name, to_string(kReducedLoads[k]),
                          damping > 0.0 ? "damped" : "undamped"),
              trace);
        write(options, dampings.size() > 1 ? "runs.csv" : fmt::format("runs_{}.csv", dampings[0]),
              rows);
      }
    }
  }
  return true;
}

bool study_reduced_long(const ReducedStudyOptions& options, const StudyProgress& progress) {
  const StudyBody body = make_study_body("quadruped", options.share);
  std::string rows = "integrator,steps,end_s,status,total_change,high_change,warned,step_us\n";
  const std::vector<StudyIntegrator> integrators = compared_integrators();
  constexpr double kWindow = 35.0;  // as the thesis [s]
  double done = 0.0;
  for (const StudyIntegrator& integrator : integrators) {
    ReducedRunOptions run{
        integrator, ReducedLoad::kImpulse, body.amplitudes[0],
        0.0,        kThesisStep,           kThesisStep * static_cast<double>(options.long_steps)};
    const double window = std::min(kWindow, 0.1 * run.duration);
    EnergyMeans means;
    std::uint64_t step = 0;
    bool is_wanted = true;
    const ReducedRun result = run_reduced(body, run, [&](const ReducedSystem& system, double time) {
      if (time > 0.01 && (time < window || time > run.duration - window)) {
        means.add(time < window ? 0 : 1, energy(system), system.linear_energy(body.high));
      }
      if (++step % 10000 == 0) {
        is_wanted = progress(done + time / run.duration, static_cast<double>(integrators.size()),
                             integrator.label);
      }
      return is_wanted;
    });
    if (!is_wanted) return false;
    rows += fmt::format("{},{},{:.6g},{},{:.4g},{:.4g},{},{:.4g}\n", integrator.label, result.steps,
                        result.end, result.blew_up ? "blew_up" : "finished",
                        means.change(means.total), means.change(means.high), result.warned,
                        1e6 * result.seconds / static_cast<double>(result.steps));
    write(options, "long.csv", rows);
    ++done;
  }
  return true;
}

bool study_reduced_steps(const ReducedStudyOptions& options, const StudyProgress& progress) {
  const StudyBody body = make_study_body("beam", options.share);
  std::string rows = "integrator,h_s,time_s,total_j\n";
  double done = 0.0;
  for (const StudyIntegrator& integrator : compared_integrators()) {
    for (const double h : {0.01, 0.005, 0.001}) {
      if (!progress(done++, 18.0, integrator.label)) return false;
      const ReducedRunOptions run{integrator, ReducedLoad::kConstant, body.amplitudes[1], 0.0, h,
                                  10.0};
      run_reduced(body, run, [&](const ReducedSystem& system, double time) {
        if (std::fmod(time + 1e-9, 0.01) < 0.5 * h) {
          rows += fmt::format("{},{},{:.6g},{:.9g}\n", integrator.label, h, time, energy(system));
        }
        return true;
      });
    }
  }
  write(options, "steps.csv", rows);
  return true;
}

bool study_reduced_speed(const ReducedStudyOptions& options, const StudyProgress& progress) {
  std::string rows = "body,rank,load,damping,integrator,status,step_us,iterations\n";
  double done = 0.0;
  const double total = static_cast<double>(options.bodies.size() * 6);
  for (const std::string& name : options.bodies) {
    if (!progress(done, total, name)) return false;
    const StudyBody body = make_study_body(name, options.share);
    for (const double damping : {0.0, 0.3}) {
      for (int k = 0; k < 3; ++k, ++done) {
        for (const StudyIntegrator& integrator : compared_integrators()) {
          if (!progress(done, total, name + " " + integrator.label)) return false;
          const ReducedRunOptions options_of_run{integrator, kReducedLoads[k], body.amplitudes[k],
                                                 damping,    kThesisStep,      3.0};
          ReducedRun run;
          const double seconds = step_seconds(body, options_of_run, 7, run);
          rows += fmt::format("{},{},{},{},{},{},{:.4g},{:.4g}\n", name, body.model.rank(),
                              to_string(kReducedLoads[k]), damping, integrator.label,
                              run.blew_up ? "blew_up" : "finished", 1e6 * seconds,
                              static_cast<double>(run.iterations) /
                                  static_cast<double>(std::max<std::uint64_t>(1, run.steps)));
        }
      }
    }
    write(options, "speed.csv", rows);
  }
  return true;
}

bool study_reduced_precision(const ReducedStudyOptions& options, const StudyProgress& progress) {
  const StudyBody body = make_study_body("beam", options.share);
  std::string rows =
      "integrator,h_s,status,step_us,s_per_simulated_s,trajectory_error,energy_error\n";
  constexpr double kDuration = 0.6;
  ReducedRunOptions exact{{"reference", "reference", {{"substeps", "4"}}},
                          ReducedLoad::kConstant,
                          body.amplitudes[1],
                          0.0,
                          kThesisStep / 256,
                          kDuration};
  double highest = 0.0;
  const ReducedRun reference = run_reduced(body, exact, [&](const ReducedSystem& system, double) {
    highest = std::max(highest, energy(system));
    return true;
  });
  ReducedSystem end(body.model.potential);
  end.q = reference.q;
  end.p = reference.p;
  const double expected = energy(end);
  std::vector<StudyIntegrator> integrators = compared_integrators();
  integrators.push_back({"midpoint", "midpoint", {}});
  integrators.push_back({"stoermer_verlet", "stoermer_verlet", {}});
  double done = 0.0;
  for (const StudyIntegrator& integrator : integrators) {
    for (int halvings = -1; halvings <= 6; ++halvings, ++done) {
      if (!progress(done, 8.0 * static_cast<double>(integrators.size()), integrator.label))
        return false;
      ReducedRunOptions run{integrator,
                            ReducedLoad::kConstant,
                            body.amplitudes[1],
                            0.0,
                            kThesisStep * std::pow(0.5, halvings),
                            kDuration};
      ReducedRun result;
      const double seconds = step_seconds(body, run, 3, result);
      end.q = result.q;
      end.p = result.p;
      rows += fmt::format("{},{:.6g},{},{:.4g},{:.4g},{:.4g},{:.4g}\n", integrator.label, run.h,
                          result.blew_up ? "blew_up" : "finished", 1e6 * seconds, seconds / run.h,
                          (result.q - reference.q).norm() / reference.q.norm(),
                          std::abs(energy(end) - expected) / highest);
    }
  }
  write(options, "precision.csv", rows);
  return true;
}

}  // namespace pliant
