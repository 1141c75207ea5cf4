#pragma once
#include <cstddef>
#include <cstdint>

namespace inverse::gpu {

/// SPIR-V words that live as long as the program.
struct Spirv {
  const uint32_t* words;
  size_t count;
};

/// A compiled shader as the build embeds it: SPIR-V for both variants (see Variant::portable). Its
/// header is small, as dozens of generated files include it.
struct KernelSource {
  const char* name;
  Spirv fast;
  Spirv portable;
};

}  // namespace inverse::gpu
