// SPDX-License-Identifier: LGPL-2.1-or-later
// The virtual stage against its reference, and light that adds up.
#include <algorithm>
#include <limits>
#include <numeric>

#include "common/error.hpp"
#include "kernels/lightstage/virtual_stage/camera_schedule.hpp"
#include "kernels/lightstage/virtual_stage/half.hpp"
#include "kernels/lightstage/virtual_stage/virtual_camera.hpp"
#include "kernels/lightstage/virtual_stage/virtual_head.hpp"
#include "tests/differences.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/lightstage/reference/virtual_head.hpp"

namespace inverse::testing {
namespace {

reference::Head reference_head() {
  const HeadScene& scene = virtual_head();
  reference::Head head;
  for (size_t i = 0; i < scene.primitives.size(); i += HeadScene::kPrimitiveVec4s) {
    const auto* p = &scene.primitives[i];
    reference::HeadSolid solid{};
    for (size_t r = 0; r < 3; ++r) {
      solid.rows[r] = {p[r][0], p[r][1], p[r][2]};
      solid.center[r] = p[r][3];
    }
    solid.radius = p[3][0], solid.blend = p[3][1];
    solid.carving = p[3][2] == 1;
    solid.material = static_cast<int>(p[3][3]);
    head.solids.push_back(solid);
  }
  for (size_t i = 0; i < scene.materials.size(); i += 2) {
    const auto &a = scene.materials[i], &b = scene.materials[i + 1];
    head.materials.push_back({{a[0], a[1], a[2]}, a[3], b[0], b[1], b[2]});
  }
  return head;
}

reference::Vec3 vec(const Pixels& pixels, size_t i) {
  return {pixels[4 * i], pixels[4 * i + 1], pixels[4 * i + 2]};
}

constexpr uint64_t kPlenty = uint64_t{1} << 30;

class VirtualStageTest : public GpuTest {
 protected:
  Pixels sum(OlatStack& stack, const std::vector<LightColor>& colors) {
    return result_of([&](gpu::Commands& commands) { return stack.record(commands, colors); });
  }
  /// What a stack holds of one light: its frame under that light alone, white.
  Pixels olat(OlatStack& stack, uint32_t light) {
    std::vector<LightColor> colors(stack.lights());
    colors[light] = {1, 1, 1};
    return sum(stack, colors);
  }
  struct Surface {
    Pixels position, normal, albedo;
  };
  /// The head from a camera, in two parts.
  Surface surface(Extent extent, const HeadView& view) {
    const HeadSurface surface = make_head_surface(device, extent);
    run([&](gpu::Commands& commands) {
      const auto all = static_cast<uint32_t>(extent.pixels());
      record_head_surface(commands, surface, view, 0, all / 3);
      record_head_surface(commands, surface, view, all / 3, all - all / 3);
    });
    return {download(surface.position), download(surface.normal), download(surface.albedo)};
  }
  OlatStack random_stack(Extent extent, uint32_t lights, unsigned seed) {
    OlatStack stack(device, extent, lights, kPlenty);
    for (uint32_t i = 0; i < lights; ++i) {
      const Pixels pixels = random_pixels(extent, seed + i, 0, 2);
      stack.load(i, std::span(pixels).first(3 * extent.pixels()));
    }
    return stack;
  }
};

TEST_F(VirtualStageTest, SurfaceMatchesItsReference) {
  const reference::Head head = reference_head();
  for (const uint32_t camera : {0U, 1U, 4U}) {
    const Extent extent{80, 60};
    const HeadView view = view_of_camera(camera);
    const auto [position, normal, albedo] = surface(extent, view);
    const reference::HeadCamera eye{view.turn, view.distance, view.height, view.center};
    size_t seen = 0, differ = 0, off = 0;
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        const size_t i = size_t{y} * extent.width + x;
        const auto expected = reference::see_head(head, eye, static_cast<int>(extent.width),
                                                  static_cast<int>(extent.height),
                                                  static_cast<int>(x), static_cast<int>(y));
        const bool hit = position[4 * i + 3] > 0;
        differ += hit != expected.has_value();
        if (!hit || !expected) continue;
        ++seen;
        // Creases and borders of materials may fall on the other side.
        off += max_difference(vec(position, i), expected->position) > 3e-3 ||
               max_difference(vec(normal, i), expected->normal) > 2e-2 ||
               max_difference(vec(albedo, i), expected->albedo) > 1e-2 ||
               std::abs(normal[4 * i + 3] - expected->roughness) > 1e-2 ||
               std::abs(albedo[4 * i + 3] - expected->f0) > 1e-3;
      }
    EXPECT_GT(seen, 1000U);
    EXPECT_LE(differ, 6U) << "camera " << camera;
    EXPECT_LE(off, seen / 25) << "camera " << camera;
  }
}

TEST_F(VirtualStageTest, ShadingMatchesItsReference) {
  const reference::Head head = reference_head();
  const Extent extent{64, 48};
  const HeadView view = view_of_camera(2);
  std::vector<Direction> lights = geodesic_directions(12);
  lights.push_back({0, 0, 1});
  lights.push_back({0, 0, -1});
  OlatStack stack(device, extent, static_cast<uint32_t>(lights.size()), kPlenty);
  ASSERT_TRUE(render_head(stack, lights, view));
  const Extent fine{2 * extent.width, 2 * extent.height};
  const auto [position, normal, albedo] = surface(fine, view);
  const auto eye = view.eye();
  for (uint32_t light = 0; light < lights.size(); ++light) {
    const Pixels image = olat(stack, light);
    size_t off = 0;
    double total = 0;
    for (uint32_t y = 0; y < extent.height; ++y)
      for (uint32_t x = 0; x < extent.width; ++x) {
        reference::Vec3 expected{};
        for (uint32_t s = 0; s < 4; ++s) {
          const size_t i = size_t{2 * y + s / 2} * fine.width + 2 * x + s % 2;
          if (position[4 * i + 3] <= 0) continue;
          const reference::HeadPoint point{vec(position, i), vec(normal, i), vec(albedo, i),
                                           normal[4 * i + 3], albedo[4 * i + 3]};
          const auto one =
              reference::shade_head(head, point, {eye[0], eye[1], eye[2]}, lights[light]);
          for (size_t c = 0; c < 3; ++c) expected[c] += one[c] / 4;
        }
        const size_t i = size_t{y} * extent.width + x;
        total += expected[1];
        // Half floats, and the rim of a solid may fall on the other side of "inside".
        off += max_difference(vec(image, i), expected) >
               1e-3 * std::max({1.0, expected[0], expected[1], expected[2]});
      }
    EXPECT_TRUE(are_light(image)) << "light " << light;
    EXPECT_LE(off, extent.pixels() / 200) << "light " << light;
    if (lights[light][2] > .5) {
      EXPECT_GT(total, 20) << "light " << light;
    }
  }
}

TEST_F(VirtualStageTest, RenderingCanBeCancelled) {
  OlatStack stack(device, {8, 8}, 3, kPlenty);
  EXPECT_FALSE(render_head(stack, geodesic_directions(3), {}, [] { return false; }));
}

TEST_F(VirtualStageTest, FramesAreSumsOfTheirImages) {
  const LightProgram program = static_capture(stage_lights(geodesic_directions(42)), 60);
  for (const Extent extent : {Extent{40, 30}, {16, 16}, {1, 1}, {17, 5}}) {
    OlatStack stack(device, extent, 42, kPlenty);
    std::vector<Direction> directions;
    for (const auto& light : program.lights) directions.push_back(light.direction);
    ASSERT_TRUE(render_head(stack, directions, {}));
    std::vector<Pixels> images;
    for (uint32_t i = 0; i < 42; ++i) images.push_back(olat(stack, i));
    for (size_t step = 0; step < program.steps.size(); ++step) {
      const auto colors = program.colors(program.steps[step]);
      const Pixels frame = sum(stack, colors);
      for (size_t i = 0; i < frame.size(); ++i) {
        if (i % 4 == 3) continue;
        double expected = 0;
        for (uint32_t l = 0; l < 42; ++l)
          expected += double{colors[l][i % 4]} * double{images[l][i]};
        // 42 additions in float.
        ASSERT_NEAR(frame[i], expected, 42 * 6e-8 * expected + 1e-12) << "step " << step;
      }
    }
  }
}

TEST_F(VirtualStageTest, SumsAreRightInAnySplitOfBuffers) {
  const Extent extent{33, 9};
  OlatStack stack = random_stack(extent, 50, 7);
  std::vector<LightColor> colors(50);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(0, 1);
  for (auto& c : colors)
    if (random() % 3) c = {value(random), value(random), value(random)};
  std::vector<double> expected(4 * extent.pixels());
  for (uint32_t l = 0; l < 50; ++l) {
    const Pixels pixels = random_pixels(extent, 7 + l, 0, 2);
    for (size_t p = 0; p < extent.pixels(); ++p)
      for (size_t c = 0; c < 3; ++c)
        expected[4 * p + c] += double{colors[l][c]} * double{pixels[3 * p + c]};
  }
  const Pixels frame = sum(stack, colors);
  for (size_t i = 0; i < frame.size(); ++i) {
    if (i % 4 < 3) {
      ASSERT_NEAR(frame[i], expected[i], 5e-4 * expected[i]);  // images are half floats
    }
  }
  for (const float x : sum(stack, std::vector<LightColor>(50))) EXPECT_TRUE(x == 0 || x == 1);
}

TEST_F(VirtualStageTest, SumsArePerLight) {
  const Extent extent{20, 20};
  OlatStack stack = random_stack(extent, 20, 1);
  std::vector<std::vector<LightColor>> all;
  std::vector<Pixels> first;
  for (int i = 0; i < 12; ++i) {
    const float x = static_cast<float>(i) / 12;
    all.emplace_back(20, LightColor{x, 1 - x, .5F});
    first.push_back(sum(stack, all.back()));
  }
  EXPECT_EQ(stack.made(), 12U);
  EXPECT_EQ(sum(stack, all[11]), first[11]);
  EXPECT_EQ(sum(stack, all[10]), first[10]);
  EXPECT_EQ(stack.taken_again(), 2U);
  EXPECT_EQ(sum(stack, all[0]), first[0]);  // was forgotten, and is made again
  EXPECT_EQ(stack.made(), 13U);
}

TEST_F(VirtualStageTest, TooMuchMemoryIsAnError) {
  expect_error(ErrorKind::limit,
               "331 images of 640x480 under one light each take 776 MiB, the limit is 100 MiB; use "
               "a smaller frame",
               [&] {
                 OlatStack(device, {640, 480}, 331, uint64_t{100} << 20);
               });
}

TEST_F(VirtualStageTest, InvalidImagesAreBounded) {
  OlatStack stack(device, {2, 1}, 1, kPlenty);
  stack.load(0, std::vector<float>{kNan, -1, kInf, 1e30F, .5F, -kInf});
  const Pixels frame = olat(stack, 0);
  const std::vector<float> expected = {0, 0, 65504, 1, 65504, .5F, 0, 1};
  EXPECT_EQ(frame, expected);
  for (const auto& [light, size] : {std::pair{1U, 6U}, {0U, 5U}})
    expect_error(ErrorKind::internal, "an OLAT image of another stack",
                 [&] { stack.load(light, std::vector<float>(size)); });
}

TEST(Half, IsTheNearest) {
  const auto value = [](uint16_t half) {
    const int exponent = half >> 10;
    const double fraction = (half & 1023) / 1024.0;
    return exponent ? std::ldexp(1 + fraction, exponent - 15) : std::ldexp(fraction, -14);
  };
  for (uint32_t h = 0; h < 0x7bff; ++h) {
    const auto half = static_cast<uint16_t>(h);
    const double a = value(half), b = value(static_cast<uint16_t>(h + 1));
    ASSERT_EQ(to_half(static_cast<float>(a)), half);
    ASSERT_EQ(to_half(static_cast<float>(a + .49 * (b - a))), half);
    ASSERT_EQ(to_half(static_cast<float>(a + .51 * (b - a))), half + 1);
    ASSERT_EQ(to_half(static_cast<float>(a + .5 * (b - a))), half % 2 ? half + 1 : half);
  }
}

TEST_F(VirtualStageTest, CameraMatchesItsReference) {
  const VirtualCamera camera(device);
  for (const Extent extent : kOddSizes)
    for (const VirtualCamera::Shot& shot :
         {VirtualCamera::Shot{}, {3.3F, .5F}, {-7.25F, 2, .1F, 5, 77}, {1e4F, 1, .02F, 0, 1}}) {
      const Pixels pixels = random_pixels(extent, 3, 0, 2);
      const Plane light = plane(extent, pixels), picture = plane(extent);
      run([&](gpu::Commands& commands) { camera.record(commands, light, shot, picture); });
      const Pixels result = download(picture);
      const auto expected = reference::take_picture(
          to_reference(extent, pixels), {shot.sway, shot.gain, shot.noise, shot.seed, shot.frame});
      for (size_t i = 0; i < result.size(); ++i)
        ASSERT_NEAR(result[i], expected.data[i / 4][i % 4], 2e-3) << extent.width << " " << i;
    }
}

TEST_F(VirtualStageTest, NoiseHasTheSpecifiedSize) {
  const Extent extent{200, 200};
  const VirtualCamera camera(device);
  for (const float level : {0.0F, .25F, 1.0F}) {
    const Plane light = plane(extent, Pixels(4 * extent.pixels(), level)), picture = plane(extent);
    run([&](gpu::Commands& commands) {
      camera.record(commands, light, {0, 1, .1F, 9, 4}, picture);
    });
    const Pixels result = download(picture);
    double mean = 0, variance = 0;
    const double count = 3.0 * static_cast<double>(extent.pixels());
    for (size_t i = 0; i < result.size(); ++i)
      if (i % 4 < 3) mean += result[i] / count;
    for (size_t i = 0; i < result.size(); ++i)
      if (i % 4 < 3) variance += (result[i] - mean) * (result[i] - mean) / count;
    EXPECT_NEAR(mean, level, 2e-3);
    EXPECT_NEAR(std::sqrt(variance), .1 * std::sqrt(.9 * level + .1), 2e-3);
  }
}

TEST(CameraSchedule, RatesAreAsSpecified) {
  const CameraFaults faults{.02F, .01F, .05F, .3F, 6};
  int dropped = 0, duplicated = 0, late = 0;
  double smallest = 0, largest = 0;
  for (uint64_t i = 0; i < 100000; ++i) {
    const FrameFate fate = fate_of(i, faults);
    dropped += fate.dropped, duplicated += fate.duplicated;
    late += fate.shift > .31;
    smallest = std::min(smallest, fate.shift);
    update_max(largest, fate.shift);
  }
  EXPECT_NEAR(dropped, 2000, 150);
  EXPECT_NEAR(duplicated, 1000, 110);
  EXPECT_NEAR(late, 4700, 400);  // some of these were early otherwise
  EXPECT_NEAR(smallest, -.3, 1e-3);
  EXPECT_NEAR(largest, 1.3, 3e-2);
  for (uint64_t i = 0; i < 1000; ++i) {
    const FrameFate none = fate_of(i, {}), all = fate_of(i, {1, 1, 0, 0, 0});
    EXPECT_FALSE(none.dropped || none.duplicated);
    EXPECT_EQ(none.shift, 0);
    EXPECT_TRUE(all.dropped && all.duplicated);
  }
}

TEST(CameraSchedule, FrameIdsWrap) {
  EXPECT_EQ(frame_id(0, 65400, 16), 65400U);
  EXPECT_EQ(frame_id(135, 65400, 16), 65535U);
  EXPECT_EQ(frame_id(136, 65400, 16), 1U);
  EXPECT_EQ(frame_id(65535 + 135, 65400, 16), 65535U);
  EXPECT_EQ(frame_id(0, 0, 16), 0U);
  EXPECT_EQ(frame_id(1, 0, 16), 1U);
  EXPECT_EQ(frame_id(65536, 0, 16), 1U);
  EXPECT_EQ(frame_id(70000, 65400, 64), 135400U);
}

}  // namespace
}  // namespace inverse::testing
