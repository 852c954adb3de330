#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/task_arena.h>

#include "pliant/geometry/distance/voxel_band.h"

namespace {

using pliant::VoxelBand;

constexpr float kBandWidth = 3.0f;  // of the samples that have a nearest triangle [spacings]
constexpr int kUnknown = -1;

}  // namespace

extern "C" void pliant_voxel_band(const Eigen::Matrix3Xd& vertices,
                                  const Eigen::Matrix3Xi& triangles, const Eigen::Array3i& count,
                                  VoxelBand& band) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> faces;
  for (const auto v : vertices.colwise()) points.emplace_back(v[0], v[1], v[2]);
  for (const auto t : triangles.colwise()) {
    faces.emplace_back(t[0], t[1], t[2], openvdb::util::INVALID_IDX);
  }
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec4I> data(points,
                                                                                        faces);
  openvdb::Int32Grid nearest(kUnknown);
  openvdb::FloatGrid::Ptr field;
  // Among equally near triangles several threads would pick now one, now another.
  tbb::task_arena(1).execute([&] {
    field = openvdb::tools::meshToVolume<openvdb::FloatGrid>(data, openvdb::math::Transform(),
                                                             kBandWidth, kBandWidth, 0, &nearest);
  });
  const auto distance = field->getConstAccessor();
  const auto triangle = nearest.getConstAccessor();
  for (openvdb::Coord at(0); at.z() < count[2]; ++at.z()) {
    for (at.y() = 0; at.y() < count[1]; ++at.y()) {
      for (at.x() = 0; at.x() < count[0]; ++at.x()) {
        band.inside.push_back(distance.getValue(at) < 0.0f ? 1 : 0);
        band.triangle.push_back(triangle.isValueOn(at) ? triangle.getValue(at) : kUnknown);
      }
    }
  }
}
