#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pliant/core/body/particles.h"
#include "pliant/core/state_archive.h"

namespace pliant {

/// A group of particles that keeps its shape.
struct Cluster {
  std::vector<int> particles;  ///< at least one, none twice
  double stiffness = 0.0;      ///< >= 0, per mass [1/s²]
  /// Where they rest, in a frame of the cluster's own [m]; empty: where all particles' rest is.
  std::vector<Eigen::Vector3d> rest = {};
};

/// The rest shapes of clusters of any sizes, member by member.
class ClusterShapes {
 public:
  struct Member {
    int particle;
    double mass;           // times its weight [kg]
    Eigen::Vector3d rest;  // from the cluster's centre of mass [m]
    double full_mass;      // [kg]
    double weight;
  };
  struct Shape {
    int begin, end;  // members
    double mass;     // of all members with their weights [kg]; 0: it holds nothing
    double stiffness;
    bool straight;  // at rest; its rotation about itself is free, and of no consequence
  };

  ClusterShapes() = default;
  /// `rest` 3 x n [m], `masses` n [kg]. Throws InputError, naming the cluster, when one is empty,
  /// holds a particle twice or out of range, or has a stiffness that is negative or not finite;
  /// and for a rest position or mass of a member that is not finite or, the mass, not positive.
  ClusterShapes(const std::string& name, const Positions& rest, const Eigen::VectorXd& masses,
                const std::vector<Cluster>& clusters);

  int size() const { return static_cast<int>(shapes_.size()); }
  const Shape& shape(int cluster) const { return shapes_[static_cast<std::size_t>(cluster)]; }
  const Member& member(int number) const { return members_[static_cast<std::size_t>(number)]; }
  int members() const { return static_cast<int>(members_.size()); }
  void set_stiffness(int cluster, double stiffness);
  /// A member's part in the cluster, 0 to 1, and where it rests from the present centre of mass
  /// [m]. The cluster's rebalance() follows.
  void set_member(int number, double weight, const Eigen::Vector3d& rest);
  /// Moves the rest positions so that they are measured from the centre of mass again.
  void rebalance(int cluster);
  /// Stiffnesses, weights and rest positions, and back.
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

  /// Centre of mass, summed from the first member: no digits lost far from the origin.
  Eigen::Vector3d center(const Shape& shape, const Positions& x) const;
  /// A = Σ m (x - x_cm) (x⁰ - x⁰_cm)ᵀ [kg m²].
  Eigen::Matrix3d moment(const Shape& shape, const Positions& x,
                         const Eigen::Vector3d& center) const;
  /// The same at rest.
  Eigen::Matrix3d spread(const Shape& shape) const;

  /// The first cluster with a shape in space that `x` turned inside out: its moment's determinant
  /// has the wrong sign, so that no rotation is near. -1: none.
  int first_inside_out(const Positions& x) const;

  /// Clusters in an order of colours that share no particle, and where each colour begins.
  const std::vector<int>& order() const { return order_; }
  const std::vector<int>& begins() const { return begins_; }

 private:
  void add(const Positions& rest, const Eigen::VectorXd& masses, const Cluster& cluster);
  void measure(Shape& shape);

  std::vector<Member> members_;
  std::vector<Shape> shapes_;
  std::vector<int> order_, begins_;
};

}  // namespace pliant
