// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "bad_input.hpp"
#include "csv.hpp"
#include "files.hpp"
#include "swivel/core/input_error.hpp"
#include "swivel/io/io.hpp"

namespace swivel::io {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kHeader =
    "episode,status,cost,plan_ms,nodes_checked,fcl_calls,tool_path_error_mm_mean,tool_path_error_mm_max,failed_s,reason\n";
constexpr std::size_t kColumns = 10;

/// The shortest digits that read back as the same double.
std::string number(double value) {
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

std::string number(const std::optional<double>& value) {
  return value ? number(*value) : "";
}

std::string milliseconds(double value) {
  std::array<char, 64> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed, 3).ptr};
}

/// On one line whatever bodies are called, so that the rows of a file that was cut off can be told apart.
std::string quoted(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return csv_field(text);
}

std::string line_of(const EpisodeRow& row) {
  return std::to_string(row.episode) + ',' + to_string(row.status) + ',' + number(row.cost) + ',' + milliseconds(row.plan_ms) +
         ',' + std::to_string(row.nodes_checked) + ',' + std::to_string(row.fcl_calls) + ',' + number(row.tool_path_error_mm_mean) +
         ',' + number(row.tool_path_error_mm_max) + ',' + number(row.failed_s) + ',' + quoted(row.reason) + '\n';
}

/// Empty where a quote is left open.
std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields(1);
  bool inside = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (line[k] == '"') {
      if (inside && k + 1 < line.size() && line[k + 1] == '"')
        fields.back() += line[k++];
      else
        inside = !inside;
    } else if (line[k] == ',' && !inside) {
      fields.emplace_back();
    } else {
      fields.back() += line[k];
    }
  }
  return inside ? std::vector<std::string>{} : fields;
}

template <class Value>
bool parse(const std::string& field, Value& value) {
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size();
}

bool parse(const std::string& field, std::optional<double>& value) {
  return field.empty() || (parse(field, value.emplace()) && std::isfinite(*value));
}

std::optional<EpisodeRow> row_of(std::string_view line) {
  const std::vector<std::string> fields = fields_of(line);
  if (fields.size() != kColumns) return std::nullopt;
  EpisodeRow row;
  const auto statuses = {PlanStatus::kSolved, PlanStatus::kInfeasible, PlanStatus::kError};
  const auto* const status =
      std::find_if(statuses.begin(), statuses.end(), [&](PlanStatus s) { return fields[1] == to_string(s); });
  if (status == statuses.end()) return std::nullopt;
  row.status = *status;
  const bool read = parse(fields[0], row.episode) && parse(fields[2], row.cost) && parse(fields[3], row.plan_ms) &&
                    parse(fields[4], row.nodes_checked) && parse(fields[5], row.fcl_calls) &&
                    parse(fields[6], row.tool_path_error_mm_mean) && parse(fields[7], row.tool_path_error_mm_max) &&
                    parse(fields[8], row.failed_s);
  row.reason = fields[9];
  return read ? std::optional(row) : std::nullopt;
}

/// The rows of a text from a byte on that is the beginning of a line; `line` is its number. `visit` gets each, what names its
/// place, and the byte after it.
template <class Visit>
void read_rows(std::string_view text, std::size_t begin, const std::string& file, int line, const std::string& allowed,
               const Visit& visit) {
  for (; begin < text.size(); ++line) {
    const std::size_t end = text.find('\n', begin) + 1;
    const std::string where = at_line(file, line);
    const auto row = row_of(text.substr(begin, end - 1 - begin));
    if (!row) bad_input(where, "not a row of results", allowed);
    visit(*row, where, end);
    begin = end;
  }
}

constexpr std::string_view kSettingsMark = "# swivel campaign ";

/// One line, for people and for comparison.
std::string line_of(const CampaignSettings& settings) {
  Json json = {{"settings", Json::object()}, {"files", Json::object()}};
  for (const auto& [name, value] : settings.values) json["settings"][name] = value;
  for (const auto& [name, hash] : settings.files) json["files"][name] = hash;
  return std::string(kSettingsMark) + json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

/// What a file that begins with the first line has otherwise than one that begins with the second; empty if nothing.
std::string difference(std::string_view found, std::string_view wanted) {
  if (found == wanted) return {};
  found.remove_prefix(kSettingsMark.size());
  wanted.remove_prefix(kSettingsMark.size());
  const Json was = Json::parse(found, nullptr, false), is = Json::parse(wanted);
  const auto has = [&](const char* key) { return was.is_object() && was.contains(key) && was[key].is_object(); };
  if (!has("settings") || !has("files")) return "its settings cannot be read";
  const auto text = [](const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); };
  for (const auto& [name, value] : is["settings"].items()) {
    const auto old = was["settings"].find(name);
    if (old == was["settings"].end()) return "begun without " + name;
    if (*old != value) return "begun with " + name + " " + text(*old) + ", this is " + text(value);
  }
  for (const auto& [name, hash] : is["files"].items()) {
    const auto old = was["files"].find(name);
    if (old == was["files"].end()) return "begun without " + name;
    if (*old != hash) return name + " was another when it was begun";
  }
  return "begun with more settings or files";
}

}  // namespace

CampaignFile::CampaignFile(const fs::path& csv, const CampaignSettings& settings, const Shard& shard, std::uint64_t episodes)
    : part_(csv) {
  part_ += ".part";
  for (const fs::path& file : {csv, part_}) {
    std::error_code ignored;
    // The rows are to be taken up again, which a device cannot do.
    if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))
      bad_input(file.string(), "is a folder or a device", "the name of a file");
  }
  descriptor_ = open(part_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(errno);
  const auto refuse = [this](const std::string& where, const std::string& what, const std::string& allowed) {
    close(descriptor_);
    bad_input(where, what, allowed);
  };
  struct stat opened {
  }, named{};
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 || fstat(descriptor_, &opened) != 0 || stat(part_.c_str(), &named) != 0 ||
      opened.st_ino != named.st_ino)  // or has removed it in between
    refuse(part_.string(), "another campaign is writing it", "one campaign at a time for one results file");

  const std::string text = read_file(part_, "CSV file", kMostTableBytes);
  const std::string mine = "the first rows of this campaign and shard; remove the file to start anew";
  const std::string mine_settings = line_of(settings), preamble = mine_settings + std::string(kHeader);
  const std::size_t complete = text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1;
  const std::string first = text.substr(0, std::min(complete, text.find('\n') + 1));
  if (!std::string_view(text).substr(0, kSettingsMark.size()).starts_with(kSettingsMark.substr(0, text.size())))
    refuse(part_.string() + ":1", "does not say which campaign it is of", mine);
  if (const std::string other = first.empty() ? "" : difference(first, mine_settings); !other.empty())
    refuse(part_.string() + ":1", other, "a file of the same problem and settings; remove it to start anew");
  if (complete > first.size() && !std::string_view(text).substr(first.size()).starts_with(kHeader))
    refuse(part_.string() + ":2", "another header", mine);

  const std::size_t begin = complete > first.size() ? preamble.size() : 0;
  ends_.push_back(begin);
  if (begin > 0) try {
      read_rows(std::string_view(text).substr(0, complete), begin, part_.string(), 3, mine,
                [&](const EpisodeRow& row, const std::string& where, std::size_t end) {
                  const std::size_t k = rows_.size();
                  if (k >= shard.size(episodes)) bad_input(where, "more rows than the shard has episodes", mine);
                  if (row.episode != shard.episode(k))
                    bad_input(where,
                              "episode " + std::to_string(row.episode) + " where the shard has " + std::to_string(shard.episode(k)),
                              mine);
                  rows_.push_back(row);
                  ends_.push_back(end);
                });
    } catch (const InputError&) {
      close(descriptor_);
      throw;
    }
  keep(rows_.size());  // cuts what is torn
  if (ends_.front() == 0) {
    write(preamble);
    ends_.front() = preamble.size();
  }
}

std::vector<EpisodeRow> load_rows(const fs::path& csv) {
  const std::string text = read_file(csv, "CSV file", kMostTableBytes);
  const std::string allowed = "the results of a campaign or a shard, as it wrote them";
  if (!std::string_view(text).starts_with(kHeader) || text.back() != '\n') bad_input(csv.string(), "not a results file", allowed);
  std::vector<EpisodeRow> rows;
  read_rows(text, kHeader.size(), csv.string(), 2, allowed,
            [&](const EpisodeRow& row, const std::string&, std::size_t) { rows.push_back(row); });
  return rows;
}

CampaignFile::~CampaignFile() {
  if (descriptor_ < 0) return;
  std::error_code ignored;
  if (rows_.empty()) fs::remove(part_, ignored);
  close(descriptor_);
}

void CampaignFile::keep(std::size_t count) {
  rows_.resize(count);
  ends_.resize(count + 1);
  if (ftruncate(descriptor_, static_cast<off_t>(ends_.back())) != 0) fail(errno);
}

void CampaignFile::append(const EpisodeRow& row) {
  const std::string line = line_of(row);
  write(line);
  rows_.push_back(row);
  ends_.push_back(ends_.back() + line.size());
}

std::string CampaignFile::csv() const {
  std::string text(kHeader);
  for (const EpisodeRow& row : rows_) text += line_of(row);
  return text;
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
