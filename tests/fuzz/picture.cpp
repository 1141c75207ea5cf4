// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted pictures: an Error, or as many pixels as the picture says.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/error.hpp"
#include "gst/base/pictures/picture_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  const int file = memfd_create("picture", MFD_CLOEXEC);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) abort();
  try {
    const Picture8 picture = load_picture("/proc/self/fd/" + std::to_string(file));
    if (picture.extent.pixels() == 0 || picture.rgba.size() != 4 * picture.extent.pixels()) abort();
    const LinearPicture reduced = linear_picture(picture, 16);
    for (const float v : reduced.rgba)
      if (!(v >= 0 && v <= 1)) abort();
  } catch (const Error&) {
  }
  close(file);
  return 0;
}
