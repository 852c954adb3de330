#pragma once

#include <visualization_msgs/Marker.h>

#include <deque>
#include <string>
#include <vector>

#include "pliant/core/body.h"
#include "pliant/ros/markers/color_scale.h"

namespace pliant {

/// What colours show instead of the bodies' own: the node's ~color_by, ~color_min, ~color_max and
/// ~color_outliers.
struct ColorBy {
  std::string quantity = "none";  ///< `speed`, `strain`, `stress`, or a field of the points
  double min = 0.0, max = 0.0;    ///< of the quantity; where equal, the range follows what occurs
  double tail = 0.0;              ///< share of the values that such a range leaves out on each side
};

/// For each body the field that shows the quantity: `speed`, or one of its point_fields(). Empty
/// where it has none. Throws InputError, with the names that there are, when no body has any.
std::vector<std::string> fields_to_color(const std::deque<Body>& bodies,
                                         const std::string& quantity);

/// The values of such a field at the body's particles.
Eigen::VectorXd field_to_color(const Body& body, const std::string& field);

/// A text beside the bodies that says which quantity the colours show, and their range.
class ColorLegend {
 public:
  ColorLegend(const std::deque<Body>& bodies, std::string quantity);
  visualization_msgs::Marker marker(const std_msgs::Header& header, const ColorScale& scale) const;

 private:
  std::string quantity_;
  Eigen::Vector3d place_;  // above the middle of the bodies at the start [m]
  double height_;          // of its letters [m]
};

}  // namespace pliant
