// SPDX-License-Identifier: LGPL-2.1-or-later
#include "texture_pyramid.hpp"

#include "kernels/image/pyramid.hpp"

namespace inverse {

TexturePyramid::TexturePyramid(const std::shared_ptr<gpu::Device>& device, Extent picture)
    : extent_(picture), base_(device, {.base = true}), level_(device) {
  uint64_t texels = picture.pixels();
  for (Extent size = picture; size.pixels() > 1; ++levels_) {
    size = half_of(size);
    texels += size.pixels();
  }
  buffer_ = gpu::Buffer::create(device, gpu::Element::vec4, texels);
}

void TexturePyramid::record(gpu::Commands& commands, const Plane& picture) {
  Extent fine = extent_;
  uint32_t first = 0;
  for (uint32_t level = 0; level < levels_; ++level) {
    const Extent size = level == 0 ? extent_ : half_of(fine);
    const auto fine_pixels = static_cast<uint32_t>(level == 0 ? 0 : fine.pixels());
    commands.dispatch(
        level == 0 ? base_ : level_, {.picture = picture.buffer, .pyramid = buffer_},
        {.fine_size = fine, .size = size, .fine_first = first, .first = first + fine_pixels},
        gpu::Items(static_cast<uint32_t>(size.pixels())));
    first += fine_pixels;
    fine = size;
  }
}

}  // namespace inverse
