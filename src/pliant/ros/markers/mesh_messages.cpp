#include "pliant/ros/markers/mesh_messages.h"

#include <algorithm>

namespace pliant {

MeshMessages::MeshMessages(const Body& body, const std::string& name) {
  topology_.body = name;
  set_triangles(body.model->surface_triangles(), body.model->surface_vertices());
}

void MeshMessages::set_triangles(const Eigen::Matrix3Xi& triangles, Eigen::Index vertices) {
  ++topology_.version;
  topology_.vertices = static_cast<std::uint32_t>(vertices);
  topology_.triangles.assign(triangles.data(), triangles.data() + triangles.size());
}

bool MeshMessages::update(const BodySnapshot& snapshot, const std_msgs::Header& header) {
  const Eigen::Matrix3Xd& surface = snapshot.surface;
  bool is_other = false;
  if (snapshot.surface_changes) {
    const Eigen::Matrix3Xi& triangles = snapshot.surface_triangles;
    const auto same = [](std::uint32_t known, int now) {
      return known == static_cast<unsigned>(now);
    };
    is_other = topology_.vertices != surface.cols() ||
               !std::equal(topology_.triangles.begin(), topology_.triangles.end(), triangles.data(),
                           triangles.data() + triangles.size(), same);
  }
  if (is_other) {
    set_triangles(snapshot.surface_triangles, surface.cols());
    topology_.header = header;
  }
  points_.header = header;
  points_.version = topology_.version;
  points_.xyz.resize(static_cast<std::size_t>(surface.size()));
  std::transform(surface.data(), surface.data() + surface.size(), points_.xyz.begin(),
                 [](double value) { return static_cast<float>(value); });
  return is_other;
}

}  // namespace pliant
