// SPDX-License-Identifier: LGPL-2.1-or-later
#include "prior_network.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace inverse::reference {
namespace {

uint32_t padded(int side) {
  return static_cast<uint32_t>((side + kPriorStep - 1) / kPriorStep * kPriorStep);
}

double saturated(double v, double limit) {
  if (std::isnan(v)) return 0;
  return std::isinf(v) ? std::copysign(limit, v) : v / (1 + std::abs(v) / limit);
}

}  // namespace

PriorPicture::PriorPicture(int frame_width, int frame_height, int least_level)
    : level(least_level) {
  const auto divided = [&](int side) { return (side + (1 << level) - 1) >> level; };
  while (divided(std::max(frame_width, frame_height)) > kMaxPriorSide) ++level;
  width = divided(frame_width), height = divided(frame_height);
}

Image prior_input(const Guide& guide) {
  return prior_input(guide, {guide.level[0].width, guide.level[0].height});
}

Image prior_input(const Guide& guide, const PriorPicture& picture) {
  GuideLevel seen = guide.level[std::size_t(std::min(picture.level, kGuideLevels - 1))];
  for (int level = kGuideLevels; level <= picture.level; ++level) seen = halve(seen);
  Image image{{6, padded(picture.height), padded(picture.width)}, {}};
  image.data.resize(image.shape.size());
  for (uint32_t y = 0; y < image.shape.height; ++y)
    for (uint32_t x = 0; x < image.shape.width; ++x) {
      const std::size_t i = seen.index(int(x), int(y));
      const double channels[] = {0.7 * (seen.m[i] - guide.mean),
                                 2 * seen.c0[i],
                                 2 * seen.c1[i],
                                 2 * seen.u[i] - 0.7,
                                 std::clamp((seen.m[i] + 4) / 2, -1.0, 2.0),
                                 guide.statistics[4]};
      for (uint32_t c = 0; c < image.shape.channels; ++c)
        image.at(c, y, x) = std::clamp(channels[c], -kPriorInput, kPriorInput);
    }
  return image;
}

std::vector<PriorFields> prior_fields(const Image& output, const PriorPicture& picture) {
  std::vector<PriorFields> fields;
  for (uint32_t y = 0; y < uint32_t(picture.height); ++y)
    for (uint32_t x = 0; x < uint32_t(picture.width); ++x) {
      PriorFields& at = fields.emplace_back();
      for (uint32_t q = 0; q < kPriorFields; ++q)
        at[q] =
            saturated(output.at(4 * q + 2 * (y & 1U) + (x & 1U), y / 2, x / 2), kPriorLimits[q]);
    }
  return fields;
}

PriorNetwork::PriorNetwork(const Guide& guide, const network::Graph& graph)
    : picture_(guide.level[0].width, guide.level[0].height) {
  const Image input = prior_input(guide);
  fields_ = prior_fields(run_network(graph, std::span(&input, 1))[0], picture_);
}

PriorFields PriorNetwork::at_cell(int x, int y) const {
  if (picture_.level >= kCellLevel)
    return at(x >> (picture_.level - kCellLevel), y >> (picture_.level - kCellLevel));
  const int side = 1 << (kCellLevel - picture_.level);
  PriorFields sum{};
  int count = 0;
  for (int v = side * y; v < std::min(side * (y + 1), picture_.height); ++v)
    for (int u = side * x; u < std::min(side * (x + 1), picture_.width); ++u, ++count)
      for (std::size_t q = 0; q < sum.size(); ++q) sum[q] += at(u, v)[q];
  for (double& v : sum) v /= count;
  return sum;
}

}  // namespace inverse::reference
