#include "pliant/ros/running/master_watch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <ros/connection_manager.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>

#include <chrono>

namespace pliant {
namespace {

using XmlRpc::XmlRpcValue;

constexpr auto kPeriod = std::chrono::seconds(1);
const char* const kMaster = "master";  // what notices are about
const char* const kClock = "clock";

/// A call's arguments: all calls begin with the name of the node.
XmlRpcValue arguments(const std::vector<std::string>& further) {
  XmlRpcValue values;
  values[0] = ros::this_node::getName();
  for (std::size_t k = 0; k < further.size(); ++k) values[static_cast<int>(k) + 1] = further[k];
  return values;
}

/// Asks the master. Returns false when it does not answer, or knows no answer.
bool ask_master(const char* method, const std::vector<std::string>& further, XmlRpcValue& answer) {
  XmlRpcValue response;
  return ros::master::execute(method, arguments(further), response, answer, false);
}

/// Calls this node itself as a master does, by its XML-RPC API: roscpp tells others' code no more.
bool ask_node(const char* method, const XmlRpcValue& values, XmlRpcValue& answer) {
  std::string host;
  std::uint32_t port = 0;
  ros::XMLRPCManagerPtr manager = ros::XMLRPCManager::instance();
  if (!ros::network::splitURI(manager->getServerURI(), host, port)) return false;
  XmlRpc::XmlRpcClient* client = manager->getXMLRPCClient(host, static_cast<int>(port), "/");
  if (client == nullptr) return false;
  XmlRpcValue response;
  const bool is_answered = client->execute(method, values, response) &&
                           manager->validateXmlrpcResponse(method, response, answer);
  manager->releaseXMLRPCClient(client);
  return is_answered;
}

/// (topic, type) of what this node publishes or has subscribed to.
std::vector<std::pair<std::string, std::string>> own_topics(const char* method) {
  std::vector<std::pair<std::string, std::string>> topics;
  XmlRpcValue answer;
  if (!ask_node(method, arguments({}), answer)) return topics;
  for (int k = 0; k < answer.size(); ++k) {
    topics.emplace_back(std::string(answer[k][0]), std::string(answer[k][1]));
  }
  return topics;
}

/// The master's answer to a subscriber: where publishers are. It would tell of later ones itself.
void take_publishers(const std::string& topic, const XmlRpcValue& publishers) {
  if (publishers.getType() != XmlRpcValue::TypeArray || publishers.size() == 0) return;
  XmlRpcValue values, answer;
  values[0] = "/master";
  values[1] = topic;
  values[2] = publishers;
  ask_node("publisherUpdate", values, answer);
}

}  // namespace

MasterWatch::MasterWatch(std::vector<std::string> services, bool publishes_clock, Notices& notices)
    : services_(std::move(services)), publishes_clock_(publishes_clock), notices_(notices) {
  // Those that roscpp gives each node.
  for (const char* name : {"/get_loggers", "/set_logger_level"}) {
    services_.push_back(ros::this_node::getName() + name);
  }
  thread_ = std::thread([this] { run(); });
}

MasterWatch::~MasterWatch() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void MasterWatch::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!stop_ && !ros::isShuttingDown()) {
    lock.unlock();
    look();
    lock.lock();
    changed_.wait_for(lock, kPeriod, [this] { return stop_; });
  }
}

void MasterWatch::look() {
  XmlRpcValue answer;
  if (!ask_master("getPid", {}, answer)) {
    if (ros::isShuttingDown()) return;
    const std::string text = fmt::format(
        "the ROS master at {} does not answer: connections that are there go on, and "
        "this node registers again when it is back",
        ros::master::getURI());
    if (notices_.set(kMaster, text)) ROS_WARN("%s", text.c_str());
    return;
  }
  notices_.clear(kMaster);
  if (!ask_master("lookupNode", {ros::this_node::getName()}, answer)) register_again();
  if (publishes_clock_) look_for_clocks();
}

void MasterWatch::register_again() {
  if (ros::isShuttingDown()) return;
  const std::string api = ros::XMLRPCManager::instance()->getServerURI();
  int topics = 0, services = 0;
  XmlRpcValue answer;
  for (const auto& [topic, type] : own_topics("getPublications")) {
    topics += ask_master("registerPublisher", {topic, type, api}, answer) ? 1 : 0;
  }
  for (const auto& [topic, type] : own_topics("getSubscriptions")) {
    if (!ask_master("registerSubscriber", {topic, type, api}, answer)) continue;
    ++topics;
    take_publishers(topic, answer);
  }
  const std::string service_api = fmt::format("rosrpc://{}:{}", ros::network::getHost(),
                                              ros::ConnectionManager::instance()->getTCPPort());
  for (const std::string& service : services_) {
    services += ask_master("registerService", {service, service_api, api}, answer) ? 1 : 0;
  }
  ROS_WARN(
      "the ROS master came back and did not know this node: registered %d topics and %d services "
      "again; parameters that the old master had are gone",
      topics, services);
}

void MasterWatch::look_for_clocks() {
  XmlRpcValue answer;
  if (!ask_master("getSystemState", {}, answer)) return;
  std::vector<std::string> others;
  XmlRpcValue& publishers = answer[0];
  for (int k = 0; k < publishers.size(); ++k) {
    if (std::string(publishers[k][0]) != "/clock") continue;
    XmlRpcValue& nodes = publishers[k][1];
    for (int n = 0; n < nodes.size(); ++n) {
      if (std::string(nodes[n]) != ros::this_node::getName()) others.emplace_back(nodes[n]);
    }
  }
  if (others.empty()) {
    notices_.clear(kClock);
    return;
  }
  const std::string text = fmt::format(
      "{} publishes /clock as this node does, so that time jumps to and fro: stop one of the two, "
      "or start this node with _publish_clock:=false",
      fmt::join(others, ", "));
  if (notices_.set(kClock, text)) ROS_ERROR("%s", text.c_str());
}

}  // namespace pliant
