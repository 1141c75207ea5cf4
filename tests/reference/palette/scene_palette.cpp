// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_palette.hpp"

#include <algorithm>
#include <cmath>

#include "palette.hpp"

namespace inverse::reference {
namespace {

Vec4 log_reflectance(const Vec4& model) {
  Vec4 r{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double finite = model[c] > 0 ? std::min(model[c], 65504.0) : 0;
    r[c] = std::log(std::max(finite, kReflectanceFloor));
  }
  return r;
}

}  // namespace

Plane pick(const Plane& model, int stride) {
  Plane picked((model.width - 1) / stride + 1, (model.height - 1) / stride + 1);
  for (int y = 0; y < picked.height; ++y)
    for (int x = 0; x < picked.width; ++x)
      picked.at(x, y) = log_reflectance(model.at(x * stride, y * stride));
  return picked;
}

Plane paint(const Plane& model, const std::vector<Vec3>& log_colors) {
  Plane painted(model.width, model.height);
  for (std::size_t n = 0; n < model.size(); ++n) {
    const Vec3& color = log_colors[nearest_color(log_reflectance(model.data[n]), log_colors)];
    for (std::size_t c = 0; c < 3; ++c) painted.data[n][c] = std::exp(color[c]);
    painted.data[n][3] = 1;
  }
  return painted;
}

}  // namespace inverse::reference
