// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lobes.hpp"

namespace inverse::olat {

using namespace lime;

namespace {

float ggx(float alpha, float nh, float nl, float nv) {
  const float a2 = alpha * alpha, d = nh * nh * (a2 - 1) + 1;
  const float density = a2 / (kPi * d * d);
  // Smith's height-correlated masking over 4 n·l n·v (Heitz 2014).
  const float masking =
      0.5f / (nl * std::sqrt(a2 + (1 - a2) * nv * nv) + nv * std::sqrt(a2 + (1 - a2) * nl * nl));
  return density * masking;
}

}  // namespace

float specular(const Material& m, Vec n, Vec v, Vec l) {
  const float nl = dot(n, l), nv = std::max(dot(n, v), 0.02f);
  if (nl <= 0) return 0;
  const Vec h = normalize(l + v);
  const float nh = std::clamp(dot(n, h), 0.f, 1.f), vh = std::clamp(dot(v, h), 0.f, 1.f);
  const float g = (1 - vh) * (1 - vh), f = m.f0 + (1 - m.f0) * g * g * (1 - vh);
  float lobes = (1 - m.second) * ggx(m.rough, nh, nl, nv);
  if (m.second > 0) lobes += m.second * ggx(m.rough2, nh, nl, nv);
  return f * lobes * nl;
}

Vec fiber(const Material& m, Vec tangent, Vec v, Vec l) {
  const float tl = dot(tangent, l), tv = dot(tangent, v);
  const float sin_l = std::sqrt(std::max(1 - tl * tl, 0.f));
  const float theta = std::asin(std::clamp(tl, -1.f, 1.f)) + std::asin(std::clamp(tv, -1.f, 1.f));
  const auto lobe = [](float x, float width) {
    return std::exp(-x * x / (2 * width * width)) / (2.5066f * width);
  };
  // Light from behind passes in part.
  const Vec across_l = normalize(l - tl * tangent), across_v = normalize(v - tv * tangent);
  const float around = dot(across_l, across_v);
  const float front = 0.5f + 0.5f * around;
  const Vec diffuse = (sin_l * (0.25f + 0.75f * front) / kPi) * m.albedo;
  const float first = m.f0 * lobe(theta + 0.1f, m.rough) * front;
  const float second = 0.35f * lobe(theta - 0.07f, 1.7f * m.rough) * (0.3f + 0.7f * front);
  const float both = 0.5f * sin_l;
  return diffuse + (both * first) * Vec{1, 1, 1} + (both * second) * m.albedo;
}

}  // namespace inverse::olat
