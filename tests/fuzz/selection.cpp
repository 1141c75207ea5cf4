// SPDX-License-Identifier: LGPL-2.1-or-later
// Texts of strokes that select: an Error, or strokes that are written as they are read.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"
#include "gst/edit/selection_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const std::string given(reinterpret_cast<const char*>(data), size);
  try {
    read_selection_stroke(given);
  } catch (const Error&) {
  }
  SelectionList list;
  try {
    list = read_selection(given);
  } catch (const Error&) {
    return 0;
  }
  if (list.strokes.size() > kMaxSelectionStrokes) abort();
  const std::string text = text_of(list);
  if (text_of(read_selection(text)) != text) abort();
  return 0;
}
