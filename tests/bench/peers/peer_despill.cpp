// SPDX-License-Identifier: LGPL-2.1-or-later
#include "peer_despill.hpp"

#include <algorithm>

#include "tests/srgb.hpp"

namespace inverse::bench {
namespace {

float to_code(float v) { return srgb_code(std::clamp(v, 0.0F, 1.0F)); }

float to_linear(float v) { return srgb_light(std::clamp(v, 0.0F, 1.0F)); }

/// Applies change(r, g, b) to the codes of every pixel.
template <typename Change>
Image on_codes(const Image& linear, const Change& change) {
  Image out = linear;
  for (std::size_t i = 0; i + 2 < out.data.size(); i += 3) {
    float code[3];
    for (std::size_t c = 0; c < 3; ++c) code[c] = to_code(out.data[i + c]);
    change(code[0], code[1], code[2]);
    for (std::size_t c = 0; c < 3; ++c) out.data[i + c] = to_linear(code[c]);
  }
  return out;
}

struct Yuv {
  float y, u, v;
};

Yuv yuv_of(float r, float g, float b) {
  const float y = 0.299F * r + 0.587F * g + 0.114F * b;
  return {y, (b - y) / 1.772F, (r - y) / 1.402F};
}

}  // namespace

Image ffmpeg_despill(const Image& linear) {
  return on_codes(linear, [](const float& r, float& g, const float& b) {
    g -= std::max(g - (r + b) / 2, 0.0F);
  });
}

Image green_limit(const Image& linear) {
  return on_codes(
      linear, [](const float& r, float& g, const float& b) { g = std::min(g, std::max(r, b)); });
}

Image gst_alpha_green(const Image& linear) {
  const float tangent = std::tan(20 * std::acos(-1.0F) / 180);
  const Yuv key = yuv_of(0, 1, 0);
  const float length = std::hypot(key.u, key.v), cb = key.u / length, cr = key.v / length;
  return on_codes(linear, [&](float& r, float& g, float& b) {
    Yuv p = yuv_of(r, g, b);
    const float x = p.u * cb + p.v * cr, z = p.v * cb - p.u * cr;
    if (std::abs(z) > x * tangent) return;
    const float edge = std::abs(z) / tangent;
    p = {std::max(0.0F, p.y - (x - edge) * key.y / length), edge * cb - z * cr, edge * cr + z * cb};
    r = p.y + 1.402F * p.v;
    b = p.y + 1.772F * p.u;
    g = (p.y - 0.299F * r - 0.114F * b) / 0.587F;
  });
}

}  // namespace inverse::bench
