// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis_strokes.hpp"

#include <algorithm>
#include <utility>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pack4.hpp"

namespace inverse {

ThesisStrokeTerm::ThesisStrokeTerm(const std::shared_ptr<gpu::Device>& device)
    : device_(device),
      coarsen_(device),
      average_(device, {}, gpu::kOneGroup),
      means_(gpu::Buffer::create(device, gpu::Element::vec4, ThesisStrokes::kMax)),
      spreads_(gpu::Buffer::create(device, gpu::Element::vec4, ThesisStrokes::kMax)) {}

void ThesisStrokeTerm::set(ThesisStrokes strokes) {
  strokes_ = std::move(strokes);
  strokes_.kinds.resize(std::min(strokes_.kinds.size(), ThesisStrokes::kMax));
  kinds_.reset();
}

void ThesisStrokeTerm::set_levels(std::vector<Extent> levels) {
  levels_ = std::move(levels);
  coarse_.clear();
}

void ThesisStrokeTerm::record_levels(gpu::Commands& commands) {
  if (empty()) return;
  if (!kinds_) {
    std::vector<float> kinds;
    for (const auto kind : strokes_.kinds)
      kinds.push_back(kind == ThesisStrokes::Kind::reflectance ? 1.0F : 0.0F);
    commands.write_table(kinds_, gpu::Element::scalar, kinds);
  }
  for (size_t n = 1; n < levels_.size(); ++n) {
    const Extent extent = levels_[n];
    if (coarse_.size() < n)
      coarse_.push_back(gpu::Buffer::create(device_, gpu::Element::vec4, pack4_count(extent)));
    commands.dispatch(coarsen_, {.fine = mask(n - 1), .coarse = coarse_[n - 1]},
                      {.size = extent, .fine_size = levels_[n - 1]}, line_of(pack4_count(extent)));
  }
}

void ThesisStrokeTerm::record_means(gpu::Commands& commands, size_t level,
                                    const gpu::BufferPtr& solution) const {
  if (empty()) return;
  commands.dispatch(average_,
                    {.stroke_mask = mask(level),
                     .kinds = kinds_,
                     .solution = solution,
                     .stroke_means = means_,
                     .stroke_spreads = spreads_},
                    {.size = levels_[level]},
                    line_of(uint64_t{count()} * average_.kernel()->workgroup()));
}

}  // namespace inverse
