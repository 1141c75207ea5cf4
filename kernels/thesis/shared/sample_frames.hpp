// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

#include "kernels/gpu/device.hpp"

namespace inverse {

/// How many of `slots` sample frames of `pixels` each share a buffer that kernels can bind whole:
/// one of the four divisions that sample_frames.glsl knows. `INVERSE_SAMPLE_SLOTS=6|3|2|1`
/// overrides it.
int sample_slots_per_buffer(const gpu::Device& device, uint64_t slots, uint64_t pixels);

}  // namespace inverse
