// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

namespace inverse {

/// Simulated transport faults of a camera. The same seed gives the same faults.
struct CameraFaults {
  float drop_rate = 0;       ///< share of frames that never arrive
  float duplicate_rate = 0;  ///< share of frames that arrive twice
  float late_rate = 0;       ///< share of frames stamped half a period to a period late
  float jitter = 0;          ///< maximum error of time stamps, either way, periods
  uint32_t seed = 0;
};

struct FrameFate {
  bool dropped = false, duplicated = false;
  double shift = 0;  ///< of the time stamp, periods
};
FrameFate fate_of(uint64_t frame, const CameraFaults& faults);

/// Frame id of a camera, counted from `first`; with 16 bits 65535 is followed by 1, as in GigE
/// Vision.
uint64_t frame_id(uint64_t frame, uint64_t first, uint32_t bits);

}  // namespace inverse
