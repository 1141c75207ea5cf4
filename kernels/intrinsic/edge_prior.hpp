#pragma once
#include <memory>

#include "guide.hpp"

namespace inverse {

/// Decides edge by edge how much of a step is paint and how much is light, and cell by cell what
/// pins the rest (energy.glsl: a, b, v, V, g). The solver knows nothing of how: whatever fills the
/// same three buffers can take its place. This one evaluates two small fitted functions of local
/// cues (docs/method-intrinsicdecomp.md, 2).
class EdgePrior {
 public:
  struct Params {
    /// Factor on a, how firmly reflectance stays even across an edge; 1e-3…1e3.
    float reflectance_weight = 1.0F;
    /// Factor on b, how firmly shading stays even; 1e-3…1e3.
    float shading_weight = 1.0F;
    /// Factor on v, how firmly the largest channel of reflectance stays near 1; 1e-3…1e3. Pins the
    /// free scale.
    float value_weight = 1.0F;
    /// Factor on g, how firmly equal chroma means equal reflectance; 0…1e3, 0 switches the chroma
    /// bins off.
    float chroma_weight = 1.0F;
  };
  /// Where the prior writes.
  struct Target {
    gpu::BufferPtr
        system;  ///< three vec4 a quad; the prior writes the first two, a + b to the right and down
    gpu::BufferPtr flux;   ///< two vec4 a quad: a (m_x - m_y) to the right and down
    gpu::BufferPtr value;  ///< three vec4 a quad of cells: v, V, g
  };
  static constexpr uint64_t kFluxStride = 2, kValueStride = 3;
  /// The largest g that it writes, for a chroma_weight of 1: e^3 a pixel, 16 pixels a cell.
  static constexpr float kMostChroma = 16 * 20.0856F;

  explicit EdgePrior(const std::shared_ptr<gpu::Device>& device);
  void record(gpu::Commands& commands, const Guide& guide, const Target& target,
              const Params& params) const;

 private:
  gpu::KernelPtr fold_, edges_, values_;
  gpu::BufferPtr biases_;
};

}  // namespace inverse
