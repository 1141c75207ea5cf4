// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted lights.json of OLAT folders: an Error, or as many unit vectors as files.
#include "kernels/lightstage/program/light_list.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  LightList lights;
  try {
    lights = LightList::parse({reinterpret_cast<const char*>(data), size}, "lights");
  } catch (const Error&) {
    return 0;
  }
  if (lights.directions.empty() || lights.directions.size() != lights.files.size()) abort();
  for (const Direction& d : lights.directions)
    if (!(std::abs(std::hypot(d[0], d[1], d[2]) - 1) < 1e-9)) abort();
  return 0;
}
