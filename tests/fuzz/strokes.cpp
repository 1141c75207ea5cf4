// SPDX-License-Identifier: LGPL-2.1-or-later
// Texts of strokes: an Error, or strokes that are written as they are read.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"
#include "gst/decompose/strokes/stroke_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const std::string given(reinterpret_cast<const char*>(data), size);
  try {
    read_stroke(given);
  } catch (const Error&) {
  }
  StrokeList list;
  try {
    list = read_strokes(given);
  } catch (const Error&) {
    return 0;
  }
  const std::string text = text_of(list);
  if (text_of(read_strokes(text)) != text) abort();
  return 0;
}
