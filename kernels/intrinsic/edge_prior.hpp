#pragma once
#include <memory>

#include "guide.hpp"

namespace inverse {

/// Decides edge by edge how much of a step is paint and how much is light, and pixel by pixel what pins the rest
/// (energy.glsl: a, b, v, V, g). The solver knows nothing of how: whatever fills the same three buffers can take its
/// place. This one evaluates two small fitted functions of local cues (docs/method-intrinsicdecomp.md, 2).
class EdgePrior {
 public:
  struct Params {
    /// Factor on a, how firmly reflectance stays even across an edge; 1e-3…1e3.
    float reflectance_weight = 1.0F;
    /// Factor on b, how firmly shading stays even; 1e-3…1e3.
    float shading_weight = 1.0F;
    /// Factor on v, how firmly the largest channel of reflectance stays near 1; 1e-3…1e3. Pins the free scale.
    float value_weight = 1.0F;
    /// Factor on g, how firmly equal chroma means equal reflectance; 0…1e3, 0 switches the chroma bins off.
    float chroma_weight = 1.0F;
  };
  /// Where the prior writes: all in quads.
  struct Target {
    gpu::BufferPtr system;  ///< four vec4 a quad; the prior writes the edges' weights a + b, right and down
    gpu::BufferPtr flux;    ///< two vec4 a quad: a (m_x - m_y), right and down
    gpu::BufferPtr value;   ///< three vec4 a quad: v, V, g
  };
  static constexpr uint64_t kFluxStride = 2, kValueStride = 3;

  explicit EdgePrior(const std::shared_ptr<gpu::Device>& device);
  void record(gpu::Commands& commands, const Guide& guide, const Target& target, const Params& params) const;

 private:
  gpu::KernelPtr fold_, prior_;
  gpu::BufferPtr biases_;
};

}  // namespace inverse
