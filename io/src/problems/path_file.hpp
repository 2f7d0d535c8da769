// SPDX-License-Identifier: BSD-3-Clause
// Files with tool paths, as CAM programs, simulators and scripts write them: tables with columns by
// name, and APT/CL files.
#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "swivel/core/problem/path_problem.hpp"

namespace swivel::io {

/// The units of length that path files may have.
enum class LengthUnit { kMetre, kMillimetre, kInch };
/// Returns a length in m.
[[nodiscard]] double in_metres(double value, LengthUnit unit);
/// Returns the name of a unit: "m", "mm" or "inch".
[[nodiscard]] const char* name_of(LengthUnit unit);
/// Returns the unit that a word in lower-case letters stands for: "m", "mm", "in", "inch",
/// "inches"; none for any other.
[[nodiscard]] std::optional<LengthUnit> length_unit(std::string_view word);

/// A tool path as its file has it.
struct PathFile {
  std::vector<Waypoint> waypoints;  ///< m
  std::vector<double> feeds;        ///< m/s, one for each waypoint; empty: the file has none
  /// True if the file has the tool's axis alone: how far the tool is turned about it is arbitrary.
  bool axis_alone = false;
  /// One sentence each, with file and line, for what the file has and is not read.
  std::vector<std::string> warnings;
};

/// What a problem file says of a path file.
struct PathFileOptions {
  std::optional<LengthUnit> units;  ///< of positions and feeds; unset: as the file says, else m
  std::optional<std::size_t> cut;   ///< which cut of an APT file, from 1; unset: it has only one
  bool feeds = false;               ///< feeds are used; else a warning says that they are not
  /// The tool may turn about its axis without bounds: a tangent counts as a line, whose direction
  /// is the one nearer to that of the waypoint before.
  bool turns_freely = false;
};

/// Completes the warning about feeds that are not used.
inline constexpr const char* kNoFeeds =
    "strokes of a job have feeds, other paths the speed that `--speed` asks for";

/// What an APT file has, whichever of its cuts is asked for.
struct AptMoves;
/// The APT file that was loaded last, since the strokes of a job take their cuts from one file.
struct AptFile {
  std::filesystem::path name;
  std::shared_ptr<const AptMoves> moves;
};

/// Loads a tool path, from an APT file if its name ends so (is_apt_name()), else from a table. An
/// APT file that is `last` is not read again. Throws InputError.
[[nodiscard]] PathFile load_path_file(const std::filesystem::path& file,
                                      const PathFileOptions& options, AptFile& last);

/// Returns true if a file's name ends as those of APT/CL files do: .apt, .aptsource, .cl, .cls,
/// .ncl, in small or capital letters.
[[nodiscard]] bool is_apt_name(const std::filesystem::path& file);
/// Reads the text of an APT/CL file. Throws InputError.
[[nodiscard]] std::shared_ptr<const AptMoves> read_apt(const std::string& file,
                                                       std::string_view text);
/// Returns the path along a cut of an APT/CL file. Throws InputError.
[[nodiscard]] PathFile apt_path(const std::string& file, const AptMoves& moves,
                                const PathFileOptions& options);
/// Reads the text of a table. Throws InputError.
[[nodiscard]] PathFile read_table_path(const std::string& file, std::string_view text,
                                       const PathFileOptions& options);

/// A place of the tool with the direction of its axis.
struct AxisPoint {
  Vector3d position = Vector3d::Zero();  ///< m
  /// The tool's z axis is against it: the outward normal of the surface, or the direction from the
  /// tool's tip to its holder. Of any length above 1e-6.
  Vector3d outward = Vector3d::UnitZ();
  /// The tool's x axis is its part perpendicular to `outward`; unset: any.
  std::optional<Vector3d> tangent = {};
};

/// Returns the tool's orientation at each point. Without tangents the tool is turned from point to
/// point by the smallest turn that takes one axis to the next, and its x axis points along the path
/// at the first point, as far as that is perpendicular to the axis. With `either_side` a tangent
/// counts as a line (PathFileOptions::turns_freely). Throws InputError, with `where(k)`, for an
/// axis or a tangent without a direction, a tangent along its axis, and an axis opposite to the one
/// before.
[[nodiscard]] std::vector<Quaterniond> tool_frames(
    const std::vector<AxisPoint>& points, bool either_side,
    const std::function<std::string(std::size_t)>& where);

}  // namespace swivel::io
