// SPDX-License-Identifier: LGPL-2.1-or-later
#include "object_light.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/image/format/transfer.hpp"

namespace inverse {
namespace {

constexpr float kClipped = 0.985F;  // code, sRGB

/// Inverse sRGB curve, interpolated in a table.
float linear(float code) {
  constexpr size_t kSteps = 1024;
  static const auto table = [] {
    const Transfer srgb = Transfer::of(TransferFunction::srgb);
    std::array<float, kSteps + 2> t{};
    for (size_t i = 0; i < t.size(); ++i) {
      t[i] = static_cast<float>(srgb.decode(static_cast<double>(i) / kSteps));
    }
    return t;
  }();
  const float at = std::clamp(code, 0.0F, 1.0F) * kSteps;
  const auto low = static_cast<size_t>(at);
  return table[low] + (at - static_cast<float>(low)) * (table[low + 1] - table[low]);
}

/// As in lime.glsl.
float decoded(float code) { return 0.25F * (std::exp(2 * std::clamp(code, 0.0F, 8.0F)) - 1); }

/// The points within the frame.
GridWindow window_of(const ObjectLight::View& view) {
  const float pixels = view.square.size / static_cast<float>(view.side);
  const auto first = [&](float corner) {
    return static_cast<uint32_t>(
        std::clamp(std::ceil(-corner / pixels - 0.5F), 0.0F, static_cast<float>(view.side)));
  };
  const auto past = [&](float corner, uint32_t size) {
    return static_cast<uint32_t>(
        std::clamp(std::ceil((static_cast<float>(size) - corner) / pixels - 0.5F), 0.0F,
                   static_cast<float>(view.side)));
  };
  return {first(view.square.x), first(view.square.y), past(view.square.x, view.frame.width),
          past(view.square.y, view.frame.height)};
}

}  // namespace

const std::vector<Normal>& ObjectLight::normals(const View& view,
                                                const std::shared_ptr<const NormalMap>& map) {
  const bool same_place = view.square == square_ && map == map_ && !normals_.empty();
  if (same_place && (map || std::ranges::equal(view.mask, mask_))) return normals_;
  square_ = view.square;
  map_ = map;
  mask_.assign(view.mask.begin(), view.mask.end());
  if (!map) {
    normals_ = inflated_normals(view.mask, view.side, window_of(view));
    return normals_;
  }
  normals_.assign(size_t{view.side} * view.side, Normal{});
  const float pixels = view.square.size / static_cast<float>(view.side);
  for (uint32_t row = 0; row < view.side; ++row)
    for (uint32_t column = 0; column < view.side; ++column) {
      const float x = (view.square.x + pixels * (static_cast<float>(column) + 0.5F)) /
                      static_cast<float>(view.frame.width);
      const float y = (view.square.y + pixels * (static_cast<float>(row) + 0.5F)) /
                      static_cast<float>(view.frame.height);
      if (x >= 0 && x < 1 && y >= 0 && y < 1) normals_[row * view.side + column] = map->at(x, y);
    }
  return normals_;
}

void ObjectLight::add(const View& view, const std::shared_ptr<const NormalMap>& map,
                      const Params& params) {
  if (!map && !params.inflate) return;
  const std::vector<Normal>& normals = this->normals(view, map);
  std::vector<EnvironmentFit::Point> points;
  points.reserve(normals.size());
  for (size_t i = 0; i < normals.size(); ++i) {
    if (!view.mask[i] || !(normals[i][2] > 0)) continue;
    const float *code = &view.image[4 * i], *layers = &view.codes[4 * i];
    EnvironmentFit::Point point{normals[i]};
    float lowest = 1;
    for (size_t c = 0; c < 3; ++c) {
      point.diffuse[c] = linear(code[c]);
      point.clipped |= !(code[c] < kClipped);
      lowest = std::min(lowest, point.diffuse[c]);
    }
    const float specular = std::min(decoded(layers[0]), lowest);
    for (float& light : point.diffuse) light -= specular;
    point.mirror = decoded(layers[1]);
    points.push_back(point);
  }
  lacks_normals_ = points.empty();
  fit_.add(points, params.fit);
}

std::shared_ptr<const Environment> ObjectLight::light(const Material& material,
                                                      const Params& params) const {
  auto light = fit_.light(material.diffuse, material.specular, params.fit);
  return light ? std::make_shared<const Environment>(std::move(*light)) : nullptr;
}

}  // namespace inverse
