// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted OpenEXR pictures: an Error, or three values for each pixel of a bounded size.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/error.hpp"
#include "gst/exr/exr_picture.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  constexpr uint32_t kMaxSide = 256;
  const int file = memfd_create("exr", MFD_CLOEXEC);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) abort();
  try {
    ExrPicture picture("/proc/self/fd/" + std::to_string(file), "picture", kMaxSide);
    const Extent extent = picture.extent();
    if (!extent.pixels() || extent.width > kMaxSide || extent.height > kMaxSide) abort();
    if (picture.rgb().size() != 3 * extent.pixels()) abort();
  } catch (const Error&) {
  }
  close(file);
  return 0;
}
