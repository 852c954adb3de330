#ifndef PLIANT_GEOMETRY_TRIANGLE_MESH_H_
#define PLIANT_GEOMETRY_TRIANGLE_MESH_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace pliant {

constexpr int kMaxTriangles = 10'000'000;

struct TriangleMesh {
  Eigen::Matrix3Xd vertices;   // 3 x n [m]
  Eigen::Matrix3Xi triangles;  // 3 x m vertex indices, counter-clockwise seen from outside
};

// Total area [m^2].
double area(const TriangleMesh& mesh);

// n areas [m^2]: a third of the adjacent triangles' areas; they sum to area(mesh).
Eigen::VectorXd vertex_areas(const TriangleMesh& mesh);

// 3 x m, the part of a triangle's area that belongs to each corner; columns sum to 1. A corner has
// what lies nearer to it than to the others. An obtuse triangle, whose circumcentre is outside, is
// shared by halves: one for the corner of the obtuse angle, a quarter for each of the others (Meyer
// et al. 2003, "mixed area").
Eigen::Matrix3Xd voronoi_shares(const TriangleMesh& mesh);

// n areas [m^2] of the vertices' Voronoi cells, by those shares; they sum to area(mesh). How a
// rectangle is cut into triangles leaves them alone.
Eigen::VectorXd voronoi_areas(const TriangleMesh& mesh);

// 3 x n unit normals: mean of the adjacent triangles' normals weighted by area. +z where that mean
// vanishes (no adjacent triangle, or triangles that cancel), so that it is never NaN.
Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh);

// Volume [m^3] enclosed by a closed mesh: positive when its winding points outward.
double signed_volume(const TriangleMesh& mesh);

// The undirected edges, in ascending order of their vertices.
struct Edges {
  std::vector<std::array<int, 2>> vertices;  // the smaller index first
  // The vertex opposite the edge in each adjacent triangle, the triangle with the smaller index
  // first; the second is -1 at a boundary.
  std::vector<std::array<int, 2>> opposite;
};

// Throws InputError, naming the edge's vertices, where more than two triangles share an edge.
Edges edges(const TriangleMesh& mesh);

// Vertices on an edge that has one triangle only, ascending. Empty for a closed mesh.
// Throws InputError as edges() does.
std::vector<int> boundary_vertices(const TriangleMesh& mesh);

// Throws InputError, its message beginning with `where` (a file or scene field), when the mesh
// - has no vertices or no triangles, or more than kMaxTriangles triangles;
// - has a vertex that is not finite, or an index outside [0, vertices);
// - has a degenerate triangle: a height below 1e-10 of its longest edge;
// - has a triangle twice, or a vertex in no triangle;
// - has an edge with more than two triangles;
// - has neighbours with opposite winding (orient_consistently() may mend that).
// The message names the first offenders and how many there are.
void validate(const TriangleMesh& mesh, const std::string& where);

// Flips triangles until neighbours agree; in each connected part the winding of the majority wins,
// the first triangle's where there is a draw. Returns false, the mesh unchanged, where that is
// impossible (a Moebius strip). Throws InputError where more than two triangles share an edge.
bool orient_consistently(TriangleMesh& mesh);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_TRIANGLE_MESH_H_
