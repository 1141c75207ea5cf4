// SPDX-License-Identifier: LGPL-2.1-or-later
// Calibrations of cameras with depth: an Error, or two lenses by which a depth image can be drawn.
#include "gst/depth/calibration.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const int file = memfd_create("calibration", MFD_CLOEXEC);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) abort();
  try {
    const Calibration calibration = read_calibration("/proc/self/fd/" + std::to_string(file));
    if (!calibration.color.usable() || !calibration.depth.usable()) abort();
    constexpr Extent kSize{8, 6};
    std::vector<uint16_t> depth(kSize.pixels(), 1000), registered;
    Registration(calibration, kSize)
        .run(reinterpret_cast<const uint8_t*>(depth.data()), 2 * kSize.width, 0.001, registered);
    if (registered.size() != depth.size()) abort();
  } catch (const Error&) {
  }
  close(file);
  return 0;
}
