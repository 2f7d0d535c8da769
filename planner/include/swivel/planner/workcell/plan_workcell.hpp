// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "swivel/core/answer/workcell_certificate.hpp"
#include "swivel/core/answer/workcell_result.hpp"
#include "swivel/core/problem/workcell.hpp"
#include "swivel/planner/plan/plan_options.hpp"

namespace swivel {

class InterArmWorld;
class PreparedRobot;
struct WorkcellView;

/// What is known of a workcell before it is planned: the problem that each arm poses by itself and
/// its prepared robot, and the bodies of both arms that must keep clear of each other. Immutable
/// and safe to share between threads.
class PreparedWorkcell {
 public:
  /// Prepares both arms. Throws InvalidArgument for what validate(Workcell) refuses, InputError for
  /// what PreparedRobot refuses of either arm, arms that share a joint or a link, a follower whose
  /// tool stands still in the base frame on a step, a given motion whose tool stands still on one,
  /// and a roll that is chosen besides the arm angle; Stopped.
  explicit PreparedWorkcell(const Workcell& cell, const Budget& budget = {});
  ~PreparedWorkcell();
  PreparedWorkcell(PreparedWorkcell&&) noexcept;
  PreparedWorkcell& operator=(PreparedWorkcell&&) noexcept;
  /// Returns the name of an arm.
  [[nodiscard]] const std::string& name(std::size_t arm) const;
  /// Returns the problem of an arm by itself: its path in the base frame, cut into as many steps as
  /// the other's (for a given motion, the path that its rows lead the tool along), and a robot
  /// model without the collision shapes of the links that the other arm moves.
  [[nodiscard]] const Problem& problem(std::size_t arm) const;
  [[nodiscard]] const PreparedRobot& robot(std::size_t arm) const;
  [[nodiscard]] const InterArmWorld& between() const;
  /// Returns the number of the arm whose motion is given, if one is.
  [[nodiscard]] std::optional<std::size_t> given_arm() const;
  /// Returns the rows of the given motion: the joints of Workcell::given, bit for bit, with the
  /// path length, arm angle and branch that follow from them. Empty where no motion is given.
  [[nodiscard]] const std::vector<TrajectoryRow>& given_rows() const;
  /// Returns the bodies of both arms with what they keep at and between the samples of timed
  /// motions (time_workcell()).
  [[nodiscard]] InterArmWorld between_samples(const Budget& budget = {}) const;
  /// Returns the number of the arm whose path the other one's tool carries; -1: there is none.
  [[nodiscard]] int follower() const;
  /// Returns the pose of the follower's tool in the frame of the leader's tool at a layer; between
  /// two layers at a fraction. Only where there is a follower.
  [[nodiscard]] Pose on_leader(double layer) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// Plans two arms that work at one time: the two paths without conflict whose costs together are
/// least. Where the arms' own answers have no conflict, they are the answer, bit for bit. The
/// result is the same at any thread count, unless it times out. Where the motion of one arm is
/// given, the answer is the other arm's cheapest path that keeps clear of it. Throws
/// InvalidArgument for options that workcells do not have (an eager planner, hooks), InputError as
/// plan() does of either arm and for a given motion that does not pass check_trajectory() by
/// itself,
/// std::logic_error if options.check finds an answer invalid.
[[nodiscard]] WorkcellResult plan_workcell(const Workcell& cell, const PlanOptions& options = {});
/// Plans a workcell that was prepared before. `view`: filled with what was found out, or null.
[[nodiscard]] WorkcellResult plan_workcell(const PreparedWorkcell& prepared,
                                           const PlanOptions& options = {},
                                           WorkcellView* view = nullptr);

/// Returns a certificate that a workcell has no plan, which verify_certificate() verifies. It comes
/// from a search of its own, by regions of conflict alone: where plan_workcell() was decided by
/// pairs of nodes, this may take much longer. Throws InvalidArgument if the workcell has a plan,
/// InputError as plan_workcell() does, and Stopped.
[[nodiscard]] WorkcellCertificate prove_infeasible(const PreparedWorkcell& prepared,
                                                   const Budget& budget = {});

}  // namespace swivel
