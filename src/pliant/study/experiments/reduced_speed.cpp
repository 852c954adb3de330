#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/reduced_study.h"

namespace pliant {
namespace {

std::string speed_rows(const std::string& name, double share,
                       const std::function<bool(double, const std::string&)>& go_on) {
  const StudyBody body = make_study_body(name, share);
  std::string rows;
  double done = 0.0;
  for (const double damping : {0.0, 0.3}) {
    for (int k = 0; k < 3; ++k, done += 1.0 / 6.0) {
      for (const StudyIntegrator& integrator : compared_integrators()) {
        if (!go_on(done, integrator.label)) return "";
        const ReducedRunOptions options{integrator, kReducedLoads[k], body.amplitudes[k],
                                        damping,    kThesisStep,      3.0};
        ReducedRun run;
        const double seconds = step_seconds(body, options, 7, run);
        rows += fmt::format("{},{},{},{},{},{},{:.4g},{:.4g}\n", name, body.model.rank(),
                            to_string(kReducedLoads[k]), damping, integrator.label,
                            run.blew_up ? "blew_up" : "finished", 1e6 * seconds,
                            static_cast<double>(run.iterations) /
                                static_cast<double>(std::max<std::uint64_t>(1, run.steps)));
      }
    }
  }
  return rows;
}

/// The beam under the constant force, and where it is at the end.
struct PrecisionCase {
  StudyBody body;
  ReducedRun reference;
  double energy = 0.0, highest = 0.0;  // of the reference: at the end, ever [J]
};

constexpr double kDuration = 0.6;

double energy_at_end(const StudyBody& body, const ReducedRun& run) {
  ReducedSystem end(body.model.potential);
  end.q = run.q;
  end.p = run.p;
  return total_energy(end);
}

PrecisionCase precision_case(double share) {
  PrecisionCase made;
  made.body = make_study_body("beam", share);
  const ReducedRunOptions exact{{"reference", "reference", {{"substeps", "4"}}},
                                ReducedLoad::kConstant,
                                made.body.amplitudes[1],
                                0.0,
                                kThesisStep / 256,
                                kDuration};
  made.reference = run_reduced(made.body, exact, [&](const ReducedSystem& system, double) {
    made.highest = std::max(made.highest, total_energy(system));
    return true;
  });
  made.energy = energy_at_end(made.body, made.reference);
  return made;
}

/// From twice the thesis's step to 1/1024 of it: below 1/64 the fastest coordinates, which the
/// force's jumps have shaken, are resolved too.
std::string precision_rows(const PrecisionCase& exact, const StudyIntegrator& integrator,
                           const std::function<bool(double)>& go_on) {
  std::string rows;
  for (int halvings = -1; halvings <= 10; ++halvings) {
    if (!go_on((halvings + 1.0) / 12.0)) return "";
    const ReducedRunOptions run{integrator,
                                ReducedLoad::kConstant,
                                exact.body.amplitudes[1],
                                0.0,
                                kThesisStep * std::pow(0.5, halvings),
                                kDuration};
    ReducedRun result;
    const double seconds = step_seconds(exact.body, run, halvings > 4 ? 1 : 3, result);
    rows += fmt::format("{},{:.6g},{},{:.4g},{:.4g},{:.4g},{:.4g}\n", integrator.label, run.h,
                        result.blew_up ? "blew_up" : "finished", 1e6 * seconds, seconds / run.h,
                        (result.q - exact.reference.q).norm() / exact.reference.q.norm(),
                        std::abs(energy_at_end(exact.body, result) - exact.energy) / exact.highest);
  }
  return rows;
}

}  // namespace

double step_seconds(const StudyBody& body, const ReducedRunOptions& options, int repeats,
                    ReducedRun& run) {
  double best = 1e300;
  for (int k = 0; k < repeats; ++k) {
    run = run_reduced(body, options);
    best = std::min(best, run.seconds / static_cast<double>(std::max<std::uint64_t>(1, run.steps)));
  }
  return best;
}

bool study_reduced_speed(const ReducedStudyOptions& options, const ReducedParts& parts,
                         const StudyProgress& progress) {
  std::string rows = "body,rank,load,damping,integrator,status,step_us,iterations\n";
  double done = 0.0;
  for (const std::string& name : options.bodies) {
    const auto go_on = [&](double share, const std::string& what) {
      return progress(done + share, static_cast<double>(options.bodies.size()), name + " " + what);
    };
    const std::string part =
        parts.part("speed_" + name, [&] { return speed_rows(name, options.share, go_on); });
    if (part.empty()) return false;
    rows += part;
    write_file_atomically(options.folder + "/speed.csv", rows);
    ++done;
  }
  return true;
}

bool study_reduced_precision(const ReducedStudyOptions& options, const ReducedParts& parts,
                             const StudyProgress& progress) {
  std::vector<StudyIntegrator> integrators = compared_integrators();
  integrators.push_back({"midpoint", "midpoint", {}});
  integrators.push_back({"stoermer_verlet", "stoermer_verlet", {}});
  std::string rows =
      "integrator,h_s,status,step_us,s_per_simulated_s,trajectory_error,energy_error\n";
  std::optional<PrecisionCase> precision;
  double done = 0.0;
  for (const StudyIntegrator& integrator : integrators) {
    const auto go_on = [&](double share) {
      return progress(done + share, static_cast<double>(integrators.size()), integrator.label);
    };
    const std::string part = parts.part("precision_" + integrator.label, [&] {
      if (!go_on(0.0)) return std::string();
      if (!precision) precision = precision_case(options.share);
      return precision_rows(*precision, integrator, go_on);
    });
    if (part.empty()) return false;
    rows += part;
    ++done;
  }
  write_file_atomically(options.folder + "/precision.csv", rows);
  return true;
}

}  // namespace pliant
