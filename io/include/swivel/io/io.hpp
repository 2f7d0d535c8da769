// SPDX-License-Identifier: BSD-3-Clause
// Files in and out. Every loader throws InputError: one line with file, key or row, what is wrong and what is allowed.
#pragma once
#include <filesystem>
#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "swivel/core/campaign.hpp"
#include "swivel/core/plan.hpp"
#include "swivel/core/problem.hpp"
#include "swivel/core/robot_model.hpp"
#include "swivel/core/timeline.hpp"

namespace swivel::io {

/// STL, OBJ, DAE, PLY, at most 2 million triangles within 1000 m: vertices as stored (no up-axis rotation, as ROS reads them), node
/// transforms and units applied, all meshes of the file merged; scale per axis, negative mirrors. The same file and scale loaded
/// twice shares one mesh within `cache`.
using MeshCache = std::map<std::string, MeshPtr>;
[[nodiscard]] MeshPtr load_mesh(const std::filesystem::path& file, const Vector3d& scale, MeshCache& cache);

/// URDF (+ SRDF when not empty). Meshes through package:// (`packages`: name -> folder; else walk up from the URDF), file://,
/// absolute or relative names. Only what a planner needs is read: visuals, materials and inertias may be as wrong as they like.
[[nodiscard]] std::shared_ptr<const RobotModel> load_robot(const std::filesystem::path& urdf,
                                                           const std::filesystem::path& srdf = {},
                                                           const std::map<std::string, std::filesystem::path>& packages = {});

/// Tool path: header x,y,z,qw,qx,qy,qz; at least two rows. Quaternions as written, of length 1 within 1e-3.
[[nodiscard]] std::vector<Waypoint> load_path(const std::filesystem::path& csv);

/// PROBLEM.yaml, design.md 4. Unknown keys are errors with the nearest known key named.
[[nodiscard]] Problem load_problem(const std::filesystem::path& yaml);

/// TRAJ.csv: header s,phi,branch,<seven joint names>, 17 significant digits; written beside and renamed.
void write_trajectory(const std::filesystem::path& csv, const PlanResult& result);
/// Joint names of the header must be those given.
[[nodiscard]] std::vector<TrajectoryRow> load_trajectory(const std::filesystem::path& csv,
                                                         const std::array<std::string, kDof>& joint_names);

/// RESULT.json as text, design.md 4. Cost, tool-path error and manipulability are null unless solved.
[[nodiscard]] std::string to_json(const PlanResult& result);
/// The timeline in Chrome's trace event format, which Perfetto and speedscope open.
[[nodiscard]] std::string to_trace_json(const Timeline& timeline);
/// Writes text beside the target and renames it over; a device or pipe is written to.
void write_file(const std::filesystem::path& file, const std::string& text);

/// RESULTS.csv of a campaign, design.md 4. Rows are appended to RESULTS.csv.part as they come, so that a killed campaign goes on
/// from there; finish() renames it. Settings are not in the file: whoever changes seed or resolution removes the .part file first.
class CampaignFile {
 public:
  /// Opens or creates the .part file and locks it against a second process. A torn last line is dropped.
  /// Throws InputError where its rows are not the first ones of the shard.
  CampaignFile(std::filesystem::path csv, const Shard& shard, std::uint64_t episodes);
  /// Leaves the .part file, but not one without a row.
  ~CampaignFile();
  CampaignFile(const CampaignFile&) = delete;
  CampaignFile& operator=(const CampaignFile&) = delete;

  /// Found at opening or appended since.
  [[nodiscard]] const std::vector<EpisodeRow>& rows() const { return rows_; }
  /// Forgets all rows but the first `count`.
  void keep(std::size_t count);
  /// The row is with the operating system when this returns.
  void append(const EpisodeRow& row);
  void finish();

 private:
  void write(const std::string& text);
  [[noreturn]] void fail(int error) const;

  std::filesystem::path csv_, part_;
  std::vector<EpisodeRow> rows_;
  std::vector<std::size_t> ends_;  ///< where each row ends in the file, after the header's end
  int descriptor_ = -1;
};

/// The answer to `campaign --json -`.
[[nodiscard]] std::string to_json(const CampaignSummary& summary);

}  // namespace swivel::io
