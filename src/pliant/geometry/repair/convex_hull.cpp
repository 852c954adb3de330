#include "pliant/geometry/repair/convex_hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "pliant/math/error.h"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace pliant {
namespace {

/// One run of the library, whose memory goes with it.
class HullRun {
 public:
  HullRun() { qh_zero(&state_, sink_.get()); }
  HullRun(const HullRun&) = delete;
  HullRun& operator=(const HullRun&) = delete;
  ~HullRun() {
    qh_freeqhull(&state_, !qh_ALL);
    int blocks = 0, bytes = 0;
    qh_memfreeshort(&state_, &blocks, &bytes);
  }

  /// Triangles whose vertices are numbers of `points`, in any winding.
  std::vector<Eigen::Vector3i> triangles(Eigen::Matrix3Xd& points) {
    char options[] = "qhull Qt Pp";  // triangles; no warnings
    const int failed = qh_new_qhull(&state_, 3, static_cast<int>(points.cols()), points.data(),
                                    False, options, sink_.get(), sink_.get());
    if (failed != 0) {
      throw InputError("its points have no convex hull: they lie in one plane or in one place");
    }
    std::vector<Eigen::Vector3i> result;
    qhT* qh = &state_;  // the name that the library's loops look for
    facetT* facet = nullptr;
    FORALLfacets {
      Eigen::Vector3i triangle;
      int k = 0;
      vertexT *vertex = nullptr, **vertexp = nullptr;
      FOREACHvertex_(facet->vertices) {
        if (k < 3) triangle[k++] = qh_pointid(qh, vertex->point);
      }
      result.push_back(triangle);
    }
    return result;
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> sink_{std::fopen("/dev/null", "w")};
  qhT state_;
};

}  // namespace

TriangleMesh convex_hull(const Eigen::Matrix3Xd& points) {
  if (points.cols() < 4) throw InputError("fewer than four points have no convex hull");
  Eigen::Matrix3Xd copy = points;
  const std::vector<Eigen::Vector3i> triangles = HullRun().triangles(copy);
  TriangleMesh hull;
  std::vector<int> place(static_cast<std::size_t>(points.cols()), -1), used;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3i& t : triangles) {
    for (const int v : t) {
      if (place[v] >= 0) continue;
      place[v] = static_cast<int>(used.size());
      used.push_back(v);
      middle += points.col(v);
    }
  }
  middle /= static_cast<double>(used.size());
  hull.vertices = points(Eigen::all, used);
  hull.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    Eigen::Vector3i t(place[triangles[k][0]], place[triangles[k][1]], place[triangles[k][2]]);
    const Eigen::Vector3d a = hull.vertices.col(t[0]);
    const Eigen::Vector3d normal = (hull.vertices.col(t[1]) - a).cross(hull.vertices.col(t[2]) - a);
    if (normal.dot(a - middle) < 0.0) std::swap(t[1], t[2]);
    hull.triangles.col(static_cast<Eigen::Index>(k)) = t;
  }
  return hull;
}

}  // namespace pliant
