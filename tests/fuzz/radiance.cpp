// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted Radiance pictures: an Error, or an environment map of finite light.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/error.hpp"
#include "kernels/environment/environment.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const int file = memfd_create("radiance", MFD_CLOEXEC);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) abort();
  try {
    const Environment map = Environment::load("/proc/self/fd/" + std::to_string(file));
    if (map.rgb().size() != 3 * map.extent().pixels()) abort();
    for (const float c : map.rgb())
      if (!std::isfinite(c) || c < 0) abort();
  } catch (const Error&) {
  }
  close(file);
  return 0;
}
