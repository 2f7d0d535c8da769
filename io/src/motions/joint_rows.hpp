// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "motions/trajectory_formats.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

inline constexpr std::size_t kMostTrajectoryRows = 1'000'000;

/// Returns true if the arm's last joint is the roll of its tool, which files of controllers do not
/// have.
[[nodiscard]] bool may_lack_last(const JointNames& joint_names);

/// Builds the trajectories of arms from rows whose joints come by name and whose times are whole
/// nanoseconds, as in ROS 2.
class JointRows {
 public:
  JointRows(const std::vector<ArmColumns>& arms, std::string file)
      : arms_(arms), file_(std::move(file)), read_(arms.size()) {}

  /// Returns how many joints the arms have.
  [[nodiscard]] std::size_t joint_count() const { return kDof * arms_.size(); }
  /// Sets the joints whose values follow, in this order. Throws InputError, prefixed by `where`,
  /// unless all joints of the arms are there, each once, and no other; the roll of a tool may be
  /// missing, in all rows.
  void joints(const std::vector<std::string>& names, const std::string& where);
  /// Adds a row: rad, rad/s, rad/s^2, in the order of joints(). Speeds or accelerations are empty
  /// in every row or in none. Throws InputError, prefixed by `where`, if they are not, or if times
  /// do not ascend.
  void add(std::int64_t nanoseconds, std::span<const double> q, std::span<const double> v,
           std::span<const double> a, const std::string& where);
  /// Returns the trajectory of all rows, by arm. Throws InputError if there are fewer than two.
  [[nodiscard]] std::vector<TrajectoryFile> finish();

 private:
  /// A joint of an arm, by numbers.
  struct Joint {
    std::size_t arm = 0;
    Eigen::Index joint = 0;
    friend bool operator==(const Joint&, const Joint&) = default;
  };
  [[nodiscard]] std::string allowed() const;

  std::vector<ArmColumns> arms_;
  std::string file_;
  std::vector<std::string> order_;
  std::vector<Joint> joint_;  // of each value
  std::vector<std::int64_t> nanoseconds_;
  std::vector<TrajectoryFile> read_;  // by arm
};

}  // namespace swivel::io
