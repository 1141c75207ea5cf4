// SPDX-License-Identifier: LGPL-2.1-or-later
#include "subject.hpp"

namespace inverse::olat {

using namespace lime;

namespace {

/// Points on the skin, drawn by area; the seed of a strand each.
struct Root {
  Vec at, normal, rest;
};

class Roots {
 public:
  explicit Roots(const Subject& subject) : subject_(subject) {
    for (std::size_t m = 0; m < subject.meshes.size(); ++m) {
      const Mesh& mesh = subject.meshes[m];
      if (mesh.part != Part::skin) continue;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& tri = mesh.triangles[t];
        total_ += length(cross(mesh.positions[tri.b] - mesh.positions[tri.a],
                               mesh.positions[tri.c] - mesh.positions[tri.a]));
        sums_.push_back(total_);
        which_.push_back({std::uint32_t(m), std::uint32_t(t)});
      }
    }
  }
  Root draw(Random& random) const {
    const float s = random.uniform() * total_;
    const auto i = std::size_t(std::lower_bound(sums_.begin(), sums_.end(), s) - sums_.begin());
    const auto [m, t] = which_[std::min(i, which_.size() - 1)];
    const Mesh& mesh = subject_.meshes[m];
    const Triangle& tri = mesh.triangles[t];
    float u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const float w = 1 - u - v;
    const auto blend = [&](const std::vector<Vec>& a) {
      return w * a[tri.a] + u * a[tri.b] + v * a[tri.c];
    };
    return {blend(mesh.positions), normalize(blend(mesh.normals)), blend(mesh.rest)};
  }

 private:
  const Subject& subject_;
  std::vector<float> sums_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> which_;
  float total_ = 0;
};

struct Style {
  float length, root, tip, stand, fall, curl, clump;
  Vec comb;
  std::uint32_t salt;
};

Strand grow(const Root& root, const Style& style, Random& random) {
  constexpr int kSegments = 6;
  Strand strand;
  strand.root = style.root * random.uniform(0.7f, 1.3f);
  strand.tip = style.tip;
  Vec at = root.at + (-0.1f) * root.normal;
  Vec direction = normalize(style.stand * root.normal + style.comb +
                            style.clump * Vec{noise(0.4f * root.rest, style.salt) - 0.5f,
                                              noise(0.4f * root.rest, style.salt + 1) - 0.5f,
                                              noise(0.4f * root.rest, style.salt + 2) - 0.5f} +
                            0.15f * Vec{random.normal(), random.normal(), random.normal()});
  const float step = style.length * random.uniform(0.6f, 1.1f) / kSegments;
  strand.points.push_back(at);
  for (int i = 0; i < kSegments; ++i) {
    const Vec p = 0.5f * at;
    direction =
        normalize(direction + Vec{0, -style.fall / kSegments, 0} +
                  style.curl * Vec{noise(p, style.salt + 3) - 0.5f, noise(p, style.salt + 4) - 0.5f,
                                   noise(p, style.salt + 5) - 0.5f});
    // Hair lies on the head rather than in it.
    const float inward = dot(direction, root.normal);
    if (inward < 0.05f && i < 4) direction = normalize(direction + (0.05f - inward) * root.normal);
    at = at + step * direction;
    strand.points.push_back(at);
  }
  return strand;
}

}  // namespace

void grow_hair(Subject& subject, Random& random) {
  const Landmarks& m = subject.marks;
  const Roots roots(subject);
  const auto hairline = [&](Vec p) {
    const float t = std::clamp((p.z - m.back) / (m.front - m.back), 0.f, 1.f);
    return m.hairline_back + t * t * (m.hairline_front - m.hairline_back) + t * (1 - t) * 3;
  };
  const auto salt = std::uint32_t(random.bits());
  if (random.chance(0.75f)) {
    const bool shorn = random.chance(0.25f);
    Style style{};
    style.length = shorn ? random.uniform(0.4f, 1.2f) : random.log_uniform(1.5f, 10);
    style.root = random.uniform(0.05f, 0.11f), style.tip = 0.6f * style.root;
    style.stand = random.uniform(0.3f, 1.2f), style.fall = random.uniform(0, 2.2f);
    style.curl = random.chance(0.4f) ? random.uniform(0.4f, 1.6f) : 0.2f;
    style.clump = random.uniform(0.2f, 1.5f);
    style.comb = random.uniform(0, 0.9f) *
                 normalize({random.normal(), random.uniform(-1, 0.3f), random.normal()});
    style.salt = salt;
    const int wanted = random.below(5000) + 5000;
    const float recede = random.uniform(-1.5f, 2.5f);
    int grown = 0;
    for (int i = 0; i < 12 * wanted && grown < wanted; ++i) {
      const Root root = roots.draw(random);
      const float edge =
          hairline(root.rest) + recede + 1.5f * (noise(0.5f * root.rest, salt + 9) - 0.5f);
      if (root.rest.y < edge) continue;
      subject.strands.push_back(grow(root, style, random));
      ++grown;
    }
  }
  if (random.chance(0.25f)) {  // beard
    Style style{random.log_uniform(0.4f, 4),
                0.06f,
                0.03f,
                0.6f,
                1.5f,
                0.6f,
                0.6f,
                {0, -0.5f, 0.2f},
                salt + 50};
    const int wanted = random.below(2500) + 1500;
    const bool mustache = random.chance(0.6f);
    int grown = 0;
    for (int i = 0; i < 25 * wanted && grown < wanted; ++i) {
      const Root root = roots.draw(random);
      const Vec p = root.rest;
      const bool lips =
          std::abs(p.x) < 1.1f * m.mouth_width && std::abs(p.y - m.mouth.y) < 1.1f * m.mouth_height;
      const float top =
          m.mouth.y +
          (mustache && std::abs(p.x) < 1.3f * m.mouth_width ? 1.5f * m.mouth_height + 0.3f : 0.3f);
      if (p.z < m.jaw_back || p.y > top || p.y < m.chin - 1.5f || lips) continue;
      subject.strands.push_back(grow(root, style, random));
      ++grown;
    }
  }
  if (random.chance(0.85f)) {  // brows
    Style style{
        random.uniform(0.7f, 1.2f), 0.05f, 0.03f, 0.3f, 0.2f, 0.2f, 0.2f, {0, 0.1f, 0}, salt + 70};
    const int wanted = random.below(250) + 150;
    int grown = 0;
    for (int i = 0; i < 60000 && grown < wanted; ++i) {
      const Root root = roots.draw(random);
      const float s = root.rest.x < 0 ? -1.f : 1.f;
      const float x = (std::abs(root.rest.x) - m.brow.x) / m.brow_width;
      const float y = (root.rest.y - m.brow.y + 0.35f * x * x) / m.brow_height;
      if (root.rest.z < m.brow.z - 5 || x * x > 1 || y * y > 1) continue;
      style.comb = {s, 0.2f, 0};
      Strand strand = grow(root, style, random);
      strand.brow = true;
      subject.strands.push_back(std::move(strand));
      ++grown;
    }
  }
}

}  // namespace inverse::olat
