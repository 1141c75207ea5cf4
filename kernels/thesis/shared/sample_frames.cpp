// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sample_frames.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace inverse {

int sample_slots_per_buffer(const gpu::Device& device, uint64_t slots, uint64_t pixels) {
  const gpu::Limits& limits = device.limits();
  const uint64_t largest = std::min<uint64_t>(
      limits.storage_buffer_bytes / 16,
      device.variant().portable ? std::numeric_limits<uint64_t>::max() : limits.texel_elements);
  const char* wanted = std::getenv("INVERSE_SAMPLE_SLOTS");
  for (const int division : {6, 3, 2}) {
    const bool fits =
        std::min<uint64_t>(slots, static_cast<uint64_t>(division)) * pixels <= largest;
    if (wanted ? std::atoi(wanted) == division : fits) return division;
  }
  return 1;
}

}  // namespace inverse
