// SPDX-License-Identifier: LGPL-2.1-or-later
#include "skin.hpp"

namespace inverse::olat {

using namespace lime;

float hash(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t salt) {
  std::uint32_t h = std::uint32_t(x) * 0x9e3779b1u ^ std::uint32_t(y) * 0x85ebca77u ^
                    std::uint32_t(z) * 0xc2b2ae3du ^ salt * 0x27d4eb2fu;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 12;
  h *= 0x297a2d39u;
  h ^= h >> 15;
  return float(h >> 8) * 0x1p-24f;
}

float noise(Vec p, std::uint32_t salt, int octaves) {
  float sum = 0, size = 1, total = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    const float fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const auto soft = [](float t) { return t * t * (3 - 2 * t); };
    const float u = soft(p.x - fx), v = soft(p.y - fy), w = soft(p.z - fz);
    const int x = int(fx), y = int(fy), z = int(fz);
    const auto at = [&](int i, int j, int k) {
      return hash(x + i, y + j, z + k, salt + std::uint32_t(octave));
    };
    const auto mix = [](float t, float a, float b) { return a + t * (b - a); };
    sum += size * mix(w, mix(v, mix(u, at(0, 0, 0), at(1, 0, 0)), mix(u, at(0, 1, 0), at(1, 1, 0))),
                      mix(v, mix(u, at(0, 0, 1), at(1, 0, 1)), mix(u, at(0, 1, 1), at(1, 1, 1))));
    total += size;
    size *= 0.5f;
    p = 2 * p;
  }
  return sum / total;
}

namespace {

Vec mix(Vec a, Vec b, float t) { return (1 - t) * a + t * b; }

float step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.f, 1.f);
  return t * t * (3 - 2 * t);
}

Vec any_color(Random& random, float low, float high) {
  return {random.uniform(low, high), random.uniform(low, high), random.uniform(low, high)};
}

/// From light to dark skin, roughly along melanin and hemoglobin.
Vec skin_color(Random& random) {
  const float melanin = random.uniform(), red = random.uniform();
  const Vec light{0.68f, 0.47f, 0.37f}, middle{0.45f, 0.27f, 0.17f}, dark{0.13f, 0.075f, 0.05f};
  Vec c = melanin < 0.5f ? mix(light, middle, 2 * melanin) : mix(middle, dark, 2 * melanin - 1);
  c = c * Vec{1 + 0.08f * red, 1 - 0.1f * red, 1 - 0.12f * red};
  return c * any_color(random, 0.92f, 1.08f);
}

Vec any_hair(Random& random) {
  static constexpr Vec kinds[] = {{0.015f, 0.012f, 0.01f}, {0.05f, 0.03f, 0.018f},
                                  {0.14f, 0.075f, 0.035f}, {0.32f, 0.2f, 0.09f},
                                  {0.25f, 0.08f, 0.03f},   {0.42f, 0.4f, 0.38f}};
  return random.uniform(0.7f, 1.5f) * (kinds[random.below(6)] * any_color(random, 0.85f, 1.15f));
}

}  // namespace

Skin::Skin(Random& random, const Landmarks& marks) : marks_(marks) {
  salt_ = std::uint32_t(random.bits());
  base_ = random.chance(0.9f) ? skin_color(random) : any_color(random, 0.05f, 0.8f);
  paint_ = random.chance(0.06f) ? 1.f : 0.f;  // large patches of any color
  const float redness = random.uniform(0.05f, 0.3f);
  blotch_ = base_ * Vec{1 - 0.2f * redness, 1 - redness, 1 - 1.1f * redness};
  if (paint_ > 0) blotch_ = any_color(random, 0.03f, 0.8f);
  blotch_size_ = random.log_uniform(0.8f, 6);
  lips_ =
      mix(base_, base_ * Vec{0.9f, 0.45f, 0.45f} + Vec{0.03f, 0, 0}, random.uniform(0.5f, 1.3f));
  lip_strength_ = random.uniform(0.4f, 1);
  freckle_ = base_ * (random.uniform(0.45f, 0.75f) * Vec{1, 0.85f, 0.75f});
  freckles_ = random.chance(0.5f) ? random.uniform(0.03f, 0.35f) : 0.f;
  freckle_size_ = random.uniform(0.25f, 0.6f);
  blush_ = random.uniform(0, 0.3f);
  stubble_ = random.chance(0.25f) ? random.uniform(0.1f, 0.5f) : 0.f;
  f0_ = random.uniform(0.025f, 0.05f);
  rough_ = random.uniform(0.16f, 0.5f);
  rough2_ = rough_ * random.uniform(0.3f, 0.6f);
  second_ = random.uniform(0, 0.35f);
  rough_noise_ = random.uniform(0, 0.35f);
  oily_ = random.uniform(0, 0.4f);
  hair_ = any_hair(random);
  cloth_ = any_color(random, 0.02f, 0.7f);
  if (random.chance(0.4f)) cloth_ = random.uniform(0.02f, 0.8f) * Vec{1, 1, 1};
  cloth2_ = random.chance(0.6f) ? cloth_ : any_color(random, 0.02f, 0.7f);
  cloth_stripes_ = random.uniform(0.6f, 3);
  iris_ = mix(Vec{0.12f, 0.06f, 0.03f}, Vec{0.07f, 0.13f, 0.2f}, random.uniform()) *
          any_color(random, 0.6f, 1.4f);
  eye_rough_ = random.log_uniform(0.06f, 0.16f);
  eye_f0_ = random.uniform(0.03f, 0.05f);
  iris_size_ = random.uniform(0.36f, 0.46f);
  scatter_ = random.log_uniform(0.4f, 1.8f);
}

Material Skin::skin(Vec rest) const {
  const float blotch = noise((1 / blotch_size_) * rest, salt_, 3);
  Vec c = mix(base_, blotch_, step(0.35f, 0.65f, blotch) * (paint_ > 0 ? 1.f : 0.8f));
  c = (0.85f + 0.3f * noise(3.f * rest, salt_ + 11, 2)) * c;
  const Vec side{std::abs(rest.x), rest.y, rest.z};
  const Vec to_cheek = side - marks_.cheek;
  c = mix(c, c * Vec{1, 0.7f, 0.68f}, blush_ * std::exp(-dot(to_cheek, to_cheek) / 9));
  if (freckles_ > 0) {  // one spot at most in a cell
    const Vec p = (1 / freckle_size_) * rest;
    const int x = int(std::floor(p.x)), y = int(std::floor(p.y)), z = int(std::floor(p.z));
    if (hash(x, y, z, salt_ + 5) < freckles_) {
      const Vec at{float(x) + 0.3f + 0.4f * hash(x, y, z, salt_ + 6),
                   float(y) + 0.3f + 0.4f * hash(x, y, z, salt_ + 7),
                   float(z) + 0.3f + 0.4f * hash(x, y, z, salt_ + 8)};
      c = mix(c, freckle_, 0.9f * step(0.45f, 0.2f, length(p - at)));
    }
  }
  if (stubble_ > 0 && rest.y < marks_.mouth.y + 1.5f && rest.z > marks_.jaw_back)
    c = mix(c, hair_,
            stubble_ * (0.5f + 0.5f * noise(5.f * rest, salt_ + 21)) *
                step(marks_.mouth.y + 1.5f, marks_.mouth.y, rest.y));
  const Vec m = rest - marks_.mouth;
  const float lips = std::sqrt(m.x * m.x / (marks_.mouth_width * marks_.mouth_width) +
                               m.y * m.y / (marks_.mouth_height * marks_.mouth_height));
  const float lip = m.z > -4 ? lip_strength_ * step(1.15f, 0.8f, lips) : 0;
  c = mix(c, lips_, lip);
  Material out;
  out.part = Part::skin;
  out.albedo = {std::clamp(c.x, 0.01f, 0.9f), std::clamp(c.y, 0.01f, 0.9f),
                std::clamp(c.z, 0.01f, 0.9f)};
  const float shine =
      oily_ * std::exp(-(rest.x * rest.x) / 8) + 0.4f * lip;  // nose, forehead, lips
  out.rough =
      std::max(0.12f, rough_ * (1 + rough_noise_ * (2 * noise(2.f * rest, salt_ + 31, 2) - 1)) *
                          (1 - 0.5f * shine));
  out.rough2 = std::max(0.08f, rough2_);
  out.second = second_;
  out.f0 = f0_;
  return out;
}

Material Skin::hair(std::uint32_t strand, bool brow) const {
  Material out;
  out.part = Part::hair;
  const float shade = 0.7f + 0.6f * hash(int(strand), 3, 7, salt_);
  out.albedo = (brow ? 0.8f : 1.f) * shade * hair_;
  out.f0 = 0.045f;
  out.rough = 0.12f + 0.12f * hash(1, 2, 3, salt_);
  return out;
}

Material Skin::cloth(Vec rest) const {
  Material out;
  out.part = Part::cloth;
  const float wave = std::sin(6.2832f * rest.y / cloth_stripes_);
  out.albedo = (0.8f + 0.4f * noise(4.f * rest, salt_ + 41, 2)) * (wave > 0 ? cloth_ : cloth2_);
  out.f0 = 0.03f;
  out.rough = 0.55f;
  return out;
}

Material Skin::eye(Vec axis, Vec direction, float spin) const {
  Material out;
  out.part = Part::eye;
  const float angle = std::acos(std::clamp(dot(axis, direction), -1.f, 1.f));
  const float rays = 0.7f + 0.6f * hash(int(8 * spin), int(20 * angle), 5, salt_);
  Vec c{0.46f, 0.42f, 0.4f};
  if (angle < iris_size_) c = rays * iris_;
  if (angle < 0.38f * iris_size_) c = {0.005f, 0.005f, 0.005f};
  out.albedo = c;
  out.f0 = eye_f0_;
  out.rough = eye_rough_;
  return out;
}

Material Skin::teeth() const { return {Part::teeth, {0.6f, 0.55f, 0.46f}, 0.05f, 0.15f, 0.15f, 0}; }

Material Skin::mouth() const { return {Part::mouth, {0.3f, 0.08f, 0.07f}, 0.04f, 0.2f, 0.2f, 0}; }

}  // namespace inverse::olat
