#include "guided_upsample.hpp"

#include <array>

#include "kernels/gpu/shaders.hpp"
#include "kernels/image/pyramid.hpp"
#include "kernels/image/quads.hpp"

INVERSE_SHADER(intrinsic_resolution_upsample_sample);
INVERSE_SHADER(intrinsic_resolution_upsample_fit);
INVERSE_SHADER(intrinsic_resolution_upsample_layers);

namespace inverse {

GuidedUpsample::GuidedUpsample(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      sample_(device->kernel(shaders::intrinsic_resolution_upsample_sample)),
      fit_(device->kernel(shaders::intrinsic_resolution_upsample_fit)),
      layers_(device->kernel(shaders::intrinsic_resolution_upsample_layers)),
      samples_(gpu::Buffer::create(device, gpu::Element::vec4, half_of(extent).pixels())),
      lines_(gpu::Buffer::create(device, gpu::Element::vec4, half_of(extent).pixels())) {}

void GuidedUpsample::record(gpu::Commands& commands, const gpu::BufferPtr& frame,
                            const gpu::BufferPtr& half_intrinsic,
                            const gpu::BufferPtr& intrinsic) const {
  const Extent half = half_of(extent_);
  const std::array<uint32_t, 2> size{extent_.width, extent_.height},
      half_size{half.width, half.height};
  const gpu::Items items = line_of(half.pixels());
  commands.dispatch(sample_, {frame, half_intrinsic, samples_}, size, items);
  commands.dispatch(fit_, {samples_, lines_}, half_size, items);
  commands.dispatch(layers_, {frame, lines_, intrinsic}, size, items);
}

}  // namespace inverse
