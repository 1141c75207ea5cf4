// SPDX-License-Identifier: LGPL-2.1-or-later
// Remembered scenes, whose mark and checksum are put before the input: an Error, or a scene that is
// within its limits.
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/checksum.hpp"
#include "common/error.hpp"
#include "kernels/depth/memory/scene_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  std::string text = "gst-inverse scene 2\n";
  const uint64_t sum = checksum({reinterpret_cast<const char*>(data), size});
  text.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  text.append(reinterpret_cast<const char*>(data), size);
  const int file = memfd_create("scene", MFD_CLOEXEC);
  if (file < 0 || write(file, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    abort();
  try {
    const SceneData scene = load_scene("/proc/self/fd/" + std::to_string(file), 1 << 20);
    if (scene.volume.voxels.size() != scene.volume.keys.size() * VolumeData::kBlockVoxels) abort();
    for (const auto& frame : scene.keyframes)
      for (const float depth : frame.picture.depth)
        if (!std::isfinite(depth)) abort();
  } catch (const Error&) {
  }
  close(file);
  return 0;
}
