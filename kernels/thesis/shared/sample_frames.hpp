// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "kernels/gpu/commands.hpp"

namespace inverse {

/// How many of `slots` sample frames of `pixels` each share a buffer that kernels can bind whole:
/// 6, 3, 2 or 1 (sample_frames.glsl). The environment variable `INVERSE_SAMPLE_SLOTS` overrides it;
/// throws Error(unsupported) if that is another number.
int sample_slots_per_buffer(const gpu::Device& device, uint64_t slots, uint64_t pixels);

/// Runs a kernel that includes sample_frames.glsl: binds `frames`, at most six, as frames0 to
/// frames5. Those that it does not need are bound to the first again.
template <typename Shader, typename Push>
void dispatch_with_frames(gpu::Commands& commands, const gpu::Program<Shader>& program,
                          const std::vector<gpu::BufferPtr>& frames,
                          typename Shader::Buffers buffers, const Push& push, gpu::Items items) {
  gpu::In* const bindings[] = {&buffers.frames0, &buffers.frames1, &buffers.frames2,
                               &buffers.frames3, &buffers.frames4, &buffers.frames5};
  for (size_t n = 0; n < 6; ++n) bindings[n]->buffer = frames[n < frames.size() ? n : 0];
  commands.dispatch(program, buffers, push, items);
}

}  // namespace inverse
