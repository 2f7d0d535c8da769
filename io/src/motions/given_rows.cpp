// SPDX-License-Identifier: BSD-3-Clause
#include "motions/given_rows.hpp"

#include <algorithm>
#include <string_view>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"

namespace swivel::io {

std::vector<ArmColumns> arms_of_workcell(const std::array<std::string, 2>& names,
                                         const std::array<JointNames, 2>& joints) {
  return {{joints[0], "_" + names[0]}, {joints[1], "_" + names[1]}};
}

std::vector<std::string> workcell_columns(const std::vector<ArmColumns>& arms) {
  std::vector<std::string> columns;
  for (const char* const what : {"s", "phi", "branch"})
    for (const ArmColumns& arm : arms) columns.push_back(what + arm.suffix);
  for (const ArmColumns& arm : arms)
    for (std::size_t j = 0; j < named_joints(arm.joints); ++j) columns.push_back(arm.name(j));
  return columns;
}

namespace {

/// Returns whether a table has a column for the first joint of an arm.
bool has_joints_of(const ArmColumns& arm, std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(" \t\r\n")));
  const std::string_view line = text.substr(0, text.find('\n'));
  const std::vector<std::string> columns = csv_fields(line, 4 * kDof);
  return std::find(columns.begin(), columns.end(), arm.name(0)) != columns.end();
}

}  // namespace

std::vector<Config> load_given_rows(const std::filesystem::path& file, std::size_t arm,
                                    bool six_joints, const std::array<std::string, 2>& names,
                                    const std::array<JointNames, 2>& joints) {
  const std::string text = read_file(file, "trajectory file", kMostTableBytes);
  const std::vector<ArmColumns> both = arms_of_workcell(names, joints);
  const bool of_both = has_joints_of(both[1 - arm], text);
  const Sought sought{.arms = of_both ? both : std::vector{ArmColumns{joints[arm]}}};
  const FileRows all = read_rows(file.string(), text, sought);
  const TrajectoryFile& read = all.arms[of_both ? arm : 0];
  if (!read.timed.empty())
    bad_input(file.string(), "has times, which the plan of two arms would not keep",
              "rows without times, as `swivel plan --out` writes them");
  if (!read.stated.last_joint && !six_joints)
    bad_input(file.string(), "lacks joint '" + joints[arm].back() + "'",
              "a motion of all joints of the arm");
  std::vector<Config> rows;
  for (const TrajectoryRow& row : read.rows) rows.push_back(row.q);
  return rows;
}

}  // namespace swivel::io
