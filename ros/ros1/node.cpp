// SPDX-License-Identifier: BSD-3-Clause
// A node of ROS 1 that offers MoveIt's service compute_cartesian_path.
#include <moveit_msgs/GetCartesianPath.h>
#include <moveit_msgs/PlanningScene.h>
#include <ros/callback_queue.h>
#include <ros/poll_manager.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_srvs/Trigger.h>
#include <sys/resource.h>
#include <tf2_ros/transform_listener.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "convert.hpp"

namespace {

using swivel::ros::Answer;
using swivel::ros::PathService;
using swivel::ros::Pose7;

volatile std::sig_atomic_t interrupted = 0;

void interrupt(int) {
  interrupted = 1;
}

/// Called by roscpp's thread that waits for sockets. From when an answer is ready until it is sent,
/// that thread asks whether the socket can be written to, again and again, and where no core is
/// free it would keep the answer's own thread from sending for a slice of 4 ms: so that one goes
/// first.
void go_last() {
  constexpr int kNice = 19;
  thread_local const int done = setpriority(PRIO_PROCESS, 0, kNice);  // of this thread
  static_cast<void>(done);
}

std::string parameter(ros::NodeHandle& node, const char* name) {
  std::string value;
  if (!node.getParam(name, value))
    throw std::runtime_error(std::string("the parameter ") + name + " is not set");
  return value;
}

swivel::ros::Settings settings_of(const ros::NodeHandle& own) {
  swivel::ros::Settings settings;
  own.param("deadline", settings.deadline_s, settings.deadline_s);
  own.param("clearance", settings.clearance, settings.clearance);
  own.param("rate", settings.rate, settings.rate);
  own.param("roll", settings.roll, settings.roll);
  return settings;
}

class Node {
 public:
  Node()
      : service_(parameter(node_, "robot_description"),
                 parameter(node_, "robot_description_semantic"), settings_of(own_)),
        listener_(buffer_) {
    const auto topic = [&](const char* name, auto function) {
      subscribers_.push_back(node_.subscribe(name, 100, function, this));
    };
    topic("joint_states", &Node::joints);
    topic("planning_scene", &Node::scene);
    topic("move_group/monitored_planning_scene", &Node::scene);
    topic("collision_object", &Node::object);
    topic("attached_collision_object", &Node::attached);
    offered_.push_back(node_.advertiseService("compute_cartesian_path", &Node::compute, this));
    offered_.push_back(own_.advertiseService("why", &Node::why, this));
  }
  void stop() { service_.stop(); }

 private:
  void joints(const sensor_msgs::JointState& state) {
    service_.state(swivel::ros::to_joints(state));
  }
  void scene(const moveit_msgs::PlanningScene& scene) {
    const swivel::ros::SceneChange change = swivel::ros::to_scene(scene);
    for (const std::string& warning : change.warnings) ROS_WARN("%s", warning.c_str());
    if (change.says_unchecked) service_.unchecked(change.unchecked);
    apply(change.bodies, change.diff, change.allowed);
  }
  void object(const moveit_msgs::CollisionObject& object) {
    apply({swivel::ros::to_body(object)}, true, {});
  }
  void attached(const moveit_msgs::AttachedCollisionObject& attached) {
    apply({swivel::ros::to_attached(attached)}, true, {});
  }
  void apply(const std::vector<swivel::ros::Body>& bodies, bool diff,
             const swivel::ros::AllowedPairs& allowed) {
    for (const std::string& fault : service_.world(bodies, diff, allowed, transform()))
      ROS_ERROR("left out of the scene: %s", fault.c_str());
  }

  bool compute(moveit_msgs::GetCartesianPath::Request& request,
               moveit_msgs::GetCartesianPath::Response& response) {
    const auto begin = std::chrono::steady_clock::now();
    const Answer answer = service_.answer(swivel::ros::to_query(request), transform());
    swivel::ros::fill(answer, response);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    ROS_INFO("fraction %.4f, code %d: %s", answer.fraction, answer.code, answer.words.c_str());
    const std::lock_guard<std::mutex> lock(mutex_);
    words_ = answer.words + "\nanswered in " + std::to_string(took.count()) + " ms";
    fraction_is_one_ = answer.fraction == 1;
    return true;
  }
  bool why(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    const std::lock_guard<std::mutex> lock(mutex_);
    response.success = fraction_is_one_;
    response.message = words_;
    return true;
  }

  /// Returns what asks TF where frames are in the model's frame, at their latest time.
  PathService::Transform transform() {
    return [this](const std::string& from, Pose7& pose) {
      try {
        const auto at = buffer_.lookupTransform(service_.frame(), from, ros::Time(0)).transform;
        swivel::ros::place(at, pose);
        return true;
      } catch (const tf2::TransformException& error) {
        ROS_WARN("%s", error.what());
        return false;
      }
    };
  }

  ros::NodeHandle node_, own_{"~"};
  PathService service_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> offered_;
  std::mutex mutex_;  // of the last answer's words
  std::string words_ = "no path was asked for yet";
  bool fraction_is_one_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "swivel", ros::init_options::NoSigintHandler);
  std::signal(SIGINT, interrupt);
  std::signal(SIGTERM, interrupt);
  try {
    Node node;
    ros::PollManager::instance()->addPollThreadListener(go_last);
    ros::AsyncSpinner spinner(4);
    spinner.start();
    ROS_INFO("compute_cartesian_path is offered");
    while (!interrupted && ros::ok()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    node.stop();                               // plans end, so that their callbacks do
    ros::getGlobalCallbackQueue()->disable();  // threads that wait for the next one look up
    spinner.stop();
    ros::shutdown();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 2;
  }
  return 0;
}
