// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "motions/joint_rows.hpp"
#include "motions/trajectory_columns.hpp"
#include "motions/trajectory_formats.hpp"
#include "schema/schema.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

namespace {

/// The columns of a table that hold the values of a row.
struct Columns {
  using Place = std::optional<std::size_t>;
  Place t, s, phi, roll, branch;
  std::array<Place, kDof> q, v, a;
};

/// Finds the columns. Names are tried in the order in which Swivel writes them, so that a joint may
/// have the name of another column. Throws InputError.
Columns columns_of(const std::vector<std::string>& header, const JointNames& names,
                   const std::string& where) {
  Columns columns;
  std::vector<std::pair<std::string, Columns::Place*>> known{
      {"t", &columns.t}, {"s", &columns.s}, {"phi", &columns.phi}};
  if (!may_lack_last(names)) known.emplace_back("roll", &columns.roll);
  known.emplace_back("branch", &columns.branch);
  for (const auto& [ending, places] :
       {std::pair("", &columns.q), std::pair("_v", &columns.v), std::pair("_a", &columns.a)})
    for (std::size_t j = 0; j < kDof; ++j) known.emplace_back(names[j] + ending, &(*places)[j]);
  std::string joints;
  for (const std::string& name : names) joints += ", " + csv_field(name);
  const std::string allowed =
      "t, s, phi, roll, branch" + joints + ", and joints with _v and _a, each once";
  const auto end = header.size();
  if (end > kDof + 2 && header[end - 2] == "stroke" && header[end - 1] == "process")
    bad_input(where, "columns 'stroke' and 'process' are those of a job's rows",
              "the rows of one path; those of a job are read with the job's problem file");
  for (std::size_t k = 0; k < header.size(); ++k) {
    bool there = false, placed = false;
    for (auto& [name, place] : known) {
      if (name != header[k]) continue;
      there = true;
      if (*place) continue;
      *place = k;
      placed = true;
      break;
    }
    if (!placed)
      bad_input(where,
                "column '" + header[k] + "' " +
                    (there ? "is there twice" : "is unknown, or no joint of the arm"),
                allowed);
  }
  const auto all = [&](const std::array<Columns::Place, kDof>& places, const std::string& ending,
                       std::size_t count) {
    for (std::size_t j = 0; j < kDof; ++j)
      if (places[j].has_value() != (j < count))
        bad_input(where,
                  "column '" + names[j] + ending + "' is " +
                      (places[j] ? "there, but not its joint" : "missing"),
                  allowed);
  };
  const std::size_t count = may_lack_last(names) && !columns.q.back() ? kDof - 1 : kDof;
  all(columns.q, "", count);
  for (const auto& [ending, places] : {std::pair("_v", &columns.v), std::pair("_a", &columns.a)}) {
    if (std::none_of(places->begin(), places->end(),
                     [](const Columns::Place& place) { return place.has_value(); }))
      continue;
    if (!columns.t)
      bad_input(where, std::string("joints have ") + ending + ", but column 't' is missing",
                allowed);
    all(*places, ending, count);
  }
  return columns;
}

TrajectoryFile read_csv(const std::string& file, std::string_view text, const JointNames& names) {
  Columns columns;
  const CsvTable table(file, text,
                       {"a header with the names of the arm's joints",
                        [&](const std::vector<std::string>& header, const std::string& where) {
                          columns = columns_of(header, names, where);
                        }});
  TrajectoryFile read;
  Stated& stated = read.stated;
  stated.s = columns.s.has_value();
  stated.phi = columns.phi.has_value();
  stated.branch = columns.branch.has_value();
  // Swivel leaves the column out where all are 0
  stated.roll = columns.roll || (stated.s && stated.phi && stated.branch);
  stated.last_joint = columns.q.back().has_value();
  stated.v = columns.v.front().has_value();
  stated.a = columns.a.front().has_value();
  for (std::size_t k = 0; k < table.rows(); ++k) {
    const std::span<const double> values = table.row(k);
    const auto take = [&](const Columns::Place& place) { return place ? values[*place] : 0.0; };
    TimedRow timed;
    TrajectoryRow& row = timed.row;
    row.s = take(columns.s);
    row.phi = take(columns.phi);
    row.roll = take(columns.roll);
    const double branch = take(columns.branch);
    if (!(branch >= 0 && branch <= 7) || branch != static_cast<int>(branch))
      bad_input(table.where(k) + ": branch", "is " + format_double(branch),
                "a whole number from 0 to 7");
    row.branch = static_cast<int>(branch);
    for (std::size_t j = 0; j < kDof; ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      row.q[joint] = take(columns.q[j]);
      timed.v[joint] = take(columns.v[j]);
      timed.a[joint] = take(columns.a[j]);
    }
    read.rows.push_back(row);
    if (!columns.t) continue;
    timed.t = take(columns.t);
    if (k > 0 && !(timed.t > read.timed.back().t))
      bad_input(table.where(k) + ": t", "is " + format_double(timed.t),
                "times that ascend from row to row");
    read.timed.push_back(timed);
  }
  return read;
}

enum class Format { kCsv, kJson, kYaml, kMcap };

/// Returns the format of a file by its contents, docs/formats.md "Trajectories that are read".
Format format_of(std::string_view text) {
  if (text.starts_with("\x89MCAP")) return Format::kMcap;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#' || line.starts_with("---")) continue;
    if (line[first] == '{' || line[first] == '[') return Format::kJson;
    const auto end = line.find_first_not_of("abcdefghijklmnopqrstuvwxyz_", first);
    const bool is_key = end != std::string_view::npos && end > first && line[end] == ':' &&
                        (end + 1 == line.size() || line[end + 1] == ' ' || line[end + 1] == '\r');
    return is_key ? Format::kYaml : Format::kCsv;
  }
  return Format::kCsv;
}

}  // namespace

TrajectoryFile load_trajectory_file(const std::filesystem::path& path,
                                    const JointNames& joint_names) {
  const std::string text = read_file(path, "trajectory file", kMostTableBytes),
                    file = path.string();
  switch (format_of(text)) {
    case Format::kJson:
      return read_joint_trajectory_json(file, text, joint_names);
    case Format::kYaml:
      return read_joint_trajectory_yaml(file, text, joint_names);
    case Format::kMcap:
      return read_mcap(file, text, joint_names);
    case Format::kCsv:
      break;
  }
  return read_csv(file, text, joint_names);
}

}  // namespace swivel::io
