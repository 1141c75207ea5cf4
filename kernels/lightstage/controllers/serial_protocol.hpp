// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/lightstage/program/light_program.hpp"

namespace inverse::serial {

/// The line protocol of a controller: docs/reference/light-stage-serial.md.
inline constexpr int kVersion = 1;
/// Of a reply, bytes. The rest of a longer line is dropped.
inline constexpr size_t kMaxReplyLength = 512;

/// Of the upload of a program, which may be a thousand times as long as its file.
inline constexpr size_t kMaxProgramBytes = size_t{64} << 20;

/// CRC-32 of zlib and Ethernet.
uint32_t crc32(std::string_view bytes);

/// The upload of a program: `begin`, one `set` per step, `end` with the checksum of all bytes
/// before it. Each line ends with a line feed. Throws Error(unsupported) above kMaxProgramBytes.
std::vector<std::string> program_lines(const LightProgram& program);
/// The checksum of `end` and of its reply, as text.
std::string checksum_of(const std::vector<std::string>& lines);

/// Splits received bytes into lines, without line feed and carriage return. Control characters
/// become '?'. Lines are cut at kMaxReplyLength.
class LineReader {
 public:
  void take(std::span<const char> bytes);
  std::optional<std::string> next();

 private:
  std::string partial_;
  std::deque<std::string> lines_;
};

/// A controller's line.
struct Reply {
  enum class Kind : uint8_t { ok, hello, error, other } kind = Kind::other;
  uint32_t token = 0;  ///< of hello
  int version = 0;     ///< of hello
  std::string text;    ///< what follows
};
Reply parse_reply(std::string_view line);

}  // namespace inverse::serial
