#include "pliant/models/viscoelastic/particle_surface.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "support/random.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

struct Sampled {
  Eigen::Matrix3Xd x;
  Eigen::VectorXd volumes;
  double support;
};

Sampled sampled(const TriangleMesh& mesh, double spacing) {
  InteriorSamples samples = sample_interior(mesh, spacing);
  const Eigen::Index n = samples.points.cols();
  const double volume = samples.volume / static_cast<double>(n);
  return {samples.points, Eigen::VectorXd::Constant(n, volume), 2.0 * std::cbrt(volume)};
}

ParticleSurface surface_of(const Sampled& s, int detail, bool anisotropic = false) {
  ParticleSurface surface;
  surface.update(s.x, s.volumes, {s.support, detail, anisotropic});
  return surface;
}

TEST(ParticleSurface, IsClosedAndHoldsTheParticlesVolume) {
  for (const TriangleMesh& mesh :
       {Sphere(0.1).surface(), Box(Eigen::Vector3d(0.2, 0.15, 0.1)).surface()}) {
    const Sampled s = sampled(mesh, 0.01);
    for (const auto& [detail, anisotropic] :
         {std::pair(2, false), std::pair(3, false), std::pair(3, true), std::pair(4, true)}) {
      const TriangleMesh drawn = surface_of(s, detail, anisotropic).mesh();
      validate(drawn, "surface");
      EXPECT_TRUE(boundary_vertices(drawn).empty());
      EXPECT_NEAR(signed_volume(drawn), s.volumes.sum(), 0.03 * s.volumes.sum());
    }
  }
}

TEST(ParticleSurface, LeavesOutSingleParticlesAndKeepsParts) {
  Sampled s = sampled(Sphere(0.05).surface(), 0.01);
  const Eigen::Index n = s.x.cols();
  s.x.conservativeResize(3, 2 * n + 1);
  s.x.middleCols(n, n) = s.x.leftCols(n).colwise() + Eigen::Vector3d(0.3, 0.0, 0.0);
  s.x.col(2 * n) = Eigen::Vector3d(0.15, 0.0, 0.0);
  s.volumes = Eigen::VectorXd::Constant(2 * n + 1, s.volumes[0]);
  const TriangleMesh mesh = surface_of(s, 2).mesh();
  EXPECT_TRUE(boundary_vertices(mesh).empty());
  const Eigen::ArrayXd from_middle = (mesh.vertices.row(0).array() - 0.15).abs();
  EXPECT_GT(from_middle.minCoeff(), 0.08) << "nothing about the single one";
  EXPECT_GT(mesh.vertices.row(0).maxCoeff(), 0.3);
  EXPECT_LT(mesh.vertices.row(0).minCoeff(), 0.0);
}

TEST(ParticleSurface, AFilmOneParticleThickIsDrawn) {
  const double spacing = 0.01;
  Sampled s;
  s.x.resize(3, 400);
  // Wider apart than in bulk.
  for (int i = 0; i < 400; ++i) s.x.col(i) = 1.3 * spacing * Eigen::Vector3d(i % 20, i / 20, 0.0);
  s.volumes = Eigen::VectorXd::Constant(400, spacing * spacing * spacing);
  s.support = 2.0 * spacing;
  for (const bool anisotropic : {false, true}) {
    const TriangleMesh mesh = surface_of(s, 2, anisotropic).mesh();
    EXPECT_TRUE(boundary_vertices(mesh).empty());
    EXPECT_GT(mesh.vertices.row(0).maxCoeff() - mesh.vertices.row(0).minCoeff(), 24.0 * spacing);
    EXPECT_GT(signed_volume(mesh), 0.5 * s.volumes.sum());
    EXPECT_LT(signed_volume(mesh), 2.0 * s.volumes.sum());
  }
}

TEST(ParticleSurface, AThreadOneParticleThickIsDrawn) {
  const double spacing = 0.01;
  Sampled s;
  s.x.setZero(3, 40);
  for (int i = 0; i < 40; ++i) s.x.col(i) << spacing * i, 0.02 * std::sin(0.2 * i), 0.0;
  s.volumes = Eigen::VectorXd::Constant(40, spacing * spacing * spacing);
  s.support = 2.0 * spacing;
  for (const bool anisotropic : {false, true}) {
    const TriangleMesh mesh = surface_of(s, 3, anisotropic).mesh();
    EXPECT_TRUE(boundary_vertices(mesh).empty());
    EXPECT_GT(mesh.vertices.row(0).maxCoeff() - mesh.vertices.row(0).minCoeff(), 38.0 * spacing);
    EXPECT_GT(signed_volume(mesh), 0.25 * s.volumes.sum()) << anisotropic;
    EXPECT_LT(signed_volume(mesh), 2.0 * s.volumes.sum()) << anisotropic;
  }
}

/// Mean angle between a box's top and its surface's triangles there [rad].
double tilt_of_top(const TriangleMesh& mesh, double height) {
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d a = mesh.vertices.col(mesh.triangles(0, t));
    const Eigen::Vector3d b = mesh.vertices.col(mesh.triangles(1, t));
    const Eigen::Vector3d c = mesh.vertices.col(mesh.triangles(2, t));
    if (a.z() < height || a.head<2>().cwiseAbs().maxCoeff() > 0.05) continue;
    sum += std::acos(std::min(1.0, (b - a).cross(c - a).normalized().z()));
    ++count;
  }
  return sum / count;
}

TEST(ParticleSurface, AnisotropicKernelsDrawAFlatTopFlatter) {
  Sampled s = sampled(Box(Eigen::Vector3d(0.16, 0.16, 0.08)).surface(), 0.01);
  // Particles out of their places by a third of a spacing.
  s.x += Random(3).positions(static_cast<int>(s.x.cols()), 0.003);
  const double smooth = tilt_of_top(surface_of(s, 3, false).mesh(), 0.03);
  const double anisotropic = tilt_of_top(surface_of(s, 3, true).mesh(), 0.03);
  // Kernels 1.4 times as wide along the surface average over twice as many of them, and so leave
  // 1/√2 of the tilt at most.
  EXPECT_LT(anisotropic, smooth / std::sqrt(2.0));
  EXPECT_GT(smooth, 0.05) << "there was something to flatten";
}

TEST(ParticleSurface, EveryTriangleFitsIntoACubeOfItsDetail) {
  const Sampled s = sampled(Sphere(0.025).surface(), 0.01);
  for (const bool anisotropic : {false, true}) {
    for (const int detail : {3, 6}) {
      const TriangleMesh mesh = surface_of(s, detail, anisotropic).mesh();
      double longest = 0.0;
      for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
        for (int k = 0; k < 3; ++k) {
          const Eigen::Vector3d side = mesh.vertices.col(mesh.triangles(k, t)) -
                                       mesh.vertices.col(mesh.triangles((k + 1) % 3, t));
          longest = std::max(longest, side.norm());
        }
      }
      EXPECT_LE(longest, 1.0001 * std::sqrt(3.0) * s.support / detail) << anisotropic;
    }
  }
}

TEST(ParticleSurface, InterpolatesFields) {
  const Sampled s = sampled(Sphere(0.1).surface(), 0.015);
  const ParticleSurface surface = surface_of(s, 2);
  const Eigen::VectorXd ones = surface.interpolate(Eigen::VectorXd::Ones(s.x.cols()));
  EXPECT_NEAR(ones.minCoeff(), 1.0, 1e-12);
  EXPECT_NEAR(ones.maxCoeff(), 1.0, 1e-12);
  const Eigen::VectorXd heights = surface.interpolate(s.x.row(2).transpose());
  const Eigen::VectorXd error = heights - surface.mesh().vertices.row(2).transpose();
  EXPECT_LT(error.cwiseAbs().maxCoeff(), s.support) << "a mean of particles within the support";
}

TEST(ParticleSurface, IsEmptyForNoParticlesAndTheSameForAnyNumberOfThreads) {
  ParticleSurface none;
  none.update(Eigen::Matrix3Xd(3, 0), Eigen::VectorXd(), SurfaceStyle());
  EXPECT_EQ(none.mesh().triangles.cols(), 0);
  const Sampled s = sampled(Box(Eigen::Vector3d(0.2, 0.15, 0.1)).surface(), 0.01);
  for (const bool anisotropic : {false, true}) {
    const TriangleMesh mesh = surface_of(s, 2, anisotropic).mesh();
    for (int count : {2, 4}) {
      set_threads(count);
      const TriangleMesh again = surface_of(s, 2, anisotropic).mesh();
      EXPECT_TRUE(again.vertices == mesh.vertices) << count;
      EXPECT_TRUE(again.triangles == mesh.triangles) << count;
    }
    set_threads(1);
  }
}

}  // namespace
}  // namespace pliant
