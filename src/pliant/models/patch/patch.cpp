#include "pliant/models/patch/patch.h"

#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/elements/solids/averaged_tetrahedra.h"
#include "pliant/elements/solids/fiber_set.h"
#include "pliant/elements/solids/leaves_out_pinned.h"
#include "pliant/elements/solids/material_damping.h"
#include "pliant/elements/solids/principal_stretches.h"
#include "pliant/elements/solids/simplex.h"
#include "pliant/elements/solids/tetrahedron_set.h"
#include "pliant/geometry/meshing/embedding.h"
#include "pliant/math/error.h"
#include "pliant/math/joined.h"

namespace pliant {
namespace {

EmbeddedPoints embedded(const Eigen::Matrix3Xd& points, const TetrahedralMesh& rest,
                        const std::string& where) {
  Embedding embedding = embed(points, rest, where);
  Eigen::Matrix4Xi particles(4, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    particles.col(i) = rest.tetrahedra.col(embedding.tetrahedron[i]);
  }
  return {std::move(particles), std::move(embedding.weights)};
}

Eigen::VectorXd boundary_areas(const TetrahedralMesh& mesh) {
  return vertex_areas({mesh.vertices, boundary_triangles(mesh)});
}

EmbeddedPoints joined(const EmbeddedPoints& left, const EmbeddedPoints& right, int first) {
  const Eigen::Matrix4Xi moved = right.particles().array() + first;
  return {beside(left.particles(), moved), beside(left.weights(), right.weights())};
}

TetrahedronState state_of(const Eigen::Matrix3d& g, const ElasticMaterial& material) {
  const Eigen::Vector3d sigma = principal_stretches(g).sigma;
  const Eigen::Vector3d strain = sigma.array() - 1.0;
  // Of the principal stresses 2 μ ε + λ tr(ε), only differences count.
  const Eigen::Vector3d deviator =
      2.0 * lame_parameters(material).mu * (strain.array() - strain.mean()).matrix();
  return {strain.cwiseAbs().maxCoeff(), g.determinant(), std::sqrt(1.5) * deviator.norm()};
}

}  // namespace

PatchModel::PatchModel(const BodyGeometry& geometry, const Material& material) {
  if (!geometry.tetrahedra) {
    throw InputError("model 'patch' needs a body with an inside: a closed surface or tetrahedra");
  }
  rest_ = *geometry.tetrahedra;
  validate(rest_, "tetrahedra");
  triangles_ = geometry.mesh.triangles;
  surface_ = embedded(geometry.mesh.vertices, rest_, "surface");
  contact_ = embedded(geometry.contact_points, rest_, "contact points");
  areas_ = boundary_areas(rest_);
  lame_parameters(material.elastic);  // refuses what is out of range
  system_.particles = Particles(rest_.vertices, material.elastic.density * vertex_volumes(rest_));
  parts_.push_back({rest_, material, 0});
  add_elements(parts_.front());
}

void PatchModel::add_elements(const Part& part) {
  auto& elements = system_.elements;
  const std::size_t first = elements.size();
  const LameParameters lame = lame_parameters(part.material.elastic);
  if (part.material.averaged) {
    for (auto& set : averaged_tetrahedra(part.rest, lame, part.first)) {
      elements.push_back(std::move(set));
    }
  } else {
    elements.push_back(std::make_unique<TetrahedronSet>(part.rest, lame, part.first));
  }
  if (part.material.fiber_stiffness > 0.0) {
    elements.push_back(std::make_unique<FiberSet>(part.rest, part.material.fiber_stiffness,
                                                  part.material.fiber_direction, part.first));
  }
  add_damping(system_, first, part.material.damping);
}

Eigen::Matrix3Xf PatchModel::particle_colors() const {
  return particle_colors_.cols() > 0 ? particle_colors_ : Model::particle_colors();
}

Eigen::Matrix3Xf PatchModel::surface_colors() const {
  return surface_colors_.cols() > 0 ? surface_colors_ : Model::surface_colors();
}

bool PatchModel::join(Model& base) {
  auto* other = base.find<PatchModel>();
  if (other == nullptr) return false;
  particle_colors_ = beside(particle_colors(), other->particle_colors());
  surface_colors_ = beside(surface_colors(), other->surface_colors());
  const int first = particles().size();
  for (const Part& part : other->parts_) {
    parts_.push_back({part.rest, part.material, part.first + first});
    add_elements(parts_.back());
  }
  triangles_ = beside(triangles_, Eigen::Matrix3Xi(other->triangles_.array() + surface_.size()));
  surface_ = joined(surface_, other->surface_, first);
  contact_ = joined(contact_, other->contact_, first);
  rest_.tetrahedra =
      beside(rest_.tetrahedra, Eigen::Matrix4Xi(other->rest_.tetrahedra.array() + first));
  // Apart also at rest, where distances within one part count.
  // The gap is one for all: by the size of those before it, the rest shape of fifty bodies would be
  // so wide that no digit of a single one is left.
  const auto along = parts_.front().rest.vertices.row(0);
  const double gap = along.maxCoeff() - along.minCoeff();
  const double apart =
      rest_.vertices.row(0).maxCoeff() + gap - other->rest_.vertices.row(0).minCoeff();
  const Eigen::Matrix3Xd moved = other->rest_.vertices.colwise() + Eigen::Vector3d(apart, 0.0, 0.0);
  rest_.vertices = beside(rest_.vertices, moved);
  areas_ = above(areas_, other->areas_);
  particles().append(other->particles());
  return true;
}

StepPlan PatchModel::plan_step(double, StepReport&) {
  StepPlan plan;
  for (const auto& set : system_.elements) {
    auto* depends = set->find<LeavesOutPinned>();
    if (depends != nullptr && depends->leave_out_pinned(particles())) plan.system_changed = true;
  }
  return plan;
}

std::vector<TetrahedronState> PatchModel::states_of(const Part& part) const {
  constexpr int kGrain = 256;
  const TetrahedralMesh& rest = part.rest;
  std::vector<TetrahedronState> states(static_cast<std::size_t>(rest.tetrahedra.cols()));
  parallel_for(0, static_cast<int>(states.size()), kGrain, [&](int begin, int end) {
    for (int t = begin; t < end; ++t) {
      const Eigen::Vector4i own = rest.tetrahedra.col(t);
      Eigen::Matrix3d rest_sides, sides;
      for (int k = 0; k < 3; ++k) {
        rest_sides.col(k) = rest.vertices.col(own[k + 1]) - rest.vertices.col(own[0]);
        sides.col(k) =
            particles().x.col(part.first + own[k + 1]) - particles().x.col(part.first + own[0]);
      }
      states[static_cast<std::size_t>(t)] =
          state_of(sides * rest_sides.inverse(), part.material.elastic);
    }
  });
  return states;
}

std::map<std::string, Eigen::VectorXd> PatchModel::point_fields() const {
  const int n = particles().size();
  Eigen::VectorXd strain = Eigen::VectorXd::Zero(n), volume = strain, von_mises = strain,
                  count = strain;
  for (const Part& part : parts_) {
    const std::vector<TetrahedronState> states = states_of(part);
    for (std::size_t t = 0; t < states.size(); ++t) {
      const TetrahedronState& state = states[t];
      for (int k = 0; k < 4; ++k) {
        const int i = part.first + part.rest.tetrahedra(k, static_cast<Eigen::Index>(t));
        strain[i] += state.strain;
        volume[i] += state.volume;
        von_mises[i] += state.von_mises;
        count[i] += 1.0;
      }
    }
  }
  return {{"strain", strain.cwiseQuotient(count)},
          {"volume", volume.cwiseQuotient(count)},
          {"von_mises", von_mises.cwiseQuotient(count)}};
}

ModelRegistry::Entry patch_entry() {
  return {
      "patch",
      "elastic bodies with a smooth surface: corotated tetrahedra, volume, fibres",
      {positive_parameter("young", "Pa", "1e4", 1e12, "Young's modulus"),
       number_parameter(
           "poisson", "", "0.3", 0.0, 0.499,
           "Poisson's ratio; near 0.5 take `strain: averaged`, since tetrahedra bend too stiffly"),
       positive_parameter("density", "kg/m^3", "1000", 1e6, "mass per volume at rest"),
       strain_parameter(), material_damping_parameter(),
       number_parameter("fiber_stiffness", "Pa", "0", 0.0, 1e12,
                        "of fibres, besides Young's modulus; 0: none"),
       vector_parameter("fiber_direction", "", "[1, 0, 0]", 1e6,
                        "of the fibres, in the body's frame at rest")},
      {"patch"},
      [](const Parameters& parameters, const BodyGeometry& geometry) {
        PatchModel::Material material;
        material.elastic = {parameters.number("young"), parameters.number("poisson"),
                            parameters.number("density")};
        material.averaged = parameters.text("strain") == kAveragedStrain;
        material.damping = parameters.number("damping");
        material.fiber_stiffness = parameters.number("fiber_stiffness");
        material.fiber_direction = parameters.vector("fiber_direction");
        if (material.fiber_direction.isZero(0.0)) {
          throw InputError("'fiber_direction' is [0, 0, 0], but must have a direction");
        }
        return std::make_unique<PatchModel>(geometry, material);
      }};
}

}  // namespace pliant
