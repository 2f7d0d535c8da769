// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "problems/path_file.hpp"
#include "problems/path_table.hpp"
#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/formatted.hpp"
#include "swivel/core/messages/nearest_name.hpp"
#include "swivel/io/problems/problem.hpp"

namespace swivel::io {

double in_metres(double value, LengthUnit unit) {
  if (unit == LengthUnit::kMillimetre) return value / 1000;
  return unit == LengthUnit::kInch ? value * 0.0254 : value;
}

const char* name_of(LengthUnit unit) {
  if (unit == LengthUnit::kMillimetre) return "mm";
  return unit == LengthUnit::kInch ? "inch" : "m";
}

std::optional<LengthUnit> length_unit(std::string_view word) {
  if (word == "m") return LengthUnit::kMetre;
  if (word == "mm") return LengthUnit::kMillimetre;
  if (word == "in" || word == "inch" || word == "inches") return LengthUnit::kInch;
  return std::nullopt;
}

namespace {

using Index = std::optional<std::size_t>;

constexpr const char* kColumnsAllowed =
    "columns x,y,z with qw,qx,qy,qz, or with the outward normal nx,ny,nz and, if need be, the "
    "tangent tx,ty,tz; besides roll_min,roll_max and feed";

/// A group of columns that stand together.
struct ColumnGroup {
  std::vector<const char*> names;
  std::size_t at = 0;  ///< of the first among the numbers of a row, if they are there
  bool there = false;
};

/// What the columns of a path's table are.
class PathColumns {
 public:
  ColumnGroup position{{"x", "y", "z"}}, quaternion{{"qw", "qx", "qy", "qz"}},
      normal{{"nx", "ny", "nz"}}, tangent{{"tx", "ty", "tz"}}, roll{{"roll_min", "roll_max"}},
      feed{{"feed"}};
  std::optional<LengthUnit> unit;            ///< of positions, where the header says it
  std::optional<LengthUnit> feed_unit;       ///< of the feed, where the header says it
  bool per_minute = false, degrees = false;  ///< of the feed, and of the roll
  std::string where;                         ///< of the header
  std::string skipped;                       ///< names of columns that are not read

  /// Takes the columns of a header. Returns which of them are read. Throws InputError.
  std::vector<std::size_t> choose(std::vector<TableColumn> columns, const std::string& at) {
    where = at;
    rename_axis(columns);
    std::vector<std::size_t> chosen;
    for (ColumnGroup* group : groups()) choose(*group, columns, chosen);
    for (const TableColumn& column : columns) look_at_rest(column);
    require_orientation();
    for (std::size_t k = 0; k < chosen.size(); ++k) take_unit(columns[chosen[k]], k);
    return chosen;
  }

 private:
  std::array<ColumnGroup*, 6> groups() {
    return {&position, &quaternion, &normal, &tangent, &roll, &feed};
  }

  /// Columns i,j,k, the axis of the tool from tip to holder, are the outward normal.
  static void rename_axis(std::vector<TableColumn>& columns) {
    const auto find = [&](const char* name) {
      return std::find_if(columns.begin(), columns.end(),
                          [&](const TableColumn& column) { return column.name == name; });
    };
    const std::array axis{find("i"), find("j"), find("k")};
    if (std::find(axis.begin(), axis.end(), columns.end()) != axis.end()) return;
    for (std::size_t k = 0; k < 3; ++k) axis[k]->name = std::string("n") + "xyz"[k];
  }

  void choose(ColumnGroup& group, const std::vector<TableColumn>& columns,
              std::vector<std::size_t>& chosen) const {
    std::vector<std::size_t> found;
    const char* missing = nullptr;
    for (const char* const name : group.names) {
      Index at;
      for (std::size_t k = 0; k < columns.size(); ++k) {
        if (columns[k].name != name) continue;
        if (at)
          bad_input(where, std::string("header: column ") + name + " is there twice",
                    "each column once");
        at = k;
      }
      if (at)
        found.push_back(*at);
      else
        missing = name;
    }
    if (missing && (!found.empty() || &group == &position))
      bad_input(where, std::string("header: has no column ") + missing, kColumnsAllowed);
    group.there = !missing;
    group.at = chosen.size();
    chosen.insert(chosen.end(), found.begin(), found.end());
  }

  /// Notes a column that is not read. Throws InputError for one that may be meant to be.
  void look_at_rest(const TableColumn& column) {
    std::vector<std::string> known;
    for (const ColumnGroup* group : groups())
      known.insert(known.end(), group->names.begin(), group->names.end());
    if (std::find(known.begin(), known.end(), column.name) != known.end()) return;
    constexpr std::array kCounting{"t",     "time", "s",  "index", "id", "n",
                                   "point", "no",   "nr", "line",  "row"};
    if (std::find(kCounting.begin(), kCounting.end(), column.name) == kCounting.end())
      bad_input(where,
                "header: unknown column '" + printable(column.name.substr(0, 60)) +
                    "', nearest is '" + nearest_name(column.name.substr(0, 60), known) + "'",
                kColumnsAllowed);
    skipped += (skipped.empty() ? "" : ", ") + column.name;
  }

  void require_orientation() const {
    if (quaternion.there && normal.there)
      bad_input(where, "header: has quaternions and normals", "one of the two");
    if (!quaternion.there && !normal.there)
      bad_input(where,
                std::string("header: has ") + (tangent.there ? "tangents" : "positions") +
                    " alone, and no direction of the tool",
                kColumnsAllowed);
    if (quaternion.there && tangent.there)
      bad_input(where, "header: has quaternions and tangents", "tangents beside normals");
    if (normal.there && !tangent.there && roll.there)
      bad_input(where,
                "header: has roll_min,roll_max beside normals alone, of which nothing says where "
                "the roll is 0",
                "these beside quaternions, or normals with tangents tx,ty,tz");
  }

  /// Takes the unit that stands behind the name of the k-th chosen column.
  void take_unit(const TableColumn& column, std::size_t k) {
    if (column.unit.empty()) return;
    const auto refuse = [&](const char* allowed) {
      bad_input(
          where,
          "header: column " + column.name + " in '" + printable(column.unit.substr(0, 60)) + "'",
          allowed);
    };
    if (k < 3) {
      const auto one = length_unit(column.unit);
      if (!one || (k > 0 && unit != one)) refuse("m, mm or inch, the same for x, y and z");
      unit = one;
    } else if (column.name == "feed") {
      const auto slash = column.unit.find('/');
      const std::string time = slash == std::string::npos ? "" : column.unit.substr(slash + 1);
      feed_unit = length_unit(column.unit.substr(0, slash));
      per_minute = time == "min";
      if (!feed_unit || (time != "s" && time != "min"))
        refuse("m, mm or inch, each per s or per min, as in mm/min");
    } else if (roll.there && k >= roll.at && k < roll.at + 2) {
      degrees = column.unit == "deg";
      if (!degrees && column.unit != "rad") refuse("rad or deg");
    } else {
      refuse("no unit");
    }
  }
};

/// Reads the rows of a path's table.
class PathRows {
 public:
  PathRows(const std::string& file, const PathFileOptions& options)
      : file_(file), options_(options) {}

  PathFile read(std::string_view text) {
    read_path_table(
        file_, text,
        [&](const std::vector<TableColumn>& columns, const std::string& where) {
          std::vector<std::size_t> chosen = columns_.choose(columns, where);
          unit_ = chosen_unit();
          return chosen;
        },
        [&](const CsvPlace& place, std::span<const double> row) { take(place, row); });
    if (columns_.normal.there) orient();
    tell();
    return std::move(path_);
  }

 private:
  [[nodiscard]] LengthUnit chosen_unit() const {
    if (columns_.unit && options_.units && columns_.unit != options_.units)
      bad_input(columns_.where,
                std::string("header: positions in ") + name_of(*columns_.unit) +
                    ", and the problem file says `units: " + name_of(*options_.units) + "`",
                "the same unit, or one of the two");
    return columns_.unit ? *columns_.unit : options_.units.value_or(LengthUnit::kMetre);
  }

  void take(const CsvPlace& place, std::span<const double> row) {
    lines_.push_back(place.line);
    Waypoint waypoint;
    for (std::size_t k = 0; k < 3; ++k)
      waypoint.position[static_cast<Eigen::Index>(k)] = in_metres(row[k], unit_);
    if (!(waypoint.position.array().abs() <= kMostMetres).all()) refuse_far(place);
    if (columns_.quaternion.there) {
      const auto q = row.subspan(columns_.quaternion.at, 4);
      waypoint.orientation = Quaterniond(q[0], q[1], q[2], q[3]);
      const double norm = waypoint.orientation.norm();
      if (!(std::abs(norm - 1) <= 1e-3))
        bad_input(place.where() + ": qw,qx,qy,qz", "quaternion has length " + format_double(norm),
                  "a quaternion of length 1 within 1e-3");
    } else {
      AxisPoint& point = points_.emplace_back();
      point.position = waypoint.position;
      point.outward = vector(row, columns_.normal);
      if (columns_.tangent.there) point.tangent = vector(row, columns_.tangent);
    }
    if (columns_.roll.there) waypoint.roll = window(place, row.subspan(columns_.roll.at, 2));
    path_.waypoints.push_back(waypoint);
    if (columns_.feed.there && options_.feeds)
      path_.feeds.push_back(feed(place, row[columns_.feed.at]));
  }

  static Vector3d vector(std::span<const double> row, const ColumnGroup& group) {
    return {row[group.at], row[group.at + 1], row[group.at + 2]};
  }

  [[nodiscard]] Roll window(const CsvPlace& place, std::span<const double> ends) const {
    const double unit = columns_.degrees ? kPi / 180 : 1;
    if (!(ends[0] <= ends[1]))
      bad_input(place.where() + ": roll_min,roll_max", "is empty", "roll_min <= roll_max");
    return {ends[0] * unit, ends[1] * unit};
  }

  [[nodiscard]] double feed(const CsvPlace& place, double value) const {
    const double feed =
        in_metres(value, columns_.feed_unit.value_or(unit_)) / (columns_.per_minute ? 60 : 1);
    if (!(feed > 0))
      bad_input(place.where() + ": feed", "is " + format_double(value), "a number > 0");
    return feed;
  }

  [[noreturn]] void refuse_far(const CsvPlace& place) const {
    const bool stated = columns_.unit || options_.units;
    bad_input(place.where() + ": x,y,z",
              std::string("a coordinate is too large") +
                  (stated ? "" : ": are these millimetres? then say `units: mm` beside `file`"),
              stated ? "at most 1000 m" : "numbers from -1000 to 1000");
  }

  /// Gives the waypoints the orientations that normals and tangents say.
  void orient() {
    const std::vector<Quaterniond> frames =
        tool_frames(points_, options_.turns_freely, [&](std::size_t k) {
          return CsvPlace{file_, k, lines_[k]}.where();
        });
    for (std::size_t k = 0; k < frames.size(); ++k) path_.waypoints[k].orientation = frames[k];
    path_.axis_alone = !columns_.tangent.there;
  }

  void tell() {
    if (!columns_.skipped.empty())
      path_.warnings.push_back(columns_.where + ": not read: " + columns_.skipped);
    if (columns_.feed.there && !options_.feeds)
      path_.warnings.push_back(columns_.where + ": column feed is not used: " + kNoFeeds);
    double extent = 0;
    for (const Waypoint& waypoint : path_.waypoints)
      extent = std::max(extent, waypoint.position.lpNorm<Eigen::Infinity>());
    if (unit_ != LengthUnit::kMetre && extent < kSmall)
      path_.warnings.push_back(
          columns_.where +
          formatted(": no coordinate exceeds %.3g mm, read in %s: are these metres?", 1000 * extent,
                    name_of(unit_)));
  }

  /// m; a path all of whose coordinates are less, and not in metres, is suspected to be in metres.
  static constexpr double kSmall = 0.005;

  const std::string& file_;
  const PathFileOptions& options_;
  PathColumns columns_;
  LengthUnit unit_ = LengthUnit::kMetre;
  std::vector<AxisPoint> points_;
  std::vector<int> lines_;
  PathFile path_;
};

}  // namespace

PathFile read_table_path(const std::string& file, std::string_view text,
                         const PathFileOptions& options) {
  if (options.cut.value_or(1) != 1)
    bad_input(file, "has one cut, since it is no APT file", "`cut: 1`, or no `cut`");
  return PathRows(file, options).read(text);
}

PathFile load_path_file(const std::filesystem::path& file, const PathFileOptions& options,
                        AptFile& last) {
  if (!is_apt_name(file))
    return read_table_path(file.string(), read_file(file, "CSV file", kMostTableBytes), options);
  if (!last.moves || last.name != file)
    last = {file, read_apt(file.string(), read_file(file, "APT file", kMostTableBytes))};
  return apt_path(file.string(), *last.moves, options);
}

std::vector<Waypoint> load_path(const std::filesystem::path& file) {
  AptFile last;
  return load_path_file(file, {}, last).waypoints;
}

}  // namespace swivel::io
