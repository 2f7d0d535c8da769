// SPDX-License-Identifier: BSD-3-Clause
// Holds the kinematics of every problem of the data folder against those of KDL, which reads the
// same URDF with a reader of its own and shares no code with this project.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <map>
#include <string>
#include <vector>

#include "robots.hpp"
#include "swivel/core/kinematics/chain/arm.hpp"
#include "swivel/core/lattice/problem_path.hpp"
#include "swivel/io/io.hpp"
#include "swivel/planner/plan/planner.hpp"

namespace swivel::test {
namespace {

/// The problem files of the data folder with one arm and one path.
std::vector<std::filesystem::path> problem_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(data_dir() / "problems")) {
    const std::string name = entry.path().stem().string();
    if (!name.ends_with("_job") && !name.ends_with("_workcell")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The chain from base link to tip link as KDL has it, with all movable joints of the URDF between
/// the two, and the joints of Swivel's chain among them.
class KdlArm {
 public:
  explicit KdlArm(const PathProblem& problem)
      : arm_(build_arm(*problem.model, problem.base_link, problem.tip_link, problem.hold,
                       problem.tool, problem.roll)),
        tool_(problem.tool) {
    KDL::Tree tree;
    if (!kdl_parser::treeFromFile(problem.model->source, tree) ||
        !tree.getChain(problem.base_link, problem.tip_link, chain_))
      throw std::runtime_error("KDL does not read " + problem.model->source);
    std::map<std::string, double> held;
    for (const HeldJoint& joint : arm_.held) held[joint.name] = joint.position;
    for (const KDL::Segment& segment : chain_.segments) {
      if (segment.getJoint().getType() == KDL::Joint::Fixed) continue;
      const std::string& name = segment.getJoint().getName();
      const auto& names = arm_.chain.joint_names;
      const auto at = std::find(names.begin(), names.end(), name);
      of_.push_back(at == names.end() ? -1 : static_cast<int>(at - names.begin()));
      still_.push_back(at == names.end() ? held.at(name) : 0);
    }
  }
  [[nodiscard]] const Chain& chain() const { return arm_.chain; }
  /// Returns the number of the chain's joints that KDL has as well: all but the roll of the tool.
  [[nodiscard]] std::ptrdiff_t common_joints() const {
    return std::count_if(of_.begin(), of_.end(), [](int joint) { return joint >= 0; });
  }
  /// Returns the tool in the base frame at joints q, rad; `roll` is 0 for arms without one.
  [[nodiscard]] Pose tool(const Config& q) const {
    KDL::Frame tip;
    KDL::ChainFkSolverPos_recursive solver(chain_);
    EXPECT_EQ(0, solver.JntToCart(positions(q), tip));
    return pose(tip) * tool_;
  }
  /// Returns the Jacobian at the tool origin in the base frame: rows 0-2 linear, rows 3-5 angular,
  /// columns as those of Chain::jacobian(), zero for the roll.
  [[nodiscard]] Eigen::Matrix<double, 6, kDof> jacobian(const Config& q) const {
    KDL::Jacobian at_tip(chain_.getNrOfJoints());
    KDL::ChainJntToJacSolver solver(chain_);
    EXPECT_EQ(0, solver.JntToJac(positions(q), at_tip));
    KDL::Frame tip;
    KDL::ChainFkSolverPos_recursive(chain_).JntToCart(positions(q), tip);
    const Vector3d arm = tool(q).translation() - pose(tip).translation();
    at_tip.changeRefPoint(KDL::Vector(arm.x(), arm.y(), arm.z()));
    Eigen::Matrix<double, 6, kDof> columns = Eigen::Matrix<double, 6, kDof>::Zero();
    for (std::size_t k = 0; k < of_.size(); ++k)
      if (of_[k] >= 0) columns.col(of_[k]) = at_tip.data.col(static_cast<Eigen::Index>(k));
    return columns;
  }

 private:
  static Pose pose(const KDL::Frame& frame) {
    Pose out = Pose::Identity();
    for (int row = 0; row < 3; ++row) {
      out.translation()[row] = frame.p(row);
      for (int column = 0; column < 3; ++column) out.linear()(row, column) = frame.M(row, column);
    }
    return out;
  }
  [[nodiscard]] KDL::JntArray positions(const Config& q) const {
    KDL::JntArray out(static_cast<unsigned>(of_.size()));
    for (std::size_t k = 0; k < of_.size(); ++k)
      out(static_cast<unsigned>(k)) = of_[k] >= 0 ? q[of_[k]] : still_[k];
    return out;
  }

  ArmModel arm_;
  Pose tool_;
  KDL::Chain chain_;
  std::vector<int> of_;        // by joint of KDL's chain: joint of Swivel's, -1: held
  std::vector<double> still_;  // by joint of KDL's chain: where it is held, rad or m
};

/// Draws joints, rad, within a whole turn of zero; the roll of an arm of six joints is 0.
Config any_joints(const Chain& chain, Random& random) {
  Config q;
  for (int j = 0; j < kDof; ++j) q[j] = random.uniform(-kPi, kPi);
  if (chain.roll) q[kDof - 1] = 0;
  return q;
}

TEST(Kdl, HasTheSameToolPosesAndJacobians) {
  Random random(seed("Kdl.HasTheSameToolPosesAndJacobians"));
  int arms = 0, postures = 0;
  double apart = 0, turned = 0, column = 0;
  for (const auto& file : problem_files()) {
    const PathProblem problem = io::load_path_problem(file);
    const KdlArm kdl(problem);
    const Chain& chain = kdl.chain();
    ASSERT_EQ(chain.roll ? kDof - 1 : kDof, kdl.common_joints()) << file;
    for (int k = trials(1000); k > 0; --k, ++postures) {
      const Config q = any_joints(chain, random);
      const Pose ours = chain.tool(q), theirs = kdl.tool(q);
      apart = std::max(apart, (ours.translation() - theirs.translation()).norm());
      turned = std::max(turned, (ours.linear() - theirs.linear()).cwiseAbs().maxCoeff());
      const auto jacobian = chain.jacobian(q);
      const int joints = chain.roll ? kDof - 1 : kDof;
      column = std::max(
          column,
          (jacobian.leftCols(joints) - kdl.jacobian(q).leftCols(joints)).cwiseAbs().maxCoeff());
    }
    ++arms;
  }
  std::printf("%d postures of %d arms: tool %.1e m, rotation matrix %.1e, Jacobian %.1e\n",
              postures, arms, apart, turned, column);
  EXPECT_GE(arms, 13);
  EXPECT_LE(apart, 1e-12);
  EXPECT_LE(turned, 1e-12);
  EXPECT_LE(column, 1e-10);
}

TEST(Kdl, FindsTheToolOfPlannedRowsOnThePath) {
  int plans = 0, rows = 0;
  double apart = 0, turned = 0;
  for (const auto& file : problem_files()) {
    const PathProblem problem = io::load_path_problem(file);
    const PlanResult result = plan(problem);
    if (result.status != PlanStatus::kSolved) continue;  // one problem shows what has no path
    const KdlArm kdl(problem);
    const ToolPath path = problem_path(problem, kdl.chain());
    ASSERT_EQ(static_cast<std::size_t>(path.size()), result.trajectory.size()) << file;
    for (int i = 0; i < path.size(); ++i, ++rows) {
      const Pose tool = kdl.tool(result.trajectory[static_cast<std::size_t>(i)].q);
      const Pose& asked = path.layer(i).tool;
      apart = std::max(apart, (tool.translation() - asked.translation()).norm());
      // A tool with a roll is free about its own z axis.
      turned = std::max(turned, problem.roll ? (tool.linear().col(2) - asked.linear().col(2)).norm()
                                             : (tool.linear() - asked.linear()).norm());
    }
    ++plans;
  }
  std::printf("%d rows of %d plans: %.1e m and %.1e off the path\n", rows, plans, apart, turned);
  EXPECT_GE(plans, 13);
  EXPECT_LE(apart, 1e-9);
  EXPECT_LE(turned, 1e-9);
}

}  // namespace
}  // namespace swivel::test
