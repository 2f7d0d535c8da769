// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/ros/path_service.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <stop_token>

#include "robot_state.hpp"
#include "scene.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/io/robots/robot.hpp"
#include "swivel/planner/refine/cartesian_path.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel::ros {

namespace {

/// Ends a request with a code and words.
struct Refusal {
  int code = kFailure;
  std::string words;
};

/// A robot that was prepared for requests that are alike.
struct Ready {
  std::string key;
  Robot robot;
  std::shared_ptr<const PreparedRobot> prepared;  // shared with the planners of requests
};

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

Waypoint to_waypoint(const Pose7& pose) {
  return {{pose.x, pose.y, pose.z}, Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz), {}};
}

}  // namespace

struct PathService::Impl {
  std::shared_ptr<const RobotModel> model;  // as Robot holds it
  std::vector<io::PlanningGroup> groups;
  Settings settings;
  std::string frame;
  mutable std::mutex mutex;  // of all below
  RobotState state;
  Scene scene;
  std::string unchecked;
  std::deque<Ready> ready;  // lately used last
  std::stop_source stopped;

  Impl(const std::string& urdf, const std::string& srdf, const Settings& given)
      : model(io::parse_robot(urdf, srdf)),
        groups(io::planning_groups(srdf, *model)),
        settings(given),
        frame(model->links[static_cast<std::size_t>(model->root_link)].name),
        state(*model) {}

  /// Returns the robot of a key, prepared by make() unless a request before was alike.
  template <class Make>
  Ready robot_of(const std::string& key, const Make& make) {
    constexpr std::size_t kMost = 8;
    {
      const std::lock_guard lock(mutex);
      for (auto one = ready.begin(); one != ready.end(); ++one) {
        if (one->key != key) continue;
        Ready found = std::move(*one);
        ready.erase(one);
        ready.push_back(found);
        return found;
      }
    }
    Ready made = make();
    const std::lock_guard lock(mutex);
    ready.push_back(made);
    if (ready.size() > kMost) ready.pop_front();
    return made;
  }
};

namespace {

/// Answers one request. It works on copies of state and scene.
template <class Service>
class Request {
 public:
  Request(Service& service, const Query& query, const PathService::Transform& transform,
          Answer& answer)
      : service_(service),
        model_(*service.model),
        query_(query),
        transform_(transform),
        answer_(answer),
        now_(model_),
        start_(model_) {
    const std::lock_guard lock(service_.mutex);
    now_ = start_ = service_.state;
    scene_ = service_.scene;
    unchecked_ = service_.unchecked;
    stop_ = service_.stopped.get_token();
  }

  void run() {
    take_start();
    choose_group();
    choose_link();
    std::vector<Pose7> waypoints = query_.waypoints;
    const bool in_link = slashless(query_.frame) == link_;
    for (Pose7& waypoint : waypoints)
      if (!in_link && !to_model_frame(query_.frame, waypoint, model_, now_, transform_))
        throw Refusal{kFrameTransformFailure, "the frame '" + query_.frame + "' is not known"};
    if (!(query_.max_step >= std::numeric_limits<double>::epsilon()))
      throw Refusal{kFailure, "max_step must be above 0"};
    refuse_what_is_not_supported();
    answer_.frame = service_.frame;
    answer_.start = start_.values();
    answer_.joints = group_->joints;
    answer_.code = kSuccess;
    if (waypoints.empty()) {
      answer_.words = "no waypoints";
      return;
    }
    follow(waypoints, in_link);
  }

 private:
  static std::string slashless(const std::string& frame) {
    return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
  }
  [[nodiscard]] const Joint& joint(int k) const {
    return model_.joints[static_cast<std::size_t>(k)];
  }
  void note(const std::string& text) { notes_ += '\n' + text; }

  /// Applies the request's start state to where the robot is. One that is empty and no diff says
  /// nothing.
  void take_start() {
    const bool empty = query_.start.names.empty() && query_.attached.empty();
    if (empty && !query_.start_is_diff) return;
    try {
      if (const std::string unknown = start_.set(query_.start); !unknown.empty())
        throw Refusal{kInvalidRobotState, "start_state: the robot has no joint '" + unknown + "'"};
    } catch (const std::invalid_argument& error) {
      throw Refusal{kInvalidRobotState, std::string("start_state: ") + error.what()};
    }
    if (!query_.start_is_diff) scene_.clear_attached();
    for (const Body& body : query_.attached)
      if (const std::string fault = scene_.apply(body, model_, start_, transform_); !fault.empty())
        throw Refusal{kInvalidRobotState, "start_state: " + fault};
  }

  void choose_group() {
    std::vector<std::string> names;
    for (const io::PlanningGroup& group : service_.groups) {
      if (group.name == query_.group) group_ = &group;
      names.push_back(group.name);
    }
    if (!group_)
      throw Refusal{kInvalidGroupName, "group_name '" + query_.group +
                                           "' is not a group of the SRDF: allowed are " +
                                           list_of(names)};
  }

  /// Finds the link that follows the path, and the joints that move it there.
  void choose_link() {
    link_ = query_.link.empty() ? group_->tip_link : query_.link;
    const int link = model_.find_link(link_);
    if (link_.empty())
      throw Refusal{kFailure, "group '" + group_->name +
                                  "' is no chain: allowed are chains, or a "
                                  "link_name that all its joints move"};
    if (link < 0)
      throw Refusal{kInvalidLinkName, "link_name '" + link_ + "' is not a link of the robot"};
    const std::set<std::string> of_group(group_->joints.begin(), group_->joints.end());
    std::size_t moved = 0;
    for (int k = model_.links[static_cast<std::size_t>(link)].parent_joint; k >= 0;
         k = model_.links[static_cast<std::size_t>(joint(k).parent_link)].parent_joint) {
      if (!of_group.contains(joint(k).name)) continue;
      ++moved;
      if (!joint(k).mimic && chain_.size() < kDof) chain_.push_back(k);
    }
    std::reverse(chain_.begin(), chain_.end());
    if (moved < of_group.size())
      throw Refusal{kInvalidLinkName, "link_name '" + link_ + "' is not moved by all joints of '" +
                                          group_->name + "'"};
    if (chain_.size() + 1 < kDof)
      throw Refusal{kFailure, "group '" + group_->name + "' has " + std::to_string(chain_.size()) +
                                  " joints: allowed are six or seven"};
    for (const int k : chain_)
      if (!start_.known(k))
        throw Refusal{kRobotStateStale, "where joint '" + joint(k).name +
                                            "' is, neither joint states nor start_state say"};
  }

  void refuse_what_is_not_supported() {
    if (!query_.unsupported.empty())
      throw Refusal{kFailure, "not supported: " + list_of(query_.unsupported)};
    if (query_.tool_speed > 0 && !query_.speed_link.empty() && query_.speed_link != link_)
      throw Refusal{kFailure, "cartesian_speed_limited_link '" + query_.speed_link +
                                  "': allowed is the link that follows the path, '" + link_ + "'"};
    if (query_.avoid_collisions && !unchecked_.empty())
      throw Refusal{kCollisionCheckingUnavailable,
                    "the scene has " + unchecked_ + ", which is not checked for collisions"};
  }

  /// Returns where the chain begins. A joint that is beyond its limit by no more than a reading may
  /// be wrong begins at the limit. Sets `stuck_` where one is further beyond.
  Config start_of_chain() {
    constexpr double kReading = 1e-3;  // rad
    Config start = Config::Zero();
    for (std::size_t j = 0; j < chain_.size(); ++j) {
      const Joint& one = joint(chain_[j]);
      const double at = start_.position(chain_[j]), inside = within_limits(one, at);
      start[static_cast<Eigen::Index>(j)] = inside;
      if (at == inside) continue;
      const std::string where =
          formatted("%.6g rad, limits %.6g to %.6g", at, one.lower, one.upper);
      if (std::abs(at - inside) <= kReading)
        note("joint '" + one.name + "' begins at its limit (" + where + ")");
      else if (stuck_.empty())
        stuck_ = "joint '" + one.name + "' begins beyond its limits (" + where + ")";
    }
    return start;
  }

  /// Returns the options of the plan. Sets `stuck_` where the start is outside of a band.
  CartesianPathOptions options_of() {
    CartesianPathOptions options;
    options.max_step = query_.max_step;
    options.limits.clearance = service_.settings.clearance;
    if (query_.revolute_jump > 0) options.limits.joint_step = query_.revolute_jump;
    if (query_.jump_factor > 0) note("jump_threshold is ignored: every step of a joint is bounded");
    options.avoid_collisions = query_.avoid_collisions;
    if (!query_.avoid_collisions) note("collisions are not avoided, as asked for");
    for (const Query::JointBand& band : query_.bands) add_band(band, options);
    options.timed = true;
    if (query_.tool_speed > 0) options.tool_speed = query_.tool_speed;
    const auto scale = [](double one) { return one > 0 && one <= 1 ? one : 1; };
    options.speed_scale = scale(query_.speed_scale);
    options.acceleration_scale = scale(query_.acceleration_scale);
    options.rate = service_.settings.rate;
    options.plan.timeout_s = service_.settings.deadline_s;
    options.plan.stop = stop_;
    return options;
  }

  void add_band(const Query::JointBand& band, CartesianPathOptions& options) {
    const int index = model_.find_joint(band.joint);
    if (index < 0 || !joint(index).movable() || joint(index).mimic)
      throw Refusal{kFailure, "path_constraints: '" + band.joint + "' is no joint that moves"};
    double lower = band.position - band.below, upper = band.position + band.above;
    if (!(lower <= upper))
      throw Refusal{kFailure, "path_constraints: no position of '" + band.joint + "' is allowed"};
    const double at = start_.position(index);
    if (joint(index).type == Joint::Type::kContinuous) {
      if (upper - lower >= kTwoPi) return;
      const double turns = kTwoPi * std::ceil((lower - at) / kTwoPi - 1e-12);
      lower -= turns, upper -= turns;  // the turn in which the joint is, if it is allowed there
    }
    constexpr double kReading = 1e-9;
    if (!(at >= lower - kReading && at <= upper + kReading) && stuck_.empty())
      stuck_ = "joint '" + band.joint + "' begins outside of its path constraint";
    if (std::find(chain_.begin(), chain_.end(), index) == chain_.end()) return;  // it stays there
    const auto [entry, fresh] = options.bands.try_emplace(band.joint, Joint::Range{lower, upper});
    if (fresh) return;
    entry->second.lower = std::max(entry->second.lower, lower);
    entry->second.upper = std::min(entry->second.upper, upper);
  }

  /// Returns the robot of the request, with joints outside of the chain held where they are.
  Ready robot_of(const CartesianPathOptions& options) {
    Robot robot;
    robot.model = service_.model;
    robot.base_link = service_.frame;
    robot.tip_link = link_;
    if (const double roll = service_.settings.roll; chain_.size() < kDof && roll > 0)
      robot.roll = Roll{-roll, roll};
    std::string key = link_ + formatted("\n%d\n", options.avoid_collisions ? 1 : 0);
    for (std::size_t k = 0; k < model_.joints.size(); ++k) {
      const Joint& one = model_.joints[k];
      const int index = static_cast<int>(k);
      if (!one.movable() || one.mimic ||
          std::find(chain_.begin(), chain_.end(), index) != chain_.end())
        continue;
      robot.hold[one.name] = within_limits(one, start_.position(index));
      key += one.name + formatted("=%a\n", robot.hold[one.name]);
    }
    for (const auto& [name, band] : options.bands)
      key += name + formatted("=%a..%a\n", band.lower, band.upper);
    return service_.robot_of(key + scene_.key(), [&] {
      Ready made{key + scene_.key(), cartesian_robot(scene_.robot_with_bodies(robot), options), {}};
      PathProblem problem;
      static_cast<Robot&>(problem) = made.robot;
      made.prepared = std::make_shared<const PreparedRobot>(problem);
      return made;
    });
  }

  void follow(const std::vector<Pose7>& poses, bool in_link) {
    const Config start = start_of_chain();
    const CartesianPathOptions options = options_of();
    if (!stuck_.empty()) {
      answer_.words = stuck_ + notes_;
      return;
    }
    const Ready ready = robot_of(options);
    const Pose here = ready.prepared->arm().chain.tool(start);
    std::vector<Waypoint> waypoints;
    Pose before = here;
    bool moves = false;
    for (const Pose7& pose : poses) {
      Waypoint waypoint = to_waypoint(pose);
      if (in_link) {  // each is in the frame in which the one before leaves the link
        before = before * to_pose(pose);
        waypoint = {before.translation(), Quaterniond(before.linear()), {}};
      }
      moves = moves || !stays(here, waypoint);
      waypoints.push_back(std::move(waypoint));
    }
    if (!moves) {
      answer_.fraction = 1;
      answer_.words = "the waypoints are where the link is: nothing moves" + notes_;
      add_point(start, {}, {}, 0);
      return;
    }
    PathProblem problem;
    static_cast<Robot&>(problem) = ready.robot;
    if (options.avoid_collisions) problem.scene = scene_.objects(ready.robot);
    Planner planner(ready.prepared, std::move(problem));
    const auto begin = std::chrono::steady_clock::now();
    const CartesianPath path = compute_cartesian_path(planner, waypoints, start, options);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    answer_.plan_ms = took.count();
    take(path);
  }

  static bool stays(const Pose& here, const Waypoint& waypoint) {
    const Quaterniond turn(here.linear());
    return (here.translation() - waypoint.position).cwiseAbs().maxCoeff() < 1e-6 &&
           waypoint.orientation.norm() - std::abs(turn.dot(waypoint.orientation)) < 5e-13;
  }

  void take(const CartesianPath& path) {
    answer_.fraction = path.fraction;
    answer_.words = path.cause;
    if (path.fraction == 1)
      answer_.words = formatted("the whole path: %zu rows", path.rows.size()) +
                      (path.cause.empty() ? "" : "; " + path.cause);
    if (path.motion) {
      answer_.words +=
          formatted(path.fraction == 1 ? ", %.3f s" : "\nthe part that is reached takes %.3f s",
                    path.motion->duration);
      for (const TimedRow& row : path.motion->rows) add_point(row.row.q, row.v, row.a, row.t);
    } else {
      for (const TrajectoryRow& row : path.rows) add_point(row.q, {}, {}, 0);
    }
    answer_.words += notes_ + formatted("\nplanned in %.3f ms", answer_.plan_ms);
  }

  void add_point(const Config& q, const std::optional<Config>& v, const std::optional<Config>& a,
                 double time) {
    Point& point = answer_.points.emplace_back();
    point.time = time;
    for (const std::string& name : group_->joints) {
      const int index = model_.find_joint(name);
      const auto place = std::find(chain_.begin(), chain_.end(), index) - chain_.begin();
      const bool held = place == static_cast<std::ptrdiff_t>(chain_.size());
      point.positions.push_back(held ? start_.position(index) : q[place]);
      if (v) point.velocities.push_back(held ? 0 : (*v)[place]);
      if (a) point.accelerations.push_back(held ? 0 : (*a)[place]);
    }
  }

  Service& service_;
  const RobotModel& model_;
  const Query& query_;
  const PathService::Transform& transform_;
  Answer& answer_;
  RobotState now_, start_;
  Scene scene_;
  std::string unchecked_, link_, notes_, stuck_;
  std::stop_token stop_;
  const io::PlanningGroup* group_ = nullptr;
  std::vector<int> chain_;  // joints that are planned, base to tip
};

}  // namespace

PathService::PathService(const std::string& urdf, const std::string& srdf,
                         const Settings& settings) {
  if (!(settings.deadline_s > 0 && settings.clearance >= 0 && settings.rate > 0 &&
        settings.rate <= 1e5 && settings.roll >= 0 && std::isfinite(settings.roll)))
    throw std::runtime_error(
        "settings: allowed are a deadline and a rate above 0, a clearance and "
        "a roll of at least 0");
  impl_ = std::make_unique<Impl>(urdf, srdf, settings);
}
PathService::~PathService() = default;

const std::string& PathService::frame() const {
  return impl_->frame;
}

void PathService::state(const JointValues& joints) {
  const std::lock_guard lock(impl_->mutex);
  try {
    impl_->state.set(joints);
  } catch (const std::invalid_argument&) {  // a broken message says nothing
  }
}

std::vector<std::string> PathService::world(const std::vector<Body>& bodies, bool diff,
                                            const AllowedPairs& allowed,
                                            const Transform& transform) {
  const std::lock_guard lock(impl_->mutex);
  if (!diff) impl_->scene.clear();
  if (allowed.given) impl_->scene.allow(allowed);
  std::vector<std::string> faults;
  for (const Body& body : bodies)
    if (auto fault = impl_->scene.apply(body, *impl_->model, impl_->state, transform);
        !fault.empty())
      faults.push_back(std::move(fault));
  return faults;
}

void PathService::unchecked(const std::string& what) {
  const std::lock_guard lock(impl_->mutex);
  impl_->unchecked = what;
}

Answer PathService::answer(const Query& query, const Transform& transform) const {
  Answer answer;
  try {
    Request<Impl>(*impl_, query, transform, answer).run();
    return answer;
  } catch (const Refusal& refusal) {
    answer = {};
    answer.code = refusal.code;
    answer.words = refusal.words;
  } catch (const std::exception& error) {
    answer = {};
    answer.words = error.what();
  } catch (...) {
    answer = {};
    answer.words = "an error without a name";
  }
  return answer;
}

void PathService::stop() {
  impl_->stopped.request_stop();
}

}  // namespace swivel::ros
