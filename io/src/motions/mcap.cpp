// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

#include "motions/mcap_records.hpp"
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
  Cdr& add(Number value) {
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

std::string joint_state(const TimedPath& motion, const TimedRow& row, const JointNames& joint_names,
                        const std::string& frame_id) {
  const Stamp stamp = stamp_of(row.t);
  Cdr cdr;
  cdr.add(stamp.sec).add(stamp.nanosec).add(frame_id);
  const auto names = moved_joints(motion, joint_names);
  cdr.add(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) cdr.add(name);
  cdr.add(moved_joints(motion, row.row.q)).add(moved_joints(motion, row.v)).add(std::uint32_t{0});
  return cdr.message();
}

std::uint64_t nanoseconds(double t) {
  const Stamp stamp = stamp_of(t);
  return static_cast<std::uint64_t>(stamp.sec) * 1'000'000'000u + stamp.nanosec;
}

constexpr std::uint16_t kSchemaId = 1, kChannelId = 0;

std::string schema_record() {
  return record(kSchema, Bytes()
                             .add(kSchemaId)
                             .counted("sensor_msgs/msg/JointState")
                             .counted("ros2msg")
                             .counted(kJointState));
}

std::string channel_record() {
  return record(
      kChannel,
      Bytes().add(kChannelId).add(kSchemaId).counted("/joint_states").counted("cdr").counted(""));
}

/// The one chunk of a file: its records, where in it the messages begin, by time, and the times of
/// the first and the last of them, ns.
struct Chunk {
  std::string records;
  Bytes index;
  std::uint64_t begin = 0, end = 0;
  [[nodiscard]] std::uint64_t size() const { return records.size(); }
};

Chunk chunk_of(const TimedPath& motion, const JointNames& joint_names,
               const std::string& frame_id) {
  Chunk chunk;
  chunk.begin = nanoseconds(motion.rows.front().t);
  chunk.end = nanoseconds(motion.rows.back().t);
  chunk.records = schema_record() + channel_record();
  std::uint32_t sequence = 0;
  for (const TimedRow& row : motion.rows) {
    const std::uint64_t time = nanoseconds(row.t);
    chunk.index.add(time).add(chunk.size());
    chunk.records += record(kMessage, Bytes()
                                          .add(kChannelId)
                                          .add(sequence++)
                                          .add(time)
                                          .add(time)
                                          .raw(joint_state(motion, row, joint_names, frame_id)));
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

std::string statistics_record(const Chunk& chunk, std::uint64_t messages) {
  return record(kStatistics, Bytes()
                                 .add(messages)
                                 .add(std::uint16_t{1})  // schemas
                                 .add(std::uint32_t{1})  // channels
                                 .add(std::uint32_t{0})  // attachments
                                 .add(std::uint32_t{0})  // metadata
                                 .add(std::uint32_t{1})  // chunks
                                 .add(chunk.begin)
                                 .add(chunk.end)
                                 .counted(Bytes().add(kChannelId).add(messages).text()));
}

/// Returns the record that tells where in the file the chunk begins, and where the index of its
/// messages begins and ends.
std::string chunk_index_record(const Chunk& chunk, std::uint64_t chunk_at, std::uint64_t index_at,
                               std::uint64_t index_end) {
  return record(kChunkIndex, Bytes()
                                 .add(chunk.begin)
                                 .add(chunk.end)
                                 .add(chunk_at)
                                 .add(index_at - chunk_at)
                                 .counted(Bytes().add(kChannelId).add(index_at).text())
                                 .add(index_end - index_at)
                                 .counted("")
                                 .add(chunk.size())
                                 .add(chunk.size()));
}

}  // namespace

std::string to_mcap(const TimedPath& motion, const JointNames& joint_names,
                    const std::string& frame_id) {
  const std::string magic(kMcapMagic);
  const Chunk chunk = chunk_of(motion, joint_names, frame_id);
  std::string file = magic + record(kHeader, Bytes().counted("ros2").counted("swivel"));
  const std::uint64_t chunk_at = file.size();
  file += chunk_record(chunk);
  const std::uint64_t index_at = file.size();
  file += record(kMessageIndex, Bytes().add(kChannelId).counted(chunk.index.text()));
  const std::uint64_t index_end = file.size();
  file += record(kDataEnd, Bytes().add(std::uint32_t{0}));

  // The summary: groups of records, and where each group lies.
  std::string offsets;
  const std::uint64_t summary_at = file.size();
  const auto add_group = [&](Opcode opcode, const std::string& records) {
    const std::uint64_t from = file.size();
    file += records;
    offsets += record(kSummaryOffset, Bytes()
                                          .add(static_cast<std::uint8_t>(opcode))
                                          .add(from)
                                          .add(std::uint64_t{records.size()}));
  };
  add_group(kSchema, schema_record());
  add_group(kChannel, channel_record());
  add_group(kStatistics, statistics_record(chunk, motion.rows.size()));
  add_group(kChunkIndex, chunk_index_record(chunk, chunk_at, index_at, index_end));
  const std::uint64_t offsets_at = file.size();
  file += offsets;
  file += record(kFooter, Bytes().add(summary_at).add(offsets_at).add(std::uint32_t{0}));
  return file + magic;
}

}  // namespace swivel::io
