// SPDX-License-Identifier: BSD-3-Clause
#include "constrained_sampling.hpp"

#include <ompl/base/ConstrainedSpaceInformation.h>
#include <ompl/base/Constraint.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>
#include <ompl/base/spaces/constraint/TangentBundleStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "swivel/collision/world/world.hpp"
#include "swivel/core/lattice/kinds/srs_lattice.hpp"

namespace swivel::baselines {

namespace {

namespace ob = ompl::base;

constexpr int kPlace = kDof;     // index of the path parameter among the coordinates
constexpr double kLength = 2.0;  // of the path in that coordinate: about as much as joints move, so
                                 // that distances mean something
constexpr double kStep = 0.02;   // between the states of a motion, in the coordinates
constexpr double kRange = 0.3;   // longest motion of a tree, in the coordinates; found on four
                                 // episodes to serve both better than the default
constexpr int kGoals = 50;

Config joints(const Eigen::Ref<const Eigen::VectorXd>& x) {
  return x.head<kDof>();
}

/// Pose of the tool against the path, and its derivative.
class OnPath : public ob::Constraint {
 public:
  OnPath(const Chain& chain, const ToolPath& path)
      : ob::Constraint(kDof + 1, 6, 1e-6), chain_(chain), path_(path) {}

  [[nodiscard]] Pose at(double place) const {
    const double t = std::clamp(place / kLength, 0.0, 1.0) * (path_.size() - 1);
    const int i = std::min(path_.size() - 2, static_cast<int>(t));
    return path_.at(i, t - i);
  }
  void function(const Eigen::Ref<const Eigen::VectorXd>& x,
                Eigen::Ref<Eigen::VectorXd> out) const override {
    out = error(at(x[kPlace]), chain_.tool(joints(x)));
  }
  void jacobian(const Eigen::Ref<const Eigen::VectorXd>& x,
                Eigen::Ref<Eigen::MatrixXd> out) const override {
    constexpr double kDifference = 1e-6;
    out.leftCols<kDof>() = chain_.jacobian(joints(x));
    const double from = std::clamp(x[kPlace], kDifference, kLength - kDifference);
    out.col(kPlace) = -error(at(from - kDifference), at(from + kDifference)) / (2 * kDifference);
  }

 private:
  /// Motion from a to b: m and rad, base frame.
  static Eigen::Matrix<double, 6, 1> error(const Pose& a, const Pose& b) {
    const Eigen::AngleAxisd turn(b.linear() * a.linear().transpose());
    Eigen::Matrix<double, 6, 1> e;
    e << b.translation() - a.translation(), turn.angle() * turn.axis();
    return e;
  }
  const Chain& chain_;
  const ToolPath& path_;
};

double place_of(const ob::State* state) {
  return (*state->as<ob::ConstrainedStateSpace::StateType>())[kPlace];
}

/// Refuses motions that go back along the path.
class Forwards : public ob::ConstrainedMotionValidator {
 public:
  explicit Forwards(ob::ConstrainedSpaceInformation* information)
      : ob::ConstrainedMotionValidator(information) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    if (place_of(b) < place_of(a) || !ob::ConstrainedMotionValidator::checkMotion(a, b))
      return false;
    std::vector<ob::State*> states;
    bool forwards = ss_.discreteGeodesic(a, b, false, &states);
    for (std::size_t k = 1; k < states.size(); ++k)
      forwards = forwards && place_of(states[k]) >= place_of(states[k - 1]);
    for (ob::State* const state : states) ss_.freeState(state);
    return forwards;
  }
  using ob::ConstrainedMotionValidator::checkMotion;
};

Eigen::VectorXd coordinates(const Config& q, double place) {
  Eigen::VectorXd x(kDof + 1);
  x << q.coordinates(), place;
  return x;
}

double distance_to_segment(const Vector3d& x, const Vector3d& a, const Vector3d& b) {
  const Vector3d d = b - a;
  const double t =
      d.squaredNorm() < 1e-18 ? 0 : std::clamp((x - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return (x - a - t * d).norm();
}

/// Fills what only the finished path tells.
void examine(const std::vector<Eigen::VectorXd>& rows, const Chain& chain, const OnPath& on_path,
             const PathProblem& problem, const std::function<bool(const Eigen::VectorXd&)>& valid,
             ConstrainedResult& result) {
  double sum = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!valid(rows[k]) || !on_path.isSatisfied(rows[k])) {
      result.reason = "invalid between its states";
      return;
    }
    if (k == 0) continue;
    const Config delta = joints(rows[k]) - joints(rows[k - 1]);
    if (rows[k][kPlace] < rows[k - 1][kPlace] - 1e-6) {
      result.reason = "goes back along the path";
      return;
    }
    if (delta.cwiseAbs().maxCoeff() > problem.limits.joint_step) {
      result.reason = "joint step";
      return;
    }
    for (const double t : {0.25, 0.5, 0.75}) {
      const double error =
          1e3 * distance_to_segment(chain.tool(joints(rows[k - 1]) + t * delta).translation(),
                                    on_path.at(rows[k - 1][kPlace]).translation(),
                                    on_path.at(rows[k][kPlace]).translation());
      sum += error;
      result.error_max_mm = std::max(result.error_max_mm, error);
    }
  }
  if (problem.limits.tool_path_error &&
      result.error_max_mm > 1e3 * *problem.limits.tool_path_error) {
    result.reason = "leaves the path between its states";
    return;
  }
  result.error_mm = sum / (3.0 * static_cast<double>(rows.size() - 1));
  result.finished = true;
}

/// Returns true if the joints keep their limits, the place is on the path, and no pair of bodies
/// violates its clearance.
bool is_valid(const Eigen::VectorXd& x, const Chain& chain, const PathProblem& problem,
              World::Query& query) {
  constexpr double kSlack = 1e-9;
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    const double margin = problem.limits.joint_margin - kSlack;
    if (!limit.continuous && (x[j] < limit.lower + margin || x[j] > limit.upper - margin))
      return false;
  }
  return x[kPlace] >= -kSlack && x[kPlace] <= kLength + kSlack &&
         !query.find_violating_pair(joints(x), ClearanceRule::kNode);
}

/// Returns the space of the joints and the path parameter, within their limits.
std::shared_ptr<ob::RealVectorStateSpace> ambient_space(const Chain& chain) {
  auto ambient = std::make_shared<ob::RealVectorStateSpace>(kDof + 1);
  ob::RealVectorBounds bounds(kDof + 1);
  for (int j = 0; j < kDof; ++j) {
    const JointLimit& limit = chain.limit[static_cast<std::size_t>(j)];
    bounds.setLow(static_cast<unsigned>(j), limit.continuous ? -kPi : limit.lower);
    bounds.setHigh(static_cast<unsigned>(j), limit.continuous ? kPi : limit.upper);
  }
  bounds.setLow(kPlace, 0);
  bounds.setHigh(kPlace, kLength);
  ambient->setBounds(bounds);
  return ambient;
}

/// The states that satisfy the constraint, and how OMPL tests them.
struct ConstrainedSpace {
  std::shared_ptr<ob::ConstrainedStateSpace> space;
  std::shared_ptr<ob::ConstrainedSpaceInformation> information;
};

/// Makes the space of a manifold, ready for planners. `valid` must outlive it.
ConstrainedSpace make_space(Manifold manifold, const Chain& chain,
                            const std::shared_ptr<OnPath>& constraint,
                            const std::function<bool(const Eigen::VectorXd&)>& valid) {
  const auto ambient = ambient_space(chain);
  ConstrainedSpace made;
  if (manifold == Manifold::kProjected) {
    made.space = std::make_shared<ob::ProjectedStateSpace>(ambient, constraint);
    made.information = std::make_shared<ob::ConstrainedSpaceInformation>(made.space);
  } else {
    made.space = std::make_shared<ob::TangentBundleStateSpace>(ambient, constraint);
    made.information = std::make_shared<ob::TangentBundleSpaceInformation>(made.space);
  }
  made.space->setDelta(kStep);
  made.information->setStateValidityChecker([&valid](const ob::State* state) {
    return valid(*state->as<ob::ConstrainedStateSpace::StateType>());
  });
  made.information->setMotionValidator(std::make_shared<Forwards>(made.information.get()));
  made.information->setup();
  return made;
}

/// Returns the valid states at the end of the path, one for each slot of the lattice's last layer.
std::vector<Eigen::VectorXd> valid_ends(const SrsLattice& lattice,
                                        const std::function<bool(const Eigen::VectorXd&)>& valid) {
  std::vector<Eigen::VectorXd> ends;
  for (int slot = 0; slot < lattice.width(); ++slot)
    if (const auto q = lattice.exact_config(lattice.layers() - 1, slot))
      if (const auto x = coordinates(*q, kLength); valid(x)) ends.push_back(x);
  return ends;
}

/// Returns the states of a solution, interpolated, on the manifold.
std::vector<Eigen::VectorXd> rows_of_solution(const ob::ProblemDefinition& definition,
                                              const OnPath& constraint) {
  auto& found = *definition.getSolutionPath()->as<ompl::geometric::PathGeometric>();
  found.interpolate();
  std::vector<Eigen::VectorXd> rows;
  for (const ob::State* state : found.getStates()) {
    rows.emplace_back(*state->as<ob::ConstrainedStateSpace::StateType>());
    constraint.project(rows.back());  // a tangent bundle's states lie beside the manifold
  }
  return rows;
}

}  // namespace

ConstrainedResult plan_constrained(const PreparedRobot& robot, const PathProblem& problem,
                                   Manifold manifold, double seconds) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ConstrainedResult result;
  const auto begin = std::chrono::steady_clock::now();
  const Chain& chain = robot.arm().chain;
  const ToolPath path(waypoints_in_base(problem), problem.resolution, problem.source);
  const World world(robot.world(), problem);
  World::Query query(world, DistanceProofs::kOn);
  const auto constraint = std::make_shared<OnPath>(chain, path);
  const std::function<bool(const Eigen::VectorXd&)> valid = [&](const Eigen::VectorXd& x) {
    return is_valid(x, chain, problem, query);
  };
  const ConstrainedSpace made = make_space(manifold, chain, constraint, valid);
  const auto& space = made.space;
  const auto& information = made.information;
  const auto state_of = [&](const Eigen::VectorXd& x) {
    ob::ScopedState<> state(space);
    state->as<ob::ConstrainedStateSpace::StateType>()->copy(x);
    if (manifold == Manifold::kTangentBundle)
      space->as<ob::AtlasStateSpace>()->anchorChart(state.get());
    return state;
  };
  const auto definition = std::make_shared<ob::ProblemDefinition>(information);
  definition->addStartState(state_of(coordinates(*problem.start, 0)));
  const auto goals = std::make_shared<ob::GoalStates>(information);
  const SrsLattice lattice(chain, robot.srs(), path, problem);
  const std::vector<Eigen::VectorXd> ends = valid_ends(lattice, valid);
  const std::size_t every = std::max<std::size_t>(1, ends.size() / kGoals);
  for (std::size_t k = 0; k < ends.size(); k += every) goals->addState(state_of(ends[k]));
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  if (ends.empty()) {
    result.reason = "no goal";
    result.ms = 1e3 * elapsed();
    return result;
  }
  definition->setGoal(goals);
  ompl::geometric::RRTConnect planner(information);
  planner.setProblemDefinition(definition);
  planner.setRange(kRange);
  planner.setup();
  result.connected = planner.ob::Planner::solve(std::max(0.0, seconds - elapsed())) ==
                     ob::PlannerStatus::EXACT_SOLUTION;
  result.ms = 1e3 * elapsed();
  if (!result.connected) {
    result.reason = "time";
    return result;
  }
  examine(rows_of_solution(*definition, *constraint), chain, *constraint, problem, valid, result);
  return result;
}

}  // namespace swivel::baselines
