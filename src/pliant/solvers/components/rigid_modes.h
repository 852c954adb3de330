#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "pliant/solvers/components/components.h"

namespace pliant {

/// The rigid motions of the connected components that nothing holds from outside: six modes P each,
/// in the metric of M/h². They turn any approximate inverse G of a step's Hessian H into
///   B = R G Rᵀ + P (Pᵀ M P / h²)⁻¹ Pᵀ,  R = 1 − P (Pᵀ M P)⁻¹ Pᵀ M,
/// which answers net forces and torques by the inertia of the whole component. Inner forces change
/// neither momentum nor angular momentum, H P = M P / h², so that B is the better inverse of the
/// two (0 <= H⁻¹ − B where G <= H⁻¹), and a displacement B f holds exactly the momentum that the
/// forces f give it in a step, however few iterations there are. Components on which elements have
/// a torque have the three modes alone that do not turn them: their arms count as 0.
class RigidModes {
 public:
  /// `inertia` m/h² of each particle [N/m].
  void prepare(Components components, const Eigen::VectorXd& inertia);
  /// Takes others, `scale` times `mass`.
  void set_inertia(const Eigen::VectorXd& mass, double scale) {
    if (bodies_.empty()) return;
    inertia_ = scale * mass;
  }
  /// The modes of the present positions `x`.
  void update(const Positions& x);
  /// Whether from then on all components turn, whatever elements do.
  void let_all_turn(bool all_turn) { all_turn_ = all_turn; }

  /// Takes the net force and torque of each component out of `f` [N], in proportion to its masses,
  /// and keeps the rigid motions with which they are answered.
  void take_out(Forces& f);
  /// Puts these motions in place of the rigid part of displacements `d` [m].
  void put_in(Positions& d) const;

  /// How far a force of 1 N on a particle shifts its component as a whole; 0 of one that is held
  /// [m/N]. After update().
  double translation(int particle) const {
    const int body = body_of(particle);
    return body < 0 ? 0.0 : 1.0 / bodies_[static_cast<std::size_t>(body)].mass;
  }
  /// m/h² of a particle [N/m].
  double inertia_of(int particle) const { return inertia_[particle]; }
  /// (M P)ᵀ v of displacements, six numbers of each component.
  void momenta(const Positions& v, Eigen::Matrix<double, 6, Eigen::Dynamic>& result) const;
  /// From its component's centre of mass to a particle. After update() [m].
  Eigen::Vector3d arm(int particle) const { return arms_.col(particle); }
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  int count() const { return static_cast<int>(bodies_.size()); }
  /// Number of the free component that holds `particle`; -1: none does.
  int body_of(int particle) const {
    return bodies_.empty() ? -1 : body_of_[static_cast<std::size_t>(particle)];
  }
  /// Pᵀ g of a force g on a particle: it, and its moment about the component's centre [N, N m].
  Vector6 project(int particle, const Eigen::Vector3d& g) const {
    Vector6 result;
    result << g, Eigen::Vector3d(arms_.col(particle)).cross(g);
    return result;
  }
  /// Pᵀ K P of a stiffness K between two particles [N/m]: of the force and the moment on the
  /// component of `particle`, by how that of `other` is shifted and turned.
  Matrix6 project(int particle, const Eigen::Matrix3d& k, int other) const {
    Eigen::Matrix<double, 3, 6> of_motion;
    of_motion.leftCols<3>() = k;
    const Eigen::Vector3d own = arms_.col(particle), arm = arms_.col(other);
    // K (t × p) = −(K [p]×) t, row by row p × k of its rows k.
    for (int r = 0; r < 3; ++r) {
      of_motion.row(r).tail<3>() = arm.cross(Eigen::Vector3d(k.row(r))).transpose();
    }
    Matrix6 result;
    result.topRows<3>() = of_motion;
    for (int c = 0; c < 6; ++c) {
      result.col(c).tail<3>() = own.cross(Eigen::Vector3d(of_motion.col(c)));
    }
    return result;
  }
  /// P y of a particle: its displacement as its component is shifted and turned by y [m, rad].
  Eigen::Vector3d motion(int particle, const Vector6& y) const {
    return y.head<3>() + Eigen::Vector3d(y.tail<3>()).cross(Eigen::Vector3d(arms_.col(particle)));
  }
  /// Moves `x`, at which the modes are, by motions as those of motion(), six numbers of each
  /// component, turning it however far that turns.
  void move(const Eigen::VectorXd& motions, Positions& x) const;
  /// (Pᵀ M P / h²)⁻¹ Pᵀ f, six numbers of each component, for `force`(i) on each particle; 0 where
  /// their sum is below `least` and their moment below `least` times the component's size. With
  /// `moments` of each component besides, where there are any. False: all are 0.
  template <class Force>
  bool find_motions(const Force& force, const std::vector<Eigen::Vector3d>& moments, double least,
                    Eigen::VectorXd& motions) const {
    motions.setZero(6 * count());
    bool any = false;
    for (int b = 0; b < count(); ++b) {
      const Body& body = bodies_[static_cast<std::size_t>(b)];
      Eigen::Vector3d shift, turn;
      motion_of(body, force, shift, turn);
      if (!moments.empty()) turn += body.inverse_inertia * moments[static_cast<std::size_t>(b)];
      const double radius = std::sqrt(body.inertia.trace() / (2.0 * body.mass));
      if (body.mass * shift.norm() <= least && (body.inertia * turn).norm() <= least * radius) {
        continue;
      }
      any = true;
      motions.segment<6>(6 * b) << shift, turn;
    }
    return any;
  }
  /// Pᵀ M P / h² of a component.
  Matrix6 inertia(int body) const;
  /// (Pᵀ M P / h²)⁻¹ of a force and a torque on a component; 0 about an axis without inertia.
  Vector6 answer(int body, const Vector6& sum) const {
    const Body& b = bodies_[static_cast<std::size_t>(body)];
    Vector6 result;
    result << sum.head<3>() / b.mass, b.inverse_inertia * sum.tail<3>();
    return result;
  }

 private:
  struct Body {
    Body(int first, int last, bool turning) : begin(first), end(last), turns(turning) {}
    int begin, end;     // of its members
    bool turns;         // elements have no torque on it
    double mass = 0.0;  // Σ m/h² [N/m]
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // Σ m/h² (|q|² 1 − q qᵀ) [N m]
    Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();  // 0 about an axis without inertia
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();            // kept by take_out() [m]
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();             // [rad]
  };
  /// shift and turn of the motion with momentum Σ p and moment Σ q × p, p of each member.
  template <class Momentum>
  void motion_of(const Body& body, const Momentum& momentum, Eigen::Vector3d& shift,
                 Eigen::Vector3d& turn) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = Eigen::Vector3d::Zero();
    for (int k = body.begin; k < body.end; ++k) {
      const int i = components_.members[static_cast<std::size_t>(k)];
      const Eigen::Vector3d p = momentum(i);
      sum += p;
      moment += Eigen::Vector3d(arms_.col(i)).cross(p);
    }
    shift = sum / body.mass;
    turn = body.inverse_inertia * moment;
  }

  Components components_;
  Eigen::VectorXd inertia_;
  Positions arms_;  // of particles from their component's centre of mass [m]
  std::vector<Body> bodies_;
  std::vector<int> body_of_;
  bool all_turn_ = false;
};

}  // namespace pliant
