// SPDX-License-Identifier: LGPL-2.1-or-later
#include "key_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/srgb.hpp"

namespace inverse::bench {
namespace {

constexpr int kMoments = 16, kSide = 4;  // subframes, samples along a pixel's side
constexpr float kShutter = .5F;          // share of a frame's time
constexpr float kSpill = .06F;           // of the screen's light, on what is before it

using Color = std::array<float, 3>;
struct Point {
  float x, y;
};

constexpr Color kGreen{.05F, .34F, .09F}, kBlue{.04F, .10F, .38F};
constexpr Color kSkin{.58F, .33F, .23F};
// No blue and no green: actors do not wear the screen's color.
constexpr std::array<Color, 6> kCloth{{{.55F, .06F, .05F},
                                       {.30F, .14F, .07F},
                                       {.72F, .70F, .66F},
                                       {.18F, .18F, .18F},
                                       {.62F, .42F, .06F},
                                       {.03F, .03F, .03F}}};
constexpr std::array<Color, 3> kHair{{{.03F, .02F, .015F}, {.45F, .30F, .13F}, {.35F, .34F, .33F}}};

float hash(int x, int y) {
  auto h = static_cast<uint32_t>(x * 374761393 + y * 668265263);
  h = (h ^ h >> 13) * 1274126177U;
  return static_cast<float>((h ^ h >> 16) & 0xffff) / 65535.F;
}

float step(float low, float high, float t) {
  t = std::clamp((t - low) / (high - low), 0.F, 1.F);
  return t * t * (3 - 2 * t);
}

struct Strand {
  Point root, bend, tip;  // relative to the head
  float width;            // pixels
  Color paint;
};

struct Disk {
  Point at, velocity;  // pixels; a frame
  float radius;
  Color one, other;
};

/// What a scene is made of, in pixels of the frame.
struct Cast {
  Point head;
  float size, sway, phase;
  Color shirt, stripe;
  std::vector<Strand> hair;
  std::vector<Disk> disks;
  Point shadow;

  Cast(const KeyScene& scene) {
    std::mt19937 random(scene.seed * 2654435761U + (scene.blue ? 1 : 0));
    const auto between = [&](float a, float b) {
      return a + (b - a) * static_cast<float>(random() % 65536) / 65535.F;
    };
    const auto w = static_cast<float>(scene.width), h = static_cast<float>(scene.height);
    head = {w * between(.35F, .6F), h * between(.3F, .38F)};
    size = h * between(.15F, .19F);
    sway = between(6, 20);
    phase = between(0, 6);
    shadow = {w * between(.15F, .85F), h * between(.2F, .8F)};
    size_t cloth = random() % kCloth.size();
    shirt = kCloth[cloth];
    stripe = kCloth[(cloth + 1 + random() % (kCloth.size() - 1)) % kCloth.size()];
    for (int k = 0; k < 90; ++k) {
      const float angle = between(-3.4F, .26F), length = size * between(.5F, 1.3F);
      const Point root{size * .8F * std::cos(angle), size * std::sin(angle)};
      const Point bend{root.x + length * .6F * std::cos(angle + between(-.3F, .3F)),
                       root.y + length * .6F * std::sin(angle)};
      const Point tip{bend.x + length * .5F * std::cos(angle + between(-1, 1)),
                      bend.y + length * .5F * std::sin(angle + between(-1, 1))};
      hair.push_back(
          {root, bend, tip, .3F * std::pow(10.F, between(0, 1)), kHair[scene.seed % kHair.size()]});
    }
    for (int k = 0; k < 4; ++k) {
      const float angle = between(0, 6.28F), speed = 2 * between(4, 40);
      cloth = random() % kCloth.size();
      disks.push_back({{between(.05F, .95F) * w, between(.1F, .9F) * h},
                       {speed * std::cos(angle), speed * std::sin(angle)},
                       between(6, 22),
                       kCloth[cloth],
                       kCloth[(cloth + 2) % kCloth.size()]});
    }
  }
};

/// Light on the screen: a gradient, a lamp, a wide shadow and the sharp edge of another.
float light_on_screen(const KeyScene& scene, const Cast& cast, float x, float y) {
  const float u = x / static_cast<float>(scene.width), v = y / static_cast<float>(scene.height);
  const float far = std::hypot(u - .3F, v - .2F);
  float light = 1.15F - .35F * u - .3F * far * far;
  const float off = std::hypot((x - cast.shadow.x) / 90, (y - cast.shadow.y) / 50);
  light *= 1 - .4F * step(1.2F, .7F, off);
  return light *
         (1 - .3F * step(-1.5F, 1.5F, .5F * x + y - 1.12F * static_cast<float>(scene.height)));
}

/// Four floats a sample: light of the foreground, opacity 0 or 1.
class Canvas {
 public:
  Canvas(const KeyScene& scene)
      : width_(scene.width * kSide),
        height_(scene.height * kSide),
        samples_(static_cast<size_t>(width_) * static_cast<size_t>(height_)) {}

  /// Calls paint(x, y) -> light for samples of a box where inside(x, y); in pixels.
  template <typename Inside, typename Paint>
  void fill(Point first, Point last, Inside inside, Paint paint) {
    const auto sample = [](float at) { return static_cast<int>(std::floor(at * kSide)); };
    for (int y = std::max(sample(first.y), 0); y <= std::min(sample(last.y), height_ - 1); ++y)
      for (int x = std::max(sample(first.x), 0); x <= std::min(sample(last.x), width_ - 1); ++x) {
        const float px = (static_cast<float>(x) + .5F) / kSide;
        const float py = (static_cast<float>(y) + .5F) / kSide;
        if (!inside(px, py)) continue;
        const Color c = paint(px, py);
        samples_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)] = {
            c[0], c[1], c[2], 1};
      }
  }
  void clear() { std::fill(samples_.begin(), samples_.end(), std::array<float, 4>{}); }
  /// Adds the mean of each pixel's samples, times `part`.
  void add_to(Image& sum, float part) const {
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const auto& s =
            samples_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
        if (s[3] > 0)
          for (int c = 0; c < 4; ++c)
            sum.at(x / kSide, y / kSide, c) += part / (kSide * kSide) * s[static_cast<size_t>(c)];
      }
  }

 private:
  int width_, height_;
  std::vector<std::array<float, 4>> samples_;
};

void draw_ellipse(Canvas& canvas, Point at, float rx, float ry, auto paint) {
  canvas.fill(
      {at.x - rx, at.y - ry}, {at.x + rx, at.y + ry},
      [=](float x, float y) {
        const float u = (x - at.x) / rx, v = (y - at.y) / ry;
        return u * u + v * v < 1;
      },
      paint);
}

void draw_strand(Canvas& canvas, Point head, const Strand& s) {
  const float radius = s.width / 2;
  // Finer than a sample's side, strands become dashed: paint by a disk of at least half of that.
  const int steps =
      std::max(8, static_cast<int>(kSide * std::hypot(s.tip.x - s.root.x, s.tip.y - s.root.y)));
  for (int k = 0; k <= steps; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(steps), r = 1 - t;
    const Point at{head.x + r * r * s.root.x + 2 * r * t * s.bend.x + t * t * s.tip.x,
                   head.y + r * r * s.root.y + 2 * r * t * s.bend.y + t * t * s.tip.y};
    const float light = .7F + .5F * std::sin(9 * t);
    draw_ellipse(canvas, at, radius, radius, [&](float, float) {
      return Color{light * s.paint[0], light * s.paint[1], light * s.paint[2]};
    });
  }
}

void draw(Canvas& canvas, const Cast& cast, float time) {
  const float sway = cast.sway * std::sin(cast.phase + 1.1F * time);
  const Point head{cast.head.x + sway, cast.head.y};
  const Point body{cast.head.x + .7F * sway, cast.head.y + 2.7F * cast.size};
  draw_ellipse(canvas, body, 1.5F * cast.size, 1.9F * cast.size, [&](float x, float y) {
    const float u = (x - body.x) / cast.size, v = (y - body.y) / cast.size;
    const Color& paint = std::fmod(v + 9, .5F) < .22F ? cast.stripe : cast.shirt;
    const float light = (.95F - .35F * u * u) *
                        (.85F + .3F * hash(static_cast<int>(40 * u), static_cast<int>(40 * v)));
    return Color{light * paint[0], light * paint[1], light * paint[2]};
  });
  draw_ellipse(canvas, head, .8F * cast.size, cast.size, [&](float x, float y) {
    const float u = (x - head.x) / cast.size, v = (y - head.y) / cast.size;
    const float light =
        1 - .3F * u - .4F * v * v + .25F * step(.3F, 0, std::hypot(u + .3F, v + .3F));
    return Color{light * kSkin[0], light * kSkin[1], light * kSkin[2]};
  });
  for (const Strand& strand : cast.hair) draw_strand(canvas, head, strand);
  for (const Disk& disk : cast.disks) {
    const Point at{disk.at.x + disk.velocity.x * (time - 2),
                   disk.at.y + disk.velocity.y * (time - 2)};
    draw_ellipse(canvas, at, disk.radius, disk.radius, [&](float x, float y) {
      const float angle = std::atan2(y - at.y, x - at.x) + 3 * time;
      const Color& paint = std::fmod(angle + 20, 1.2F) < .6F ? disk.one : disk.other;
      const float light = 1 - .5F * (y - at.y) / disk.radius;
      return Color{light * paint[0], light * paint[1], light * paint[2]};
    });
  }
}

const Color& paint_of(const KeyScene& scene) { return scene.blue ? kBlue : kGreen; }

}  // namespace

std::array<int, 3> KeyScene::screen_code() const {
  std::array<int, 3> code{};
  for (size_t c = 0; c < 3; ++c)
    code[c] = static_cast<int>(std::lround(255 * srgb_code(.85F * paint_of(*this)[c])));
  return code;
}

KeyFrame KeyScene::frame(int number) const {
  const Cast cast(*this);
  Canvas canvas(*this);
  Image sum(width, height, 4);
  for (int k = 0; k < kMoments; ++k) {
    const float part = (static_cast<float>(k) + .5F) / kMoments;
    canvas.clear();
    draw(canvas, cast, static_cast<float>(number) + kShutter * part);
    canvas.add_to(sum, 1.F / kMoments);
  }
  KeyFrame result{{}, Image(width, height, 1), Image(width, height, 3)};
  std::mt19937 random(seed * 977 + static_cast<unsigned>(number));
  std::normal_distribution<float> noise;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float alpha = std::min(sum.at(x, y, 3), 1.F);
      const float on_screen =
          light_on_screen(*this, cast, static_cast<float>(x) + .5F, static_cast<float>(y) + .5F);
      result.alpha.at(x, y) = alpha;
      for (int c = 0; c < 3; ++c) {
        const float paint = paint_of(*this)[static_cast<size_t>(c)];
        const float front = sum.at(x, y, c);
        result.front.at(x, y, c) = front;
        // What the screen reflects onto the foreground is colored by that, too.
        const float spill = kSpill * paint * (.3F * alpha + 2 * front);
        float light = front + spill + (1 - alpha) * on_screen * paint;
        light += noise(random) * std::sqrt(4e-6F + 2e-4F * light);
        const float code = 255 * srgb_code(std::clamp(light, 0.F, 1.F));
        result.seen.push_back(static_cast<uint8_t>(std::lround(code)));
      }
      result.seen.push_back(255);
    }
  return result;
}

Image KeyScene::background() const {
  Image image(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) =
            .25F + .2F * std::sin(.02F * static_cast<float>(x) + 2 * static_cast<float>(c)) *
                       std::cos(.03F * static_cast<float>(y) + static_cast<float>(seed));
  return image;
}

}  // namespace inverse::bench
