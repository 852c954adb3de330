#include "pliant/effects/particles/heat_network.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

constexpr int kGrain = 1024;
constexpr int kMostNewton = 60, kMostGradients = 2000, kBisections = 60;
// Of the highest temperature: a change that counts as none, and what a linear solve may leave.
constexpr double kTolerance = 1e-10, kLinearTolerance = 1e-12;
// Of the slope where a search begins: what is left of it at its end.
constexpr double kSearched = 1e-6;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

int root_of(std::vector<int>& parents, int i) {
  while (parents[at(i)] != i) i = parents[at(i)] = parents[at(parents[at(i)])];
  return i;
}

}  // namespace

double HeatNetwork::heat_at(int i, double temperature) const {
  return masses[i] * materials[at(i)]->enthalpy(temperature);
}

double HeatNetwork::slope_at(int i, double temperature) const {
  return masses[i] * materials[at(i)]->slope(temperature);
}

void HeatNetwork::prepare() {
  sums_ = passes;
  for (int i = 0; i < size(); ++i) {
    for (int k = begins[at(i)]; k < begins[at(i + 1)]; ++k) sums_[i] += conductances[at(k)];
  }
  find_components();
}

void HeatNetwork::find_components() {
  std::vector<int> parents(at(size()));
  std::iota(parents.begin(), parents.end(), 0);
  for (int i = 0; i < size(); ++i) {
    for (int k = begins[at(i)]; k < begins[at(i + 1)]; ++k) {
      if (!(conductances[at(k)] > 0.0)) continue;
      const int a = root_of(parents, i), b = root_of(parents, others[at(k)]);
      parents[at(std::max(a, b))] = std::min(a, b);
    }
  }
  component_.assign(at(size()), -1);
  is_open_.clear();
  for (int i = 0; i < size(); ++i) {
    // A root is the least node of its component, and comes first.
    const int root = root_of(parents, i);
    if (root == i) {
      component_[at(i)] = static_cast<int>(is_open_.size());
      is_open_.push_back(0);
    }
    component_[at(i)] = component_[at(root)];
    if (passes[i] > 0.0) is_open_[at(component_[at(i)])] = 1;
  }
}

void HeatNetwork::apply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  y.resize(size());
  parallel_for(0, size(), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      double sum = 0.0;
      for (int k = begins[at(i)]; k < begins[at(i + 1)]; ++k) {
        sum += conductances[at(k)] * (x[i] - x[others[at(k)]]);
      }
      y[i] = passes[i] * x[i] + sum;
    }
  });
}

void HeatNetwork::precondition(const Eigen::VectorXd& residual, Eigen::VectorXd& z) const {
  means_.setZero(levels_.size());
  for (int i = 0; i < size(); ++i) means_[component_[at(i)]] += residual[i];
  means_.array() /= levels_.array();
  z = residual.cwiseQuotient(diagonal_);
  for (int i = 0; i < size(); ++i) z[i] += means_[component_[at(i)]];
}

bool HeatNetwork::solve(double dt, double tolerance, const Eigen::VectorXd& right,
                        Eigen::VectorXd& x) {
  diagonal_ = slopes_ + dt * sums_;
  levels_.setZero(static_cast<Eigen::Index>(is_open_.size()));
  for (int i = 0; i < size(); ++i) levels_[component_[at(i)]] += slopes_[i] + dt * passes[i];
  x.setZero(size());
  Eigen::VectorXd residual = right;
  precondition(residual, z_);
  p_ = z_;
  double rz = residual.dot(z_);
  for (int k = 0; k < kMostGradients; ++k) {
    if (z_.cwiseAbs().maxCoeff() <= tolerance) return true;
    apply(p_, q_);
    q_ = slopes_.cwiseProduct(p_) + dt * q_;
    const double curvature = p_.dot(q_);
    if (!(curvature > 0.0)) return false;
    x += rz / curvature * p_;
    residual -= rz / curvature * q_;
    precondition(residual, z_);
    const double next = residual.dot(z_);
    p_ = z_ + next / rz * p_;
    rz = next;
  }
  return false;
}

double HeatNetwork::share_of_step(double dt, const Eigen::VectorXd& temperature,
                                  const Eigen::VectorXd& direction) const {
  apply(direction, along_);
  const double curvature = dt * direction.dot(along_), before = direction.dot(missing_);
  // The slope of the convex function at the share t of the step, which grows with t.
  const auto slope = [&](double t) {
    double sum = before + t * curvature;
    for (int i = 0; i < size(); ++i) {
      sum += direction[i] *
             (heat_at(i, temperature[i] + t * direction[i]) - heat_at(i, temperature[i]));
    }
    return sum;
  };
  const double rest = kSearched * std::abs(before);
  if (slope(1.0) <= rest) return 1.0;
  double low = 0.0, high = 1.0;
  for (int k = 0; k < kBisections; ++k) {
    const double middle = 0.5 * (low + high), value = slope(middle);
    if (std::abs(value) <= rest) return middle;
    (value < 0.0 ? low : high) = middle;
  }
  return low;
}

double HeatNetwork::settle(const Eigen::VectorXd& temperature, Eigen::VectorXd& heat) const {
  Eigen::VectorXd before = Eigen::VectorXd::Zero(levels_.size()), after = before, share = before;
  for (int i = 0; i < size(); ++i) {
    const int c = component_[at(i)];
    before[c] += heat[i];
    heat[i] = heat_at(i, temperature[i]);
    after[c] += heat[i];
    share[c] += slopes_[i];
  }
  double from_outside = 0.0;
  for (Eigen::Index c = 0; c < before.size(); ++c) {
    if (is_open_[static_cast<std::size_t>(c)]) from_outside += after[c] - before[c];
  }
  for (int i = 0; i < size(); ++i) {
    const int c = component_[at(i)];
    if (!is_open_[at(c)]) heat[i] += (before[c] - after[c]) * (slopes_[i] / share[c]);
  }
  return from_outside;
}

HeatNetwork::Result HeatNetwork::step(double dt, Eigen::VectorXd& heat,
                                      Eigen::VectorXd& temperature) {
  Result result;
  result.converged = false;
  slopes_.resize(size());
  missing_.resize(size());
  double scale = 1.0;  // the hottest that it was, 1 K at least
  for (int k = 0; k < kMostNewton && !result.converged; ++k) {
    apply(temperature, missing_);
    missing_ = dt * (missing_ - brings);
    for (int i = 0; i < size(); ++i) {
      missing_[i] += heat_at(i, temperature[i]) - heat[i];
      slopes_[i] = slope_at(i, temperature[i]);
    }
    scale = std::max(scale, temperature.cwiseAbs().maxCoeff());
    const bool solved = solve(dt, kLinearTolerance * scale, -missing_, change_);
    const double share = share_of_step(dt, temperature, change_);
    temperature += share * change_;
    result.converged = solved && share * change_.cwiseAbs().maxCoeff() <= kTolerance * scale;
  }
  result.from_outside = settle(temperature, heat);
  return result;
}

}  // namespace pliant
