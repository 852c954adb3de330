#include "pliant/ros/node_publishers.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/WrenchStamped.h>
#include <pliant/Contacts.h>
#include <pliant/LinkWrenches.h>
#include <pliant/MeshPoints.h>
#include <pliant/MeshTopology.h>
#include <pliant/SolverStatus.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

namespace pliant {
namespace {

/// Under `space`: "" or "BODY/".
void advertise_body(ros::NodeHandle& node, const std::string& space, BodyPublishers& body) {
  body.surface.push_back(node.advertise<visualization_msgs::Marker>(space + "surface", 1));
  body.points.push_back(node.advertise<sensor_msgs::PointCloud2>(space + "points", 1));
  body.mesh_points.push_back(node.advertise<MeshPoints>(space + "mesh/points", 1));
  body.mesh_topology.push_back(node.advertise<MeshTopology>(space + "mesh/topology", 1, true));
}

}  // namespace

NodePublishers advertise_topics(ros::NodeHandle& node, const BodyNames& names,
                                const std::vector<Wrench>& wrenches, bool has_legend,
                                const ros::SubscriberStatusCallback& on_markers,
                                const ros::SubscriberStatusCallback& on_frames) {
  NodePublishers publishers;
  publishers.bodies.resize(names.size());
  // The first body has the plain names; each of several has its own.
  advertise_body(node, "", publishers.bodies.front());
  if (names.size() > 1) {
    // rviz's display of a topic `surface` shows this one with it.
    publishers.surfaces = node.advertise<visualization_msgs::MarkerArray>("surface_array", 1);
    for (std::size_t b = 0; b < names.size(); ++b) {
      advertise_body(node, names.graph_name(b) + "/", publishers.bodies[b]);
    }
  }
  publishers.shadows = node.advertise<visualization_msgs::Marker>("shadows", 1);
  if (has_legend) {
    publishers.legend = node.advertise<visualization_msgs::Marker>("legend", 1, true);
  }
  publishers.markers = node.advertise<visualization_msgs::MarkerArray>("markers", 10, on_markers);
  publishers.contacts = node.advertise<Contacts>("contacts", 10);
  publishers.wrenches = node.advertise<LinkWrenches>("contact_wrenches", 10);
  std::vector<std::string> links;
  for (const Wrench& wrench : wrenches) links.push_back(wrench.name);
  for (const std::string& link : graph_names_of(links, "link_")) {
    publishers.each_wrench.push_back(
        node.advertise<geometry_msgs::WrenchStamped>("wrench/" + link, 10));
  }
  publishers.status = node.advertise<SolverStatus>("status", 10);
  publishers.diagnostics = node.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 10);
  publishers.frames = node.advertise<tf2_msgs::TFMessage>("/tf", 100, on_frames);
  return publishers;
}

}  // namespace pliant
