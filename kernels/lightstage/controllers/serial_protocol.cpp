// SPDX-License-Identifier: LGPL-2.1-or-later
#include "serial_protocol.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "common/error.hpp"

namespace inverse::serial {
namespace {

constexpr size_t kMaxLines = 1024;  // that wait for `next`; more are dropped

std::string hex(uint64_t value, int digits) {
  std::array<char, 17> text{};
  snprintf(text.data(), text.size(), "%0*llx", digits, static_cast<unsigned long long>(value));
  return text.data();
}

std::string hex(const LightColor& color) {
  std::string text;
  for (const float c : color) text += hex(static_cast<uint64_t>(std::lround(65535 * c)), 4);
  return text;
}

std::string set_line(uint32_t index, const std::vector<LightColor>& colors) {
  const std::string start = "set " + std::to_string(index) + " ";
  const auto lit = [](const LightColor& c) { return c != LightColor{}; };
  const auto first = std::find_if(colors.begin(), colors.end(), lit);
  if (first == colors.end()) return start + "off\n";
  if (std::count(colors.begin(), colors.end(), *first) == std::ssize(colors))
    return start + "all " + hex(*first) + "\n";
  if (std::count_if(colors.begin(), colors.end(), lit) == 1)
    return start + "one " + std::to_string(first - colors.begin()) + " " + hex(*first) + "\n";
  std::string line = start + "each ";
  for (const LightColor& color : colors) line += hex(color);
  return line + "\n";
}

std::string_view word(std::string_view& rest) {
  const size_t end = std::min(rest.find(' '), rest.size());
  const std::string_view result = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return result;
}

template <typename T>
bool number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty();
}

}  // namespace

uint32_t crc32(std::string_view bytes) {
  uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320 : 0);
  }
  return ~crc;
}

std::vector<std::string> program_lines(const LightProgram& program) {
  using Marker = LightProgram::Marker;
  constexpr uint32_t kMarker = LightProgram::kMarkerSteps;
  const uint32_t intro = program.marker == Marker::start ? kMarker : 0;
  const uint32_t loop =
      static_cast<uint32_t>(program.steps.size()) + (program.marker == Marker::pass ? kMarker : 0);
  std::vector<std::string> lines;
  size_t bytes = 0;
  lines.push_back("begin " + hex(program.id(), 16) + " " + std::to_string(program.lights.size()) +
                  " " + std::to_string(intro) + " " + std::to_string(loop) + " " +
                  std::to_string(program.repeat) + "\n");
  // The first triggers are the intro and one pass.
  for (uint32_t i = 0; i < intro + loop; ++i) {
    lines.push_back(set_line(i, program.colors(program.at(i))));
    bytes += lines.back().size();
    if (bytes > kMaxProgramBytes)
      throw Error(ErrorKind::unsupported,
                  '"' + program.name + "\" has more than " +
                      std::to_string(kMaxProgramBytes >> 20) +
                      " MiB of colors for a serial controller; use fewer steps that set lights one "
                      "by one, or backend=sacn");
  }
  const std::string sum = checksum_of(lines);
  lines.push_back("end " + sum + "\n");
  return lines;
}

std::string checksum_of(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines)
    if (!line.starts_with("end ")) all += line;
  return hex(crc32(all), 8);
}

void LineReader::take(std::span<const char> bytes) {
  for (const char c : bytes) {
    if (c == '\n' || c == '\r') {
      if (!partial_.empty() && lines_.size() < kMaxLines) lines_.push_back(partial_);
      partial_.clear();
    } else if (partial_.size() < kMaxReplyLength) {
      partial_.push_back(c >= ' ' && c <= '~' ? c : '?');
    }
  }
}

std::optional<std::string> LineReader::next() {
  if (lines_.empty()) return std::nullopt;
  std::string line = std::move(lines_.front());
  lines_.pop_front();
  return line;
}

Reply parse_reply(std::string_view line) {
  std::string_view rest = line;
  const std::string_view first = word(rest);
  if (first == "ok") return {Reply::Kind::ok, 0, 0, std::string(rest)};
  if (first == "error") return {Reply::Kind::error, 0, 0, std::string(rest)};
  if (first == "hello") {
    Reply reply{Reply::Kind::hello};
    if (number(word(rest), reply.token) && number(word(rest), reply.version)) {
      reply.text = rest;
      return reply;
    }
  }
  return {Reply::Kind::other, 0, 0, std::string(line)};
}

}  // namespace inverse::serial
