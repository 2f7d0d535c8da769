// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "motions/given_rows.hpp"
#include "motions/messages.hpp"
#include "swivel/io/workcells/workcell_csv.hpp"

namespace swivel::io {

namespace {

constexpr std::size_t kBeforeJoints = 6;  // s, phi and branch of both arms

std::vector<std::string> workcell_motion_header(const std::array<std::string, 2>& names,
                                                const std::array<JointNames, 2>& joint_names,
                                                RollColumns rolls = RollColumns::kOfArms) {
  std::vector<std::string> columns = workcell_columns(names, joint_names, rolls);
  const std::vector<std::string> joints(columns.begin() + kBeforeJoints, columns.end());
  columns.insert(columns.begin(), "t");
  for (const char* const what : {"_v", "_a"})
    for (const std::string& joint : joints) columns.push_back(joint + what);
  return columns;
}

std::string header_line(const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& name : columns) text += (text.empty() ? "" : ",") + csv_field(name);
  return text + '\n';
}

/// Returns the fields of both arms' rows at one moment.
std::string fields_of(const std::array<const TrajectoryRow*, 2>& rows) {
  std::string text = csv_number(rows[0]->s) + ',' + csv_number(rows[1]->s);
  for (const TrajectoryRow* row : rows) text += ',' + csv_number(row->phi);
  for (const TrajectoryRow* row : rows) text += ',' + std::to_string(row->branch);
  for (const TrajectoryRow* row : rows)
    for (const double joint : row->q) text += ',' + csv_number(joint);
  return text;
}

/// Returns the row of an arm from the values of a line, without those of times.
TrajectoryRow row_of(const std::span<const double>& values, std::size_t arm,
                     const std::string& where, const std::string& name) {
  TrajectoryRow row;
  row.s = values[arm];
  row.phi = values[2 + arm];
  const double branch = values[4 + arm];
  if (!(branch >= 0 && branch <= 7) || branch != std::floor(branch))
    bad_input(where + ": branch_" + name, "is " + csv_number(branch), "a whole number from 0 to 7");
  row.branch = static_cast<int>(branch);
  for (std::size_t j = 0; j < kDof; ++j)
    row.q[static_cast<Eigen::Index>(j)] = values[kBeforeJoints + kDof * arm + j];
  return row;
}

/// Returns the rows of a table of either form.
WorkcellRows rows_of(const CsvTable& table, bool timed, const std::array<std::string, 2>& names) {
  WorkcellRows read;
  for (std::size_t k = 0; k < table.rows(); ++k)
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const std::span<const double> all = table.row(k), values = all.subspan(timed ? 1 : 0);
      read.rows[arm].push_back(row_of(values, arm, table.where(k), names[arm]));
      if (!timed) continue;
      TimedRow row;
      row.t = all[0];
      row.row = read.rows[arm].back();
      if (k > 0 && !(row.t > read.timed[arm].back().t))
        bad_input(table.where(k) + ": t", "is " + csv_number(row.t),
                  "times that ascend from row to row");
      for (std::size_t j = 0; j < kDof; ++j) {
        const auto joint = static_cast<Eigen::Index>(j);
        row.v[joint] = values[kBeforeJoints + kDof * (2 + arm) + j];
        row.a[joint] = values[kBeforeJoints + kDof * (4 + arm) + j];
      }
      read.timed[arm].push_back(row);
    }
  return read;
}

}  // namespace

std::string to_workcell_csv(const WorkcellResult& result) {
  std::string text = header_line(
      workcell_columns(result.names, {result.arms[0].joint_names, result.arms[1].joint_names}));
  const auto &first = result.arms[0].trajectory, &second = result.arms[1].trajectory;
  for (std::size_t k = 0; k < first.size(); ++k) text += fields_of({&first[k], &second[k]}) + '\n';
  return text;
}

std::array<std::vector<TrajectoryRow>, 2> load_workcell_csv(
    const std::filesystem::path& csv, const std::array<std::string, 2>& names,
    const std::array<JointNames, 2>& joint_names) {
  std::vector<std::vector<std::string>> headers{workcell_columns(names, joint_names)};
  if (have_roll(joint_names))
    headers.push_back(workcell_columns(names, joint_names, RollColumns::kPlain));
  return rows_of(CsvTable(csv, headers), false, names).rows;
}

std::string to_workcell_motion_csv(const WorkcellMotion& motion,
                                   const std::array<JointNames, 2>& joint_names) {
  std::string text = header_line(workcell_motion_header(motion.names, joint_names));
  const auto &first = motion.arms[0].rows, &second = motion.arms[1].rows;
  for (std::size_t k = 0; k < first.size(); ++k) {
    text += csv_number(first[k].t) + ',' + fields_of({&first[k].row, &second[k].row});
    for (const Config* values : {&first[k].v, &second[k].v, &first[k].a, &second[k].a})
      for (const double value : *values) text += ',' + csv_number(value);
    text += '\n';
  }
  return text;
}

std::string workcell_motion_text(const WorkcellMotion& motion,
                                 const std::array<JointNames, 2>& joint_names,
                                 const std::string& frame_id, const std::filesystem::path& file) {
  require_motion_format(file);
  const std::string format = file.extension().string();
  if (format == ".csv") return to_workcell_motion_csv(motion, joint_names);
  const auto &first = motion.arms[0], &second = motion.arms[1];
  const MotionMessages other{second.rows, second.roll, joint_names[1], frame_id};
  const MotionMessages both{first.rows, first.roll, joint_names[0], frame_id, nullptr, &other};
  if (format == ".json") return trajectory_json(both);
  if (format == ".yaml") return trajectory_yaml(both);
  return mcap_log(both);
}

WorkcellRows load_workcell_rows(const std::filesystem::path& csv,
                                const std::array<std::string, 2>& names,
                                const std::array<JointNames, 2>& joint_names) {
  std::vector<std::vector<std::string>> headers;
  for (const RollColumns rolls : {RollColumns::kOfArms, RollColumns::kPlain}) {
    if (rolls == RollColumns::kPlain && !have_roll(joint_names)) break;
    headers.push_back(workcell_columns(names, joint_names, rolls));
    headers.push_back(workcell_motion_header(names, joint_names, rolls));
  }
  const CsvTable table(csv, headers);
  return rows_of(table, table.header() % 2 == 1, names);
}

}  // namespace swivel::io
