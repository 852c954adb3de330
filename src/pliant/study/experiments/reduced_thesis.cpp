#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/math/symmetric_eigen.h"
#include "pliant/study/experiments/reduced_study.h"

namespace pliant {
namespace {

/// √ of the tangent's largest eigenvalue among the first `count` coordinates [1/s].
double fastest_explicit(const ReducedSystem& system, int count,
                        QuarticPotential::Workspace& space) {
  Eigen::VectorXd r;
  Eigen::MatrixXd k;
  system.potential.evaluate(system.q, r, k, space);
  const Eigen::VectorXd values = symmetric_eigenvalues(k.topLeftCorner(count, count));
  return std::sqrt(std::max(0.0, values[count - 1]));
}

std::string thesis_row(const StudyBody& body, const std::string& stiffness, ReducedLoad load,
                       double scale, const ReducedRunOptions& options) {
  QuarticPotential::Workspace space;
  const Eigen::VectorXd& lambda = body.model.potential.lambda();
  const double at_rest = options.h * std::sqrt(lambda[body.high - 1]);
  double largest = at_rest, beyond = -1.0;
  const ReducedRun run = run_reduced(body, options, [&](const ReducedSystem& system, double time) {
    largest = std::max(largest, options.h * fastest_explicit(system, body.high, space));
    if (beyond < 0.0 && largest > 2.0) beyond = time;
    return true;
  });
  return fmt::format("{},{},{},{},{},{},{},{},{:.4g},{:.4g},{:.4g},{:.4g}\n", body.example.name,
                     stiffness, to_string(load), options.damping, scale, body.high,
                     body.model.rank() - body.high, run.blew_up ? "blew_up" : "finished", run.end,
                     at_rest, largest, beyond);
}

}  // namespace

bool study_reduced_thesis(const ReducedStudyOptions& options, const ReducedParts& parts,
                          const StudyProgress& progress) {
  std::string rows =
      "body,stiffness,load,damping,scale,low,high,status,end_s,hw_at_rest,hw_largest,"
      "beyond_2_at_s\n";
  double done = 0.0;
  for (const std::string& name : options.bodies) {
    for (const bool is_soft : {false, true}) {
      const std::string stiffness = is_soft ? "soft" : "own";
      const std::string part = parts.part("thesis_" + name + "_" + stiffness, [&] {
        // Coordinates with f < 1/h, the thesis's counts, are those with h ω < 1 of a body that is
        // (2π)² times softer.
        const double softer = is_soft ? 4.0 * M_PI * M_PI : 1.0;
        const StudyBody body = make_study_body(name, options.share, softer);
        std::string made;
        for (const double damping : {0.0, 0.3}) {
          for (int k = 0; k < 3; ++k) {
            for (const double scale : {1.0, 2.0, 4.0}) {
              if (!progress(done, static_cast<double>(2 * options.bodies.size()), name)) {
                return std::string();
              }
              const ReducedRunOptions run{{"imex_thesis",
                                           "imex_thesis",
                                           {{"split", fmt::format("{}", 1.0 / std::sqrt(softer))}}},
                                          kReducedLoads[k],
                                          scale * body.amplitudes[k],
                                          damping,
                                          kThesisStep,
                                          options.duration};
              made += thesis_row(body, stiffness, kReducedLoads[k], scale, run);
            }
          }
        }
        return made;
      });
      if (part.empty()) return false;
      rows += part;
      ++done;
      write_file_atomically(options.folder + "/thesis.csv", rows);
    }
  }
  return true;
}

}  // namespace pliant
