// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis_known.hpp"

#include <utility>

namespace inverse {

ThesisKnownTerm::ThesisKnownTerm(const std::shared_ptr<gpu::Device>& device)
    : device_(device),
      known_(device),
      nothing_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {}

void ThesisKnownTerm::set_levels(std::vector<Extent> levels) {
  levels_ = std::move(levels);
  targets_.clear();
  weight_ = 0;
}

void ThesisKnownTerm::record(gpu::Commands& commands, const KnownReflectance* known,
                             const Frame& frame) {
  weight_ = known ? known->weight : 0;
  if (!(weight_ > 0)) return;
  if (targets_.empty())
    for (const Extent extent : levels_)
      targets_.push_back(gpu::Buffer::create(device_, gpu::Element::vec4, extent.pixels()));
  commands.dispatch(known_,
                    {.image = frame.image,
                     .reflectance = known->reflectance,
                     .known_depth = known->known_depth,
                     .depth = known->depth,
                     .valid = known->valid,
                     .scale = frame.scale,
                     .known_targets = targets_[0]},
                    {.size = levels_[0],
                     .known_size = known->extent,
                     .log_floor = frame.log_floor,
                     .chroma_floor = frame.chroma_floor},
                    {levels_[0].width, levels_[0].height});
}

}  // namespace inverse
