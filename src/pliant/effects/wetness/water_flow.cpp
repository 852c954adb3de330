#include "pliant/effects/wetness/water_flow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {
namespace {

// Steps within one of the world's, at the most: beyond, the limits on what a vertex takes and gives
// keep it bounded.
constexpr int kMaxSteps = 100;

/// Half the cotangent of the angle at `tip`, times the opposite side: its part of the cells' side.
double cell_side(const Eigen::Vector3d& tip, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d u = a - tip, v = b - tip;
  return 0.5 * std::max(0.0, u.dot(v) / u.cross(v).norm()) * (a - b).norm();
}

}  // namespace

WaterFlow::WaterFlow(const Positions& rest, const Eigen::Matrix3Xi& triangles,
                     const Eigen::VectorXd& areas, const Rates& rates)
    : areas_(areas), rates_(rates) {
  const Edges edges = pliant::edges({rest, triangles});
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [a, b] = edges.vertices[e];
    double width = 0.0;
    for (const int tip : edges.opposite[e]) {
      if (tip >= 0) width += cell_side(rest.col(tip), rest.col(a), rest.col(b));
    }
    if (width > 0.0) edges_.push_back({a, b, width, (rest.col(a) - rest.col(b)).norm()});
  }
  largest_step_ = stable_step();
}

double WaterFlow::stable_step() const {
  Eigen::VectorXd rate = Eigen::VectorXd::Zero(areas_.size());
  for (const Edge& edge : edges_) {
    // d(w³)/dw = 3.
    const double own =
        rates_.diffusion * edge.width / edge.length + 3.0 * rates_.drainage * edge.width;
    rate[edge.a] += own;
    rate[edge.b] += own;
  }
  return 1.0 / rate.cwiseQuotient(areas_).maxCoeff();
}

void WaterFlow::find_fluxes(const Positions& x, const Eigen::Vector3d& up,
                            const Eigen::VectorXd& wetness) {
  flux_.resize(static_cast<Eigen::Index>(edges_.size()));
  drip_.setZero(areas_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    const double slope = std::clamp(up.dot(x.col(edge.a) - x.col(edge.b)) / edge.length, -1.0, 1.0);
    const double upper = wetness[slope > 0.0 ? edge.a : edge.b];
    const double fall = rates_.drainage * edge.width * upper * upper * upper * slope;
    flux_[static_cast<Eigen::Index>(e)] =
        rates_.diffusion * edge.width / edge.length * (wetness[edge.a] - wetness[edge.b]) + fall;
    // A vertex that no water leaves drips as much as would flow on below it.
    const int lower = slope > 0.0 ? edge.b : edge.a, higher = slope > 0.0 ? edge.a : edge.b;
    const double w = wetness[lower];
    if (slope != 0.0) drip_[higher] = -INFINITY;
    drip_[lower] += rates_.drainage * edge.width * w * w * w * std::abs(slope);
  }
  drip_ = drip_.cwiseMax(0.0);
}

double WaterFlow::step(double dt, Eigen::VectorXd& wetness) {
  in_.setZero(areas_.size());
  out_ = drip_;
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const double flux = flux_[static_cast<Eigen::Index>(e)];
    const Edge& edge = edges_[e];
    in_[flux > 0.0 ? edge.b : edge.a] += std::abs(flux);
    out_[flux > 0.0 ? edge.a : edge.b] += std::abs(flux);
  }
  // The share of it that there is, and that there is room for.
  for (int i = 0; i < areas_.size(); ++i) {
    const double room = (1.0 - wetness[i]) * areas_[i] / dt, there = wetness[i] * areas_[i] / dt;
    in_[i] = in_[i] > room ? room / in_[i] : 1.0;
    out_[i] = out_[i] > there ? there / out_[i] : 1.0;
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const double flux = flux_[static_cast<Eigen::Index>(e)];
    const Edge& edge = edges_[e];
    const int from = flux > 0.0 ? edge.a : edge.b, to = flux > 0.0 ? edge.b : edge.a;
    const double moved = dt * std::abs(flux) * std::min(out_[from], in_[to]);
    wetness[from] -= moved / areas_[from];
    wetness[to] += moved / areas_[to];
  }
  double dripped = 0.0;
  for (int i = 0; i < areas_.size(); ++i) {
    const double moved = dt * drip_[i] * out_[i];
    wetness[i] = std::clamp(wetness[i] - moved / areas_[i], 0.0, 1.0);
    dripped += moved;
  }
  return dripped;
}

double WaterFlow::flow(const Positions& x, const Eigen::Vector3d& up, double dt,
                       Eigen::VectorXd& wetness) {
  const double substeps = std::ceil(dt / largest_step_);
  const int steps = std::clamp(static_cast<int>(std::min(substeps, 1e6)), 1, kMaxSteps);
  double dripped = 0.0;
  for (int k = 0; k < steps; ++k) {
    find_fluxes(x, up, wetness);
    dripped += step(dt / steps, wetness);
  }
  return dripped;
}

}  // namespace pliant
