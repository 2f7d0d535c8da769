// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "shapes/fcl_shapes.hpp"
#include "swivel/collision/world/world.hpp"

namespace swivel::detail {

/// What worlds of one robot share: it does not depend on the scene. Immutable. Whatever takes a budget throws Stopped.
class RobotPart {
 public:
  RobotPart(const RobotModel& robot, const ArmModel& arm, const Problem& problem, MeshStore& meshes, const Budget& budget);
  /// `part` itself where it knows the medians that these limits need, else a copy that does.
  [[nodiscard]] static std::shared_ptr<const RobotPart> for_limits(const std::shared_ptr<const RobotPart>& part,
                                                                   const Limits& limits, const Budget& budget);

  /// Robot pairs by a problem's limits, whose medians are known.
  [[nodiscard]] std::vector<RobotPair> pairs(const Limits& limits) const;
  /// The same with all medians, computed for it.
  [[nodiscard]] std::vector<RobotPair> pairs_with_medians(const Limits& limits) const;
  /// Links of the arm without a shape.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  Chain chain;
  std::vector<RobotBody> bodies;
  std::vector<FclShape> shapes;
  FollowerMotion followers;

 private:
  struct Candidate {
    BodyPair pair;
    bool sampled = false;  // no SRDF speaks for it
    bool dropped = false;
  };
  void find_medians(double far, const Budget& budget);
  void drop_always_touching(const Budget& budget);
  [[nodiscard]] double median(const BodyPair& pair, double far, const std::vector<std::vector<Pose>>& samples,
                              const Budget& budget) const;

  std::vector<Candidate> candidates_;
  std::vector<std::string> warnings_;
  double medians_up_to_ = 0;     // m
  std::vector<double> medians_;  // by candidate; infinite from medians_up_to_ on
};

}  // namespace swivel::detail
