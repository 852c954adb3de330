#include <fmt/format.h>

#include <cmath>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/study/experiments/reduced_study.h"
#include "pliant/study/experiments/ringing.h"

namespace pliant {
namespace {

constexpr double kShares[] = {0.001, 0.01, 0.03};
/// Steps of the standard: Störmer-Verlet so fine that the fastest coordinate is resolved.
constexpr int kFine = 128;

/// The thesis's step and halves of it.
constexpr int kHalvings = 3;

std::vector<StudyIntegrator> ringing_integrators() {
  std::vector<StudyIntegrator> all = compared_integrators();
  all.push_back({"midpoint", "midpoint", {}});
  all.push_back({"stoermer_verlet", "stoermer_verlet", {}});
  return all;
}

/// Coordinates that the thesis's step can show.
int shown(const StudyBody& body) {
  const Eigen::VectorXd omega = body.model.potential.lambda().cwiseSqrt();
  return static_cast<int>((kThesisStep * omega.array() < M_PI).count());
}

std::string rows_of(const StudyBody& body, double share, int coordinate,
                    const StudyIntegrator& integrator, const Ringing& exact) {
  std::string rows;
  const double omega = std::sqrt(body.model.potential.lambda()[coordinate]);
  for (int halvings = 0; halvings < kHalvings; ++halvings) {
    const double h = kThesisStep / (1 << halvings);
    const Ringing it = ring(body, {integrator, coordinate, share, h});
    rows +=
        fmt::format("{},{},{},{:.4g},{:.6g},{},{},{:.6g},{:.6g},{:.5g},{:.4g}\n", body.example.name,
                    coordinate, share, kThesisStep * omega, h, integrator.label,
                    it.blew_up ? "blew_up" : "finished", it.frequency, exact.frequency,
                    it.blew_up ? 0.0 : it.amplitude / exact.amplitude, it.step_seconds / h);
  }
  return rows;
}

std::string body_rows(const std::string& name,
                      const std::function<bool(double, const std::string&)>& go_on) {
  const StudyBody body = make_study_body(name, kShares[0]);
  std::string rows;
  double done = 0.0;
  for (int coordinate = 0; coordinate < shown(body); ++coordinate, ++done) {
    for (const double share : kShares) {
      if (!go_on(done / shown(body), fmt::format("coordinate {}", coordinate))) return "";
      const Ringing exact = ring(
          body,
          {{"stoermer_verlet", "stoermer_verlet", {}}, coordinate, share, kThesisStep / kFine});
      for (const StudyIntegrator& integrator : ringing_integrators()) {
        rows += rows_of(body, share, coordinate, integrator, exact);
      }
    }
  }
  return rows;
}

}  // namespace

bool study_reduced_frequencies(const ReducedStudyOptions& options, const ReducedParts& parts,
                               const StudyProgress& progress) {
  std::string rows =
      "body,coordinate,share,hw,h_s,integrator,status,frequency_hz,exact_hz,amplitude_ratio,"
      "s_per_simulated_s\n";
  double done = 0.0;
  for (const std::string& name : options.bodies) {
    const auto go_on = [&](double share, const std::string& what) {
      return progress(done + share, static_cast<double>(options.bodies.size()), name + " " + what);
    };
    const std::string part =
        parts.part("frequencies_" + name, [&] { return body_rows(name, go_on); });
    if (part.empty()) return false;
    rows += part;
    write_file_atomically(options.folder + "/frequencies.csv", rows);
    ++done;
  }
  return true;
}

}  // namespace pliant
