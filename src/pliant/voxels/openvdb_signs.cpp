#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/task_arena.h>

#include "pliant/geometry/distance/sample_rows.h"
#include "pliant/geometry/distance/voxel_signs.h"

namespace {

constexpr float kBandWidth = 3.0f;  // around the surface, of distances [spacings]

}  // namespace

extern "C" void pliant_voxel_signs(const Eigen::Matrix3Xd& vertices,
                                   const Eigen::Matrix3Xi& triangles, const Eigen::Array3i& count,
                                   std::vector<char>& inside) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> faces;
  for (const auto v : vertices.colwise()) points.emplace_back(v[0], v[1], v[2]);
  for (const auto t : triangles.colwise()) {
    faces.emplace_back(t[0], t[1], t[2], openvdb::util::INVALID_IDX);
  }
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec4I> data(points,
                                                                                        faces);
  openvdb::FloatGrid::Ptr field;
  // Among equally near triangles several threads would ask now one, now another for the sign.
  tbb::task_arena(1).execute([&] {
    field = openvdb::tools::meshToVolume<openvdb::FloatGrid>(data, openvdb::math::Transform(),
                                                             kBandWidth, kBandWidth);
  });
  pliant::for_each_row(count, [&] {
    return [&, distance = field->getConstAccessor()](std::size_t i, const Eigen::Vector3d& p) {
      const Eigen::Vector3i at = p.cast<int>();
      inside[i] = distance.getValue(openvdb::Coord(at[0], at[1], at[2])) < 0.0f ? 1 : 0;
    };
  });
}
