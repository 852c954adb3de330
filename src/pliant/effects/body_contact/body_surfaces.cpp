#include "pliant/effects/body_contact/body_surfaces.h"

#include <Eigen/Geometry>
#include <cmath>

#include "pliant/core/body.h"
#include "pliant/core/columns.h"
#include "pliant/math/joined.h"

namespace pliant {
namespace {

// A weight below this is the round-off of one that is 0.
constexpr double kNoWeight = 1e-12;

}  // namespace

BodySurfaces::BodySurfaces(const Group& group) {
  triangles_.resize(3, 0);
  for (std::size_t b = 0; b < group.bodies().size(); ++b) {
    Model& model = *group.bodies()[b]->model;
    const int number = static_cast<int>(b), first = group.joint()->first(number);
    is_solid_.push_back(model.is_solid());
    is_rigid_.push_back(model.is_rigid());
    particles_.push_back(first);
    if (const Eigen::VectorXd* volumes = model.ball_volumes()) {
      // Its surface is made anew for each state; the particles are what it has for good.
      for (int i = 0; i < model.particles().size(); ++i) {
        entries_.push_back({first + i, 1.0});
        begins_.push_back(entries_.size());
        radius_.push_back(0.5 * std::cbrt((*volumes)[i]));
      }
      end_body(number, Eigen::Matrix3Xi(3, 0));
      continue;
    }
    if (const EmbeddedPoints* embedded = model.surface_points()) {
      add_embedded(*embedded, first);
    } else {
      for (int i = 0; i < model.particles().size(); ++i) {
        entries_.push_back({first + i, 1.0});
        begins_.push_back(entries_.size());
      }
    }
    end_body(number, model.surface_triangles());
  }
}

void BodySurfaces::add_embedded(const EmbeddedPoints& points, int first) {
  for (int p = 0; p < points.size(); ++p) {
    for (int k = 0; k < 4; ++k) {
      const double weight = points.weights()(k, p);
      if (std::abs(weight) < kNoWeight) continue;
      entries_.push_back({first + points.particles()(k, p), weight});
    }
    begins_.push_back(entries_.size());
  }
}

void BodySurfaces::leave_rigid(Positions& by) const {
  for (std::size_t b = 0; b < is_rigid_.size(); ++b) {
    if (is_rigid_[b]) continue;
    const int end = b + 1 < particles_.size() ? particles_[b + 1] : static_cast<int>(by.cols());
    by.middleCols(particles_[b], end - particles_[b]).setZero();
  }
}

void BodySurfaces::end_body(int number, const Eigen::Matrix3Xi& triangles) {
  const int first = ends_.empty() ? 0 : ends_.back(), end = static_cast<int>(begins_.size()) - 1;
  ends_.push_back(end);
  body_.resize(static_cast<std::size_t>(end), number);
  radius_.resize(static_cast<std::size_t>(end), 0.0);
  triangles_ = beside(triangles_, Eigen::Matrix3Xi(triangles.array() + first));
}

void BodySurfaces::positions(const Positions& x, Positions& vertices) const {
  vertices.resize(3, size());
  for_each_column(vertices, [&](int i) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Entry* entry = begin(i); entry != end(i); ++entry) {
      sum += entry->weight * x.col(entry->particle);
    }
    vertices.col(i) = sum;
  });
}

bool BodySurfaces::are_far_apart(const Positions& start, const Positions& end, double reach,
                                 const BodyPairTable& pairs) const {
  std::vector<Eigen::AlignedBox3d> boxes(ends_.size());
  for (int b = 0; b < pairs.bodies(); ++b) {
    if (count(b) == 0) continue;
    Eigen::AlignedBox3d& box = boxes[index(b)];
    for (const Positions* x : {&start, &end}) {
      const auto own = x->middleCols(first(b), count(b));
      box.extend(Eigen::Vector3d(own.rowwise().minCoeff()));
      box.extend(Eigen::Vector3d(own.rowwise().maxCoeff()));
    }
    for (int a = 0; a < b; ++a) {
      if (!pairs.touches(a, b)) continue;
      // What is not finite is near.
      if (!(box.exteriorDistance(boxes[index(a)]) > reach)) return false;
    }
  }
  return true;
}

}  // namespace pliant
