// SPDX-License-Identifier: BSD-3-Clause
// Files in and out. Every loader throws InputError: one line with file, key or row, what is wrong and what is allowed.
#pragma once
#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "swivel/core/campaign.hpp"
#include "swivel/core/cut.hpp"
#include "swivel/core/input_error.hpp"
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

/// What a robot model has of its URDF.
struct RobotOptions {
  std::vector<std::string> without;  ///< links left out, with all that they carry
  bool soft_limits = true;           ///< joints keep the soft limits of their <safety_controller>, where these are narrower
};

/// URDF 1.0 to 1.2 (+ SRDF when not empty). Meshes through package:// (`packages`: name -> folder; else walk up from the URDF),
/// file://, absolute or relative names. Every element and attribute that states geometry, limits or which joints move is read or
/// refused; names that the formats do not have are warned of elsewhere (RobotModel::warnings). Visuals, materials, inertias and
/// what simulators and drivers keep in the file are not read, and may be as wrong as they like.
[[nodiscard]] std::shared_ptr<const RobotModel> load_robot(const std::filesystem::path& urdf,
                                                           const std::filesystem::path& srdf = {},
                                                           const std::map<std::string, std::filesystem::path>& packages = {},
                                                           const RobotOptions& options = {});

/// The same of texts, as a program holds them: relative names of meshes are those of the current folder.
[[nodiscard]] std::shared_ptr<const RobotModel> parse_robot(const std::string& urdf, const std::string& srdf = {},
                                                            const std::map<std::string, std::filesystem::path>& packages = {},
                                                            const RobotOptions& options = {});

/// What a URDF has of shapes.
struct ShapeSurvey {
  std::size_t collision = 0;                ///< <collision> elements
  std::size_t visual_meshes = 0;            ///< meshes in <visual> elements
  std::vector<std::string> missing_meshes;  ///< a message for each mesh of a <collision> that is not found
};

/// Links and joints of a URDF (+ SRDF when not empty) without shapes: meshes are not read.
[[nodiscard]] std::shared_ptr<const RobotModel> load_kinematics(const std::filesystem::path& urdf,
                                                                const std::filesystem::path& srdf,
                                                                const std::map<std::string, std::filesystem::path>& packages,
                                                                const RobotOptions& options, ShapeSurvey& shapes);

/// Tool path: header x,y,z,qw,qx,qy,qz; at least two rows. Quaternions as written, of length 1 within 1e-3.
[[nodiscard]] std::vector<Waypoint> load_path(const std::filesystem::path& csv);

/// PROBLEM.yaml, docs/formats.md. Unknown keys are errors with the nearest known key named.
[[nodiscard]] Problem load_problem(const std::filesystem::path& yaml);

/// TRAJ.csv: header s, phi, branch and the seven joint names, 17 significant digits.
[[nodiscard]] std::string to_csv(const PlanResult& result);
/// The same as a file, written beside and renamed.
void write_trajectory(const std::filesystem::path& csv, const PlanResult& result);

/// RESULT.json as text, docs/formats.md. Cost, tool-path error and manipulability are null unless solved.
[[nodiscard]] std::string to_json(const PlanResult& result);
/// CERTIFICATE.json, docs/formats.md: a line for each layer.
[[nodiscard]] std::string to_json(const Cut& cut);
[[nodiscard]] Cut load_cut(const std::filesystem::path& json);
/// RESULT.json after an internal error: its status is "error".
[[nodiscard]] std::string error_json(const std::string& message);
/// The timeline in Chrome's trace event format, which Perfetto and speedscope open.
[[nodiscard]] std::string to_trace_json(const Timeline& timeline);
/// Writes text beside the target and renames it over; a device or pipe is written to.
void write_file(const std::filesystem::path& file, const std::string& text);

/// Which file a name means, through links and whatever folder it is named from: by device and inode, and for a file that is not
/// there yet by its folder's and its own name.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0;
  std::string name;  ///< empty for a file that is there
  friend auto operator<=>(const FileIdentity&, const FileIdentity&) = default;
};

/// Notes every file that the loaders above read on this thread while it lives: what no output may replace, and what a campaign's
/// rows hang on. One at a time on a thread.
class InputFiles {
 public:
  /// Contents: whether to take them in as well, which costs a pass over every file.
  enum class Contents { kIgnore, kHash };
  explicit InputFiles(Contents contents = Contents::kIgnore);
  ~InputFiles();
  InputFiles(const InputFiles&) = delete;
  InputFiles& operator=(const InputFiles&) = delete;

  struct File {
    std::filesystem::path name;            ///< as it was opened
    std::optional<FileIdentity> identity;  ///< unset for pipes and devices
    std::uint64_t hash = 0;                ///< FNV-1a, 64 bits
  };
  /// In the order they were read; a file that was read twice is here once.
  [[nodiscard]] const std::vector<File>& files() const { return files_; }

  /// For loaders: the file was read, and this was in it.
  static void note(const std::filesystem::path& file, std::string_view text);

 private:
  std::vector<File> files_;
  Contents contents_;
};

/// Standard output is a pipe that nobody reads any more, as behind `| head`. Who prints ends then, silently.
class ReaderLeft : public InputError {
 public:
  ReaderLeft() : InputError("standard output: nobody reads it any more: allowed is one that takes what is printed") {}
};
/// True where standard output is a pipe or socket whose reader has left.
[[nodiscard]] bool reader_has_left();

/// The files that a command writes: all of them, or none. Names are judged before the work begins; afterwards stage() lays the
/// texts beside their targets and writes to pipes and devices, so that a full disk shows, and commit() renames. A link is followed
/// and what it points to is replaced. Pipes and character devices are written to, never replaced nor removed; the name - is
/// standard output.
class OutputFiles {
 public:
  /// `inputs`: what no output may replace.
  explicit OutputFiles(std::vector<InputFiles::File> inputs = {}) : inputs_(std::move(inputs)) {}
  /// Removes what was staged and not committed.
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  /// `option` names the output here and in messages; an empty file name is no output. Throws InputError where the file cannot be
  /// written, is one of the inputs, or is an output already.
  void add(const std::string& option, const std::filesystem::path& file);
  /// After all of these: a folder, which need not be there, for files that are written while the work goes on, outside of this
  /// class; `is_one` tells their names. Throws InputError where it is no folder, or where one of them is, or would be, one of the
  /// inputs or outputs.
  void add_folder(const std::string& option, const std::filesystem::path& folder,
                  const std::function<bool(const std::string&)>& is_one) const;
  [[nodiscard]] bool wants(const std::string& option) const;
  /// Whether one of them goes to standard output, by whatever name, so that nothing else should be printed there.
  [[nodiscard]] bool takes_standard_output() const;
  /// What the file is to hold; nothing where the option has no file. A file without a text is left as it is.
  void write(const std::string& option, std::string text);
  /// An earlier file of that name is to go: it would be taken for the answer.
  void remove(const std::string& option);

  void stage();
  /// After stage(). Returns the files that were removed. Throws InputError, like stage().
  std::vector<std::filesystem::path> commit();

 private:
  struct Output {
    std::string option;
    std::filesystem::path name, target, staged;
    FileIdentity identity;
    bool stream = false;  ///< a pipe or a device
    int descriptor = -1;  ///< one of the process's own, for a stream that is its standard output or error
    std::optional<std::string> text;
    bool remove = false;
  };
  [[nodiscard]] Output* find(const std::string& option);
  static void unstage(Output& output);

  std::vector<InputFiles::File> inputs_;
  std::vector<Output> outputs_;
};

/// What the rows of a campaign or of placements hang on. Rows of other settings must not be mixed with them.
struct RunSettings {
  std::vector<std::pair<std::string, std::string>> values;   ///< as "seed", "1"
  std::vector<std::pair<std::string, std::uint64_t>> files;  ///< name and hash of the contents
  std::vector<std::string> coordinates;                      ///< whose offsets the rows have: a column each
};

/// The rows of a campaign's RESULTS.csv, docs/formats.md, while it runs: they are appended to RESULTS.csv.part as they come, so
/// that a killed campaign goes on from there. The first line of that file holds the settings.
class CampaignFile {
 public:
  /// Opens or creates the .part file and locks it against a second process. A torn last line is dropped.
  /// Throws InputError, which says what differs, where it is of other settings, or its rows are not the first ones of the shard.
  CampaignFile(const std::filesystem::path& csv, const RunSettings& settings, const Shard& shard, std::uint64_t episodes);
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
  /// The text of RESULTS.csv.
  [[nodiscard]] std::string csv() const;
  /// RESULTS.csv is written: removes the .part file.
  void finish();

 private:
  void write(const std::string& text);
  [[noreturn]] void fail(int error) const;

  std::filesystem::path part_;
  std::vector<std::string> coordinates_;
  std::vector<EpisodeRow> rows_;
  std::vector<std::size_t> ends_;  ///< where each row ends in the file, after the end of what stands before them
  int descriptor_ = -1;
};

/// A finished RESULTS.csv of a whole campaign: those of shards are for load_shard().
struct EpisodeTable {
  std::vector<std::string> coordinates;  ///< whose offsets the rows have
  std::vector<EpisodeRow> rows;
};
[[nodiscard]] EpisodeTable load_rows(const std::filesystem::path& csv);

/// The text of RESULTS.csv. `coordinates`: whose offsets the rows have.
[[nodiscard]] std::string to_csv(const std::vector<EpisodeRow>& rows, const std::vector<std::string>& coordinates);

/// The answer to `campaign --json -`.
[[nodiscard]] std::string to_json(const CampaignSummary& summary);

}  // namespace swivel::io
