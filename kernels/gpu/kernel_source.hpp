// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>

namespace inverse::gpu {

/// What one element of a buffer is; decides the texel view that kernels read it through.
enum class Element : uint8_t { vec4, scalar, word };

/// What a shader declares at one binding; the build reads it from the SPIR-V, so that layouts and
/// barriers follow the shader and are never written twice.
struct Slot {
  bool texel;  ///< a texel buffer, else a storage buffer
  bool reads, writes;
  Element element;
};

/// SPIR-V words and the shader's bindings, that live as long as the program.
struct Spirv {
  std::span<const uint32_t> words;
  std::span<const Slot> slots;
};

/// A compiled shader as the build embeds it: SPIR-V with texel views and subgroup arithmetic, with
/// texel views alone, and with neither (see Variant).
struct KernelSource {
  const char* name;
  Spirv fast;
  Spirv no_subgroups;
  Spirv portable;
};

}  // namespace inverse::gpu
