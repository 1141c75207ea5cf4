// SPDX-License-Identifier: LGPL-2.1-or-later
#include "prior_network.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "tests/srgb.hpp"

namespace inverse::reference {
namespace {

uint32_t padded(int side) {
  return static_cast<uint32_t>((side + kPriorStep - 1) / kPriorStep * kPriorStep);
}

double saturated(double v) {
  if (std::isnan(v)) return 0;
  return std::isinf(v) ? std::copysign(kPriorLimit, v) : v / (1 + std::abs(v) / kPriorLimit);
}

/// The guide at the picture's resolution.
GuideLevel seen_level(const Guide& guide, const PriorPicture& picture) {
  GuideLevel seen = guide.level[std::size_t(std::min(picture.level, kGuideLevels - 1))];
  for (int level = kGuideLevels; level <= picture.level; ++level) seen = halve(seen);
  return seen;
}

/// An image of the picture, padded by its last column and row. channels(i): values of pixel i.
template <std::size_t kChannels, class F>
Image padded_image(const GuideLevel& seen, const PriorPicture& picture, F channels) {
  Image image{{uint32_t(kChannels), padded(picture.height), padded(picture.width)}, {}};
  image.data.resize(image.shape.size());
  for (uint32_t y = 0; y < image.shape.height; ++y)
    for (uint32_t x = 0; x < image.shape.width; ++x) {
      const std::array<double, kChannels> values = channels(seen.index(int(x), int(y)));
      for (uint32_t c = 0; c < kChannels; ++c) image.at(c, y, x) = values[c];
    }
  return image;
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
  const GuideLevel seen = seen_level(guide, picture);
  return padded_image<6>(seen, picture, [&](std::size_t i) {
    std::array<double, 6> channels = {0.7 * (seen.m[i] - guide.mean),
                                      2 * seen.c0[i],
                                      2 * seen.c1[i],
                                      2 * seen.u[i] - 0.7,
                                      std::clamp((seen.m[i] + 4) / 2, -1.0, 2.0),
                                      guide.statistics[4]};
    for (double& v : channels) v = std::clamp(v, -kPriorInput, kPriorInput);
    return channels;
  });
}

Image image_input(const Guide& guide, const PriorPicture& picture) {
  const GuideLevel seen = seen_level(guide, picture);
  return padded_image<3>(seen, picture, [&](std::size_t i) {
    const double blue = -2 * seen.c1[i] / 3, middle = seen.c1[i] / 3,
                 apart = seen.c0[i] / std::sqrt(3.0);
    std::array<double, 3> rgb = {middle + apart, middle - apart, blue};
    for (double& v : rgb)
      v = srgb_code(std::clamp(std::exp(seen.m[i] + v) - kIntensityFloor, 0.0, 1.0));
    return rgb;
  });
}

std::vector<PriorFields> prior_fields(const Image& output, const PriorPicture& picture) {
  std::vector<PriorFields> fields;
  for (uint32_t y = 0; y < uint32_t(picture.height); ++y)
    for (uint32_t x = 0; x < uint32_t(picture.width); ++x) {
      PriorFields& at = fields.emplace_back();
      for (uint32_t q = 0; q < kPriorFields; ++q)
        at[q] = saturated(output.at(4 * q + 2 * (y & 1U) + (x & 1U), y / 2, x / 2));
    }
  return fields;
}

std::vector<PriorFields> reflectance_fields(const Image& reflectance, const Guide& guide,
                                            const PriorPicture& picture) {
  const GuideLevel seen = seen_level(guide, picture);
  const auto paint_at = [&](int x, int y) {
    double sum = 0;
    for (uint32_t c = 0; c < 3; ++c) {
      const double r = reflectance.at(c, uint32_t(y), uint32_t(x));
      sum += std::isnan(r) ? r : std::log(std::clamp(r, kDarkestPaint, kBrightestPaint)) / 3;
    }
    return sum;
  };
  std::vector<PriorFields> fields;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      PriorFields& at = fields.emplace_back();
      const double paint = paint_at(x, y);
      if (std::isnan(paint)) continue;
      const double target = -paint - seen.u[seen.index(x, y)];
      at = {kPaintTrust, std::clamp(target, -kPaintReach, kPaintReach), -kPaintTrust};
    }
  return fields;
}

PriorNetwork::PriorNetwork(const Guide& guide, const network::Graph& graph)
    : picture_(guide.level[0].width, guide.level[0].height) {
  const bool image = graph.inputs[0].channels == 3;
  const Image input = image ? image_input(guide, picture_) : prior_input(guide, picture_),
              output = run_network(graph, std::span(&input, 1))[0];
  fields_ = image ? reflectance_fields(output, guide, picture_) : prior_fields(output, picture_);
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
