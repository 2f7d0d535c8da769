// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

std::vector<Waypoint> load_path(const std::filesystem::path& csv) {
  const std::vector<std::string> poses = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  std::vector<std::string> with_rolls = poses;
  with_rolls.insert(with_rolls.end(), {"roll_min", "roll_max"});
  const CsvTable table(csv, {poses, with_rolls});
  std::vector<Waypoint> waypoints;
  waypoints.reserve(table.rows());
  for (std::size_t k = 0; k < table.rows(); ++k) {
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
    if (table.header() == 1) {
      waypoint.roll = Roll{v[7], v[8]};
      if (!(v[7] <= v[8]))
        bad_input(table.where(k) + ": roll_min,roll_max", "is empty", "roll_min <= roll_max");
    }
    waypoints.push_back(waypoint);
  }
  return waypoints;
}

}  // namespace swivel::io
