// SPDX-License-Identifier: BSD-3-Clause
#include "motions/joint_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "files/bad_input.hpp"

namespace swivel::io {

std::string allowed_joints(const JointNames& joint_names) {
  std::string text = "each of the arm's joints once: ";
  const std::size_t count = may_lack_last(joint_names) ? kDof - 1 : kDof;
  for (std::size_t j = 0; j < count; ++j) text += (j == 0 ? "" : ", ") + joint_names[j];
  return text;
}

bool may_lack_last(const JointNames& joint_names) {
  return joint_names[kDof - 1] == "roll";
}

void JointRows::joints(const std::vector<std::string>& names, const std::string& where) {
  if (!joint_.empty() && names == order_) return;
  std::vector<Eigen::Index> joint;
  for (const std::string& name : names) {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end())
      bad_input(where, "'" + name + "' is no joint of the arm", allowed_joints(names_));
    const Eigen::Index index = found - names_.begin();
    if (std::find(joint.begin(), joint.end(), index) != joint.end())
      bad_input(where, "joint '" + name + "' is there twice", allowed_joints(names_));
    joint.push_back(index);
  }
  bool has_last = true;
  for (std::size_t j = 0; j < kDof; ++j) {
    if (std::find(joint.begin(), joint.end(), static_cast<Eigen::Index>(j)) != joint.end())
      continue;
    if (j + 1 < kDof || !may_lack_last(names_))
      bad_input(where, "joint '" + names_[j] + "' is missing", allowed_joints(names_));
    has_last = false;
  }
  if (!nanoseconds_.empty() && has_last != read_.stated.last_joint)
    bad_input(where, "joint '" + names_.back() + "' is in some rows only",
              "the same joints in all rows");
  read_.stated.last_joint = has_last;
  order_ = names;
  joint_ = std::move(joint);
}

void JointRows::add(std::int64_t nanoseconds, std::span<const double> q, std::span<const double> v,
                    std::span<const double> a, const std::string& where) {
  if (nanoseconds_.size() == kMostTrajectoryRows)
    bad_input(where, "too many rows", "at most " + std::to_string(kMostTrajectoryRows));
  TimedRow row;
  const auto take = [&](std::span<const double> values, const char* what, Config& into) {
    if (values.size() != joint_.size())
      bad_input(where + ": " + what, "has " + std::to_string(values.size()) + " numbers",
                std::to_string(joint_.size()) + ", one for each joint");
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!std::isfinite(values[k]))
        bad_input(where + ": " + what + ": " + order_[k], "is not finite", "a finite number");
      into[joint_[k]] = values[k];
    }
  };
  const auto take_rates = [&](std::span<const double> values, const char* what, Config& into,
                              bool& stated) {
    if (nanoseconds_.empty()) stated = !values.empty();
    if (stated == values.empty())
      bad_input(where + ": " + what, "are in some rows only", "numbers in all rows or in none");
    if (stated) take(values, what, into);
  };
  take(q, "positions", row.row.q);
  take_rates(v, "velocities", row.v, read_.stated.v);
  take_rates(a, "accelerations", row.a, read_.stated.a);
  if (!nanoseconds_.empty() && nanoseconds <= nanoseconds_.back())
    bad_input(where,
              "time is " + std::to_string(nanoseconds) + " ns after " +
                  std::to_string(nanoseconds_.back()) + " ns",
              "times that ascend from row to row");
  nanoseconds_.push_back(nanoseconds);
  read_.timed.push_back(row);
}

TrajectoryFile JointRows::finish() {
  if (read_.timed.size() < 2)
    bad_input(file_, "has " + std::to_string(read_.timed.size()) + " row(s)", "at least two");
  for (std::size_t k = 0; k < read_.timed.size(); ++k) {
    read_.timed[k].t = static_cast<double>(nanoseconds_[k]) / 1e9;
    read_.rows.push_back(read_.timed[k].row);
  }
  read_.stated.s = read_.stated.phi = read_.stated.branch = read_.stated.roll = false;
  return std::move(read_);
}

}  // namespace swivel::io
