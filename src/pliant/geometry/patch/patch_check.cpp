#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/geometry/mesh/offenders.h"
#include "pliant/geometry/patch/patch_surface.h"

namespace pliant {
namespace {

constexpr double kFolded = -0.985;  // about the cosine of 170 degrees
constexpr double kMostLift = 1e-6;  // of a vertex, relative to the edge's length

Eigen::Vector3d normal_beside(const PatchBody& body, const std::array<int, 2>& edge, int opposite) {
  const Eigen::Vector3d a = body.base.vertices.col(edge[0]);
  const Eigen::Vector3d along = body.base.vertices.col(edge[1]) - a;
  return along.cross(body.base.vertices.col(opposite) - a).normalized();
}

/// How far the quadric of an edge would take the surface from the edge's ends [m].
double lift(const PatchBody& body, std::size_t edge) {
  double worst = 0.0;
  for (const int end : body.edges[edge]) {
    const double q = value(body.quadrics[edge], body.base.vertices.col(end));
    worst = std::max(worst, body.dents || q > 0.0 ? std::abs(q * q * q) : 0.0);
  }
  return worst;
}

double length(const PatchBody& body, std::size_t edge) {
  const auto& [a, b] = body.edges[edge];
  return (body.base.vertices.col(a) - body.base.vertices.col(b)).norm();
}

}  // namespace

void validate(const PatchBody& body, const std::string& where) {
  validate(body.base, where);
  const Edges all = edges(body.base);
  if (body.edges != all.vertices) {
    throw InputError(where + ": the edges are not those of the base triangles, in their order");
  }
  if (body.quadrics.size() != all.vertices.size()) {
    throw InputError(fmt::format("{}: {} quadrics for {} edges: each edge needs one", where,
                                 body.quadrics.size(), all.vertices.size()));
  }
  Offenders not_finite, lifted, folded;
  for (std::size_t e = 0; e < all.vertices.size(); ++e) {
    if (!body.quadrics[e].allFinite()) not_finite.add(static_cast<int>(e));
    if (!(lift(body, e) <= kMostLift * length(body, e))) lifted.add(static_cast<int>(e));
    if (all.opposite[e][1] < 0) continue;
    const double cosine = -normal_beside(body, all.vertices[e], all.opposite[e][0])
                               .dot(normal_beside(body, all.vertices[e], all.opposite[e][1]));
    if (cosine < kFolded) folded.add(static_cast<int>(e));
  }
  not_finite.refuse(where, "edges have a quadric that is not finite");
  lifted.refuse(where, "edges have a quadric that lifts the surface off their vertices");
  folded.refuse(where, "edges fold back: the triangles beside them lie on each other");
}

void validate_solid(const PatchBody& body, const std::string& where) {
  validate(body, where);
  const Edges all = edges(body.base);
  const auto open = std::count_if(all.opposite.begin(), all.opposite.end(),
                                  [](const std::array<int, 2>& o) { return o[1] < 0; });
  if (open > 0) {
    throw InputError(fmt::format(
        "{}: the body is open, {} edges have one triangle only: close it, or it has no inside",
        where, open));
  }
  const double volume = signed_volume(body.base);
  if (!(volume > 0.0)) {
    throw InputError(fmt::format(
        "{}: the body is inside out, its base encloses {:.3g} m^3: reverse its triangles", where,
        volume));
  }
}

}  // namespace pliant
