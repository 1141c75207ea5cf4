// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted bytes of a serial line: the first byte determines the chunks.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "kernels/lightstage/controllers/serial_protocol.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse::serial;
  if (!size) return 0;
  const size_t piece = 1 + data[0];
  LineReader reader;
  for (size_t at = 1; at < size; at += piece) {
    const auto* bytes = reinterpret_cast<const char*>(data) + at;
    reader.take({bytes, std::min(piece, size - at)});
    while (const auto line = reader.next()) {
      if (line->empty() || line->size() > kMaxReplyLength) abort();
      for (const char c : *line)
        if (c < ' ' || c > '~') abort();
      const Reply reply = parse_reply(*line);
      if (reply.text.size() > line->size()) abort();
    }
  }
  return 0;
}
