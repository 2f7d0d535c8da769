// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "files/text_number.hpp"
#include "jobs/job_rows.hpp"
#include "motions/trajectory_columns.hpp"
#include "schema/schema.hpp"
#include "swivel/io/jobs/job_trajectory.hpp"

namespace swivel::io {

const Schema& job_trajectory_schema() {
  static const Schema schema = [] {
    std::vector<Schema::Key> keys = trajectory_schema().keys;
    for (Schema::Key& key : keys) key.group = "trajectory";
    keys.push_back({"stroke", text(), "", required(), "name of the stroke; empty in transitions"});
    keys.push_back({"process", integer(), "", required(),
                    "1 on the stroke itself, 0 on the lines of approach and retract and in "
                    "transitions"});
    return section("job_trajectory", std::move(keys));
  }();
  return schema;
}

bool any_rolls(const JobResult& result) {
  const auto any = [](const std::vector<JobPart>& parts) {
    return std::any_of(parts.begin(), parts.end(), [](const JobPart& part) {
      return part.run && swivel::any_rolls(part.rows);
    });
  };
  return any(result.parts) || any(result.partial);
}

std::string placeless_fields(const TrajectoryRow& row, bool roll) {
  std::string text = roll ? ",,," : ",,";
  for (const double angle : row.q) text += ',' + format_double(angle);
  return text;
}

double number_field(const CsvPlace& place, const std::string& column, const std::string& field) {
  const auto value = to_number<double>(field);
  if (!value || !std::isfinite(*value))
    bad_input(place.where() + ": " + column, "'" + field + "' is not a number", "a finite number");
  return *value;
}

int branch_field(const CsvPlace& place, const std::string& field) {
  const double branch = number_field(place, "branch", field);
  if (!(branch >= 0 && branch <= 7) || branch != static_cast<int>(branch))
    bad_input(place.where() + ": branch", "is " + format_double(branch),
              "a whole number from 0 to 7");
  return static_cast<int>(branch);
}

bool process_field(const CsvPlace& place, const std::string& field) {
  if (field != "0" && field != "1")
    bad_input(place.where() + ": process", "is '" + field + "'", "0 or 1");
  return field == "1";
}

void bad_header(const std::string& where, const std::string& what,
                const std::vector<std::string>& header) {
  std::string allowed;
  for (const std::string& name : header) allowed += (allowed.empty() ? "" : ",") + csv_field(name);
  bad_input(where, "is not the header of " + what, allowed + ", with roll behind phi or without");
}

namespace {

std::vector<std::string> job_header(const JointNames& joint_names, bool roll) {
  return csv_header(job_trajectory_schema(), joint_names, roll);
}

}  // namespace

std::string to_job_csv(const JobResult& result, const Job& job) {
  std::string text;
  const bool roll = any_rolls(result);
  for (const std::string& name : job_header(result.joint_names, roll))
    text += (text.empty() ? "" : ",") + csv_field(name);
  text += '\n';
  for (const JobPart& part : result.parts) {
    const std::string stroke = part.run ? csv_line_field(job.strokes[part.run->stroke].name) : "";
    const std::vector<bool> process = process_of_rows(part, job);
    for (std::size_t k = 0; k < part.rows.size(); ++k) {
      TrajectoryRow row = part.rows[k];
      if (part.run) row.s += s_of_piece(job.strokes[part.run->stroke]);
      text += part.run ? trajectory_fields(row, roll) : placeless_fields(row, roll);
      text += ',' + stroke + (process[k] ? ",1\n" : ",0\n");
    }
  }
  return text;
}

namespace {

/// Reads the rows of a job's trajectory one after the other.
class JobRows {
 public:
  /// Sets the columns. Throws InputError for any but those of to_job_csv().
  void header(const std::vector<std::string>& columns, const JointNames& joint_names,
              const std::string& where) {
    for (const bool roll : {false, true})
      if (columns == job_header(joint_names, roll)) {
        columns_ = columns;
        read_.rolls = roll;
        return;
      }
    bad_header(where, "a job's trajectory", job_header(joint_names, false));
  }

  void add(const CsvPlace& place, const std::vector<std::string>& fields) {
    const std::string& stroke = fields[columns_.size() - 2];
    const bool process = process_field(place, fields.back());
    if (read_.parts.empty() || read_.parts.back().stroke != stroke) begin_part(place, stroke);
    JobTrajectoryPart& part = read_.parts.back();
    if (process && stroke.empty())
      bad_input(place.where() + ": process", "is 1 in a transition", "0, or the name of a stroke");
    if (process) {
      if (processed_ && part.last_process + 1 != part.rows.size())
        bad_input(place.where() + ": process",
                  "is 1 again in stroke '" + stroke + "', after rows with 0",
                  "one stretch of rows with 1 in a stroke");
      if (!processed_) part.first_process = part.rows.size();
      part.last_process = part.rows.size();
      processed_ = true;
    }
    part.rows.push_back(row(place, fields, !stroke.empty()));
  }

  JobTrajectory finish(const std::string& file) {
    end_part(file);
    return std::move(read_);
  }

 private:
  void begin_part(const CsvPlace& place, const std::string& stroke) {
    if (!read_.parts.empty()) end_part(place.where());
    if (!stroke.empty() && !known_.insert(stroke).second)
      bad_input(place.where() + ": stroke", "'" + stroke + "' comes twice",
                "the rows of a stroke together");
    read_.parts.push_back({stroke, place.row, {}});
    processed_ = false;
  }

  /// Throws InputError, prefixed by `where`, if the last part cannot end there.
  void end_part(const std::string& where) const {
    const JobTrajectoryPart& part = read_.parts.back();
    const std::string name =
        part.stroke.empty() ? "the transition" : "stroke '" + part.stroke + "'";
    if (part.rows.size() < 2)
      bad_input(where, name + " before it has one row", "at least two rows in each part");
    if (!part.stroke.empty() && part.first_process == part.last_process)
      bad_input(where, name + " before it has fewer than two rows whose process is 1",
                "two or more: those on the stroke itself");
  }

  [[nodiscard]] double number(const CsvPlace& place, const std::vector<std::string>& fields,
                              std::size_t column) const {
    return number_field(place, columns_[column], fields[column]);
  }

  /// Returns the row. In transitions the columns before the joints must be empty.
  TrajectoryRow row(const CsvPlace& place, const std::vector<std::string>& fields,
                    bool of_stroke) const {
    TrajectoryRow row;
    const std::size_t joints = columns_.size() - 2 - kDof;
    for (std::size_t j = 0; j < kDof; ++j)
      row.q[static_cast<Eigen::Index>(j)] = number(place, fields, joints + j);
    if (!of_stroke) {
      for (std::size_t k = 0; k < joints; ++k)
        if (!fields[k].empty())
          bad_input(place.where() + ": " + columns_[k],
                    "is '" + fields[k] + "' in a transition, whose stroke is empty",
                    "an empty field, or the name of a stroke");
      return row;
    }
    row.s = number(place, fields, 0);
    row.phi = number(place, fields, 1);
    if (read_.rolls) row.roll = number(place, fields, 2);
    row.branch = branch_field(place, fields[joints - 1]);
    return row;
  }

  std::vector<std::string> columns_;
  JobTrajectory read_;
  std::set<std::string> known_;  // strokes that have come
  bool processed_ = false;       // a row of the last part had process 1
};

}  // namespace

JobTrajectory read_job_trajectory(const std::string& file, std::string_view text,
                                  const JointNames& joint_names) {
  JobRows rows;
  read_csv_rows(file, text,
                {"the header of a job's trajectory",
                 [&](const std::vector<std::string>& columns, const std::string& where) {
                   rows.header(columns, joint_names, where);
                 }},
                [&](const CsvPlace& place, const std::vector<std::string>& fields) {
                  rows.add(place, fields);
                });
  return rows.finish(file);
}

JobTrajectory load_job_trajectory(const std::filesystem::path& csv, const JointNames& joint_names) {
  return read_job_trajectory(csv.string(), read_file(csv, "trajectory file", kMostTableBytes),
                             joint_names);
}

}  // namespace swivel::io
