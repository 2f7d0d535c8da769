// SPDX-License-Identifier: BSD-3-Clause
#include "motions/given_rows.hpp"

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "motions/joint_rows.hpp"

namespace swivel::io {

std::vector<std::string> workcell_columns(const std::array<std::string, 2>& names,
                                          const std::array<JointNames, 2>& joints,
                                          RollColumns rolls) {
  std::vector<std::string> columns;
  for (const char* const what : {"s_", "phi_", "branch_"})
    for (const std::string& name : names) columns.push_back(what + name);
  for (std::size_t arm = 0; arm < 2; ++arm) {
    columns.insert(columns.end(), joints[arm].begin(), joints[arm].end());
    if (rolls == RollColumns::kOfArms && may_lack_last(joints[arm]))
      columns.back() += "_" + names[arm];
  }
  return columns;
}

bool have_roll(const std::array<JointNames, 2>& joints) {
  return may_lack_last(joints[0]) || may_lack_last(joints[1]);
}

namespace {

/// Returns whether a table begins with these columns, as Swivel writes them.
bool begins_with(const std::string& text, const std::vector<std::string>& columns) {
  std::string header;
  for (const std::string& column : columns)
    header.append(header.empty() ? "" : ",").append(csv_field(column));
  return text.starts_with(header + "\n") || text.starts_with(header + "\r\n");
}

}  // namespace

std::vector<Config> load_given_rows(const std::filesystem::path& file, std::size_t arm,
                                    bool six_joints, const std::array<std::string, 2>& names,
                                    const std::array<JointNames, 2>& joints) {
  std::vector<Config> rows;
  const std::string text = read_file(file, "trajectory file", kMostTableBytes);
  for (const RollColumns rolls : {RollColumns::kOfArms, RollColumns::kPlain}) {
    const std::vector<std::string> of_both = workcell_columns(names, joints, rolls);
    if (!begins_with(text, of_both)) continue;
    const CsvTable table(file, of_both);
    for (std::size_t k = 0; k < table.rows(); ++k)
      rows.emplace_back(Config::Map(&table.row(k)[of_both.size() - kDof * (2 - arm)]));
    return rows;
  }
  const TrajectoryFile read = load_trajectory_file(file, joints[arm]);
  if (!read.timed.empty())
    bad_input(file.string(), "has times, which the plan of two arms would not keep",
              "rows without times, as `swivel plan --out` writes them");
  if (!read.stated.last_joint && !six_joints)
    bad_input(file.string(), "lacks joint '" + joints[arm].back() + "'",
              "a motion of all joints of the arm");
  for (const TrajectoryRow& row : read.rows) rows.push_back(row.q);
  return rows;
}

}  // namespace swivel::io
