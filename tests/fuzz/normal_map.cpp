// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted normal maps (PNG): an Error, or unit vectors to the camera and nothing.
#include "kernels/environment/normal_map.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const int file = memfd_create("png", MFD_CLOEXEC);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) abort();
  try {
    std::string warning;
    const NormalMap map = NormalMap::load("/proc/self/fd/" + std::to_string(file), warning);
    for (const float at : {0.0F, 0.3F, 1.0F}) {
      const Normal n = map.at(at, 1 - at);
      const float length = std::hypot(n[0], n[1], n[2]);
      if (length != 0 && !(std::fabs(length - 1) < 1e-3F && n[2] > 0)) abort();
    }
  } catch (const Error&) {
  }
  close(file);
  return 0;
}
