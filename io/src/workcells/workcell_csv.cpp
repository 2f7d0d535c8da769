// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "motions/given_rows.hpp"
#include "swivel/io/workcells/workcell_csv.hpp"

namespace swivel::io {

std::string to_workcell_csv(const WorkcellResult& result) {
  std::string text;
  for (const std::string& name :
       workcell_columns(result.names, {result.arms[0].joint_names, result.arms[1].joint_names}))
    text += (text.empty() ? "" : ",") + csv_field(name);
  text += '\n';
  const auto &first = result.arms[0].trajectory, &second = result.arms[1].trajectory;
  for (std::size_t k = 0; k < first.size(); ++k) {
    const std::array<const TrajectoryRow*, 2> rows{&first[k], &second[k]};
    text += csv_number(rows[0]->s) + ',' + csv_number(rows[1]->s);
    for (const TrajectoryRow* row : rows) text += ',' + csv_number(row->phi);
    for (const TrajectoryRow* row : rows) text += ',' + std::to_string(row->branch);
    for (const TrajectoryRow* row : rows)
      for (const double joint : row->q) text += ',' + csv_number(joint);
    text += '\n';
  }
  return text;
}

std::array<std::vector<TrajectoryRow>, 2> load_workcell_csv(
    const std::filesystem::path& csv, const std::array<std::string, 2>& names,
    const std::array<JointNames, 2>& joint_names) {
  const CsvTable table(csv, workcell_columns(names, joint_names));
  std::array<std::vector<TrajectoryRow>, 2> rows;
  for (std::size_t k = 0; k < table.rows(); ++k)
    for (std::size_t arm = 0; arm < 2; ++arm) {
      const auto values = table.row(k);
      TrajectoryRow& row = rows[arm].emplace_back();
      row.s = values[arm];
      row.phi = values[2 + arm];
      const double branch = values[4 + arm];
      if (!(branch >= 0 && branch <= 7) || branch != std::floor(branch))
        bad_input(table.where(k) + ": branch_" + names[arm], "is " + csv_number(branch),
                  "a whole number from 0 to 7");
      row.branch = static_cast<int>(branch);
      for (std::size_t j = 0; j < kDof; ++j)
        row.q[static_cast<Eigen::Index>(j)] = values[6 + kDof * arm + j];
    }
  return rows;
}

}  // namespace swivel::io
