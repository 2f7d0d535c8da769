// SPDX-License-Identifier: BSD-3-Clause
// The parts of https://mcap.dev/spec that are written and read.
#pragma once
#include <cstdint>
#include <string_view>

namespace swivel::io {

inline constexpr std::string_view kMcapMagic{"\x89MCAP0\r\n", 8};
/// The four bytes before a message in Common Data Representation: little-endian, no options.
inline constexpr std::string_view kLittleEndianCdr{"\0\1\0\0", 4};
/// The schema of the messages that say when the process of a job is switched.
inline constexpr const char* kProcessSchema = "swivel.ProcessEvent";

/// The first byte of a record, which tells its kind.
enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0B,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F
};

}  // namespace swivel::io
