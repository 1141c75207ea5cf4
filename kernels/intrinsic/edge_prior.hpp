#pragma once
#include <memory>

#include "../gpu/commands.hpp"
#include "../image/plane.hpp"

namespace inverse {

/// What the frame looks like to a prior and to the solver: quads (multigrid.hpp) of energy.glsl's m, u, c0 and c1.
struct Guide {
  Extent extent;
  gpu::BufferPtr mean, excess, chroma0, chroma1;
};

/// What a prior says about every edge, as energy.glsl lays it out.
struct Edges {
  gpu::BufferPtr right, down;  ///< three vec4 a quad: a, Q, b
};

/// Decides edge by edge how reflectance and shading share a step of the image. The solver knows nothing of how: another
/// prior writes the same planes.
class EdgePrior {
 public:
  struct Params {
    /// Weight of reflectance sparsity, 0…1e6 (Eq. 3.8; 1 by method study).
    float sparsity = 1.0F;
    /// Weight of shading smoothness relative to it, 0…1e6 (Eq. 3.9).
    float smoothness = 1.0F;
    /// How fast a chroma step (in log units) makes an edge a reflectance edge, 0…100 (Eq. 3.7).
    float alpha = 15.0F;
    /// Shading smoothness left where chroma is equal, 0…1.
    float beta = 0.01F;
  };
  explicit EdgePrior(const std::shared_ptr<gpu::Device>& device);
  void record(gpu::Commands& commands, const Guide& guide, const Edges& edges, const Params& params) const;

 private:
  gpu::KernelPtr kernel_;
};

}  // namespace inverse
