// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/study/campaign.hpp"

namespace swivel::io {

/// The settings that determine the rows of a campaign or of placements: version, options, and the
/// contents of all input files. Rows of other settings must not be mixed with them.
struct RunSettings {
  /// name and value, such as "seed", "1"
  std::vector<std::pair<std::string, std::string>> values;
  std::vector<std::pair<std::string, std::uint64_t>> files;  ///< name and hash of the contents
  /// whose offsets the rows have, a column each
  std::vector<std::string> coordinates;
};

/// The rows of a campaign's RESULTS.csv, docs/formats.md, while it runs. They are appended to
/// RESULTS.csv.part as they come, in blocks of kBetweenWrites, so that a killed campaign can
/// continue from there. The first line of that file holds the settings.
class CampaignFile {
 public:
  /// Time between two writes. A campaign that is killed loses the rows of so much time at most.
  static constexpr std::chrono::milliseconds kBetweenWrites{100};

  /// Opens or creates the .part file of `csv` and locks it against a second process. A torn last
  /// line is dropped. Throws InputError if the file belongs to other settings, and says what
  /// differs, or if its rows are not the first ones of the shard.
  CampaignFile(const std::filesystem::path& csv, const RunSettings& settings, const Shard& shard,
               std::uint64_t episodes);
  /// Writes the rows that wait, without telling of errors, and closes the .part file; removes it if
  /// it has no row.
  ~CampaignFile();
  CampaignFile(const CampaignFile&) = delete;
  CampaignFile& operator=(const CampaignFile&) = delete;

  /// Returns the rows found at opening and those appended since.
  [[nodiscard]] const std::vector<EpisodeRow>& rows() const { return rows_; }
  /// Drops all rows but the first `count`, in the file as well. Throws InputError if that fails.
  void keep(std::size_t count);
  /// Appends a row. Writes it, and all that wait, if the last write was kBetweenWrites ago. Throws
  /// InputError if that fails.
  void append(const EpisodeRow& row);
  /// Writes the rows that wait; the operating system has them when this returns. Throws InputError
  /// if that fails.
  void flush();
  /// Returns the text of RESULTS.csv.
  [[nodiscard]] std::string csv() const;
  /// Removes the .part file; call it once RESULTS.csv is written. Throws InputError if that fails.
  void finish();

 private:
  void write(const std::string& text);
  [[noreturn]] void fail(int error) const;

  std::filesystem::path part_;
  std::vector<std::string> coordinates_;
  std::vector<EpisodeRow> rows_;
  std::vector<std::size_t> ends_;  ///< ends of rows in the file, after the end of the header
  std::string waiting_;            ///< lines of the last rows, to be written
  std::chrono::steady_clock::time_point written_;
  int descriptor_ = -1;
};

/// The contents of a finished RESULTS.csv of a whole campaign. load_shard() reads those of shards.
struct EpisodeTable {
  std::vector<std::string> coordinates;  ///< whose offsets the rows have
  std::vector<EpisodeRow> rows;
};
/// Loads a finished RESULTS.csv of a whole campaign. Throws InputError for any other file, the
/// results of a shard included.
[[nodiscard]] EpisodeTable load_rows(const std::filesystem::path& csv);

/// Returns the text of RESULTS.csv. `coordinates` names the coordinates whose offsets the rows
/// have.
[[nodiscard]] std::string to_csv(const std::vector<EpisodeRow>& rows,
                                 const std::vector<std::string>& coordinates);

/// Returns the summary of a campaign as JSON, as `campaign --json` writes it. `held` are the joints
/// that stood still.
[[nodiscard]] std::string to_json(const CampaignSummary& summary,
                                  const std::vector<HeldJoint>& held);

}  // namespace swivel::io
