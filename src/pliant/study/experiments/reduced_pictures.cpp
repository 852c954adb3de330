#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "pliant/geometry/io/atomic_file.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/study/experiments/reduced_study.h"

namespace pliant {
namespace {

/// The thesis's frames: the quadruped after a force of 0.3 s, at 0, 3 and 16 s.
constexpr double kFrameTimes[] = {0.0, 3.0, 16.0};

std::string surface_rows(const StudyBody& body) {
  std::string rows = "a,b,c\n";
  const Eigen::Matrix3Xi triangles = boundary_triangles(body.model.mesh);
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    rows += fmt::format("{},{},{}\n", triangles(0, t), triangles(1, t), triangles(2, t));
  }
  return rows;
}

std::string frame_rows(const StudyBody& body, const StudyIntegrator& integrator) {
  std::string rows;
  std::size_t next = 0;
  const auto take = [&](const Eigen::VectorXd& q, double time) {
    if (next == std::size(kFrameTimes) || time < kFrameTimes[next] - 0.5 * kThesisStep) return;
    const Eigen::VectorXd u = body.model.basis * q;
    for (Eigen::Index i = 0; i < u.size() / 3; ++i) {
      const Eigen::Vector3d x = body.model.mesh.vertices.col(i) + u.segment<3>(3 * i);
      rows += fmt::format("{},{},{:.6g},{:.6g},{:.6g}\n", integrator.label, kFrameTimes[next], x[0],
                          x[1], x[2]);
    }
    ++next;
  };
  take(Eigen::VectorXd::Zero(body.model.rank()), 0.0);
  const ReducedRunOptions run{
      integrator, ReducedLoad::kConstant, body.amplitudes[1], 0.0, kThesisStep, 16.1};
  run_reduced(body, run, [&](const ReducedSystem& system, double time) {
    take(system.q, time);
    return true;
  });
  return rows;
}

/// Energies of the beam in the first second, at the thesis's three steps.
std::string early_rows(const StudyBody& beam) {
  std::string rows = "integrator,h_s,time_s,total_j\n";
  for (const StudyIntegrator& integrator :
       {StudyIntegrator{"trigonometric", "trigonometric", {}}, {"newmark", "newmark", {}}}) {
    for (const double h : {0.01, 0.005, 0.001}) {
      const ReducedRunOptions run{integrator, ReducedLoad::kConstant, beam.amplitudes[1], 0.0, h,
                                  1.0};
      run_reduced(beam, run, [&](const ReducedSystem& system, double time) {
        rows +=
            fmt::format("{},{},{:.6g},{:.6g}\n", integrator.label, h, time, total_energy(system));
        return true;
      });
    }
  }
  return rows;
}

/// A run of the thesis's integrator that blows up: the tower, so soft that its counts mean h ω < 1,
/// after an impulse of twice the force; and `trigonometric` beside it.
std::string blow_up_rows(double share) {
  const double softer = 4.0 * M_PI * M_PI;
  const StudyBody tower = make_study_body("tower", share, softer);
  std::string rows = "integrator,time_s,total_j\n";
  const StudyIntegrator thesis{
      "imex_thesis", "imex_thesis", {{"split", fmt::format("{}", 1.0 / std::sqrt(softer))}}};
  for (const StudyIntegrator& integrator :
       {thesis, StudyIntegrator{"trigonometric", "trigonometric", {}}}) {
    const ReducedRunOptions run{integrator, ReducedLoad::kImpulse, 2.0 * tower.amplitudes[0],
                                0.0,        kThesisStep,           10.0};
    run_reduced(tower, run, [&](const ReducedSystem& system, double time) {
      rows += fmt::format("{},{:.6g},{:.6g}\n", integrator.label, time, total_energy(system));
      return true;
    });
  }
  return rows;
}

}  // namespace

bool study_reduced_pictures(const ReducedStudyOptions& options, const StudyProgress& progress) {
  const auto write_table = [&](const std::string& name, const std::string& text) {
    write_file_atomically(options.folder + "/" + name, text);
  };
  if (!progress(0.0, 3.0, "frames")) return false;
  const StudyBody quadruped = make_study_body("quadruped", options.share);
  std::string frames = "integrator,time_s,x_m,y_m,z_m\n";
  for (const StudyIntegrator& integrator : compared_integrators()) {
    if (integrator.label == "trigonometric" || integrator.label == "newmark") {
      frames += frame_rows(quadruped, integrator);
    }
  }
  write_table("frames_surface.csv", surface_rows(quadruped));
  write_table("frames.csv", frames);
  if (!progress(1.0, 3.0, "first second")) return false;
  write_table("early.csv", early_rows(make_study_body("beam", options.share)));
  if (!progress(2.0, 3.0, "blow-up")) return false;
  write_table("blow_up.csv", blow_up_rows(options.share));
  return true;
}

}  // namespace pliant
