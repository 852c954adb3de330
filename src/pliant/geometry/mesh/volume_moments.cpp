#include "pliant/geometry/mesh/volume_moments.h"

#include <Eigen/Geometry>
#include <cmath>

namespace pliant {
namespace {
constexpr double kPi = 3.14159265358979323846;
}

VolumeMoments volume_moments(const TriangleMesh& mesh) {
  // About the middle of the vertices, so that round-off is that of the body's size.
  const Eigen::Vector3d middle = mesh.vertices.rowwise().mean();
  VolumeMoments moments;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto t : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(t[0]) - middle,
                          b = mesh.vertices.col(t[1]) - middle,
                          c = mesh.vertices.col(t[2]) - middle;
    const double volume = a.dot(b.cross(c)) / 6.0;
    const Eigen::Vector3d sum = a + b + c;
    moments.volume += volume;
    first += volume / 4.0 * sum;
    // ∫ x xᵀ over a tetrahedron with a corner at the origin.
    second += volume / 20.0 *
              (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Eigen::Vector3d offset = first / moments.volume;
  moments.center = middle + offset;
  moments.second = second - moments.volume * offset * offset.transpose();
  return moments;
}

VolumeMoments sphere_moments(double radius) {
  const double volume = 4.0 / 3.0 * kPi * std::pow(radius, 3);
  return {volume, Eigen::Vector3d::Zero(),
          volume * radius * radius / 5.0 * Eigen::Matrix3d::Identity()};
}

VolumeMoments box_moments(const Eigen::Vector3d& size) {
  const double volume = size.prod();
  const Eigen::Vector3d squared = size.array().square();
  return {volume, Eigen::Vector3d::Zero(), (volume / 12.0 * squared).asDiagonal()};
}

VolumeMoments cylinder_moments(double radius, double length) {
  const double volume = kPi * radius * radius * length;
  const double across = volume * radius * radius / 4.0, along = volume * length * length / 12.0;
  return {volume, Eigen::Vector3d::Zero(), Eigen::Vector3d(across, across, along).asDiagonal()};
}

VolumeMoments capsule_moments(double radius, double length) {
  VolumeMoments moments = cylinder_moments(radius, length);
  const VolumeMoments ends = sphere_moments(radius);
  moments.volume += ends.volume;
  moments.second += ends.second;
  // Half spheres lie half of the length away; their own centres are 3/8 of the radius further out.
  moments.second(2, 2) += ends.volume * (0.25 * length * length + 0.375 * radius * length);
  return moments;
}

}  // namespace pliant
