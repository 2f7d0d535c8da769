// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "motions/mcap_records.hpp"
#include "motions/messages.hpp"
#include "motions/moved_joints.hpp"
#include "motions/stamp.hpp"
#include "swivel/io/motions/motion.hpp"

namespace swivel::io {

namespace {

/// Collects bytes, with numbers little-endian as in MCAP and CDR.
class Bytes {
 public:
  template <class Number>
  Bytes& add(Number value) {
    using Unsigned = std::conditional_t<
        sizeof(Number) == 1, std::uint8_t,
        std::conditional_t<sizeof(Number) == 2, std::uint16_t,
                           std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>>>;
    Unsigned bits;
    std::memcpy(&bits, &value, sizeof bits);
    for (std::size_t k = 0; k < sizeof bits; ++k)
      text_ += static_cast<char>(static_cast<unsigned char>(bits >> (8 * k)));
    return *this;
  }
  Bytes& raw(std::string_view text) {
    text_ += text;
    return *this;
  }
  /// Adds a text after its length in 32 bits, as for MCAP's strings, arrays and maps.
  Bytes& counted(std::string_view text) {
    return add(static_cast<std::uint32_t>(text.size())).raw(text);
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] std::uint64_t size() const { return text_.size(); }

 private:
  std::string text_;
};

std::string record(Opcode opcode, const Bytes& content) {
  return Bytes()
      .add(static_cast<std::uint8_t>(opcode))
      .add(content.size())
      .raw(content.text())
      .text();
}

/// The definition of the message, with the definitions of its parts.
constexpr const char* kJointState =
    "std_msgs/Header header\n"
    "string[] name\n"
    "float64[] position\n"
    "float64[] velocity\n"
    "float64[] effort\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\n"
    "builtin_interfaces/Time stamp\n"
    "string frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";

/// Collects a message in Common Data Representation, little-endian: every number is at a multiple
/// of its size.
class Cdr {
 public:
  template <class Number>
  requires std::is_arithmetic_v<Number> Cdr& add(Number value) {
    while (bytes_.size() % sizeof value != 0) bytes_.add(std::uint8_t{0});
    bytes_.add(value);
    return *this;
  }
  Cdr& add(const std::string& text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.raw(text).add(std::uint8_t{0});
    return *this;
  }
  Cdr& add(std::span<const double> values) {
    add(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) add(value);
    return *this;
  }
  /// Returns the message, after the four bytes that name the representation.
  [[nodiscard]] std::string message() const {
    return std::string(kLittleEndianCdr) + bytes_.text();
  }

 private:
  Bytes bytes_;
};

std::string joint_state(const MotionMessages& motion, std::size_t row) {
  const Stamp stamp = stamp_of(motion.rows[row].t);
  Cdr cdr;
  cdr.add(stamp.sec).add(stamp.nanosec).add(motion.frame_id);
  const auto names = motion.names();
  cdr.add(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) cdr.add(name);
  const auto positions =
      motion.values(row, [](const TimedRow& r) -> const Config& { return r.row.q; });
  const auto speeds = motion.values(row, [](const TimedRow& r) -> const Config& { return r.v; });
  cdr.add(std::span(positions)).add(std::span(speeds)).add(std::uint32_t{0});
  return cdr.message();
}

/// The definition of an event of a job.
constexpr const char* kProcessEvent =
    R"({"type": "object", "title": "swivel.ProcessEvent", )"
    R"("description": "The tool's process is on from a stroke's begin to its end.", )"
    R"("properties": {)"
    R"("t": {"type": "number", "description": "s since the motion began"}, )"
    R"("stroke": {"type": "string", "description": "name of the stroke"}, )"
    R"("s": {"type": "number", "description": "m along its path, the approach included"}, )"
    R"("process": {"type": "string", "enum": ["on", "off"]}, )"
    R"("run": {"type": "object", "description": "Where the stroke's rows begin and end, approach )"
    R"(and retract included.", "properties": {)"
    R"("t": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}, )"
    R"("s": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}}}}, )"
    R"("required": ["t", "stroke", "s", "process", "run"]})";

std::uint64_t nanoseconds(double t) {
  const Stamp stamp = stamp_of(t);
  return static_cast<std::uint64_t>(stamp.sec) * 1'000'000'000u + stamp.nanosec;
}

/// A topic of a log, whose messages have one schema.
struct Topic {
  std::uint16_t schema_id, channel_id;
  const char *schema, *schema_encoding, *definition;
  const char *name, *encoding;  ///< of its messages
};
constexpr Topic kJointStates{
    1, 0, "sensor_msgs/msg/JointState", "ros2msg", kJointState, "/joint_states", "cdr"};
constexpr Topic kProcess{2, 1, kProcessSchema, "jsonschema", kProcessEvent, "/process", "json"};

std::string schema_record(const Topic& topic) {
  return record(kSchema, Bytes()
                             .add(topic.schema_id)
                             .counted(topic.schema)
                             .counted(topic.schema_encoding)
                             .counted(topic.definition));
}

std::string channel_record(const Topic& topic) {
  return record(kChannel, Bytes()
                              .add(topic.channel_id)
                              .add(topic.schema_id)
                              .counted(topic.name)
                              .counted(topic.encoding)
                              .counted(""));
}

/// The messages of a topic in the chunk: how many there are, and where they begin, by time.
struct Indexed {
  const Topic* topic;
  Bytes index = {};
  std::uint32_t count = 0;
};

/// The one chunk of a file: its records, the messages of each topic, and the times of the first and
/// the last of them, ns.
struct Chunk {
  std::string records;
  std::vector<Indexed> topics;
  std::uint64_t begin = 0, end = 0;
  [[nodiscard]] std::uint64_t size() const { return records.size(); }
  [[nodiscard]] std::uint64_t messages() const {
    std::uint64_t sum = 0;
    for (const Indexed& topic : topics) sum += topic.count;
    return sum;
  }

  void add_message(Indexed& to, std::uint64_t time, const std::string& message) {
    to.index.add(time).add(size());
    records +=
        record(kMessage,
               Bytes().add(to.topic->channel_id).add(to.count++).add(time).add(time).raw(message));
  }
};

Chunk chunk_of(const MotionMessages& motion) {
  Chunk chunk;
  chunk.begin = nanoseconds(motion.rows.front().t);
  chunk.end = nanoseconds(motion.rows.back().t);
  chunk.topics.push_back({&kJointStates});
  if (motion.events) chunk.topics.push_back({&kProcess});
  for (const Indexed& one : chunk.topics)
    chunk.records += schema_record(*one.topic) + channel_record(*one.topic);
  std::size_t event = 0;
  for (std::size_t row = 0; row < motion.rows.size(); ++row) {
    const std::uint64_t time = nanoseconds(motion.rows[row].t);
    chunk.add_message(chunk.topics[0], time, joint_state(motion, row));
    for (; motion.events && event < motion.events->size(); ++event) {
      const EventMessage& due = (*motion.events)[event];
      if (nanoseconds(due.t) > time) break;
      chunk.add_message(chunk.topics[1], time, due.json);
    }
  }
  return chunk;
}

std::string chunk_record(const Chunk& chunk) {
  return record(kChunk, Bytes()
                            .add(chunk.begin)
                            .add(chunk.end)
                            .add(chunk.size())
                            .add(std::uint32_t{0})
                            .counted("")
                            .add(chunk.size())
                            .raw(chunk.records));
}

std::string statistics_record(const Chunk& chunk) {
  Bytes counts;
  for (const Indexed& one : chunk.topics)
    counts.add(one.topic->channel_id).add(std::uint64_t{one.count});
  const std::size_t topics = chunk.topics.size();
  return record(kStatistics, Bytes()
                                 .add(chunk.messages())
                                 .add(static_cast<std::uint16_t>(topics))  // schemas
                                 .add(static_cast<std::uint32_t>(topics))  // channels
                                 .add(std::uint32_t{0})                    // attachments
                                 .add(std::uint32_t{0})                    // metadata
                                 .add(std::uint32_t{1})                    // chunks
                                 .add(chunk.begin)
                                 .add(chunk.end)
                                 .counted(counts.text()));
}

/// Returns the record that tells where in the file the chunk begins, and where the indexes of its
/// messages are: `offsets` holds the place of each by channel.
std::string chunk_index_record(const Chunk& chunk, std::uint64_t chunk_at, std::uint64_t index_at,
                               std::uint64_t index_end, const Bytes& offsets) {
  return record(kChunkIndex, Bytes()
                                 .add(chunk.begin)
                                 .add(chunk.end)
                                 .add(chunk_at)
                                 .add(index_at - chunk_at)
                                 .counted(offsets.text())
                                 .add(index_end - index_at)
                                 .counted("")
                                 .add(chunk.size())
                                 .add(chunk.size()));
}

}  // namespace

std::string mcap_log(const MotionMessages& motion) {
  const std::string magic(kMcapMagic);
  const Chunk chunk = chunk_of(motion);
  // The profile ros2 has messages in CDR alone.
  std::string file =
      magic + record(kHeader, Bytes().counted(motion.events ? "" : "ros2").counted("swivel"));
  const std::uint64_t chunk_at = file.size();
  file += chunk_record(chunk);
  const std::uint64_t index_at = file.size();
  Bytes index_offsets;
  for (const Indexed& one : chunk.topics) {
    index_offsets.add(one.topic->channel_id).add(std::uint64_t{file.size()});
    file += record(kMessageIndex, Bytes().add(one.topic->channel_id).counted(one.index.text()));
  }
  const std::uint64_t index_end = file.size();
  file += record(kDataEnd, Bytes().add(std::uint32_t{0}));

  // The summary: groups of records, and where each group lies.
  std::string offsets, schemas, channels;
  for (const Indexed& one : chunk.topics) {
    schemas += schema_record(*one.topic);
    channels += channel_record(*one.topic);
  }
  const std::uint64_t summary_at = file.size();
  const auto add_group = [&](Opcode opcode, const std::string& records) {
    const std::uint64_t from = file.size();
    file += records;
    offsets += record(kSummaryOffset, Bytes()
                                          .add(static_cast<std::uint8_t>(opcode))
                                          .add(from)
                                          .add(std::uint64_t{records.size()}));
  };
  add_group(kSchema, schemas);
  add_group(kChannel, channels);
  add_group(kStatistics, statistics_record(chunk));
  add_group(kChunkIndex, chunk_index_record(chunk, chunk_at, index_at, index_end, index_offsets));
  const std::uint64_t offsets_at = file.size();
  file += offsets;
  file += record(kFooter, Bytes().add(summary_at).add(offsets_at).add(std::uint32_t{0}));
  return file + magic;
}

std::string to_mcap(const TimedPath& motion, const JointNames& joint_names,
                    const std::string& frame_id) {
  return mcap_log({motion.rows, motion.roll, joint_names, frame_id});
}

}  // namespace swivel::io
