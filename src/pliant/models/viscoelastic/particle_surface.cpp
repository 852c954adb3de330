#include "pliant/models/viscoelastic/particle_surface.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/laws/sph_kernels.h"
#include "pliant/models/viscoelastic/mesh_parts.h"
#include "pliant/models/viscoelastic/nearby_particles.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

// Closed parts that hold less than so many particles are left out: drops that come and go.
constexpr double kLeastParticles = 1.5;

// Cubes along a round kernel where flat ones are drawn, across which the field is steep.
constexpr int kLeastDetail = 3;

constexpr int kCellGrain = 32;
constexpr int kVertexGrain = 256;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

}  // namespace

void ParticleSurface::update(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& volumes,
                             const SurfaceStyle& style) {
  x_ = x;
  volumes_ = volumes;
  style_ = style;
  const double reach = style.anisotropic ? AnisotropicKernels::kReach : 1.0;
  cells_.arrange(x, reach * style.support);
  find_plain_weights();
  const double particle = volumes.size() > 0 ? volumes.mean() : 0.0;
  const double least = kLeastParticles * particle;
  if (make_on_device()) {
    keep_large_parts(device_vertices_, device_triangles_, least, mesh_);
  } else {
    make();
    keep_large_parts(polygons_.vertices(), polygons_.triangles(), least, mesh_);
  }
}

bool ParticleSurface::make_on_device() {
  if (!device_ || style_.anisotropic || cells_.size() == 0) return false;
  try {
    if (!device_->weigh(cells_, plain_weights_, at_boundary_)) return false;
    find_blocks();
    device_->make(cells_, blocks_, device_vertices_, device_triangles_);
  } catch (const DeviceFailure& failure) {
    device_.reset();
    device_failure_ = failure.what();
    return false;
  }
  return true;
}

void ParticleSurface::make() {
  weigh_particles();
  find_blocks();
  if (style_.anisotropic) {
    anisotropic_.make(cells_, blocks_, weights_);
    fill_blocks<NearbyEllipsoids>(anisotropic_.ellipsoids());
  } else {
    fill_blocks<NearbyParticles>(weights_);
  }
  polygons_.make(blocks_, values_, SurfaceLimits::kLevel, cells_.origin(),
                 cells_.radius() / blocks_.detail());
}

void ParticleSurface::find_plain_weights() {
  const double unit = SphKernels(style_.support).poly6(0.0);
  plain_weights_.resize(cells_.size());
  for (int rank = 0; rank < cells_.size(); ++rank) {
    plain_weights_[rank] = static_cast<float>(unit * volumes_[cells_.order()[at(rank)]]);
  }
}

void ParticleSurface::weigh_particles() {
  weights_ = plain_weights_;
  at_boundary_.assign(at(cells_.cells()), 0);
  const auto radius = static_cast<float>(style_.support / cells_.radius());
  parallel_for(0, cells_.cells(), kCellGrain, [&](int begin, int end) {
    NearbyParticles nearby;
    nearby.set_radius(radius);
    for (int c = begin; c < end; ++c) {
      nearby.gather(cells_, plain_weights_, cells_.cell(c));
      const Eigen::Vector3d corner =
          cells_.origin() + cells_.radius() * cells_.cell(c).cast<double>();
      for (int rank = cells_.cell_begin(c); rank < cells_.cell_begin(c + 1); ++rank) {
        const Eigen::Vector3d own = x_.col(cells_.order()[at(rank)]);
        Eigen::Vector3f aside;
        const float sum = nearby.sum(((own - corner) / cells_.radius()).cast<float>(), aside);
        weights_[rank] *= std::max(1.0f, SurfaceLimits::kThin / sum);
        if (sum < SurfaceLimits::kFull || aside.norm() > SurfaceLimits::kAside * radius * sum)
          at_boundary_[at(c)] = 1;
      }
    }
  });
}

void ParticleSurface::find_blocks() {
  std::vector<SurfaceBlocks::Cell> marked;
  for (int c = 0; c < cells_.cells(); ++c) {
    if (at_boundary_[at(c)] != 0) marked.push_back(cells_.cell(c));
  }
  const int detail = style_.anisotropic ? std::max(kLeastDetail, style_.detail) : style_.detail;
  const double cubes = detail * cells_.radius() / style_.support;
  blocks_.build(marked, static_cast<int>(std::ceil(cubes - 1e-9)));
}

template <class Nearby, class Kernels>
void ParticleSurface::fill_blocks(const Kernels& kernels) {
  const int detail = blocks_.detail(), nodes = blocks_.nodes();
  values_.resize(at(blocks_.size()) * at(nodes));
  const float step = 1.0f / static_cast<float>(detail);
  parallel_for(0, blocks_.size(), kCellGrain, [&](int begin, int end) {
    Nearby nearby;
    for (int b = begin; b < end; ++b) {
      nearby.gather(cells_, kernels, blocks_.cell(b));
      for (int n = 0; n < nodes; ++n) {
        const Eigen::Array3i node(n % detail, n / detail % detail, n / (detail * detail));
        values_[at(b) * at(nodes) + at(n)] = nearby.sum(step * node.cast<float>().matrix());
      }
    }
  });
}

Eigen::MatrixXd ParticleSurface::interpolate_rows(const Eigen::MatrixXd& fields) const {
  Eigen::MatrixXd result(fields.rows(), mesh_.vertices.cols());
  const auto cell_of = [&](const Eigen::Vector3d& p) -> SurfaceBlocks::Cell {
    return ((p - cells_.origin()) / cells_.radius()).array().floor().matrix().cast<int>();
  };
  parallel_for(0, static_cast<int>(result.cols()), kVertexGrain, [&](int begin, int end) {
    NearbyParticles nearby;
    nearby.set_radius(static_cast<float>(style_.support / cells_.radius()));
    SurfaceBlocks::Cell gathered = SurfaceBlocks::Cell::Zero();
    for (int v = begin; v < end; ++v) {
      const Eigen::Vector3d p = mesh_.vertices.col(v);
      const SurfaceBlocks::Cell cell = cell_of(p);
      // Vertices come block by block.
      if (v == begin || cell != gathered) nearby.gather(cells_, plain_weights_, cell);
      gathered = cell;
      const Eigen::Vector3d corner = cells_.origin() + cells_.radius() * cell.cast<double>();
      result.col(v) = nearby.mean(((p - corner) / cells_.radius()).cast<float>(), fields);
    }
  });
  return result;
}

Eigen::VectorXd ParticleSurface::interpolate(const Eigen::VectorXd& field) const {
  return interpolate_rows(field.transpose()).row(0);
}

}  // namespace pliant
