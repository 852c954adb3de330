#include "pliant/study/experiments/reduced_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "pliant/geometry/io/atomic_file.h"

namespace pliant {
namespace {

void write(const ReducedStudyOptions& options, const std::string& name, const std::string& text) {
  write_file_atomically(options.folder + "/" + name, text);
}

/// A body that is made when it is first asked for.
class LazyBody {
 public:
  LazyBody(std::string name, double share) : name_(std::move(name)), share_(share) {}
  const StudyBody& get() {
    if (!body_) body_ = make_study_body(name_, share_);
    return *body_;
  }

 private:
  std::string name_;
  double share_;
  std::optional<StudyBody> body_;
};

/// One run's row, and its energies a hundred times a second where `trace` asks for them.
std::string run_row(const StudyBody& body, const ReducedRunOptions& options, double scale,
                    std::string* trace) {
  double peak = 0.0, work = 0.0, mean = 0.0;
  Eigen::VectorXd before = Eigen::VectorXd::Zero(body.model.rank());
  std::uint64_t step = 0;
  const auto every = static_cast<std::uint64_t>(std::max(1.0, std::round(0.01 / options.h)));
  const ReducedRun run = run_reduced(body, options, [&](const ReducedSystem& system, double time) {
    work += system.force.dot(system.q - before);
    before = system.q;
    if (time > 0.5 * options.duration) mean += total_energy(system);
    if (++step % every == 0) {
      peak = std::max(peak, relative_displacement(body, system.q));
      if (trace != nullptr) {
        *trace += fmt::format("{},{:.6g},{:.9g},{:.9g}\n", options.integrator.label, time,
                              total_energy(system), system.linear_energy(body.high));
      }
    }
    return true;
  });
  const double averaged = std::floor(0.5 * options.duration / options.h);
  return fmt::format(
      "{},{},{},{},{},{:.4g},{},{:.4g},{:.4g},{},{:.4g},{:.5g},{:.5g}\n", body.example.name,
      to_string(options.load), options.damping, scale, options.integrator.label, options.force,
      run.blew_up ? "blew_up" : "finished", run.end,
      static_cast<double>(run.iterations) / static_cast<double>(run.steps + run.blew_up),
      run.warned, peak, mean / averaged, work);
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

/// The row of one long run, and its energies, means over 500 parts of it, in `trace`; "" when it
/// was stopped.
std::string long_row(const StudyBody& body, const StudyIntegrator& integrator, std::uint64_t steps,
                     const std::function<bool(double)>& go_on, std::string& trace) {
  const ReducedRunOptions run{integrator,         ReducedLoad::kImpulse,
                              body.amplitudes[0], 0.0,
                              kThesisStep,        kThesisStep * static_cast<double>(steps)};
  constexpr double kWindow = 35.0;  // as the thesis [s]
  const double window = std::min(kWindow, 0.1 * run.duration);
  const std::uint64_t every = std::max<std::uint64_t>(1, steps / 500);
  EnergyMeans means;
  double total = 0.0, high = 0.0;
  std::uint64_t step = 0;
  bool is_wanted = true;
  const ReducedRun result = run_reduced(body, run, [&](const ReducedSystem& system, double time) {
    const bool is_end = time > run.duration - window;
    if (time > 0.01 && (time < window || is_end)) {
      means.add(is_end ? 1 : 0, total_energy(system), system.linear_energy(body.high));
    }
    if (step % every < 20) {  // a swing of the fast coordinates
      total += total_energy(system) / 20.0;
      high += system.linear_energy(body.high) / 20.0;
    }
    if (++step % every == 0) {
      trace += fmt::format("{},{:.6g},{:.9g},{:.9g}\n", integrator.label, time, total, high);
      total = high = 0.0;
      is_wanted = go_on(time / run.duration);
    }
    return is_wanted;
  });
  if (!is_wanted) return "";
  return fmt::format("{},{},{:.6g},{},{:.4g},{:.4g},{},{:.4g}\n", integrator.label, result.steps,
                     result.end, result.blew_up ? "blew_up" : "finished", means.change(means.total),
                     means.change(means.high), result.warned,
                     1e6 * result.seconds / static_cast<double>(result.steps));
}

}  // namespace

std::string settings_of(const ReducedStudyOptions& options) {
  return fmt::format("version 3\ndisplacement {}\nduration {}\nsteps {}\n", options.share,
                     options.duration, options.long_steps);
}

std::vector<StudyIntegrator> compared_integrators() {
  // 1/(2π): explicit where h ω < 1, the other reading of "the sampling frequency".
  return {{"trigonometric", "trigonometric", {}},
          {"imex_thesis", "imex_thesis", {}},
          {"imex_thesis_rad", "imex_thesis", {{"split", fmt::format("{}", 0.5 / M_PI)}}},
          {"newmark_1", "newmark", {{"iterations", "1"}, {"tolerance", "0"}}},
          {"newmark", "newmark", {}}};
}

double total_energy(const ReducedSystem& system) {
  return system.elastic_energy() + system.kinetic_energy();
}

bool study_reduced_runs(const ReducedStudyOptions& options, const ReducedParts& parts,
                        double damping, const StudyProgress& progress) {
  std::string rows =
      "body,load,damping,scale,integrator,force_n,status,end_s,iterations,warned,peak_share,"
      "energy_j,work_j\n";
  const char* damped = damping > 0.0 ? "damped" : "undamped";
  double done = 0.0;
  const double total = static_cast<double>(options.bodies.size() * 3);
  for (const std::string& name : options.bodies) {
    LazyBody body(name, options.share);
    for (int k = 0; k < 3; ++k, ++done) {
      const std::string what = fmt::format("{}_{}_{}", name, to_string(kReducedLoads[k]), damped);
      const auto make = [&] {
        std::string trace = "integrator,time_s,total_j,high_j\n", made;
        for (const double scale : {1.0, 2.0, 4.0}) {
          for (const StudyIntegrator& integrator : compared_integrators()) {
            if (!progress(done, total, name + " " + integrator.label)) return std::string();
            const ReducedRunOptions run{
                integrator, kReducedLoads[k], scale * body.get().amplitudes[k],
                damping,    kThesisStep,      options.duration};
            made += run_row(body.get(), run, scale, scale == 1.0 ? &trace : nullptr);
          }
        }
        write(options, "energy_" + what + ".csv", trace);
        return made;
      };
      const std::string part = parts.part("runs_" + what, make);
      if (part.empty()) return false;
      rows += part;
      write(options, fmt::format("runs_{}.csv", damping), rows);
    }
  }
  return true;
}

bool study_reduced_long(const ReducedStudyOptions& options, const ReducedParts& parts,
                        const StudyProgress& progress) {
  LazyBody body("quadruped", options.share);
  std::string rows = "integrator,steps,end_s,status,total_change,high_change,warned,step_us\n";
  std::string traces = "integrator,time_s,total_j,high_j\n";
  double done = 0.0;
  for (const StudyIntegrator& integrator : compared_integrators()) {
    const auto go_on = [&](double share) {
      return progress(done + share, static_cast<double>(compared_integrators().size()),
                      integrator.label);
    };
    std::string trace;
    const std::string part = parts.part("long_" + integrator.label, [&] {
      const std::string row = long_row(body.get(), integrator, options.long_steps, go_on, trace);
      return row.empty() ? row : row + trace;
    });
    if (part.empty()) return false;
    const std::size_t end = part.find('\n') + 1;
    rows += part.substr(0, end);
    traces += part.substr(end);
    write(options, "long.csv", rows);
    write(options, "long_energy.csv", traces);
    ++done;
  }
  return true;
}

bool study_reduced_steps(const ReducedStudyOptions& options, const ReducedParts& parts,
                         const StudyProgress& progress) {
  LazyBody body("beam", options.share);
  std::string rows = "integrator,h_s,time_s,total_j\n";
  double done = 0.0;
  for (const StudyIntegrator& integrator : compared_integrators()) {
    for (const double h : {0.01, 0.005, 0.001}) {
      if (!progress(done++, 15.0, integrator.label)) return false;
      rows += parts.part(fmt::format("steps_{}_{}", integrator.label, h), [&] {
        std::string made;
        const ReducedRunOptions run{
            integrator, ReducedLoad::kConstant, body.get().amplitudes[1], 0.0, h, 10.0};
        run_reduced(body.get(), run, [&](const ReducedSystem& system, double time) {
          if (std::fmod(time + 1e-9, 0.01) < 0.5 * h) {
            made += fmt::format("{},{},{:.6g},{:.9g}\n", integrator.label, h, time,
                                total_energy(system));
          }
          return true;
        });
        return made.empty() ? std::string("\n") : made;
      });
    }
  }
  write(options, "steps.csv", rows);
  return true;
}

}  // namespace pliant
