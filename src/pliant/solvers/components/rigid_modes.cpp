#include "pliant/solvers/components/rigid_modes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

namespace pliant {
namespace {

// Of the largest moment of inertia; a smaller one is none, as about a line's own axis.
constexpr double kNoInertia = 1e-12;

Eigen::Matrix3d inverse_of(const Eigen::Matrix3d& inertia) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(inertia);
  Eigen::Vector3d inverse = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const double value = eigen.eigenvalues()[k];
    if (value > kNoInertia * eigen.eigenvalues()[2]) inverse[k] = 1.0 / value;
  }
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

void RigidModes::prepare(Components components, const Eigen::VectorXd& inertia) {
  components_ = std::move(components);
  inertia_ = inertia;
  bodies_.clear();
  body_of_.assign(static_cast<std::size_t>(inertia.size()), -1);
  for (int c = 0; c < components_.count(); ++c) {
    const auto k = static_cast<std::size_t>(c);
    if (components_.held[k]) continue;
    for (int m = components_.begins[k]; m < components_.begins[k + 1]; ++m) {
      const int i = components_.members[static_cast<std::size_t>(m)];
      body_of_[static_cast<std::size_t>(i)] = count();
    }
    bodies_.emplace_back(components_.begins[k], components_.begins[k + 1], !components_.twisted[k]);
  }
  arms_.setZero(3, bodies_.empty() ? 0 : inertia.size());
  if (!bodies_.empty()) return;
  // Nothing of what is held is asked for.
  components_ = Components();
  inertia_.resize(0);
  body_of_ = std::vector<int>();
}

void RigidModes::update(const Positions& x) {
  for (Body& body : bodies_) {
    const Eigen::Vector3d origin = x.col(components_.members[static_cast<std::size_t>(body.begin)]);
    body.mass = 0.0;
    body.center.setZero();
    for (int k = body.begin; k < body.end; ++k) {
      const int i = components_.members[static_cast<std::size_t>(k)];
      body.mass += inertia_[i];
      body.center += inertia_[i] * (x.col(i) - origin);
    }
    body.center = origin + body.center / body.mass;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (int k = body.begin; k < body.end; ++k) {
      const int i = components_.members[static_cast<std::size_t>(k)];
      Eigen::Vector3d q = x.col(i) - body.center;
      if (!body.turns && !all_turn_) q.setZero();
      arms_.col(i) = q;
      inertia += inertia_[i] * (q.squaredNorm() * Eigen::Matrix3d::Identity() - q * q.transpose());
    }
    body.inertia = inertia;
    body.inverse_inertia = inverse_of(inertia);
  }
}

void RigidModes::take_out(Forces& f) {
  for (Body& body : bodies_) {
    motion_of(
        body, [&](int i) { return Eigen::Vector3d(f.col(i)); }, body.shift, body.turn);
    for (int k = body.begin; k < body.end; ++k) {
      const int i = components_.members[static_cast<std::size_t>(k)];
      f.col(i) -= inertia_[i] * (body.shift + body.turn.cross(Eigen::Vector3d(arms_.col(i))));
    }
  }
}

void RigidModes::put_in(Positions& d) const {
  for (const Body& body : bodies_) {
    Eigen::Vector3d shift, turn;
    motion_of(
        body, [&](int i) { return Eigen::Vector3d(inertia_[i] * d.col(i)); }, shift, turn);
    shift = body.shift - shift;
    turn = body.turn - turn;
    for (int k = body.begin; k < body.end; ++k) {
      const int i = components_.members[static_cast<std::size_t>(k)];
      d.col(i) += shift + turn.cross(Eigen::Vector3d(arms_.col(i)));
    }
  }
}

void RigidModes::momenta(const Positions& v,
                         Eigen::Matrix<double, 6, Eigen::Dynamic>& result) const {
  result.setZero(6, count());
  for (int b = 0; b < count(); ++b) {
    const Body& body = bodies_[static_cast<std::size_t>(b)];
    for (int k = body.begin; k < body.end; ++k) {
      const int i = components_.members[static_cast<std::size_t>(k)];
      result.col(b) += project(i, inertia_[i] * v.col(i));
    }
  }
}

void RigidModes::move(const Eigen::VectorXd& motions, Positions& x) const {
  for (int b = 0; b < count(); ++b) {
    const Body& body = bodies_[static_cast<std::size_t>(b)];
    const Eigen::Vector3d shift = motions.segment<3>(6 * b), turn = motions.segment<3>(6 * b + 3);
    const double angle = turn.norm();
    // Of what changes: a motion of round-off leaves the other digits alone.
    Eigen::Matrix3d change = Eigen::Matrix3d::Zero();
    if (angle > 0.0) {
      change = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
      change -= Eigen::Matrix3d::Identity();
    }
    for (int k = body.begin; k < body.end; ++k) {
      const int i = components_.members[static_cast<std::size_t>(k)];
      x.col(i) += shift + change * Eigen::Vector3d(arms_.col(i));
    }
  }
}

RigidModes::Matrix6 RigidModes::inertia(int number) const {
  const Body& body = bodies_[static_cast<std::size_t>(number)];
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>().diagonal().setConstant(body.mass);
  result.bottomRightCorner<3, 3>() = body.inertia;
  return result;
}

}  // namespace pliant
