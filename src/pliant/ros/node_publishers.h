#pragma once

#include <ros/node_handle.h>

#include <vector>

#include "pliant/ros/body_names.h"
#include "pliant/scene/robot/wrenches.h"

namespace pliant {

/// Publishers of a body's topics: the first of several bodies has each of them twice.
struct BodyPublishers {
  std::vector<ros::Publisher> surface, points, mesh_points, mesh_topology;
};

/// Publishers of a model node's topics.
struct NodePublishers {
  std::vector<BodyPublishers> bodies;
  ros::Publisher surfaces;  // not valid with one body
  ros::Publisher shadows, markers, contacts, wrenches, status, diagnostics, frames;
  ros::Publisher legend;                    // not valid without ~color_by
  std::vector<ros::Publisher> each_wrench;  // one of the wrenches each
};

/// Advertises all topics; `node` is private. `has_legend`: colours show values. The two callbacks
/// hear of each new subscriber to ~markers and to /tf.
NodePublishers advertise_topics(ros::NodeHandle& node, const BodyNames& names,
                                const std::vector<Wrench>& wrenches, bool has_legend,
                                const ros::SubscriberStatusCallback& on_markers,
                                const ros::SubscriberStatusCallback& on_frames);

}  // namespace pliant
