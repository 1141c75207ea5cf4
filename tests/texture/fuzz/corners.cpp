// SPDX-License-Identifier: LGPL-2.1-or-later
// Texts of corners: an Error, or corners that, where nothing is wrong with them, are written as
// they are read.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"
#include "gst/texture/corners_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  std::optional<Corners> corners;
  try {
    corners = read_corners({reinterpret_cast<const char*>(data), size});
  } catch (const Error&) {
  }
  if (!corners || !wrong_corners(*corners).empty()) return 0;
  const std::string text = text_of(*corners);
  const auto again = read_corners(text);
  if (!again || text_of(*again) != text) abort();
  return 0;
}
