// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "files/bad_input.hpp"
#include "files/csv.hpp"
#include "files/files.hpp"
#include "swivel/core/messages/input_error.hpp"
#include "swivel/io/tables/campaign.hpp"
#include "tables/run_settings.hpp"
#include "tables/table_rows.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kHeader =
    "episode,status,cost,plan_ms,nodes_checked,fcl_calls,tool_path_error_mm_mean,tool_path_error_"
    "mm_max,failed_s,cause,by,reason,checked";
constexpr std::size_t kColumns = 13;  // and one for each of the coordinates that vary

std::string milliseconds(double value) {
  std::array<char, 64> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                       std::chars_format::fixed, 3)
                             .ptr};
}

constexpr const char* kSettingsMark = "# swivel campaign ";

/// Returns the settings as one line, for people and for comparison.
std::string line_of(const RunSettings& settings) {
  return kSettingsMark + to_json(settings).dump(-1, ' ', false, Json::error_handler_t::replace) +
         '\n';
}

/// Returns how the settings in the first line of a file differ from the wanted ones; empty if they
/// do not.
std::string unlike(std::string_view found, const RunSettings& wanted) {
  if (found == line_of(wanted)) return {};
  found.remove_prefix(std::string_view(kSettingsMark).size());
  auto was = settings_from(Json::parse(found, nullptr, false));
  if (!was) return "its settings cannot be read";
  was->coordinates = wanted.coordinates;  // the header has them
  const auto other = difference(*was, wanted);
  if (!other || (other->first && !other->second)) return "begun with more settings or files";
  if (!other->first && other->second) return "begun without " + other->name;
  if (other->file) return other->name + " was another when it was begun";
  return "begun with " + other->name + " " + *other->first + ", this is " + *other->second;
}

constexpr const char* kFirstRows =
    "the first rows of this campaign and shard; remove the file to start anew";

/// Locks a file for this process. Returns false where another has locked it, or has removed it in
/// between.
bool locks(int descriptor, const fs::path& file) {
  struct stat opened {
  }, named{};
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0 && fstat(descriptor, &opened) == 0 &&
         stat(file.c_str(), &named) == 0 && opened.st_ino == named.st_ino;
}

/// The lines of a file that is being written, without a torn one at its end: the first one, and
/// where the last one ends.
struct CompleteLines {
  std::size_t end = 0;
  std::string first;
  explicit CompleteLines(const std::string& text)
      : end(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1),
        first(text.substr(0, std::min(end, text.find('\n') + 1))) {}
};

/// Why a file is not taken up: the place, what is wrong there, and what is allowed.
struct Refusal {
  std::string where, what, allowed;
};

/// Returns why the first two lines of a file of rows, settings and header, are not those of a
/// campaign; nothing if they are, or are not yet written.
std::optional<Refusal> refusal_of(std::string_view text, const CompleteLines& lines,
                                  const std::string& file, const RunSettings& settings,
                                  const std::string& header) {
  const std::string_view mark = kSettingsMark;
  if (!text.substr(0, mark.size()).starts_with(mark.substr(0, text.size())))
    return Refusal{file + ":1", "does not say which campaign it is of", kFirstRows};
  if (const std::string other = lines.first.empty() ? "" : unlike(lines.first, settings);
      !other.empty())
    return Refusal{file + ":1", other,
                   "a file of the same problem and settings; remove it to start anew"};
  if (lines.end > lines.first.size() && !text.substr(lines.first.size()).starts_with(header))
    return Refusal{file + ":2", "another header", kFirstRows};
  return std::nullopt;
}

}  // namespace

std::string episode_header(const std::vector<std::string>& coordinates) {
  std::string header(kHeader);
  for (const std::string& name : coordinates) header += ',' + csv_line_field(name);
  return header + '\n';
}

std::optional<std::vector<std::string>> coordinates_of(std::string_view line) {
  constexpr std::size_t kMostCoordinates = 100'000;
  const std::vector<std::string> names = csv_fields(line, kColumns + kMostCoordinates);
  if (names.size() < kColumns) return std::nullopt;
  std::vector<std::string> coordinates(names.begin() + kColumns, names.end());
  return episode_header(coordinates) == std::string(line) + '\n'
             ? std::optional(std::move(coordinates))
             : std::nullopt;
}

std::string csv_line(const EpisodeRow& row) {
  std::string line =
      std::to_string(row.episode) + ',' + to_string(row.status) + ',' + csv_number(row.cost) + ',' +
      milliseconds(row.plan_ms) + ',' + std::to_string(row.nodes_checked) + ',' +
      std::to_string(row.fcl_calls) + ',' + csv_number(row.tool_path_error_mm_mean) + ',' +
      csv_number(row.tool_path_error_mm_max) + ',' + csv_number(row.failed_s) + ',' + row.cause +
      ',' + csv_line_field(row.by) + ',' + csv_line_field(row.reason) + ',' + csv_bool(row.checked);
  for (const double offset : row.offsets) line += ',' + csv_number(offset);
  return line + '\n';
}

std::optional<EpisodeRow> episode_row(std::string_view line, std::size_t coordinates) {
  const std::vector<std::string> fields = csv_fields(line, kColumns + coordinates);
  if (fields.size() != kColumns + coordinates) return std::nullopt;
  EpisodeRow row;
  bool read = read_field(fields[0], row.episode) && read_field(fields[1], row.status) &&
              read_field(fields[2], row.cost) && read_field(fields[3], row.plan_ms) &&
              read_field(fields[4], row.nodes_checked) && read_field(fields[5], row.fcl_calls) &&
              read_field(fields[6], row.tool_path_error_mm_mean) &&
              read_field(fields[7], row.tool_path_error_mm_max) &&
              read_field(fields[8], row.failed_s);
  row.cause = fields[9];
  row.by = fields[10];
  row.reason = fields[11];
  read = read_field(fields[12], row.checked) && read;
  row.offsets.resize(coordinates);
  for (std::size_t k = 0; k < coordinates; ++k)
    read = read && read_field(fields[kColumns + k], row.offsets[k]);
  return read ? std::optional(row) : std::nullopt;
}

std::string to_csv(const std::vector<EpisodeRow>& rows,
                   const std::vector<std::string>& coordinates) {
  std::string text = episode_header(coordinates);
  for (const EpisodeRow& row : rows) text += csv_line(row);
  return text;
}

CampaignFile::CampaignFile(const fs::path& csv, const RunSettings& settings, const Shard& shard,
                           std::uint64_t episodes)
    : part_(csv), coordinates_(settings.coordinates) {
  part_ += ".part";
  for (const fs::path& file : {csv, part_}) {
    std::error_code ignored;
    // The rows are to be taken up again, which a device cannot do.
    if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))
      bad_input(file.string(), "is a folder or a device", "the name of a file");
  }
  descriptor_ = open(part_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(errno);
  const auto refuse = [this](const Refusal& refusal) {
    close(descriptor_);
    bad_input(refusal.where, refusal.what, refusal.allowed);
  };
  if (!locks(descriptor_, part_))
    refuse({part_.string(), "another campaign is writing it",
            "one campaign at a time for one results file"});

  const std::string text = read_file(part_, "CSV file", kMostTableBytes);
  const std::string header = episode_header(coordinates_), preamble = line_of(settings) + header;
  const CompleteLines lines(text);
  if (const auto refusal = refusal_of(text, lines, part_.string(), settings, header))
    refuse(*refusal);

  const std::size_t begin = lines.end > lines.first.size() ? preamble.size() : 0;
  ends_.push_back(begin);
  if (begin > 0) try {
      read_lines(
          std::string_view(text).substr(0, lines.end), begin, part_.string(), 3, kFirstRows,
          [&](std::string_view line) { return episode_row(line, coordinates_.size()); },
          [&](const EpisodeRow& row, const std::string& where, std::size_t end) {
            const std::size_t k = rows_.size();
            if (k >= shard.size(episodes))
              bad_input(where, "more rows than the shard has episodes", kFirstRows);
            if (row.episode != shard.episode(k))
              bad_input(where,
                        "episode " + std::to_string(row.episode) + " where the shard has " +
                            std::to_string(shard.episode(k)),
                        kFirstRows);
            rows_.push_back(row);
            ends_.push_back(end);
          });
    } catch (const InputError&) {
      close(descriptor_);
      throw;
    }
  keep(rows_.size());  // cuts off a torn line
  if (ends_.front() == 0) {
    write(preamble);
    ends_.front() = preamble.size();
  }
}

EpisodeTable load_rows(const fs::path& csv) {
  const std::string text = read_file(csv, "CSV file", kMostTableBytes);
  const std::string allowed = "the results of a whole campaign, as it wrote them";
  if (std::string_view(text).starts_with(kRunMark))
    bad_input(csv.string(), "the results of a shard, which swivel merge joins", allowed);
  const std::size_t end = std::min(text.size(), text.find('\n'));
  const auto coordinates = coordinates_of(std::string_view(text).substr(0, end));
  if (!coordinates || text.back() != '\n') bad_input(csv.string(), "not a results file", allowed);
  EpisodeTable table{*coordinates, {}};
  read_lines(
      text, end + 1, csv.string(), 2, allowed,
      [&](std::string_view line) { return episode_row(line, coordinates->size()); },
      [&](const EpisodeRow& row, const std::string&, std::size_t) { table.rows.push_back(row); });
  return table;
}

CampaignFile::~CampaignFile() {
  if (descriptor_ < 0) return;
  static_cast<void>(write_all(descriptor_, waiting_));
  std::error_code ignored;
  if (rows_.empty()) fs::remove(part_, ignored);
  close(descriptor_);
}

void CampaignFile::keep(std::size_t count) {
  flush();
  rows_.resize(count);
  ends_.resize(count + 1);
  if (ftruncate(descriptor_, static_cast<off_t>(ends_.back())) != 0) fail(errno);
}

void CampaignFile::append(const EpisodeRow& row) {
  const std::string line = csv_line(row);
  waiting_ += line;
  rows_.push_back(row);
  ends_.push_back(ends_.back() + line.size());
  if (std::chrono::steady_clock::now() - written_ >= kBetweenWrites) flush();
}

void CampaignFile::flush() {
  if (waiting_.empty()) return;
  write(std::exchange(waiting_, {}));
  written_ = std::chrono::steady_clock::now();
}

std::string CampaignFile::csv() const {
  return to_csv(rows_, coordinates_);
}

void CampaignFile::finish() {
  std::error_code error;
  fs::remove(part_, error);
  if (error) fail(error.value());
  close(descriptor_);
  descriptor_ = -1;
}

void CampaignFile::write(const std::string& text) {
  if (const int error = write_all(descriptor_, text)) fail(error);
}

void CampaignFile::fail(int error) const {
  bad_input(part_.string(), std::strerror(error), "a file in an existing, writable folder");
}

}  // namespace swivel::io
