#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"

namespace inverse {

/// Mask and specular layer of an object as local linear functions of the image: the mask of its
/// color (planes), the specular layer of its smallest channel (lines). The networks compute both at
/// few points; these functions transfer them to full resolution with the edges of the frame (guided
/// filter over 5 x 5 points: He, Sun and Tang, Guided Image Filtering, 2010; subsampled: He and
/// Sun, Fast Guided Filter, 2015).
class GuidedLayers {
 public:
  /// For squares of side x side points.
  GuidedLayers(const std::shared_ptr<gpu::Device>& device, uint32_t side);

  /// `image` is SegmentationNet's input, sRGB; `probability` its output, 0 at masked-out points.
  void record_mask(gpu::Commands& commands, const gpu::BufferPtr& image,
                   const gpu::BufferPtr& probability);
  /// `masked` and `codes` are the inputs of SpecularNet and ExponentNet: sRGB of the object with
  /// its mask, and the code of the specular layer in x.
  void record_specular(gpu::Commands& commands, const gpu::BufferPtr& masked,
                       const gpu::BufferPtr& codes);

  /// side x side points: probability = rgb · sqrt(linear RGB) + w.
  const gpu::BufferPtr& mask() const { return mask_.result; }
  /// side x side points: layer = x · smallest channel + y, in linear light; x in 0…1.
  const gpu::BufferPtr& specular() const { return specular_.result; }

 private:
  struct Filter {
    gpu::KernelPtr points, fit, mean;
    gpu::BufferPtr result;
  };
  void record(gpu::Commands& commands, const Filter& filter, const gpu::BufferPtr& guide,
              const gpu::BufferPtr& layer);

  uint32_t side_;
  Filter mask_, specular_;
  gpu::BufferPtr points_, fits_;
};

}  // namespace inverse
