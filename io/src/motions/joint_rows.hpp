// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

inline constexpr std::size_t kMostTrajectoryRows = 1'000'000;

/// Returns the text that completes "allowed is ..." for joints: "each of the arm's joints once: a,
/// b, ...".
[[nodiscard]] std::string allowed_joints(const JointNames& joint_names);
/// Returns true if the arm's last joint is the roll of its tool, which files of controllers do not
/// have.
[[nodiscard]] bool may_lack_last(const JointNames& joint_names);

/// Builds a trajectory from rows whose joints come by name and whose times are whole nanoseconds,
/// as in ROS 2.
class JointRows {
 public:
  JointRows(const JointNames& joint_names, std::string file)
      : names_(joint_names), file_(std::move(file)) {}

  /// Sets the joints whose values follow, in this order. Throws InputError, prefixed by `where`,
  /// unless all of the arm's joints are there, each once, and no other; the roll of the tool may be
  /// missing, in all rows.
  void joints(const std::vector<std::string>& names, const std::string& where);
  /// Adds a row: rad, rad/s, rad/s^2, in the order of joints(). Speeds or accelerations are empty
  /// in every row or in none. Throws InputError, prefixed by `where`, if they are not, or if times
  /// do not ascend.
  void add(std::int64_t nanoseconds, std::span<const double> q, std::span<const double> v,
           std::span<const double> a, const std::string& where);
  /// Returns the trajectory of all rows. Throws InputError if there are fewer than two.
  [[nodiscard]] TrajectoryFile finish();

 private:
  JointNames names_;
  std::string file_;
  std::vector<std::string> order_;
  std::vector<Eigen::Index> joint_;  // of each value, the arm's joint
  std::vector<std::int64_t> nanoseconds_;
  TrajectoryFile read_;
};

}  // namespace swivel::io
