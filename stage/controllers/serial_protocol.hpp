#pragma once
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stage/program/light_program.hpp"

namespace inverse::serial {

/// The lines between us and a controller: docs/reference/light-stage-serial.md.
inline constexpr int kVersion = 1;
/// Longer replies are not of this protocol.
inline constexpr size_t kLongestReply = 512;

/// CRC-32 as of zlib and Ethernet.
uint32_t crc32(std::string_view bytes);

/// What describes a program: `begin`, a `set` for each step, `end` with the checksum of all bytes
/// before it. Each line ends with a line feed.
std::vector<std::string> program_lines(const LightProgram& program);
/// The checksum that `end` carries, as it is written there and in the reply.
std::string checksum_of(const std::vector<std::string>& lines);

/// Cuts what comes over a wire into lines: without line feed and carriage return, control
/// characters made visible as '?'. Of a line that is too long the rest is left out.
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
