#include "pliant/models/reduced/reduced_body.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pliant/geometry/meshing/embedding.h"
#include "pliant/math/error.h"
#include "pliant/models/reduced/stvk_body.h"

namespace pliant {
namespace {

const ReducedModel& reduced_of(const BodyGeometry& geometry) {
  if (!geometry.reduced) {
    throw InputError(
        "model 'reduced' needs a reduced body: the geometry 'reduced_model', a file that `pliant "
        "reduce` wrote, or 'example'");
  }
  return *geometry.reduced;
}

EmbeddedPoints embedded(const Eigen::Matrix3Xd& points, const TetrahedralMesh& mesh,
                        const std::string& where) {
  Embedding embedding = embed(points, mesh, where);
  Eigen::Matrix4Xi particles(4, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    particles.col(i) = mesh.tetrahedra.col(embedding.tetrahedron[i]);
  }
  return {std::move(particles), std::move(embedding.weights)};
}

/// Of Cauchy's stress F S Fᵀ / |det F|, S of St. Venant and Kirchhoff.
double von_mises(const Eigen::Matrix3d& f, double mu, double lambda) {
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d strain = 0.5 * (f.transpose() * f - identity);
  const Eigen::Matrix3d s = 2.0 * mu * strain + lambda * strain.trace() * identity;
  // A tetrahedron that is nearly flat has no finite Cauchy stress: that of a hundredth is shown.
  constexpr double kLeastVolume = 0.01;
  const Eigen::Matrix3d cauchy =
      f * s * f.transpose() / std::max(kLeastVolume, std::abs(f.determinant()));
  const Eigen::Matrix3d deviator = cauchy - cauchy.trace() / 3.0 * identity;
  return std::sqrt(1.5) * deviator.norm();
}

}  // namespace

ReducedBody::ReducedBody(const BodyGeometry& geometry, const Options& options) {
  const ReducedModel& model = reduced_of(geometry);
  model_ = geometry.reduced;
  triangles_ = boundary_triangles(model.mesh);
  areas_ = vertex_areas({model.mesh.vertices, triangles_});
  if (model.surface.triangles.cols() > 0) {
    triangles_ = model.surface.triangles;
    surface_ = embedded(model.surface.vertices, model.mesh, "surface");
  }
  system_ = std::make_unique<ReducedBodySystem>(
      model, options.damping, options.fast,
      embedded(geometry.contact_points, model.mesh, "contact points"));
}

void ReducedBody::place(const Eigen::Isometry3d& world_from_body) {
  world_from_body_ = world_from_body.linear() * world_from_body_;
  system_->place(world_from_body);
}

void ReducedBody::set_velocity(const Eigen::Vector3d& velocity) {
  std::vector<int> fixed;
  Eigen::Matrix3Xd v = Eigen::Matrix3Xd::Zero(3, model_->mesh.vertices.cols());
  for (int i = 0; i < static_cast<int>(v.cols()); ++i) {
    if (model_->fixed[static_cast<std::size_t>(i)]) {
      fixed.push_back(i);
    } else {
      v.col(i) = world_from_body_.transpose() * velocity;
    }
  }
  const StvkBody body(model_->mesh, model_->material, fixed, "reduced body");
  Eigen::VectorXd free(body.size());
  for (int i = 0; i < static_cast<int>(v.cols()); ++i) {
    if (body.index(i) >= 0) free.segment<3>(body.index(i)) = v.col(i);
  }
  const Eigen::VectorXd momenta = body.expand(body.consistent_mass() * free);
  system_->p = model_->basis.transpose() * momenta;
  system_->move_particles();
}

std::string_view ReducedBody::why_not_fix() const {
  return "which vertices of a reduced body are fixed belongs to its reduction: `pliant reduce "
         "--fix`";
}

std::map<std::string, Eigen::VectorXd> ReducedBody::point_fields() const {
  const Particles& particles = system_->particles;
  const int n = particles.size();
  const ElasticMaterial& material = model_->material;
  const double mu = material.young / (2.0 * (1.0 + material.poisson));
  const double lambda = material.young * material.poisson /
                        ((1.0 + material.poisson) * (1.0 - 2.0 * material.poisson));
  Eigen::VectorXd stress = Eigen::VectorXd::Zero(n), count = stress;
  for (int t = 0; t < system_->stretches().size(); ++t) {
    const double value = von_mises(system_->stretches().gradient(t, particles.x), mu, lambda);
    for (int k = 0; k < 4; ++k) {
      const int i = model_->mesh.tetrahedra(k, t);
      stress[i] += value;
      count[i] += 1.0;
    }
  }
  return {{"displacement", (particles.x - system_->vertices().rest()).colwise().norm().transpose()},
          {"von_mises", stress.cwiseQuotient(count)}};
}

ModelRegistry::Entry reduced_entry() {
  return {
      "reduced",
      "St. Venant-Kirchhoff tetrahedra moved by a few coordinates, with a polynomial energy",
      {number_parameter("alpha", "1/s", "0", 0.0, 1e6, "Rayleigh damping in proportion to mass"),
       number_parameter("beta", "s", "0", 0.0, 1e3,
                        "Rayleigh damping in proportion to stiffness at rest"),
       number_parameter("fast_frequency", "Hz", "0", 0.0, 1e9,
                        "from which on `high_frequency_energy` counts coordinates; 0: those "
                        "that turn by more than 1 rad a step")},
      {"reduced"},
      [](const Parameters& parameters, const BodyGeometry& geometry) {
        ReducedBody::Options options;
        options.damping = {parameters.number("alpha"), parameters.number("beta")};
        options.fast = parameters.number("fast_frequency");
        return std::make_unique<ReducedBody>(geometry, options);
      }};
}

}  // namespace pliant
