#include "pliant/study/accuracy/error_meter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace pliant {
namespace {

constexpr double kLeastShare = 1e-9;  // of the body's size or energy, below which nothing counts

double finite_or_infinite(double error) {
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

}  // namespace

StateSample extrapolated(const StateSample& fine, const StateSample& coarse, int order) {
  // The error falls to 2^-order of it: what is left of fine's is that share of the difference.
  const double share = 1.0 / (std::pow(2.0, order) - 1.0);
  const auto limit_of = [&](double f, double c) { return f + share * (f - c); };
  StateSample limit;
  for (std::size_t k = 0; k < fine.positions.size(); ++k) {
    limit.positions.push_back(fine.positions[k] +
                              share * (fine.positions[k] - coarse.positions[k]));
  }
  const Energies &f = fine.energies, &c = coarse.energies;
  limit.energies = {limit_of(f.kinetic, c.kinetic), limit_of(f.elastic, c.elastic),
                    limit_of(f.potential, c.potential)};
  limit.largest_strain = limit_of(fine.largest_strain, coarse.largest_strain);
  return limit;
}

ErrorMeter::ErrorMeter(const World& start) {
  Eigen::AlignedBox3d box;
  for (const Body& body : start.bodies()) {
    add_edges(static_cast<int>(masses_.size()), *body.model);
    masses_.push_back(body.particles().mass);
    mass_ += body.particles().mass.sum();
    for (int i = 0; i < body.particles().size(); ++i) box.extend(body.particles().x.col(i));
  }
  size_ = box.isEmpty() ? 0.0 : box.diagonal().norm();
  start_potential_ = start.energies().potential;
}

void ErrorMeter::add_edges(int body, const Model& model) {
  const Positions& x = model.particles().x;
  std::set<std::pair<int, int>> seen;
  const auto add_all = [&](const auto& elements) {
    for (Eigen::Index e = 0; e < elements.cols(); ++e) {
      for (Eigen::Index a = 0; a < elements.rows(); ++a) {
        for (Eigen::Index b = a + 1; b < elements.rows(); ++b) {
          const auto [from, to] = std::minmax({elements(a, e), elements(b, e)});
          const double rest = (x.col(from) - x.col(to)).norm();
          if (rest > 0.0 && seen.insert({from, to}).second) {
            edges_.push_back({body, from, to, rest});
          }
        }
      }
    }
  };
  if (model.tetrahedra() != nullptr) {
    add_all(model.tetrahedra()->tetrahedra);
  } else {
    add_all(model.surface_triangles());
  }
}

double ErrorMeter::largest_strain(const World& world) const {
  double largest = 0.0;
  for (const Edge& edge : edges_) {
    const Positions& x = world.bodies()[static_cast<std::size_t>(edge.body)].particles().x;
    const double length = (x.col(edge.from) - x.col(edge.to)).norm();
    largest = std::max(largest, std::abs(length / edge.rest - 1.0));
  }
  return largest;
}

StateSample ErrorMeter::sample(const World& world) const {
  StateSample sample;
  for (const Body& body : world.bodies()) sample.positions.push_back(body.particles().x);
  sample.energies = world.energies();
  sample.largest_strain = largest_strain(world);
  return sample;
}

double ErrorMeter::distance(const std::vector<Positions>& a,
                            const std::vector<Positions>& b) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < masses_.size(); ++k) {
    sum += (a[k] - b[k]).colwise().squaredNorm().dot(masses_[k].transpose());
  }
  return mass_ > 0.0 ? std::sqrt(sum / mass_) : 0.0;
}

ErrorScale ErrorMeter::scale(const std::vector<Positions>& from,
                             const StateSample& reference) const {
  const double least = std::numeric_limits<double>::min();
  const Energies& e = reference.energies;
  const double energy = e.kinetic + e.elastic + std::abs(e.potential - start_potential_);
  return {std::max({distance(from, reference.positions), kLeastShare * size_, least}),
          std::max({energy, kLeastShare * 0.5 * mass_ * size_ * size_, least})};
}

Errors ErrorMeter::errors(const StateSample& state, const StateSample& reference,
                          const ErrorScale& scale) const {
  Errors errors;
  for (std::size_t k = 0; k < masses_.size(); ++k) {
    const Positions difference = state.positions[k] - reference.positions[k];
    if (difference.size() == 0) continue;
    errors.largest = std::max(errors.largest, difference.colwise().norm().maxCoeff());
  }
  errors.rms = finite_or_infinite(distance(state.positions, reference.positions));
  if (std::isinf(errors.rms)) errors.largest = errors.rms;  // maxCoeff() may pass over NaN
  errors.position = errors.rms / scale.distance;
  errors.energy = finite_or_infinite(std::abs(state.energies.total() - reference.energies.total()) /
                                     scale.energy);
  errors.strain = finite_or_infinite(std::abs(state.largest_strain - reference.largest_strain));
  return errors;
}

std::vector<Positions> inertial_prediction(const World& world) {
  const double h = world.time_step();
  std::vector<Positions> predicted;
  for (const Body& body : world.bodies()) {
    const Particles& p = body.particles();
    Positions y = p.x_start + h * p.v_start;
    y += h * h * body.model->system().external_forces * p.inverse_mass.asDiagonal();
    for (int i = 0; i < p.size(); ++i) {
      if (p.is_fixed(i)) y.col(i) = p.x_start.col(i);
    }
    predicted.push_back(std::move(y));
  }
  return predicted;
}

}  // namespace pliant
