// SPDX-License-Identifier: BSD-3-Clause
#include "swivel/planner/refine/cartesian_path.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/answer/answer_text.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/core/lattice/scale.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/core/messages/invalid_argument.hpp"
#include "swivel/core/timing/time_path.hpp"
#include "swivel/planner/refine/motion.hpp"
#include "swivel/planner/robot/motion_defaults.hpp"
#include "swivel/planner/robot/prepared_robot.hpp"

namespace swivel {

namespace {

/// The tool is asked for this speed where only the joints bound it, m/s: more than arms reach.
constexpr double kAsFastAsJointsAllow = 20;

/// Narrows the limits of a joint to a band. Throws InvalidArgument if nothing is left.
void narrow_to_band(Joint& joint, const Joint::Range& band) {
  const bool bounded = joint.type != Joint::Type::kContinuous;
  const double lower = bounded ? std::max(joint.lower, band.lower) : band.lower,
               upper = bounded ? std::min(joint.upper, band.upper) : band.upper;
  if (!joint.movable() || !(lower <= upper) || !std::isfinite(lower) || !std::isfinite(upper))
    throw InvalidArgument("bands: joint '" + joint.name + "' has no position from " +
                          formatted("%.9g to %.9g", band.lower, band.upper) +
                          ": allowed are ranges that meet the limits of a joint that moves");
  joint.lower = lower;
  joint.upper = upper;
  if (!bounded) joint.type = Joint::Type::kRevolute;
}

void require_scale(double scale, const char* name) {
  if (!(scale > 0 && scale <= 1))
    throw InvalidArgument(std::string(name) + " is " + formatted("%.9g", scale) +
                          ": allowed are numbers above 0, at most 1");
}

bool same_pose(const Waypoint& a, const Waypoint& b) {
  constexpr double kPosition = 1e-6, kCosine = 5e-13;  // m; 2e-6 rad
  const double length = a.orientation.norm() * b.orientation.norm();
  return (a.position - b.position).cwiseAbs().maxCoeff() < kPosition &&
         length - std::abs(a.orientation.dot(b.orientation)) < kCosine;
}

/// Returns the waypoints with the pose of the tool at the start before them, once.
std::vector<Waypoint> from_start(const Chain& chain, const Config& start,
                                 const std::vector<Waypoint>& waypoints) {
  const Pose tool = chain.tool(start);
  Waypoint first{tool.translation(), Quaterniond(tool.linear()), {}};
  if (!waypoints.empty()) first.roll = waypoints.front().roll;
  std::vector<Waypoint> all{first};
  const bool repeated = !waypoints.empty() && same_pose(first, waypoints.front());
  all.insert(all.end(), waypoints.begin() + (repeated ? 1 : 0), waypoints.end());
  return all;
}

/// Sets the rates of the limits to parts of those that the joints have.
void scale_rates(const Chain& chain, const CartesianPathOptions& options, Limits& limits) {
  const JointRates rates = joint_rates(chain, limits, "");
  const auto scaled = [&](const Config& rate, double scale) {
    std::array<double, kDof> values{};
    for (std::size_t j = 0; j < kDof; ++j) {
      const double value = rate[static_cast<Eigen::Index>(j)];
      values[j] = std::isfinite(value) ? scale * value : 1;  // a roll has no rate that counts
    }
    return values;
  };
  if (options.speed_scale != 1) limits.joint_speed = scaled(rates.speed, options.speed_scale);
  if (options.acceleration_scale != 1)
    limits.joint_acceleration = scaled(rates.acceleration, options.acceleration_scale);
}

/// Returns the problem's path up to a layer, as waypoints, with all else unchanged.
Task path_up_to(const PathProblem& problem, const Chain& chain, int last, const Budget& budget) {
  PathProblem straight = problem;
  straight.smooth.reset();
  const ToolPath path = problem_path(straight, chain, budget);
  Task part = problem;
  part.waypoints.clear();
  const bool windows = problem.waypoints.front().roll.has_value();
  for (int i = 0; i <= last; ++i) {
    const PathLayer& layer = path.layer(i);
    if (i > 0 && i < last && layer.waypoint < 0) continue;
    const Pose own = rolled(layer.tool, path.waypoint_turn(layer.travel));
    Waypoint waypoint{own.translation(), Quaterniond(own.linear()), {}};
    if (windows) waypoint.roll = layer.window;
    part.waypoints.push_back(waypoint);
  }
  return part;
}

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

/// Follows one path, on a planner of its robot and scene.
class Follower {
 public:
  Follower(Planner& planner, const CartesianPathOptions& options)
      : planner_(planner),
        options_(options),
        budget_(options.plan.budget()),
        timed_(options.timed) {
    require_scale(options.speed_scale, "speed_scale");
    require_scale(options.acceleration_scale, "acceleration_scale");
  }

  CartesianPath run(const std::vector<Waypoint>& waypoints, const std::optional<Config>& start) {
    try {
      set_task(waypoints, start);
      follow();
    } catch (const Stopped&) {
      path_.cause = std::string("stopped: ") + (budget_.cancelled() ? "cancelled" : "timeout");
      path_.plan.status = budget_.cancelled() ? PlanStatus::kCancelled : PlanStatus::kTimeout;
    }
    return std::move(path_);
  }

 private:
  void set_task(const std::vector<Waypoint>& waypoints, const std::optional<Config>& start) {
    Task task;
    task.limits = options_.limits;
    task.resolution.ds = options_.max_step;
    task.start = start;
    const Chain& chain = planner_.prepare(budget_).arm().chain;
    task.waypoints = start ? from_start(chain, *start, waypoints) : waypoints;
    if (timed_) {
      try {
        scale_rates(chain, options_, task.limits);
        PathProblem with_defaults;
        static_cast<Task&>(with_defaults) = task;
        task = with_motion_defaults(std::move(with_defaults));
      } catch (const InputError& error) {  // a joint without a speed limit
        no_motion(error.what());
        timed_ = false;
      }
    }
    planner_.set_task(task);
  }

  void follow() {
    plan(path_.plan, path_.motion);
    path_.problem = planner_.problem();
    if (path_.plan.status == PlanStatus::kSolved) {
      path_.fraction = 1;
      path_.rows = path_.plan.trajectory;
      return;
    }
    path_.cause =
        one_line(answer_text(path_.plan)) + (path_.cause.empty() ? "" : "; ") + path_.cause;
    path_.rows = path_.plan.partial;
    if (path_.rows.empty()) return;
    const Chain& chain = planner_.prepare(budget_).arm().chain;
    const int layers = problem_path(path_.problem, chain).size();
    // What was not decided is not reached, even where all rows are known.
    path_.rows.resize(std::min(path_.rows.size(), static_cast<std::size_t>(layers) - 1));
    const int last = static_cast<int>(path_.rows.size()) - 1;
    path_.fraction = static_cast<double>(last) / (layers - 1);
    if (last == 0) return;
    const PathProblem whole = std::move(path_.problem);
    const auto end_at = [&](int row) {
      planner_.set_task(path_up_to(whole, chain, row, budget_));
      path_.problem = planner_.problem();
    };
    end_at(last);
    if (!timed_) return;
    // Rounded corners are other ones where the path ends beside them, so that the last rows may not
    // be reached on a path of their own.
    PlanResult part;
    int row = last;
    for (int back = 1;; back *= 2) {
      plan(part, path_.motion);
      if (part.status != PlanStatus::kInfeasible || row == 1) break;
      row = std::max(1, last - back);
      end_at(row);
    }
    if (part.status == PlanStatus::kSolved) {
      path_.rows = std::move(part.trajectory);
      path_.fraction = static_cast<double>(row) / (layers - 1);
    } else {
      end_at(last);
      no_motion(one_line(answer_text(part)));
    }
  }

  /// Plans the planner's problem, and makes a motion of it if the options ask for one.
  void plan(PlanResult& result, std::optional<TimedPath>& motion) {
    PlanOptions options = options_.plan;
    if (options.timeout_s) {
      constexpr double kLeast = 1e-9;  // s
      const std::chrono::duration<double> used = std::chrono::steady_clock::now() - begin_;
      options.timeout_s = std::max(kLeast, *options.timeout_s - used.count());
    }
    if (!timed_) {
      result = planner_.plan(options);
      return;
    }
    TimingOptions timing;
    timing.speed = std::min(options_.tool_speed.value_or(kAsFastAsJointsAllow),
                            most_tool_speed(planner_.prepare(budget_).arm().chain));
    timing.rate = options_.rate;
    MotionPlan found = plan_motion(planner_, options, true, timing);
    result = std::move(found.result);
    if (!found.motion) return;
    if (found.motion->motion) motion = std::move(found.motion->motion);
    if (motion) return;
    const NoMotion& why = *found.motion->failure;
    no_motion(formatted("at s = %.4f m: ", why.s) + why.reason);
  }

  void no_motion(const std::string& why) {
    path_.cause += (path_.cause.empty() ? "" : "; ") + ("no motion in time: " + why);
  }

  Planner& planner_;
  const CartesianPathOptions& options_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  const Budget budget_;
  bool timed_ = false;
  CartesianPath path_;
};

}  // namespace

Robot cartesian_robot(Robot robot, const CartesianPathOptions& options) {
  if (!robot.model)
    throw InvalidArgument("model: is null: allowed is a robot model, as io::load_robot gives it");
  if (options.avoid_collisions && options.bands.empty()) return robot;
  auto model = std::make_shared<RobotModel>(*robot.model);
  for (const auto& [name, band] : options.bands) {
    const int joint = model->find_joint(name);
    if (joint < 0)
      throw InvalidArgument("bands: unknown joint '" + name + "': allowed are joints of the robot");
    narrow_to_band(model->joints[static_cast<std::size_t>(joint)], band);
  }
  if (!options.avoid_collisions) {
    for (Link& link : model->links) link.collision.clear();
    robot.attached.clear();
  }
  robot.model = std::move(model);
  return robot;
}

CartesianPath compute_cartesian_path(Planner& planner, const std::vector<Waypoint>& waypoints,
                                     const std::optional<Config>& start,
                                     const CartesianPathOptions& options) {
  return Follower(planner, options).run(waypoints, start);
}

CartesianPath compute_cartesian_path(const Robot& robot, const std::vector<SceneObject>& scene,
                                     const std::vector<Waypoint>& waypoints,
                                     const std::optional<Config>& start,
                                     const CartesianPathOptions& options) {
  Planner planner(cartesian_robot(robot, options));
  if (options.avoid_collisions) planner.set_scene(scene);
  return compute_cartesian_path(planner, waypoints, start, options);
}

}  // namespace swivel
