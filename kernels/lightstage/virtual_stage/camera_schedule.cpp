// SPDX-License-Identifier: LGPL-2.1-or-later
#include "camera_schedule.hpp"

#include <array>

namespace inverse {
namespace {

/// As image/random.glsl.
std::array<uint32_t, 3> pcg3d(uint32_t x, uint32_t y, uint32_t z) {
  x = x * 1664525U + 1013904223U;
  y = y * 1664525U + 1013904223U;
  z = z * 1664525U + 1013904223U;
  x += y * z, y += z * x, z += x * y;
  x ^= x >> 16, y ^= y >> 16, z ^= z >> 16;
  x += y * z, y += z * x, z += x * y;
  return {x, y, z};
}

/// In [0, 1).
double part(uint32_t word) { return word / 4294967296.0; }

}  // namespace

FrameFate fate_of(uint64_t frame, const CameraFaults& faults) {
  const auto low = static_cast<uint32_t>(frame), high = static_cast<uint32_t>(frame >> 32);
  const auto one = pcg3d(low, high, faults.seed), other = pcg3d(low, ~high, faults.seed);
  FrameFate fate;
  fate.dropped = part(one[0]) < double{faults.drop_rate};
  fate.duplicated = part(one[1]) < double{faults.duplicate_rate};
  fate.shift = (2 * part(other[0]) - 1) * double{faults.jitter};
  if (part(one[2]) < double{faults.late_rate}) fate.shift += .5 + part(other[1]) / 2;
  return fate;
}

uint64_t frame_id(uint64_t frame, uint64_t first, uint32_t bits) {
  if (bits != 16) return first + frame;
  constexpr uint64_t kIds = 65535;  // 1 to 65535
  if (first == 0) return frame == 0 ? 0 : (frame - 1) % kIds + 1;
  return (first - 1 + frame) % kIds + 1;
}

}  // namespace inverse
