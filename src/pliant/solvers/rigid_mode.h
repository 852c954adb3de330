#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "pliant/math/host_device.h"

/// The rigid motion of a connected component (impulse_balance.h), alike on CPU and GPU.
namespace pliant {

namespace rigid {

/// Aligned as their numbers are, so that they may lie among others.
using Vector6 = Eigen::Matrix<double, 6, 1, Eigen::DontAlign>;
using Matrix6 = Eigen::Matrix<double, 6, 6, Eigen::DontAlign>;

// Below it the sine is the angle to the last digit.
constexpr double kSmallestTurn = 1e-9;
constexpr double kRoundOff = 64.0 * std::numeric_limits<double>::epsilon();

/// [v] with [v] w = v × w.
PLIANT_HOST_DEVICE inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0;
  return matrix;
}

/// Σ w (|q|² 1 − q qᵀ).
PLIANT_HOST_DEVICE inline Eigen::Matrix3d inertia_of(const Eigen::Matrix3d& second) {
  return second.trace() * Eigen::Matrix3d::Identity() - second;
}

/// Solves A x = b by Gauss's elimination with partial pivots; A and b are used up.
PLIANT_HOST_DEVICE inline Vector6 solve(Matrix6& a, Vector6& b) {
  for (int k = 0; k < 6; ++k) {
    int pivot = k;
    for (int i = k + 1; i < 6; ++i) {
      if (std::fabs(a(i, k)) > std::fabs(a(pivot, k))) pivot = i;
    }
    if (pivot != k) {
      for (int j = k; j < 6; ++j) {
        const double other = a(k, j);
        a(k, j) = a(pivot, j);
        a(pivot, j) = other;
      }
      const double other = b[k];
      b[k] = b[pivot];
      b[pivot] = other;
    }
    for (int i = k + 1; i < 6; ++i) {
      const double factor = a(i, k) / a(k, k);
      for (int j = k + 1; j < 6; ++j) a(i, j) -= factor * a(k, j);
      b[i] -= factor * b[k];
    }
  }
  Vector6 x;
  for (int i = 5; i >= 0; --i) {
    double sum = b[i];
    for (int j = i + 1; j < 6; ++j) sum -= a(i, j) * x[j];
    x[i] = sum / a(i, i);
  }
  return x;
}

/// Of a component's particles, about a place near them.
struct Sums {
  double mass = 0.0, size = 0.0;                     // Σ m, Σ |parts of g|
  double held = 0.0;                                 // Σ e, stiffness from outside
  Eigen::Vector3d first = Eigen::Vector3d::Zero();   // Σ m q
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // Σ m q qᵀ
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   // Σ g
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // Σ q × g
  Eigen::Vector3d held_first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d held_second = Eigen::Matrix3d::Zero();

  Sums operator+(const Sums& o) const {
    return {mass + o.mass,
            size + o.size,
            held + o.held,
            first + o.first,
            second + o.second,
            force + o.force,
            torque + o.torque,
            held_first + o.held_first,
            held_second + o.held_second};
  }
};

/// A component's motion is a shift t and a turn φ/radius about its centre: six numbers in metres.
struct Mode {
  Eigen::Vector3d center;
  double mass;
  double radius;                 // of gyration [m]
  Matrix6 inertia;               // PᵀMP/h², and what holds the component from outside [N/m]
  Eigen::Matrix3d turn_inverse;  // of its turns' part of PᵀMP/h² [m/N]
  Vector6 unbalanced;            // Pᵀ of all forces but those of the contacts [N]
  double size;                   // of all forces, before they cancel [N]
  double inertial_rate;          // mass/h² [N/m]

  /// The motion that holds so much momentum over h [m].
  PLIANT_HOST_DEVICE Vector6 holding(const Vector6& momentum) const {
    Vector6 result;
    const Eigen::Vector3d turning(momentum[3], momentum[4], momentum[5]);
    const Eigen::Vector3d turn = turn_inverse * turning;
    for (int k = 0; k < 3; ++k) {
      result[k] = momentum[k] / inertial_rate;
      result[3 + k] = turn[k];
    }
    return result;
  }
};

/// A turn φ moves a place q by φ × q = −[q]φ.
PLIANT_HOST_DEVICE inline void add_outer(const Sums& sums, const Eigen::Vector3d& middle,
                                         double radius, Matrix6& inertia) {
  const Eigen::Vector3d first = (sums.held_first - sums.held * middle) / radius;
  const Eigen::Matrix3d second =
      (sums.held_second - sums.held_first * middle.transpose() -
       middle * sums.held_first.transpose() + sums.held * middle * middle.transpose()) /
      (radius * radius);
  const Eigen::Matrix3d cross = cross_matrix(first), turns = inertia_of(second);
  for (int i = 0; i < 3; ++i) {
    inertia(i, i) += sums.held;
    for (int j = 0; j < 3; ++j) {
      inertia(i, 3 + j) -= cross(i, j);
      inertia(3 + i, j) += cross(i, j);
      inertia(3 + i, 3 + j) += turns(i, j);
    }
  }
}

/// Sums are about `origin`; masses times `rate` are M/h² [N/m].
PLIANT_HOST_DEVICE inline Mode mode_of(const Sums& sums, const Eigen::Vector3d& origin,
                                       double rate) {
  Mode mode;
  const Eigen::Vector3d middle = sums.first / sums.mass;
  mode.center = origin + middle;
  mode.mass = sums.mass;
  Eigen::Matrix3d inertia = inertia_of(sums.second - sums.first * middle.transpose());
  const double squared = 0.5 * inertia.trace() / sums.mass;
  mode.radius = std::sqrt(squared > 0.0 ? squared : 0.0);
  const bool has_extent = mode.radius > kRoundOff * (middle.norm() + origin.norm());
  if (!has_extent) mode.radius = 1.0;
  inertia /= mode.radius * mode.radius;
  // About the axis of a line, or of a point, nothing turns: a little inertia there does no harm.
  inertia += (has_extent ? 1e-12 : 1.0) * sums.mass * Eigen::Matrix3d::Identity();
  inertia *= rate;
  mode.inertial_rate = rate * sums.mass;
  mode.turn_inverse = inertia.inverse();
  const Eigen::Vector3d torque = (sums.torque - middle.cross(sums.force)) / mode.radius;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      mode.inertia(i, j) = i == j ? mode.inertial_rate : 0.0;
      mode.inertia(i, 3 + j) = mode.inertia(3 + i, j) = 0.0;
      mode.inertia(3 + i, 3 + j) = inertia(i, j);
    }
    mode.unbalanced[i] = sums.force[i];
    mode.unbalanced[3 + i] = torque[i];
  }
  if (sums.held > 0.0) add_outer(sums, middle, mode.radius, mode.inertia);
  // What positions far from the origin are rounded to counts as well.
  mode.size = sums.size + mode.inertial_rate * mode.center.cwiseAbs().maxCoeff();
  return mode;
}

/// R − 1 of the rotation by `turn`, so that small turns lose no digits.
PLIANT_HOST_DEVICE inline Eigen::Matrix3d change_of(const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  const Eigen::Matrix3d k = cross_matrix(turn);
  if (!(angle > kSmallestTurn)) return k;
  const double half = std::sin(0.5 * angle) / angle;
  return std::sin(angle) / angle * k + 2.0 * half * half * k * k;
}

/// Of a component's particles where a step began, q, and where they are predicted, y.
struct Moments {
  double mass = 0.0;
  Eigen::Vector3d start = Eigen::Vector3d::Zero(), predicted = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // Σ m q qᵀ
  Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();   // Σ m y qᵀ

  Moments operator+(const Moments& o) const {
    return {mass + o.mass, start + o.start, predicted + o.predicted, second + o.second,
            mixed + o.mixed};
  }
};

/// What turns is predicted on straight lines, which stretch it; that stretch goes away again.
struct Turn {
  bool any = false;
  Eigen::Vector3d start, predicted;  // means
  Eigen::Vector3d tangent;           // of the angle, along the axis
  Eigen::Matrix3d change;            // R − 1

  /// What the prediction of a particle that began at q is moved by.
  PLIANT_HOST_DEVICE Eigen::Vector3d way(const Eigen::Vector3d& q, const Eigen::Vector3d& y) const {
    const Eigen::Vector3d straight = tangent.cross(q - start);
    return change * (y - predicted - straight) - straight;
  }
};

PLIANT_HOST_DEVICE inline Turn turn_of(const Moments& sums) {
  Turn result;
  result.start = sums.start / sums.mass;
  result.predicted = sums.predicted / sums.mass;
  const Eigen::Matrix3d second = sums.second - sums.start * result.start.transpose();
  const Eigen::Matrix3d mixed = sums.mixed - sums.predicted * result.start.transpose();
  // The displacement's linear rigid part is ω × q, its moment Σ m q × y.
  const Eigen::Vector3d moment(mixed(2, 1) - mixed(1, 2), mixed(0, 2) - mixed(2, 0),
                               mixed(1, 0) - mixed(0, 1));
  Eigen::Matrix3d inertia = inertia_of(second);
  if (!(inertia.trace() > 0.0)) return result;
  inertia += 1e-12 * inertia.trace() * Eigen::Matrix3d::Identity();
  result.tangent = inertia.inverse() * moment;
  const double tangent = result.tangent.norm();
  if (!(tangent > kSmallestTurn)) return result;
  result.any = true;
  // A rigid body that is predicted at q + ω × q comes to where it is turned by atan |ω|: there
  // x × m (y − x) = 0.
  const Eigen::Vector3d angle = std::atan(tangent) / tangent * result.tangent;
  result.change = change_of(angle);
  return result;
}

}  // namespace rigid
}  // namespace pliant
