#include "pliant/core/body/particles.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/math/error.h"
#include "pliant/math/joined.h"

namespace pliant {

Particles::Particles(const Positions& positions, const Eigen::VectorXd& masses)
    : x(positions),
      v(Eigen::Matrix3Xd::Zero(3, positions.cols())),
      x_start(positions),
      v_start(v),
      v_before(v),
      mass(masses),
      inverse_mass(masses.cwiseInverse()) {
  for (int i = 0; i < size(); ++i) {
    if (!(std::isfinite(mass[i]) && mass[i] > 0.0)) {
      throw InputError(
          fmt::format("mass of particle {} is {} kg, but must be positive", i, mass[i]));
    }
  }
}

void Particles::fix(int i) {
  inverse_mass[i] = 0.0;
  v.col(i).setZero();
}

void Particles::append(const Particles& others) {
  x = beside(x, others.x);
  v = beside(v, others.v);
  x_start = beside(x_start, others.x_start);
  v_start = beside(v_start, others.v_start);
  v_before = beside(v_before, others.v_before);
  mass = above(mass, others.mass);
  inverse_mass = above(inverse_mass, others.inverse_mass);
}

double Particles::kinetic_energy() const {
  return 0.5 * v.colwise().squaredNorm().dot(mass.transpose());
}

Eigen::Vector3d Particles::momentum() const { return v * mass; }

Eigen::Vector3d Particles::angular_momentum() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < size(); ++i) sum += mass[i] * x.col(i).cross(v.col(i));
  return sum;
}

Eigen::Vector3d Particles::center_of_mass() const { return x * mass / mass.sum(); }

}  // namespace pliant
