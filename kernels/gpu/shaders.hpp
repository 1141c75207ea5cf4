#pragma once
#include "kernel.hpp"

/// Declares a kernel that the build embeds from `<folder>/<name>.comp`; use at namespace scope in
/// the .cpp that dispatches it: `INVERSE_SHADER(image_unpack);` then
/// `inverse::shaders::image_unpack`.
#define INVERSE_SHADER(name)           \
  namespace inverse::shaders {         \
  extern const gpu::KernelSource name; \
  }                                    \
  static_assert(true, "")
