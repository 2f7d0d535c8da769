// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <mutex>
#include <vector>

#include "fcl_shapes.hpp"
#include "swivel/collision/world.hpp"

namespace swivel {

/// What worlds of one robot share: it depends neither on the scene nor on the limits. Safe from many threads. Whatever takes a
/// budget throws Stopped.
class RobotPart {
 public:
  RobotPart(const RobotModel& robot, const ArmModel& arm, const Problem& problem, MeshStore& meshes, const Budget& budget);
  RobotPart(const RobotPart&) = delete;
  RobotPart& operator=(const RobotPart&) = delete;

  /// Robot pairs by a problem's limits. Medians are computed as far as these limits need them, once.
  [[nodiscard]] std::vector<RobotPair> pairs(const Limits& limits, const Budget& budget) const;
  /// The same with all medians.
  [[nodiscard]] std::vector<RobotPair> pairs_with_medians(const Limits& limits) const;
  /// Links of the arm without a shape.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  Chain chain;
  std::vector<RobotBody> bodies;
  std::vector<FclShape> shapes;

 private:
  struct Candidate {
    BodyPair pair;
    bool sampled = false;  // no SRDF speaks for it
    bool dropped = false;
  };
  [[nodiscard]] std::vector<RobotPair> pairs(const Limits& limits, double far, const Budget& budget) const;
  void drop_always_touching(const Budget& budget);
  [[nodiscard]] double median(const BodyPair& pair, double far, const std::vector<std::array<Pose, kDof + 1>>& samples,
                              const Budget& budget) const;

  std::vector<Candidate> candidates_;
  std::vector<std::string> warnings_;
  mutable std::mutex mutex_;
  mutable double medians_up_to_ = 0;     // m
  mutable std::vector<double> medians_;  // by candidate; infinite from medians_up_to_ on
};

}  // namespace swivel
