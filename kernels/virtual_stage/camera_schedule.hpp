#pragma once
#include <cstdint>

namespace inverse {

/// What goes wrong between a camera and who looks at its frames. The same seed does the same.
struct CameraFaults {
  float drop_rate = 0;       ///< share of frames that never arrive
  float duplicate_rate = 0;  ///< share of frames that arrive twice
  float late_rate = 0;       ///< share of frames that are stamped half a period to a period late
  float jitter = 0;          ///< time stamps are off by so much of a period at most, either way
  uint32_t seed = 0;
};

struct FrameFate {
  bool dropped = false, duplicated = false;
  double shift = 0;  ///< of the time stamp, periods
};
FrameFate fate_of(uint64_t frame, const CameraFaults& faults);

/// The number that a camera gives a frame: counted from `first`; of 16 bits 65535 is followed by 1,
/// as GigE Vision has it.
uint64_t frame_id(uint64_t frame, uint64_t first, uint32_t bits);

}  // namespace inverse
