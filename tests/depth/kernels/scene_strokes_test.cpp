// SPDX-License-Identifier: LGPL-2.1-or-later
// Strokes in the voxels of a scene and as frames see them, against their specification.
#include "kernels/depth/strokes/scene_strokes.hpp"

#include <map>
#include <random>

#include "kernels/camera/place_stroke.hpp"
#include "kernels/image/strokes/stroke_mask.hpp"
#include "tests/depth/kernels/volume_fixture.hpp"
#include "tests/depth/reference/strokes.hpp"

namespace inverse::testing {
namespace {

using Kind = Stroke::Kind;
using Shader = shaders::depth_strokes_grow;

constexpr Volume::Params kParams{.voxel = 0.02F, .blocks = 8192};

Stroke stroke_at(const std::vector<std::array<float, 3>>& places, float radius, bool fill) {
  Stroke stroke{.kind = Kind::reflectance, .points = {}, .fill = fill};
  for (const auto& [x, y, z] : places) stroke.balls.push_back({x, y, z, radius});
  return stroke;
}
// On the ball, the wall to the left, the wall behind and the floor of the scene.
Stroke on_ball(bool fill) { return stroke_at({{0.3F, 0.6F, 1.35F}}, 0.08F, fill); }
Stroke on_left(bool fill) { return stroke_at({{-1.4F, 0.3F, 2}, {-1.4F, 0.35F, 2}}, 0.1F, fill); }
Stroke on_back() {
  return stroke_at({{0.1F, 0, 2.6F}, {0.2F, 0, 2.6F}, {0.3F, 0, 2.6F}}, 0.1F, false);
}
Stroke on_floor() { return stroke_at({{0.1F, 1, 2}}, 0.2F, false); }

StrokesPtr list_of(std::vector<Stroke> strokes) {
  return std::make_shared<const StrokeList>(StrokeList{std::move(strokes), {160, 120}});
}

class SceneStrokesTest : public VolumeFixture {
 protected:
  void see(Volume& volume, double t) {
    const Camera camera = camera_at(160, 120, {0.6 * std::sin(t) - 0.2, 0.2, 0.1 * std::cos(t)},
                                    {0.2 * std::cos(t) - 0.3, 0.6, 2});
    const Seen seen = look(camera);
    integrate(volume, camera, reference::normals(camera, seen.depth), seen.layers);
  }
  uint32_t left(const SceneStrokes& strokes) {
    return words(strokes.state())[SceneStrokes::kLeftOffset / sizeof(uint32_t)];
  }
  /// Records frames until strokes do not spread any more.
  void settle(SceneStrokes& strokes, Volume& volume, bool grown = false) {
    for (int frame = 0; frame < 200; ++frame) {
      run([&](gpu::Commands& commands) {
        strokes.record(commands, volume, std::exchange(grown, false));
      });
      strokes.heard(left(strokes));
      if (!strokes.busy()) return;
    }
    FAIL() << "they spread without end";
  }
  /// The voxels that were seen, with the marks that the device has found.
  reference::MarkedVoxels marked(const Volume& volume) {
    const auto keys = words(volume.keys()), voxels = words(volume.voxels()),
               colors = words(volume.colors());
    reference::MarkedVoxels found;
    for (size_t b = 0; b < keys.size(); ++b) {
      if (keys[b] == 0xffffffff) continue;
      const reference::Cell block{int(keys[b] & 2047) - 1024, int(keys[b] >> 22) - 512,
                                  int(keys[b] >> 11 & 2047) - 1024};
      for (size_t n = 0; n < 512; ++n) {
        const uint32_t word = voxels[512 * b + n];
        if ((word >> 16 & 255) == 0) continue;
        const uint32_t c[] = {colors[1024 * b + n], colors[1024 * b + 512 + n]};
        const auto unit = [](uint32_t bits) { return (bits & 0xffff) / 65535.0; };
        found[{8 * block[0] + int(n & 7), 8 * block[1] + int(n >> 3 & 7),
               8 * block[2] + int(n >> 6)}] = {
            double(int16_t(word & 0xffff)) / 32767,
            {-7 + 8.5 * unit(c[0]), -7 + 8.5 * unit(c[0] >> 16), -7 + 8.5 * unit(c[1])},
            (c[1] >> 16) > 0,
            word >> 24};
      }
    }
    return found;
  }
  /// Compares the marks of the device with the specification; returns how many each stroke has.
  std::vector<size_t> compare(const Volume& volume, const SceneStrokes& strokes,
                              const StrokesPtr& list, size_t max_off = 3) {
    const reference::MarkedVoxels found = marked(volume);
    std::vector<reference::SceneStroke> meant;
    const SeenStrokes seen{{}, {}, {}, {}, {}, strokes.strokes()};
    for (const Stroke& stroke : list->strokes) {
      meant.push_back({{}, stroke.fill, seen.id_of(stroke)});
      EXPECT_GT(meant.back().id, 0U);
      for (const auto& [x, y, z, r] : stroke.balls)
        meant.back().balls.push_back({double{x}, double{y}, double{z}, double{r}});
    }
    reference::MarkedVoxels expected = found;
    reference::mark(expected, double{kParams.voxel}, meant);
    std::vector<size_t> count(list->strokes.size());
    size_t off = 0;
    for (const auto& [cell, v] : expected) {
      off += found.at(cell).stroke != v.stroke;
      for (size_t i = 0; i < count.size(); ++i) count[i] += v.stroke == meant[i].id;
    }
    // Rounding moves single voxels over the border of a ball or of what is alike.
    EXPECT_LE(off, max_off) << "of " << found.size();
    return count;
  }
};

TEST_F(SceneStrokesTest, MarkAndFillAsSpecified) {
  Volume volume(device, kParams);
  for (int i = 0; i < 3; ++i) see(volume, 0.4 * i);
  SceneStrokes strokes(device, volume);
  EXPECT_FALSE(strokes.busy());
  auto list = list_of({on_ball(true), on_back(), on_left(true)});
  strokes.set(list);
  settle(strokes, volume);
  auto count = compare(volume, strokes, list);
  EXPECT_GT(count[0], 1000U) << "the ball";
  EXPECT_GT(count[1], 20U);
  EXPECT_GT(count[2], 3000U) << "the wall";
  const size_t ball = count[0];

  // The first goes, a new one comes, and one in pixels is no matter.
  list = list_of({on_back(), on_left(true), on_floor(), Stroke{Kind::shading, {{3, 3}}, 4}});
  strokes.set(list);
  settle(strokes, volume);
  auto in_scene = list_of({on_back(), on_left(true), on_floor()});
  count = compare(volume, strokes, in_scene);
  EXPECT_GT(count[2], 100U);

  // What comes into sight is marked, too.
  list = list_of({on_ball(true)});
  strokes.set(list);
  settle(strokes, volume);
  for (int i = 3; i < 8; ++i) see(volume, 0.4 * i);
  settle(strokes, volume, true);
  // What was alike when it was marked stays so, though its reflectance is known better now.
  count = compare(volume, strokes, list, ball / 50);
  EXPECT_GT(count[0], ball + 100);

  strokes.set(nullptr);
  settle(strokes, volume);
  for (const auto& [cell, v] : marked(volume)) ASSERT_EQ(v.stroke, 0U);
}

TEST_F(SceneStrokesTest, ExtremeStrokesEnd) {
  Volume volume(device, kParams);
  SceneStrokes strokes(device, volume);
  // Nothing is there yet.
  strokes.set(list_of({on_ball(true)}));
  settle(strokes, volume);
  for (int i = 0; i < 3; ++i) see(volume, 0.4 * i);
  // As many as there may be, on the same place, and changed twice before a frame.
  std::vector<Stroke> many;
  for (size_t i = 0; i < kMaxStrokes; ++i)
    many.push_back(stroke_at({{0.3F, 0.6F, 1.35F}}, 0.05F + 0.002F * float(i), i % 2 == 0));
  auto list = list_of(many);
  strokes.set(list);
  for (Stroke& stroke : many) stroke.balls[0][3] += 0.0005F;
  list = list_of(many);
  strokes.set(list);
  settle(strokes, volume);
  compare(volume, strokes, list_of(many));
  // All that is seen, and what is far away.
  list = list_of({stroke_at({{0, 0, 0}}, 100, true), stroke_at({{9000, -9000, 9000}}, 1, true)});
  strokes.set(list);
  settle(strokes, volume);
  const auto count = compare(volume, strokes, list);
  EXPECT_GT(count[0], 100'000U);
  EXPECT_EQ(count[1], 0U);
}

TEST_F(SceneStrokesTest, SinglePixelsAreClosed) {
  Volume volume(device, {.voxel = 0.02F, .blocks = 16});
  SceneStrokes strokes(device, volume);
  std::mt19937 random(4);
  for (const Extent extent : {Extent{1, 1}, Extent{2, 3}, Extent{37, 23}}) {
    Volume::View view(device, extent);
    std::vector<uint32_t> ids(extent.pixels());
    for (size_t i = 0; i < ids.size(); ++i)
      ids[i] = random() % 5 == 0 ? 0 : 1 + (i % extent.width / 9 + i / extent.width / 7) % 128;
    const auto from = upload(gpu::Element::word, ids.data(), ids.size()),
               closed = gpu::Buffer::create(device, gpu::Element::word, ids.size());
    run([&](gpu::Commands& commands) {
      commands.copy(from, view.strokes, from->bytes());
      strokes.record_close(commands, view, closed);
    });
    const auto found = words(closed);
    const auto width = int(extent.width), height = int(extent.height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        std::map<uint32_t, int> count;
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
          for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
            if (u != x || v != y) ++count[ids[size_t(v * width + u)]];
        uint32_t meant = ids[size_t(y * width + x)];
        for (const auto& [id, n] : count)
          if (ids[size_t(y * width + x)] == 0 && n >= 5) meant = id;
        ASSERT_EQ(found[size_t(y * width + x)], meant) << x << " " << y;
      }
  }
}

TEST_F(SceneStrokesTest, FramesSeeThemAsSpecified) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const Extent seen_size : {Extent{1, 1}, Extent{5, 7}, Extent{40, 30}, Extent{80, 60}})
    for (const Extent size : {Extent{3, 2}, Extent{40, 30}, Extent{83, 61}}) {
      const auto pixels = seen_size.pixels();
      std::vector<uint32_t> ids(pixels);
      std::vector<double> known(pixels), depth(pixels);
      Pixels known_pixels, depth_pixels;
      for (size_t i = 0; i < pixels; ++i) {
        const size_t x = i % seen_size.width, y = i / seen_size.width;
        ids[i] = (x / 6 + y / 5) % 4;
        known[i] = 1 + 2 * unit(random);
        depth[i] = i % 7 == 0 ? 0 : i % 5 == 0 ? 1 + 2 * unit(random) : known[i];
        known_pixels.push_back(float(known[i]));
        depth_pixels.push_back(float(depth[i]));
      }
      // Ids 1 and 3 are in the list, which also has one in pixels.
      std::vector<std::optional<Stroke>> by_id{on_ball(false), on_left(true), on_back()};
      const auto list = std::make_shared<const StrokeList>(
          StrokeList{{on_back(), Stroke{Kind::shading, {{1, 1}}, 1.5F}, on_ball(false)}, size});
      const std::vector<uint32_t> numbers{0, 3, 0, 1};
      SeenStrokes seen{seen_size,
                       upload(gpu::Element::word, ids.data(), pixels),
                       upload(gpu::Element::scalar, known_pixels.data(), pixels),
                       upload(gpu::Element::scalar, depth_pixels.data(), pixels),
                       upload(Pixels{1, 0, 0, 0}),
                       by_id};
      StrokeMask mask(device, size), alone(device, size);
      run([&](gpu::Commands& commands) {
        mask.set(commands, list, {nullptr, &seen});
        alone.set(commands, list, {});
      });
      EXPECT_TRUE(mask.moves());
      const auto check = [&](bool valid) {
        const Pixels found = download(mask.pixels()), drawn = download(alone.pixels());
        for (uint32_t y = 0; y < size.height; ++y)
          for (uint32_t x = 0; x < size.width; ++x) {
            const size_t at = size_t{4} * y * ((size.width + 3) / 4) + x;
            const double u = (x + 0.5) * seen_size.width / size.width - 0.5,
                         v = (y + 0.5) * seen_size.height / size.height - 0.5;
            // Between two pixels rounding says which is the nearest.
            if (std::abs(u - std::floor(u) - 0.5) < 1e-4 ||
                std::abs(v - std::floor(v) - 0.5) < 1e-4)
              continue;
            const double meant =
                drawn[at] > 0 ? double{drawn[at]}
                : valid       ? reference::seen_stroke(ids, known, depth, int(seen_size.width),
                                                       int(seen_size.height), numbers, u, v)
                              : 0;
            ASSERT_NEAR(double{found[at]}, meant, 2e-5) << x << " " << y;
          }
      };
      check(true);
      // A frame that sees others there; then one whose camera is lost.
      for (uint32_t& id : ids) id = (id + 1) % 4;
      seen.ids = upload(gpu::Element::word, ids.data(), pixels);
      run([&](gpu::Commands& commands) { mask.follow(commands, {}, &seen); });
      check(true);
      seen.valid = upload(Pixels{0, 0, 0, 0});
      run([&](gpu::Commands& commands) { mask.follow(commands, {}, &seen); });
      check(false);
    }
}

TEST(PlaceStrokeTest, PutsStrokesOntoSurfaces) {
  const Extent frame{80, 60}, size{40, 30};
  SceneView view{size, {40, 40, 19.5F, 14.5F}, {}, {}};
  // Turned by 90° about y: the camera looks along x.
  view.pose.rotation = {0, std::sqrt(0.5F), 0, std::sqrt(0.5F)};
  view.pose.place = {1, 2, 3, 0};
  std::vector<float> depth(size.pixels(), 2);
  for (size_t i = 0; i < depth.size(); ++i)
    if (i % 40 >= 20) depth[i] = i % 40 < 30 ? 4 : 0;
  view.depth = depth;
  const Stroke drawn{Kind::shading, {{20, 30}, {79, 30}}, 4, true};
  const auto placed = placed_in_scene(drawn, frame, view);
  ASSERT_TRUE(placed);
  EXPECT_TRUE(placed->in_scene());
  EXPECT_TRUE(placed->fill);
  EXPECT_TRUE(placed->points.empty());
  size_t far = 0;
  for (const auto& [x, y, z, radius] : placed->balls) {
    EXPECT_NEAR(y, 2, 1e-4);  // at the height of the camera
    far += x > 4;
    EXPECT_TRUE(std::abs(x - 3) < 1e-4F || std::abs(x - 5) < 1e-4F);
    // To the right of the camera is -z.
    EXPECT_TRUE(x <= 4 || z < 3.1F);
    EXPECT_NEAR(radius, x > 4 ? 0.2 : 0.1, 1e-4) << "two pixels of the view";
  }
  EXPECT_GT(far, 5U);
  EXPECT_LT(far, placed->balls.size());
  EXPECT_TRUE(covers(*placed, {30, 30}, frame, view));
  EXPECT_TRUE(covers(*placed, {50, 31}, frame, view));
  EXPECT_FALSE(covers(*placed, {30, 45}, frame, view));
  EXPECT_FALSE(covers(*placed, {75, 30}, frame, view)) << "no surface is known there";
  EXPECT_FALSE(placed_in_scene({Kind::shading, {{75, 10}}, 4}, frame, view));
  EXPECT_FALSE(placed_in_scene({Kind::shading, {{1e6F, -1e6F}}, 4}, frame, view));
  const auto endless =
      placed_in_scene({Kind::shading, {{-1e6F, 30}, {1e6F, 30}}, 0.1F}, frame, view);
  EXPECT_TRUE(!endless || endless->balls.size() <= 1100U);
}

}  // namespace
}  // namespace inverse::testing
