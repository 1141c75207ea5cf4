// SPDX-License-Identifier: LGPL-2.1-or-later
// Texts of lamps: an Error, or lamps that are within their ranges and are written as they are read.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"
#include "gst/edit/lamp_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  LampList list;
  try {
    list = read_lamps({reinterpret_cast<const char*>(data), size});
  } catch (const Error&) {
    return 0;
  }
  if (list.lamps.size() > kMaxLamps) abort();
  for (const Lamp& lamp : list.lamps) {
    for (const float v : lamp.position)
      if (!std::isfinite(v)) abort();
    if (!(lamp.power >= 0 && lamp.angle > 0 && lamp.softness <= 1 && lamp.radius >= 0)) abort();
  }
  const std::string text = text_of(list);
  if (text_of(read_lamps(text)) != text) abort();
  return 0;
}
