// SPDX-License-Identifier: BSD-3-Clause
// A stranger's program: everything made in memory, planned, changed, planned again, cancelled,
// judged by a check of its own.
#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <swivel/planner/measure/measure.hpp>
#include <swivel/planner/plan/planner.hpp>
#include <swivel/planner/verify/check.hpp>
#include <thread>

using swivel::Vector3d;

namespace {

/// z-y-z shoulder, elbow, z-y-z wrist; two capsules.
std::shared_ptr<const swivel::RobotModel> make_arm() {
  constexpr double kOffset[] = {0.14, 0.20, 0.20, 0.20,
                                0.20, 0.20, 0.08, 0.05};  // m, from frame to frame
  auto arm = std::make_shared<swivel::RobotModel>();
  arm->links.emplace_back().name = "base";
  for (int k = 0; k < 8; ++k) {
    swivel::Joint& joint = arm->joints.emplace_back();
    joint.name = "joint_" + std::to_string(k + 1);
    joint.parent_link = k, joint.child_link = k + 1;
    joint.origin.translation().z() = kOffset[k];
    if (k < 7) {  // the last one is fixed
      joint.type = swivel::Joint::Type::kRevolute;
      joint.axis = k % 2 == 0 ? Vector3d::UnitZ() : Vector3d::UnitY();
      joint.lower = -2.9, joint.upper = 2.9, joint.velocity = 2;
    }
    swivel::Link& link = arm->links.emplace_back();
    link.name = k < 7 ? "link_" + std::to_string(k + 1) : "tool";
    link.parent_joint = k;
    if (k == 2 || k == 4)
      link.collision = {{.shape = swivel::Capsule{.radius = 0.05, .length = 0.36}}};
  }
  arm->has_srdf = true;
  arm->disabled_pairs = {{"link_3", "link_5"}};  // they meet at the elbow
  return arm;
}

/// Joint 2 may turn so far and no further.
class Shoulder : public swivel::StateCheck {
 public:
  explicit Shoulder(double most) : most_(most) {}
  [[nodiscard]] std::string name() const override { return "shoulder"; }
  void states(std::span<const swivel::Config> states, std::span<bool> allowed) override {
    for (std::size_t k = 0; k < states.size(); ++k) allowed[k] = std::abs(states[k][1]) <= most_;
  }

 private:
  double most_;
};

int failures = 0;
void expect(bool holds, const char* what) {
  std::cout << (holds ? "yes: " : "NO: ") << what << '\n';
  failures += !holds;
}

swivel::Pose at(double x, double y, double z) {
  return swivel::Pose(Eigen::Translation3d(x, y, z));
}

}  // namespace

int main() {
  swivel::Robot robot;
  robot.model = make_arm();
  robot.base_link = "base", robot.tip_link = "tool";
  swivel::Task task;
  const swivel::Quaterniond down(0, 1, 0, 0);  // w, x, y, z
  task.waypoints = {{{0.5, -0.3, 0.4}, down}, {{0.5, 0.3, 0.4}, down}};
  task.limits.clearance = 0.02;

  swivel::Planner planner(robot);
  planner.add({"box", swivel::Box{{0.1, 0.1, 0.1}}, at(0.2, 0.1, 0.75)});
  planner.set_task(task);
  const swivel::PlanResult first = planner.plan();
  expect(first.status == swivel::PlanStatus::kSolved, "a path past a box");
  expect(swivel::check_trajectory(planner.prepare(), planner.problem(), first.trajectory).passed,
         "which passes the check");
  const swivel::Measures measures =
      swivel::measure(planner.prepare(), planner.problem(), first.trajectory);
  expect(measures.min_clearance && *measures.min_clearance >= 0.02, "and keeps its clearance");

  planner.move("box", at(0.5, 0.0, 0.53));  // where the wrist must pass
  const swivel::PlanResult barred = planner.plan();
  expect(barred.status == swivel::PlanStatus::kInfeasible, "no path through the box");
  const swivel::Cause& cause = barred.diagnosis->cause;
  expect(cause.kind == swivel::Cause::Kind::kPair || cause.kind == swivel::Cause::Kind::kContact,
         "because two bodies are in the way");
  expect(cause.bodies[0] == "box" || cause.bodies[1] == "box", "one of which is the box");
  expect(!barred.partial.empty() && barred.partial.size() < first.trajectory.size(),
         "a part of the way is known");

  planner.move("box", at(0.2, 0.1, 0.75));
  const swivel::PlanResult again = planner.plan();
  expect(again.cost == first.cost && again.trajectory.size() == first.trajectory.size(),
         "back again: the first answer");
  swivel::Planner clone = planner.clone();
  expect(clone.plan().cost == first.cost, "a clone gives it, too");

  swivel::PlanOptions options;
  options.hooks.check = std::make_shared<Shoulder>(0.01);
  const swivel::PlanResult refused = planner.plan(options);
  expect(refused.status == swivel::PlanStatus::kInfeasible &&
             words(refused.diagnosis->cause).find("shoulder") != std::string::npos,
         "a check of one's own refuses, and is named");

  task.resolution = {.ds = 0.0002, .dphi = 0.0002};  // so fine that an answer takes minutes
  planner.set_task(task);
  std::stop_source cancel;
  swivel::PlanOptions patient;
  patient.stop = cancel.get_token();
  std::jthread user([&cancel] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    cancel.request_stop();
  });
  expect(planner.plan(patient).status == swivel::PlanStatus::kCancelled, "another thread cancels");
  return failures;
}
