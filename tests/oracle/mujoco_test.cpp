// SPDX-License-Identifier: BSD-3-Clause
// Executes timed motions in the simulator MuJoCo, which reads the same URDF with a reader, a
// kinematics and a dynamics of its own. Joints are moved by position servos with the torques of
// inverse dynamics fed forward, as controllers of arms do. A motion that no controller could follow
// leaves its reference: that is shown on motions that were spoilt on purpose.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "robots.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/refine/motion.hpp"

namespace swivel::test {
namespace {

constexpr double kStep = 0.0005;       // s, of the simulation
constexpr double kStiffness = 20'000;  // Nm/rad, of the servos
constexpr double kRotor = 0.5;         // kg m^2, inertia of motor and gear as the joint sees it

/// A robot in the simulator: its URDF's links, joints and shapes. Masses are those of the shapes at
/// the density of water, since the URDFs of the data folder state none. Bodies do not touch.
class SimulatedRobot {
 public:
  explicit SimulatedRobot(const RobotModel& robot) {
    const std::string file =
        ::testing::TempDir() + "swivel_mujoco_" + std::to_string(getpid()) + ".urdf";
    std::ofstream(file) << urdf_for_mujoco(robot.source);
    std::array<char, 1000> error{};
    model_.reset(mj_loadXML(file.c_str(), nullptr, error.data(), error.size()));
    std::filesystem::remove(file);
    if (!model_) throw std::runtime_error(robot.source + ": " + error.data());
    model_->opt.timestep = kStep;
    model_->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT;
    for (int k = 0; k < model_->nv; ++k) {
      model_->dof_armature[k] = kRotor;
      model_->dof_damping[k] = 2 * std::sqrt(kStiffness * kRotor);  // critical
    }
  }
  [[nodiscard]] const mjModel* model() const { return model_.get(); }
  /// Returns the number of a joint; -1 where the robot has none of that name, which a roll has not.
  [[nodiscard]] int joint(const std::string& name) const {
    return mj_name2id(model_.get(), mjOBJ_JOINT, name.c_str());
  }
  [[nodiscard]] int body(const std::string& link) const {
    return mj_name2id(model_.get(), mjOBJ_BODY, link.c_str());
  }

 private:
  struct Free {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
  };
  /// Returns a URDF with the simulator's own settings: links stay bodies of their own, and those
  /// without a shape have a small mass.
  static std::string urdf_for_mujoco(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    std::string urdf = text.str();
    const std::size_t robot = urdf.find("<robot"), behind = urdf.find('>', robot) + 1;
    urdf.insert(behind,
                "<mujoco><compiler fusestatic=\"false\" discardvisual=\"true\" strippath=\"false\" "
                "inertiafromgeom=\"true\" balanceinertia=\"true\" boundmass=\"0.01\" "
                "boundinertia=\"0.0001\"/></mujoco>");
    return urdf;
  }

  std::unique_ptr<mjModel, Free> model_;
};

/// The state of a robot in the simulator.
class State {
 public:
  explicit State(const SimulatedRobot& robot) : data_(mj_makeData(robot.model())) {}
  mjData* operator->() { return data_.get(); }
  mjData* get() { return data_.get(); }

 private:
  struct Free {
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjData, Free> data_;
};

/// A motion as it was planned: what a controller is sent, and the arm.
struct Sent {
  PathProblem problem;
  ArmModel arm;
  std::vector<TimedRow> rows;
  double rate = 250;  // samples a second
};

Sent sent_motion(const std::string& name) {
  Sent sent;
  sent.problem =
      with_motion_defaults(io::load_path_problem(data_dir() / "problems" / (name + ".yaml")));
  Planner planner(sent.problem);
  TimingOptions timing{.speed = 1};  // m/s: more than the joints can do
  timing.rate = sent.rate;
  const MotionPlan plan = plan_motion(planner, {}, true, timing);
  if (!plan.motion || !plan.motion->motion) throw std::runtime_error(name + " has no motion");
  sent.rows = plan.motion->motion->rows;
  sent.arm = build_arm(*sent.problem.model, sent.problem.base_link, sent.problem.tip_link,
                       sent.problem.hold, sent.problem.tool, sent.problem.roll);
  return sent;
}

/// What was seen while the simulator executed a motion.
struct Executed {
  double off = 0;       ///< most distance of the tip link from where the reference puts it, m
  double torque = 0;    ///< most torque of a servo beside what is fed forward, Nm
  double speed = 0;     ///< most speed of a joint as a part of its limit
  double off_path = 0;  ///< most distance of a sample's tool from the tool path, m
  double off_ends = 0;  ///< of the first and last sample's tool and its z axis, m and rad
};

/// The reference of the joints at a time: samples of the motion, straight in between.
void set_reference(const SimulatedRobot& robot, const Sent& sent, double t, State& reference) {
  const double at = std::min(t * sent.rate, static_cast<double>(sent.rows.size() - 1));
  const std::size_t from = std::min(static_cast<std::size_t>(at), sent.rows.size() - 2);
  const TimedRow &a = sent.rows[from], &b = sent.rows[from + 1];
  const double share = at - static_cast<double>(from);
  const auto between = [&](const Config& x, const Config& y, int j) {
    return x[j] + share * (y[j] - x[j]);
  };
  for (int j = 0; j < kDof; ++j) {
    const int joint = robot.joint(sent.arm.chain.joint_names[static_cast<std::size_t>(j)]);
    if (joint < 0) continue;
    reference->qpos[robot.model()->jnt_qposadr[joint]] = between(a.row.q, b.row.q, j);
    reference->qvel[robot.model()->jnt_dofadr[joint]] = between(a.v, b.v, j);
    reference->qacc[robot.model()->jnt_dofadr[joint]] = between(a.a, b.a, j);
  }
}

Vector3d position(State& state, int body) {
  return Eigen::Map<const Vector3d>(state->xpos + 3 * body);
}
Pose pose(State& state, int body) {
  Pose out = Pose::Identity();
  out.translation() = position(state, body);
  out.linear() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(state->xmat + 9 * body);
  return out;
}

/// Returns the distance of a point from the straight lines between neighbouring layers of a path,
/// m.
double distance_from(const ToolPath& path, const Vector3d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i + 1 < path.size(); ++i) {
    const Vector3d from = path.layer(i).tool.translation();
    const Vector3d step = path.layer(i + 1).tool.translation() - from;
    const double along = step.dot(point - from) / std::max(step.squaredNorm(), 1e-18);
    least = std::min(least, (from + std::clamp(along, 0.0, 1.0) * step - point).norm());
  }
  return least;
}

/// Notes how far the tool is from its path in the samples of a motion, and from the path's first
/// and last pose at its ends, by the simulator's kinematics.
void note_path(const SimulatedRobot& robot, const Sent& sent, State& state, Executed& executed) {
  const ToolPath path = problem_path(sent.problem, sent.arm.chain);
  const int base = robot.body(sent.problem.base_link), tip = robot.body(sent.problem.tip_link);
  for (std::size_t k = 0; k < sent.rows.size(); ++k) {
    set_reference(robot, sent, static_cast<double>(k) / sent.rate, state);
    mj_kinematics(robot.model(), state.get());
    const Pose tool = pose(state, base).inverse() * pose(state, tip) * sent.problem.tool;
    executed.off_path = std::max(executed.off_path, distance_from(path, tool.translation()));
    if (k > 0 && k + 1 < sent.rows.size()) continue;
    const Pose& asked = path.layer(k == 0 ? 0 : path.size() - 1).tool;
    executed.off_ends =
        std::max({executed.off_ends, (tool.translation() - asked.translation()).norm(),
                  (tool.linear().col(2) - asked.linear().col(2)).norm()});
  }
}

/// Executes a motion from rest in its first sample until its end.
Executed execute(const Sent& sent) {
  const SimulatedRobot robot(*sent.problem.model);
  State real(robot), reference(robot);
  for (const HeldJoint& held : sent.arm.held) {
    const int at = robot.model()->jnt_qposadr[robot.joint(held.name)];
    reference->qpos[at] = held.position;
  }
  Executed executed;
  note_path(robot, sent, reference, executed);
  set_reference(robot, sent, 0, reference);
  const int joints = robot.model()->nv, tip = robot.body(sent.problem.tip_link);
  std::copy_n(reference->qpos, joints, real->qpos);
  const double end = static_cast<double>(sent.rows.size() - 1) / sent.rate;
  for (double t = 0; t < end; t = real->time) {
    set_reference(robot, sent, t, reference);
    mj_inverse(robot.model(), reference.get());
    for (int k = 0; k < joints; ++k) {
      const double servo = kStiffness * (reference->qpos[k] - real->qpos[k]);
      real->qfrc_applied[k] = reference->qfrc_inverse[k] + servo;
    }
    mj_step(robot.model(), real.get());
    set_reference(robot, sent, real->time, reference);
    mj_kinematics(robot.model(), reference.get());
    mj_kinematics(robot.model(), real.get());
    executed.off = std::max(executed.off, (position(real, tip) - position(reference, tip)).norm());
    for (int k = 0; k < joints; ++k)
      executed.torque =
          std::max(executed.torque, kStiffness * std::abs(reference->qpos[k] - real->qpos[k]));
    for (std::size_t j = 0; j < kDof; ++j) {
      const JointLimit& limit = sent.arm.chain.limit[j];
      const int joint = robot.joint(sent.arm.chain.joint_names[j]);
      if (joint < 0 || limit.velocity <= 0) continue;
      const double speed = std::abs(real->qvel[robot.model()->jnt_dofadr[joint]]);
      executed.speed = std::max(executed.speed, speed / limit.velocity);
    }
  }
  return executed;
}

/// A motion in which one sample of joint 4 is off by 2 mrad: the jump that a wrong solution makes.
Sent with_a_jump(Sent sent) {
  sent.rows[sent.rows.size() / 2].row.q[3] += 0.002;
  return sent;
}
/// A motion in which joint 2 shakes by 1 mrad, 12 samples a period.
Sent with_a_shake(Sent sent) {
  for (std::size_t k = 0; k < sent.rows.size(); ++k) {
    const double phase = static_cast<double>(k % 12) / 12;
    sent.rows[k].row.q[1] += 0.001 * (1 - 4 * std::abs(phase - 0.5));
  }
  return sent;
}

class MuJoCo : public ::testing::TestWithParam<const char*> {};

TEST_P(MuJoCo, ExecutesTheMotionAndSeesWhatIsSpoilt) {
  const Sent sent = sent_motion(GetParam());
  const Executed good = execute(sent), jump = execute(with_a_jump(sent)),
                 shake = execute(with_a_shake(sent));
  std::printf(
      "%s: %zu samples, on the path to %.1e m, tip off by %.4f mm, servo %.2f Nm, speed %.3f of "
      "the limit; "
      "spoilt by a jump %.3f mm, by a shake %.3f mm\n",
      GetParam(), sent.rows.size(), good.off_path, 1e3 * good.off, good.torque, good.speed,
      1e3 * jump.off, 1e3 * shake.off);
  EXPECT_LE(good.off_ends, 1e-9);
  EXPECT_LE(good.off_path, PathSmoothing{}.position);
  EXPECT_LE(good.off, 0.05e-3);  // 0.009 to 0.015 mm were seen
  EXPECT_LE(good.torque, 2);
  EXPECT_LE(good.speed, 1.001);
  EXPECT_GE(jump.off, 10 * good.off);
  EXPECT_GE(shake.off, 10 * good.off);
}

INSTANTIATE_TEST_SUITE_P(Problems, MuJoCo,
                         ::testing::Values("iiwa14_bench", "experiment_c", "panda_weld_seam",
                                           "xarm7_polish_raster", "torch_door"),
                         [](const auto& problem) { return std::string(problem.param); });

}  // namespace
}  // namespace swivel::test
