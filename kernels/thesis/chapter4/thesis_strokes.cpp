// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis_strokes.hpp"

#include <utility>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pack4.hpp"

namespace inverse {

ThesisStrokeTerm::ThesisStrokeTerm(const std::shared_ptr<gpu::Device>& device)
    : device_(device), means_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {}

void ThesisStrokeTerm::set(ThesisStrokes strokes) {
  strokes_ = std::move(strokes);
  masks_.clear();
  kinds_.reset();
  if (empty()) return;
  if (!average_.kernel()) average_ = {device_, {}, gpu::kOneGroup};
  means_ = gpu::Buffer::create(device_, gpu::Element::vec4, strokes_.kinds.size());
}

void ThesisStrokeTerm::draw(gpu::Commands& commands, size_t level, Extent extent) {
  if (empty()) return;
  if (masks_.size() <= level) masks_.resize(level + 1);
  if (!masks_[level]) masks_[level] = strokes_.draw(commands, extent);
  if (kinds_) return;
  std::vector<float> kinds;
  for (const auto kind : strokes_.kinds)
    kinds.push_back(kind == ThesisStrokes::Kind::reflectance ? 1.0F : 0.0F);
  commands.write_table(kinds_, gpu::Element::scalar, kinds);
}

void ThesisStrokeTerm::record_means(gpu::Commands& commands, size_t level, Extent extent,
                                    const gpu::BufferPtr& solution) const {
  if (empty()) return;
  commands.dispatch(
      average_,
      {.stroke_mask = masks_[level], .kinds = kinds_, .solution = solution, .stroke_means = means_},
      {.size = extent}, line_of(uint64_t{strokes_.kinds.size()} * average_.kernel()->workgroup()));
}

}  // namespace inverse
