// SPDX-License-Identifier: LGPL-2.1-or-later
#include "still_life.hpp"

namespace inverse::clip {
namespace {

constexpr float kWallZ = -0.58f;

Paint plain(unsigned code) { return {Pattern::kPlain, {srgb(code)}, 1, ""}; }

class Builder {
 public:
  Primitive& add(Shape shape, Vec3 size, Vec3 position, Paint paint, Frame frame = {}) {
    return primitives_.emplace_back(Primitive{shape, size, position, frame, paint});
  }
  std::vector<Primitive> take() { return std::move(primitives_); }

 private:
  std::vector<Primitive> primitives_;
};

const Frame kFacingViewer = rotation({1, 0, 0}, kPi / 2);  // local y to world z, local z downward

void add_room(Builder& b) {
  Paint paper{Pattern::kWallpaper, {srgb(0xd8cdb4), srgb(0xb9c0a6), srgb(0x8a5a4e)}, 0.12f, ""};
  b.add(Shape::kRectangle, {3, 0, 2}, {0, 0.8f, kWallZ}, paper, kFacingViewer);
  b.add(Shape::kRectangle, {3, 0, 2}, {0, 0.8f, 3}, plain(0xc9c2b6), kFacingViewer);
  Frame facing_side = rotation({0, 0, 1}, kPi / 2);
  b.add(Shape::kRectangle, {2, 0, 2.4f}, {-1.9f, 0.8f, 1.4f}, plain(0x86a8a6), facing_side);
  b.add(Shape::kRectangle, {2, 0, 2.4f}, {1.9f, 0.8f, 1.4f}, plain(0xb89a80), facing_side);
  b.add(Shape::kRectangle, {3, 0, 2.4f}, {0, 2.2f, 1.4f}, plain(0xe4e0d8));
  b.add(Shape::kRectangle, {3, 0, 2.4f}, {0, -0.75f, 1.4f}, plain(0x6f6b67));
  Paint wood{Pattern::kWood, {srgb(0x6b452b), srgb(0x2e1a10)}, 0.17f, ""};
  b.add(Shape::kBox, {1.5f, 0.02f, 0.79f}, {0, -0.02f, 0.21f}, wood);
}

void add_poster(Builder& b) {
  Vec3 center{-0.40f, 0.545f, kWallZ + 0.006f};
  Paint print{Pattern::kPoster, {}, 1, ""};
  b.add(Shape::kRectangle, {0.21f, 0, 0.26f}, center, print, kFacingViewer);
  Paint frame = plain(0x2a2320);
  for (float side : {-1.0f, 1.0f}) {
    b.add(Shape::kBox, {0.012f, 0.272f, 0.014f}, center + Vec3{side * 0.22f, 0, 0}, frame);
    b.add(Shape::kBox, {0.21f, 0.012f, 0.014f}, center + Vec3{0, side * 0.27f, 0}, frame);
  }
}

void add_mat(Builder& b) {
  Paint checker{Pattern::kChecker, {srgb(0x1f1f22), srgb(0x8a8a88), srgb(0xe9e6df)}, 0.06f, ""};
  b.add(Shape::kBox, {0.36f, 0.0025f, 0.21f}, {0.06f, 0.0025f, 0.10f}, checker,
        rotation({0, 1, 0}, 0.16f));
}

void add_books(Builder& b) {
  struct Book {
    Vec3 half;
    float angle;
    Paint paint;
  };
  const Vec3 pages = srgb(0xe4d9bd);
  const Book books[] = {
      {{0.150f, 0.021f, 0.105f},
       0.28f,
       {Pattern::kBook, {srgb(0x1d3a6e), pages, srgb(0xd9b14a)}, 0.042f, "SHADING"}},
      {{0.135f, 0.017f, 0.095f},
       0.10f,
       {Pattern::kBook, {srgb(0xa3262e), pages, srgb(0xefe3cf)}, 0.034f, "COLOR"}},
      {{0.120f, 0.019f, 0.088f},
       0.45f,
       {Pattern::kBook, {srgb(0xd8a021), pages, srgb(0x231a12)}, 0.038f, "LIGHT"}}};
  float top = 0;
  for (const Book& book : books) {
    b.add(Shape::kBox, book.half, {-0.46f, top + book.half.y, -0.14f}, book.paint,
          rotation({0, 1, 0}, book.angle));
    top += 2 * book.half.y + 0.0005f;
  }
  b.add(Shape::kEllipsoid, {0.052f, 0.052f, 0.052f}, {-0.47f, top + 0.052f, -0.15f},
        plain(0xd9541e));
}

void add_mug(Builder& b) {
  Vec3 base{0.335f, 0.005f, 0.19f};
  Paint stripes{Pattern::kStripes, {srgb(0xe9e4d8), srgb(0x24539b)}, 0.022f, ""};
  b.add(Shape::kFrustum, {0.058f, 0.065f, 0.062f}, base + Vec3{0, 0.065f, 0}, stripes);
  b.add(Shape::kFrustum, {0.054f, 0.0006f, 0.054f}, base + Vec3{0, 0.1306f, 0}, plain(0x2a1710));
  Frame upright = compose(rotation({0, 1, 0}, -0.5f), rotation({1, 0, 0}, kPi / 2));
  b.add(Shape::kTorus, {0.036f, 0.0095f, 0}, base + Vec3{0.062f, 0.066f, 0.034f}, plain(0x24539b),
        upright);
}

void add_plant(Builder& b) {
  Vec3 base{0.56f, 0, -0.22f};
  Paint clay{Pattern::kSpeckles, {srgb(0xb5623c), srgb(0xc98a63), srgb(0x8f4527)}, 0.006f, ""};
  b.add(Shape::kFrustum, {0.062f, 0.065f, 0.088f}, base + Vec3{0, 0.065f, 0}, clay);
  b.add(Shape::kFrustum, {0.096f, 0.014f, 0.097f}, base + Vec3{0, 0.14f, 0}, clay);
  b.add(Shape::kFrustum, {0.086f, 0.001f, 0.086f}, base + Vec3{0, 0.155f, 0}, plain(0x2b1d14));
  constexpr int kLeaves = 22;
  for (int i = 0; i < kLeaves; ++i) {
    float level = (static_cast<float>(i) + 0.5f) / kLeaves;
    float turn = 2.39996f * static_cast<float>(i);  // golden angle
    float rise = 0.12f + 0.32f * level, reach = 0.13f - 0.08f * level;
    Vec3 outward{std::cos(turn), 0, std::sin(turn)};
    Vec3 foot = base + Vec3{0, 0.15f, 0} + outward * 0.015f;
    Vec3 joint = base + outward * reach + Vec3{0, 0.12f + rise, 0};
    Vec3 stem = joint - foot;
    b.add(Shape::kFrustum, {0.0028f, length(stem) / 2, 0.002f}, (foot + joint) * 0.5f,
          plain(0x4c6b2c), frame_along_y(normalize(stem)));
    float droop = 0.15f - 0.75f * level, half = 0.086f - 0.026f * level;
    Vec3 blade = normalize(outward - Vec3{0, droop, 0});
    Frame pose{blade, normalize(cross(cross(blade, Vec3{0, 1, 0}), blade)),
               normalize(cross(blade, Vec3{0, 1, 0}))};
    Paint green{
        Pattern::kLeaf, {i % 3 ? srgb(0x2f7a36) : srgb(0x4f9440), srgb(0x8fbf5f)}, half, ""};
    b.add(Shape::kEllipsoid, {half, 0.0035f, half * 0.52f}, joint + blade * (half * 0.8f), green,
          pose);
  }
}

void add_center(Builder& b) {
  Paint glaze{Pattern::kPlain, {srgb(0xe0dbcf)}, 1, ""};
  b.add(Shape::kVase, {0.30f, 0, 0}, {-0.13f, 0.005f, 0.02f}, glaze);
  constexpr float kEdge = 0.115f;
  Paint cube{Pattern::kStickers, {}, kEdge, ""};
  b.add(Shape::kRoundedBox, {kEdge / 2, kEdge / 2, kEdge / 2}, {0.10f, 0.005f + kEdge / 2, 0.16f},
        cube, rotation({0, 1, 0}, 0.62f));
  b.add(Shape::kTorus, {0.062f, 0.021f, 0}, {-0.015f, 0.026f, 0.245f}, plain(0x1f8a78));
  b.add(Shape::kEllipsoid, {0.075f, 0.075f, 0.075f}, {0.17f, 0.08f, -0.06f}, plain(0xbf2231));
}

void add_rolling_ball(Builder& b, float time) {
  constexpr float kRadius = 0.058f, kFrom = -0.43f, kTo = 0.16f;
  float x = std::lerp(kFrom, kTo, time);
  Frame tilt = rotation(normalize({1, 0, 0.4f}), 0.9f);
  Frame roll = rotation({0, 0, 1}, -(x - kFrom) / kRadius);
  b.add(Shape::kEllipsoid, {kRadius, kRadius, kRadius}, {x, kRadius, 0.40f},
        {Pattern::kSegments, {}, 1, ""}, compose(roll, tilt));
}

// Hangs before the table, above the picture: only its shadow is seen, crossing the wall.
void add_mobile(Builder& b) {
  constexpr float kDepth = 0.30f, kRod = 0.95f;
  Paint dark = plain(0x3a3a3a);
  auto thread = [&](float x, float low, float high) {
    b.add(Shape::kFrustum, {0.0022f, (high - low) / 2, 0.0022f}, {x, (low + high) / 2, kDepth},
          dark);
  };
  thread(0, kRod, 2.2f);
  b.add(Shape::kFrustum, {0.006f, 0.23f, 0.006f}, {0, kRod, kDepth}, dark,
        rotation({0, 0, 1}, kPi / 2));
  Frame upright = rotation({1, 0, 0}, kPi / 2);
  b.add(Shape::kTorus, {0.045f, 0.012f, 0}, {-0.21f, 0.80f, kDepth}, dark, upright);
  thread(-0.21f, 0.855f, kRod);
  b.add(Shape::kEllipsoid, {0.075f, 0.034f, 0.012f}, {0, 0.77f, kDepth}, dark,
        rotation({0, 0, 1}, 0.15f));
  b.add(Shape::kEllipsoid, {0.016f, 0.042f, 0.008f}, {-0.08f, 0.758f, kDepth}, dark);
  thread(0, 0.80f, kRod);
  b.add(Shape::kBox, {0.038f, 0.038f, 0.005f}, {0.21f, 0.815f, kDepth}, dark,
        rotation({0, 0, 1}, kPi / 4));
  thread(0.21f, 0.868f, kRod);
}

}  // namespace

Scene still_life(float time) {
  Builder builder;
  add_room(builder);
  add_poster(builder);
  add_mat(builder);
  add_books(builder);
  add_mug(builder);
  add_plant(builder);
  add_center(builder);
  add_rolling_ball(builder, time);
  add_mobile(builder);

  Scene scene;
  scene.primitives = builder.take();
  // The lamp rests, swings from left to right in front of the table, and rests again.
  float swing = std::lerp(-1.0f, 1.0f, smoothstep(0.08f, 0.92f, time));
  scene.lamp = {{1.25f * swing, 0.95f + 0.15f * (1 - swing * swing), 1.9f}, 0.016f, 2.55f};
  scene.window = {{-1.85f, 0.35f, 0.2f}, {0, 1.1f, 0}, {0, 0, 1.3f}, 0.5f};
  scene.camera = {{0.02f, 0.50f, 1.62f}, {0.02f, 0.245f, -0.1f}, 0.62f};
  return scene;
}

}  // namespace inverse::clip
