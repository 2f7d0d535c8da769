// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "swivel/core/study/campaign.hpp"

namespace swivel::io {

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
[[nodiscard]] std::string to_json(const CampaignSummary& summary, const std::vector<HeldJoint>& held);

}  // namespace swivel::io
