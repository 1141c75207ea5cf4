// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sample_frames.hpp"

#include <algorithm>

#include "kernels/gpu/variables.hpp"

namespace inverse {

int sample_slots_per_buffer(const gpu::Device& device, uint64_t slots, uint64_t pixels) {
  const gpu::Limits& limits = device.limits();
  const uint64_t largest = std::min(limits.storage_buffer_bytes / 16, limits.texel_elements);
  const uint32_t wanted = gpu::environment_number("INVERSE_SAMPLE_SLOTS", 0, 6);
  for (const uint32_t division : {6U, 3U, 2U, 1U}) {
    const bool fits = std::min<uint64_t>(slots, division) * pixels <= largest || division == 1;
    if (wanted ? wanted == division : fits) return static_cast<int>(division);
  }
  throw Error(ErrorKind::unsupported, "INVERSE_SAMPLE_SLOTS is " + std::to_string(wanted) +
                                          "; set 6, 3, 2 or 1, or unset it");
}

}  // namespace inverse
