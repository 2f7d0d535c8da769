// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "files/bad_input.hpp"
#include "motions/joint_rows.hpp"
#include "motions/mcap_records.hpp"
#include "motions/trajectory_formats.hpp"

namespace swivel::io {

namespace {

/// Reads little-endian values, one after the other. Throws InputError if the bytes end before a
/// value does.
class Cursor {
 public:
  Cursor(std::string_view bytes, const std::string& where) : bytes_(bytes), where_(&where) {}

  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  std::string_view raw(std::uint64_t size) {
    if (size > left()) bad_input(*where_, "is cut off", "a whole MCAP file");
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  template <class Number>
  Number number() {
    const std::string_view bytes = raw(sizeof(Number));
    std::uint64_t bits = 0;
    for (std::size_t k = sizeof(Number); k-- > 0;)
      bits = bits << 8 | static_cast<unsigned char>(bytes[k]);
    if constexpr (std::is_floating_point_v<Number>) {
      double value = 0;
      std::memcpy(&value, &bits, sizeof value);
      return value;
    } else {
      return static_cast<Number>(bits);
    }
  }
  /// Returns bytes after a length in 32 bits, as in MCAP.
  std::string_view counted() { return raw(number<std::uint32_t>()); }

  // Common Data Representation: a value is at a multiple of its size, and texts end with a zero.
  template <class Number>
  Number aligned() {
    raw((sizeof(Number) - at_ % sizeof(Number)) % sizeof(Number));
    return number<Number>();
  }
  std::string_view aligned_text() {
    const std::string_view text = raw(aligned<std::uint32_t>());
    if (text.empty() || text.back() != '\0')
      bad_input(*where_, "a text does not end with a zero", "messages in CDR");
    return text.substr(0, text.size() - 1);
  }
  std::vector<double> aligned_numbers() {
    const auto count = aligned<std::uint32_t>();
    if (count > left() / sizeof(double)) bad_input(*where_, "is cut off", "messages in CDR");
    std::vector<double> values(count);
    for (double& value : values) value = aligned<double>();
    return values;
  }

 private:
  std::string_view bytes_;
  const std::string* where_;
  std::size_t at_ = 0;
};

/// Returns the check sum of MCAP, which is that of zlib.
std::uint32_t crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t k = 0; k < made.size(); ++k) {
      made[k] = k;
      for (int bit = 0; bit < 8; ++bit) made[k] = made[k] >> 1 ^ (made[k] & 1 ? 0xEDB88320u : 0);
    }
    return made;
  }();
  std::uint32_t crc = ~0u;
  for (const char c : bytes) crc = crc >> 8 ^ table[(crc ^ static_cast<unsigned char>(c)) & 0xFF];
  return ~crc;
}

class Log {
 public:
  Log(const std::string& file, const Sought& sought)
      : file_(file), of_job_(sought.job), rows_(sought.arms, file) {}

  FileRows read(std::string_view bytes) {
    Cursor cursor(bytes, file_);
    if (cursor.raw(kMcapMagic.size()) != kMcapMagic)
      bad_input(file_, "is no MCAP file of version 0", "one that begins with its mark");
    bool whole = false;
    while (!whole) whole = record(cursor, false) == kDataEnd;
    if (!topic_)
      bad_input(file_, "has no joint states", "one topic of sensor_msgs/msg/JointState in CDR");
    return {.file = file_, .arms = rows_.finish(), .events = std::move(events_)};
  }

 private:
  struct Channel {
    std::string topic;
    bool joint_states = false, events = false;
  };

  /// Reads a record and returns its opcode.
  std::uint8_t record(Cursor& cursor, bool in_chunk) {
    const auto opcode = cursor.number<std::uint8_t>();
    Cursor content(cursor.raw(cursor.number<std::uint64_t>()), file_);
    switch (opcode) {
      case kSchema: {
        const auto id = content.number<std::uint16_t>();
        const std::string_view name = content.counted(), encoding = content.counted();
        if (name == "sensor_msgs/msg/JointState" && encoding == "ros2msg")
          joint_state_schemas_.insert(id);
        if (name == kProcessSchema) event_schemas_.insert(id);
        break;
      }
      case kChannel: {
        const auto id = content.number<std::uint16_t>();
        const auto schema = content.number<std::uint16_t>();
        const bool joint_states = joint_state_schemas_.contains(schema),
                   events = of_job_ && event_schemas_.contains(schema);
        const std::string topic(content.counted());
        if (joint_states && content.counted() != "cdr")
          bad_input(file_ + ": topic '" + topic + "'", "is not in CDR", "CDR");
        channels_.insert_or_assign(id, Channel{topic, joint_states, events});
        if (events && !events_) events_.emplace();
        break;
      }
      case kMessage: {
        const auto channel = channels_.find(content.number<std::uint16_t>());
        if (channel == channels_.end())
          bad_input(file_, "has a message of an unknown channel", "channels before their messages");
        const std::string& topic = channel->second.topic;
        if (!channel->second.joint_states) {
          if (channel->second.events) event(content, topic);
          break;
        }
        if (topic_ && *topic_ != topic)
          bad_input(file_, "has joint states on '" + *topic_ + "' and '" + topic + "'",
                    "one topic with joint states");
        topic_ = topic;
        message(body_of(content));
        break;
      }
      case kChunk:
        if (in_chunk)
          bad_input(file_, "has a chunk in a chunk",
                    "records as the specification of MCAP has them");
        chunk(content);
        break;
      case kFooter:
        bad_input(file_, "has no end of data", "a whole MCAP file");
      default:
        break;  // header, indexes, attachments, metadata: nothing of joints
    }
    return opcode;
  }

  void chunk(Cursor& content) {
    content.raw(3 * sizeof(std::uint64_t));  // times, size
    const auto crc = content.number<std::uint32_t>();
    const std::string_view compression = content.counted();
    if (!compression.empty())
      bad_input(file_, "has chunks compressed by " + std::string(compression),
                "chunks without compression: mcap compress --compression none");
    const std::string_view records = content.raw(content.number<std::uint64_t>());
    if (crc != 0 && crc != crc32(records))
      bad_input(file_, "is damaged: a chunk's check sum differs", "a file as it was written");
    for (Cursor cursor(records, file_); !cursor.at_end();) record(cursor, true);
  }

  /// Returns the text of a message, behind its sequence, log time and publish time.
  static std::string_view body_of(Cursor& content) {
    content.raw(sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t));
    return content.raw(content.left());
  }

  /// Reads an event of a job's process.
  void event(Cursor& content, const std::string& topic) {
    constexpr std::size_t kMostBytes = 16 << 20;  // a value takes many times its bytes
    const std::string where =
        file_ + ": message " + std::to_string(events_->size()) + " of '" + topic + "'";
    const std::string_view text = body_of(content);
    event_bytes_ += text.size();
    if (event_bytes_ > kMostBytes) bad_input(where, "is too much", "events of at most 16 MiB");
    nlohmann::json read = nlohmann::json::parse(text, nullptr, false);
    if (read.is_discarded()) bad_input(where, "is not JSON", "messages in JSON");
    events_->push_back(std::move(read));
  }

  void message(std::string_view bytes) {
    where_ = file_ + ": message " + std::to_string(messages_++) + " of '" + *topic_ + "'";
    if (!bytes.starts_with(kLittleEndianCdr))
      bad_input(where_, "is not in little-endian CDR", "messages in it");
    Cursor cursor(bytes.substr(kLittleEndianCdr.size()), where_);
    const std::int64_t sec = cursor.aligned<std::int32_t>();
    const std::int64_t nanoseconds = sec * 1'000'000'000 + cursor.aligned<std::uint32_t>();
    cursor.aligned_text();  // frame_id
    const auto count = cursor.aligned<std::uint32_t>();
    if (count > cursor.left()) bad_input(where_, "is cut off", "messages in CDR");
    std::vector<std::string> names;
    for (std::uint32_t k = 0; k < count; ++k) {
      names.emplace_back(cursor.aligned_text());
      if (names.size() > rows_.joint_count()) break;  // refused below, whatever follows
    }
    rows_.joints(names, where_);
    const std::vector<double> q = cursor.aligned_numbers(), v = cursor.aligned_numbers();
    cursor.aligned_numbers();  // efforts
    if (messages_ == 1) first_ = nanoseconds;
    rows_.add(nanoseconds - first_, q, v, {}, where_);
  }

  const std::string& file_;
  bool of_job_;  // events are wanted
  JointRows rows_;
  std::optional<std::vector<nlohmann::json>> events_;
  std::size_t event_bytes_ = 0;  // of their texts
  std::set<std::uint16_t> joint_state_schemas_, event_schemas_;
  std::map<std::uint16_t, Channel> channels_;
  std::optional<std::string> topic_;
  std::string where_;
  std::size_t messages_ = 0;
  std::int64_t first_ = 0;
};

}  // namespace

FileRows read_mcap(const std::string& file, std::string_view text, const Sought& sought) {
  return Log(file, sought).read(text);
}

}  // namespace swivel::io
