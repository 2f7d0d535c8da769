// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "problems/path_file.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

namespace {

using Columns = std::vector<std::string>;

Waypoint waypoint_of(const CsvTable& table, std::size_t k, bool with_roll) {
  const std::span<const double> v = table.row(k);
  Waypoint waypoint;
  waypoint.position = {v[0], v[1], v[2]};
  if (!(waypoint.position.array().abs() <= kMostMetres).all())
    bad_input(table.where(k) + ": x,y,z", "a coordinate is too large",
              "numbers from -1000 to 1000");
  waypoint.orientation = Quaterniond(v[3], v[4], v[5], v[6]);
  const double norm = waypoint.orientation.norm();
  if (!(std::abs(norm - 1) <= 1e-3))
    bad_input(table.where(k) + ": qw,qx,qy,qz", "quaternion has length " + format_double(norm),
              "a quaternion of length 1 within 1e-3");
  if (with_roll) {
    waypoint.roll = Roll{v[7], v[8]};
    if (!(v[7] <= v[8]))
      bad_input(table.where(k) + ": roll_min,roll_max", "is empty", "roll_min <= roll_max");
  }
  return waypoint;
}

}  // namespace

PathFile load_path_file(const std::filesystem::path& csv, bool feeds) {
  const Columns poses = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  const auto with = [](Columns columns, std::initializer_list<const char*> more) {
    columns.insert(columns.end(), more.begin(), more.end());
    return columns;
  };
  const Columns rolls = with(poses, {"roll_min", "roll_max"});
  std::vector<Columns> headers{poses, rolls};
  if (feeds) headers.insert(headers.end(), {with(poses, {"feed"}), with(rolls, {"feed"})});
  const CsvTable table(csv, headers);
  const bool with_roll = table.header() % 2 == 1, with_feed = table.header() >= 2;
  PathFile path;
  path.waypoints.reserve(table.rows());
  for (std::size_t k = 0; k < table.rows(); ++k) {
    path.waypoints.push_back(waypoint_of(table, k, with_roll));
    if (!with_feed) continue;
    path.feeds.push_back(table.row(k).back());
    if (!(path.feeds.back() > 0))
      bad_input(table.where(k) + ": feed", "is " + format_double(path.feeds.back()),
                "a number > 0, m/s");
  }
  return path;
}

std::vector<Waypoint> load_path(const std::filesystem::path& csv) {
  return load_path_file(csv, false).waypoints;
}

}  // namespace swivel::io
