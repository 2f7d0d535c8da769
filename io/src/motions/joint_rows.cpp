// SPDX-License-Identifier: BSD-3-Clause
#include "motions/joint_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "files/bad_input.hpp"

namespace swivel::io {

bool may_lack_last(const JointNames& joint_names) {
  return named_joints(joint_names) < kDof || joint_names.back() == "roll";
}

std::string ArmColumns::name(std::size_t j) const {
  return j + 1 == kDof && may_lack_last(joints) ? joints[j] + suffix : joints[j];
}

std::string JointRows::allowed() const {
  std::string text;
  for (const ArmColumns& arm : arms_) {
    const std::size_t count = may_lack_last(arm.joints) ? kDof - 1 : kDof;
    for (std::size_t j = 0; j < count; ++j) text += (text.empty() ? "" : ", ") + arm.joints[j];
  }
  return (arms_.size() == 1 ? "each of the arm's joints once: "
                            : "each joint of both arms once: ") +
         text;
}

void JointRows::joints(const std::vector<std::string>& names, const std::string& where) {
  if (!joint_.empty() && names == order_) return;
  std::vector<Joint> joints;
  const auto joint_of = [&](const std::string& name) -> std::optional<Joint> {
    for (std::size_t arm = 0; arm < arms_.size(); ++arm)
      for (std::size_t j = 0; j < named_joints(arms_[arm].joints); ++j)
        if (arms_[arm].name(j) == name) return Joint{arm, static_cast<Eigen::Index>(j)};
    return std::nullopt;
  };
  for (const std::string& name : names) {
    const std::optional<Joint> joint = joint_of(name);
    if (!joint)
      bad_input(where,
                "'" + name + "' is no joint of the " + (arms_.size() == 1 ? "arm" : "two arms"),
                allowed());
    if (std::find(joints.begin(), joints.end(), *joint) != joints.end())
      bad_input(where, "joint '" + name + "' is there twice", allowed());
    joints.push_back(*joint);
  }
  for (std::size_t arm = 0; arm < arms_.size(); ++arm) {
    bool has_last = true;
    for (std::size_t j = 0; j < named_joints(arms_[arm].joints); ++j) {
      const Joint joint{arm, static_cast<Eigen::Index>(j)};
      if (std::find(joints.begin(), joints.end(), joint) != joints.end()) continue;
      if (j + 1 < kDof || !may_lack_last(arms_[arm].joints))
        bad_input(where, "joint '" + arms_[arm].name(j) + "' is missing", allowed());
      has_last = false;
    }
    bool& stated = read_[arm].stated.last_joint;
    if (!nanoseconds_.empty() && has_last != stated)
      bad_input(where, "joint '" + arms_[arm].name(kDof - 1) + "' is in some rows only",
                "the same joints in all rows");
    stated = has_last;
  }
  order_ = names;
  joint_ = std::move(joints);
}

void JointRows::add(std::int64_t nanoseconds, std::span<const double> q, std::span<const double> v,
                    std::span<const double> a, const std::string& where) {
  if (nanoseconds_.size() == kMostTrajectoryRows)
    bad_input(where, "too many rows", "at most " + std::to_string(kMostTrajectoryRows));
  std::array<TimedRow, 2> rows;
  const auto take = [&](std::span<const double> values, const char* what, const auto& config_of) {
    if (values.size() != joint_.size())
      bad_input(where + ": " + what, "has " + std::to_string(values.size()) + " numbers",
                std::to_string(joint_.size()) + ", one for each joint");
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!std::isfinite(values[k]))
        bad_input(where + ": " + what + ": " + order_[k], "is not finite", "a finite number");
      config_of(rows[joint_[k].arm])[joint_[k].joint] = values[k];
    }
  };
  const auto take_rates = [&](std::span<const double> values, const char* what, bool Stated::*has,
                              Config TimedRow::*rates) {
    if (nanoseconds_.empty())
      for (TrajectoryFile& read : read_) read.stated.*has = !values.empty();
    const bool stated = read_.front().stated.*has;
    if (stated == values.empty())
      bad_input(where + ": " + what, "are in some rows only", "numbers in all rows or in none");
    if (stated) take(values, what, [&](TimedRow& row) -> Config& { return row.*rates; });
  };
  take(q, "positions", [](TimedRow& row) -> Config& { return row.row.q; });
  take_rates(v, "velocities", &Stated::v, &TimedRow::v);
  take_rates(a, "accelerations", &Stated::a, &TimedRow::a);
  if (!nanoseconds_.empty() && nanoseconds <= nanoseconds_.back())
    bad_input(where,
              "time is " + std::to_string(nanoseconds) + " ns after " +
                  std::to_string(nanoseconds_.back()) + " ns",
              "times that ascend from row to row");
  nanoseconds_.push_back(nanoseconds);
  for (std::size_t arm = 0; arm < arms_.size(); ++arm) read_[arm].timed.push_back(rows[arm]);
}

std::vector<TrajectoryFile> JointRows::finish() {
  const std::size_t count = nanoseconds_.size();
  if (count < 2) bad_input(file_, "has " + std::to_string(count) + " row(s)", "at least two");
  for (TrajectoryFile& read : read_) {
    for (std::size_t k = 0; k < count; ++k) {
      read.timed[k].t = static_cast<double>(nanoseconds_[k]) / 1e9;
      read.rows.push_back(read.timed[k].row);
    }
    read.stated.s = read.stated.phi = read.stated.branch = read.stated.roll = false;
  }
  return std::move(read_);
}

}  // namespace swivel::io
