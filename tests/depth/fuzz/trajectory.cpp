// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted files of poses: an Error, or poses at all times near those of the file.
#include "gst/depth/trajectory.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>

#include "common/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const int file = memfd_create("poses", MFD_CLOEXEC);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) abort();
  std::vector<std::string> warnings;
  try {
    const Trajectory trajectory("/proc/self/fd/" + std::to_string(file), warnings);
    if (!trajectory.at(0, std::numeric_limits<double>::infinity())) abort();
    for (const double time : {-1e300, 0.0, 0.5, 1.0, 1e300})
      for (const double tolerance : {0.0, 0.02, 1e9})
        if (const auto rows = trajectory.at(time, tolerance); rows && !is_pose(*rows)) abort();
  } catch (const Error&) {
  }
  if (warnings.size() > 3) abort();
  close(file);
  return 0;
}
