#pragma once

#include <vector>

#include "pliant/effects/contact/pair_detection.h"
#include "pliant/effects/self_contact/part_points.h"
#include "pliant/effects/self_contact/self_contact_parts.h"

namespace pliant {

/// Finds where a body's points are near or within its own surfaces at the end of a step. Near a
/// surface the nearest triangle counts as it now is; a point deeper inside is looked up in the
/// tetrahedra, and its place at rest tells which point of the surface it left by (McAdams et al.
/// 2011, "Efficient elasticity for character skinning with contact and collisions", sec. 5).
///
/// Parts of one body are kept apart whatever their distance at rest; within a part a point and a
/// triangle touch once they are nearer than half of what they are at rest. Parts that overlap
/// deeply leave each other along one direction, the mean of their points' shortest paths out: else
/// some would leave to one side and some to another, and the parts would stay hooked together.
class SelfContactDetection final : public PairDetection {
 public:
  SelfContactDetection(SelfContactParts parts, const Options& options);

  /// In the order of points and parts.
  void find(const Particles& particles, double dt, std::vector<PairContact>& contacts) override;

 private:
  struct Near {
    int point, part, triangle;
    Eigen::Vector3d weights;  // of the triangle's corners
    double distance;          // [m]
    double alignment;         // cosine of the offset from the surface and the triangle's normal
    bool counts;              // near enough to touch
  };
  struct Deep {
    int point, part, tetrahedron;
    Eigen::Vector4d weights;
  };
  struct Overlap {
    int low, high;        // parts
    Eigen::Vector3d out;  // sum of the displacements by which `high` leaves `low` [m]
  };
  struct Side;  // of a contact
  struct Face;  // a triangle as it now is
  // Within a part a point and a triangle touch below this share of their distance at rest.
  static constexpr double kNearShare = 0.5;

  template <class Found>
  using Blocks = std::vector<std::vector<Found>>;

  void find_near(int triangle, std::vector<Near>& found) const;
  /// Leaves out most of what look() would refuse, for a tenth of the work.
  bool may_touch(int point, const Face& face) const;
  void look(int point, const Face& face, std::vector<Near>& found) const;
  /// How far a point has to be from a face at most to touch it, but for how far the surfaces stand
  /// out of the tetrahedra [m].
  double reach(int point, const Face& face) const;
  void find_deep(int tetrahedron, const Positions& x, std::vector<Deep>& found) const;
  /// Calls visit(near, deep) for each near pair of a point and a part of the body: the nearest
  /// place of that part's surface and the tetrahedron the point lies in; one of them may be null.
  template <class Visit>
  void for_each_near_pair(const Visit& visit) const;
  /// Of one point and part; null where none counts.
  const Near* nearest(const Near* begin, const Near* end, bool is_inside) const;
  void choose(const Particles& particles, double dt, std::vector<PairContact>& contacts);
  Near nearest_surface(const Deep& deep) const;
  /// That of two parts, or null.
  const Overlap* find_overlap(int a, int b) const;
  void add_path_out(const Near& near);
  void add(const Near& near, const Particles& particles, double dt,
           std::vector<PairContact>& contacts) const;
  void add(const Deep& deep, const Overlap& overlap, double dt, const Particles& particles,
           std::vector<PairContact>& contacts) const;
  static void join(const Side& point, const Side& surface, PairContact& contact);
  double rest_distance(const Near& near) const;

  SelfContactParts parts_;
  double thickness_;
  double margin_;
  double friction_;
  double cell_;  // of the hash [m]
  // Of the running step; reused.
  Eigen::Matrix3Xd points_, motions_;
  Eigen::Matrix3Xd surface_, surface_start_;  // vertices of the triangles, and as the step began
  std::vector<PartPoints> part_points_;       // of each part
  Blocks<Near> near_blocks_;
  Blocks<Deep> deep_blocks_;
  std::vector<Near> near_;
  std::vector<Deep> deep_;
  std::vector<Overlap> overlaps_;
};

}  // namespace pliant
