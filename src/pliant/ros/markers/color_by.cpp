#include "pliant/ros/markers/color_by.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "pliant/math/error.h"
#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

/// What models call a quantity.
const std::map<std::string, std::vector<std::string>> kFields = {{"strain", {"strain", "stretch"}},
                                                                 {"stress", {"von_mises"}}};

const std::map<std::string, std::string> kUnits = {{"speed", " m/s"},     {"stress", " Pa"},
                                                   {"von_mises", " Pa"},  {"displacement", " m"},
                                                   {"temperature", " K"}, {"density", " kg/m3"}};

std::string field_of(const Body& body, const std::string& quantity) {
  if (quantity == "none" || quantity == "speed") return quantity == "none" ? "" : quantity;
  const auto entry = kFields.find(quantity);
  const auto names = entry == kFields.end() ? std::vector<std::string>{quantity} : entry->second;
  const auto fields = body.model->point_fields();
  for (const std::string& name : names) {
    if (fields.count(name) > 0) return name;
  }
  return "";
}

void refuse(const std::deque<Body>& bodies, const std::string& quantity) {
  std::set<std::string> allowed = {"none", "speed"};
  for (const Body& body : bodies) {
    for (const auto& [name, values] : body.model->point_fields()) allowed.insert(name);
    for (const auto& [name, fields] : kFields) {
      if (!field_of(body, name).empty()) allowed.insert(name);
    }
  }
  throw InputError("~color_by: " + unknown_name_message("quantity of these bodies", quantity,
                                                        {allowed.begin(), allowed.end()}));
}

}  // namespace

std::vector<std::string> fields_to_color(const std::deque<Body>& bodies,
                                         const std::string& quantity) {
  std::vector<std::string> fields;
  bool some = quantity == "none";
  for (const Body& body : bodies) {
    fields.push_back(field_of(body, quantity));
    some = some || !fields.back().empty();
  }
  if (!some) refuse(bodies, quantity);
  return fields;
}

Eigen::VectorXd field_to_color(const Body& body, const std::string& field) {
  if (field == "speed") return body.particles().v.colwise().norm().transpose();
  return body.model->point_fields().at(field);
}

ColorLegend::ColorLegend(const std::deque<Body>& bodies, std::string quantity)
    : quantity_(std::move(quantity)) {
  Eigen::AlignedBox3d box;
  for (const Body& body : bodies) {
    for (int i = 0; i < body.particles().size(); ++i) box.extend(body.particles().x.col(i));
  }
  const double size = box.diagonal().norm();
  place_ = Eigen::Vector3d(box.center().x(), box.center().y(), box.max().z() + 0.5 * size);
  height_ = 0.06 * size;
}

visualization_msgs::Marker ColorLegend::marker(const std_msgs::Header& header,
                                               const ColorScale& scale) const {
  const auto unit = kUnits.find(quantity_);
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = "legend";
  marker.type = visualization_msgs::Marker::TEXT_VIEW_FACING;
  marker.action = visualization_msgs::Marker::ADD;
  marker.pose.position = to_point(place_);
  marker.pose.orientation.w = 1.0;
  marker.scale.z = height_;
  marker.color = to_color(Eigen::Vector3f(0.1f, 0.1f, 0.12f));
  marker.text = fmt::format("{}: blue {:.4g} to yellow {:.4g}{}", quantity_, scale.min(),
                            scale.max(), unit == kUnits.end() ? "" : unit->second);
  return marker;
}

}  // namespace pliant
