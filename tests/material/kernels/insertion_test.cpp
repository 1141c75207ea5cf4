// SPDX-License-Identifier: LGPL-2.1-or-later
// An object and its shadow in a frame.
#include "kernels/material/raster/insertion.hpp"

#include <numbers>

#include "kernels/material_raster_blend.spv.hpp"
#include "kernels/material_raster_occlude.spv.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/material/reference/raster.hpp"

namespace inverse::testing {
namespace {

constexpr Extent kFrame{160, 120};

/// A disc of radius 0.8 that hovers at a height of 0.6 over its lowest point, a speck.
Mesh hovering_disc() {
  Mesh mesh;
  constexpr int kParts = 96;
  mesh.positions.push_back({0, .3F, 0});
  for (int i = 0; i < kParts; ++i) {
    const float angle = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / kParts;
    mesh.positions.push_back({.8F * std::cos(angle), .3F, .8F * std::sin(angle)});
    mesh.indices.insert(mesh.indices.end(), {0, static_cast<uint32_t>(1 + i),
                                             static_cast<uint32_t>(1 + (i + 1) % kParts)});
  }
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (const float x : {-.001F, .001F}) mesh.positions.push_back({x, -.3F, 0});
  mesh.positions.push_back({0, -.3F, .001F});
  mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
  mesh.prepare("disc");
  return mesh;
}

class InsertionTest : public GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    make_light();
  }
  void make_light() {
    light.emplace(device, 32);
    light->set_light(Environment::uniform({1, 1, 1}));
  }
  Pixels draw(Insertion& insertion, const Pixels& frame, const Insertion::Params& params,
              Extent extent = kFrame) {
    const Plane picture = plane(extent, frame);
    run([&](gpu::Commands& commands) {
      light->record(commands, {{.25F, .5F, .75F}, 0, 2}, {});
      insertion.record(commands, picture, params, *light);
    });
    return download(picture);
  }
  static Pixels flat(float value, float alpha, Extent extent = kFrame) {
    Pixels pixels(4 * extent.pixels(), value);
    for (size_t i = 3; i < pixels.size(); i += 4) pixels[i] = alpha;
    return pixels;
  }
  static const float* at(const Pixels& pixels, int x, int y) {
    return &pixels[4 * (static_cast<size_t>(y) * kFrame.width + static_cast<size_t>(x))];
  }
  std::optional<LitSphere> light;
};

}  // namespace

TEST_F(InsertionTest, DrawsTheMaterialAtItsPosition) {
  Insertion insertion(device, kFrame);
  insertion.set_mesh(Mesh::sphere());
  const Insertion::Params params{.x = .25F, .y = .4F, .size = .5F, .shadow = 0};
  const Pixels before = random_pixels(kFrame, 1), drawn = draw(insertion, before, params);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const double r = std::hypot(x + .5 - 40, y + .5 - 48);
      for (int c = 0; c < 3; ++c) {
        if (r < 29) {
          ASSERT_NEAR(at(drawn, x, y)[c], .25 * (c + 1), 6e-3);
        }
        if (r > 31) {
          ASSERT_EQ(at(drawn, x, y)[c], at(before, x, y)[c]);
        }
      }
    }
}

TEST_F(InsertionTest, EdgesMixInLinearLight) {
  Insertion insertion(device, kFrame);
  insertion.set_mesh(Mesh::sphere());
  const Insertion::Params params{.shadow = 0};
  const Pixels drawn = draw(insertion, flat(0, 1), params);
  double sum = 0;
  for (size_t i = 1; i < drawn.size(); i += 4) sum += drawn[i];
  EXPECT_NEAR(sum / .5, std::numbers::pi * 30 * 30, 15) << "as much light as area";
}

TEST_F(InsertionTest, TheShadowIsTheLightOfTheSkyThatIsHidden) {
  Insertion insertion(device, kFrame);
  const Mesh disc = hovering_disc();
  insertion.set_mesh(disc);
  double radius = 0, top = -1, bottom = 1;
  for (const auto& p : disc.positions) {
    radius = std::max<double>(radius, std::hypot(p[0], p[2]));
    top = std::max<double>(top, p[1]);
    bottom = std::min<double>(bottom, p[1]);
  }
  const Insertion::Params params{.size = .6F, .shadow = .5F, .softness = .05F};
  const Pixels drawn = draw(insertion, flat(.5F, 1), params);
  const double height = top - bottom + params.softness;
  const double scale = .3 * 120, c = std::cos(20 * M_PI / 180), s = std::sin(20 * M_PI / 180);
  for (const double x : {0.0, .5, -.9, 1.3}) {
    // A point of the ground beside or in front of the middle.
    const double z = .25;
    double hidden = 0;
    constexpr int kGrid = 200;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const double u = 2 * (i + .5) / kGrid - 1, v = 2 * (j + .5) / kGrid - 1;
        if (std::hypot(u, v) < radius)
          hidden += reference::hidden_by(4. / (kGrid * kGrid), height, std::hypot(u - x, v - z));
      }
    const int px = static_cast<int>(80 + scale * x);
    const int py = static_cast<int>(60 - scale * (bottom * c - z * s));
    EXPECT_NEAR(at(drawn, px, py)[1], .5 * (1 - .5 * hidden), .012) << x;
  }
  // At the middle of a disc it is known: R² / (R² + h²).
  double hidden = 0;
  for (int i = 0; i < 400; ++i) {
    const double r = radius * (i + .5) / 400;
    hidden += reference::hidden_by(2 * M_PI * r * radius / 400, height, r);
  }
  EXPECT_NEAR(hidden, radius * radius / (radius * radius + height * height), .01);
}

/// A corner of a cube that stands on the face across from it: all of it is above the middle of its
/// box.
TEST_F(InsertionTest, TheGroundIsBelowWhateverIsAboveTheMiddle) {
  Mesh corner;
  corner.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  corner.indices = {0, 1, 2, 0, 2, 3, 0, 3, 1};
  corner.prepare("corner");
  Insertion insertion(device, kFrame);
  insertion.set_mesh(corner);
  const Insertion::Params params{.size = .6F,
                                 .pitch = static_cast<float>(std::atan(std::sqrt(.5)) * 180 / M_PI),
                                 .roll = 225,
                                 .shadow = 1,
                                 .softness = .3F};
  const Pixels drawn = draw(insertion, flat(.5F, 1), params);
  // That face is level, a third above the middle; one of its corners is towards the camera.
  const double bottom = 1. / 3, inside = std::sqrt(2.) / 3;
  const auto across = [](double angle, double x, double z) {
    return x * std::cos(angle * M_PI / 180) + z * std::sin(angle * M_PI / 180);
  };
  const double scale = .3 * 120, c = std::cos(20 * M_PI / 180), s = std::sin(20 * M_PI / 180);
  for (const auto& [x, z] : {std::pair{.52, .3}, {-.52, .3}, {0., 1.1}}) {
    double hidden = 0;
    constexpr int kGrid = 200;
    for (int i = 0; i < kGrid; ++i)
      for (int j = 0; j < kGrid; ++j) {
        const double u = 2 * (i + .5) / kGrid - 1, v = 2 * (j + .5) / kGrid - 1;
        if (across(-90, u, v) < inside && across(30, u, v) < inside && across(150, u, v) < inside)
          hidden +=
              reference::hidden_by(4. / (kGrid * kGrid), params.softness, std::hypot(u - x, v - z));
      }
    const int px = static_cast<int>(80 + scale * x);
    const int py = static_cast<int>(60 - scale * (bottom * c - z * s));
    EXPECT_NEAR(at(drawn, px, py)[1], .5 * (1 - hidden), .02) << x;
  }
}

TEST_F(InsertionTest, HiddenLightAgreesWithReference) {
  constexpr Extent kHeights{reference::kUnderside, reference::kUnderside};
  constexpr uint32_t kPoints = reference::kGround * reference::kGround;
  unsigned seed = 1;
  for (const float far : {0.0F, 16.0F, 1e4F})  // 16 are as far as an object reaches
    for (const float ground : {-1.0F, 0.0F, 1.0F})
      for (const float soft : {.05F, 1.0F}) {
        Pixels heights = random_pixels(kHeights, ++seed, -1, 1);
        for (size_t i = 0; i < heights.size(); i += 4) {
          heights[i] *= far;
          heights[i + 1] = std::max(heights[i + 1], 0.0F);
        }
        const gpu::BufferPtr occlusion = plane({reference::kGround, reference::kGround}).buffer;
        run([&](gpu::Commands& commands) {
          commands.dispatch(gpu::Program<shaders::material_raster_occlude>(device),
                            {.heights = plane(kHeights, heights).buffer, .occlusion = occlusion},
                            {.ground = ground, .soft = soft}, {kPoints});
        });
        expect_near(
            download(occlusion),
            reference::hidden_light(to_reference(kHeights, heights), double{ground}, double{soft}),
            1e-3, "heights of " + std::to_string(far));
      }
}

TEST_F(InsertionTest, ObjectsOverShadowsAgreeWithReference) {
  constexpr Extent kGrid{reference::kGround, reference::kGround}, kWindow{40, 30};
  constexpr int kLeft = 50, kTop = 45;
  unsigned seed = 9;
  for (const reference::GroundView& view : {reference::GroundView{70, 60, 30, -.8, .34, .6, .8},
                                            {75.3, 40, 12, -.2, .02, -2, 1},
                                            {0, 0, 200, .5, 1, 3, .5},
                                            {80, 60, 1e-3, -1, .5, 0, 1},
                                            {80, 60, 1e6, -1, .5, 1, 1},
                                            {80, 60, 40, -1, .7, 1, 0}}) {
    // Light that is hidden ends before its grid does.
    Pixels hidden = random_pixels(kGrid, ++seed, 0, 1);
    for (uint32_t i = 0; i < kGrid.pixels(); ++i)
      if (const uint32_t x = i % kGrid.width, y = i / kGrid.width;
          x < 2 || y < 2 || x > kGrid.width - 4 || y > kGrid.width - 4)
        hidden[4 * i] = 0;
    // Without a shadow it is not even computed.
    const Pixels stored = view.strength > 0 ? hidden : Pixels(hidden.size(), kNan);
    Pixels object = random_pixels(kWindow, ++seed, 0, 1);
    for (size_t i = 0; i < object.size(); i += 12)
      for (size_t c = 0; c < 4; ++c) object[i + c] = 0;  // nothing there
    for (size_t i = 4; i < object.size(); i += 12) object[i + 3] = 1;
    Pixels before = random_pixels(kFrame, ++seed, 0, 2);
    for (size_t i = 3; i < before.size(); i += 4) before[i] = std::min(before[i], 1.0F);
    const Plane frame = plane(kFrame, before);
    const shaders::material_raster_blend::Push push{
        .origin = {0, 0},
        .size = kFrame,
        .window = {kLeft, kTop},
        .window_size = kWindow,
        .stride = kFrame.width,
        .center_x = static_cast<float>(view.x),
        .center_y = static_cast<float>(view.y),
        .radius = static_cast<float>(view.radius),
        .ground = static_cast<float>(view.ground),
        .sine = static_cast<float>(view.sine),
        .turn_x = static_cast<float>(std::cos(view.yaw)),
        .turn_y = static_cast<float>(std::sin(view.yaw)),
        .strength = static_cast<float>(view.strength)};
    run([&](gpu::Commands& commands) {
      commands.dispatch(gpu::Program<shaders::material_raster_blend>(device),
                        {.picture = plane(kWindow, object).buffer,
                         .occlusion = plane(kGrid, stored).buffer,
                         .frame = frame.buffer},
                        push, {kFrame.width, kFrame.height});
    });
    reference::Plane expected(static_cast<int>(kFrame.width), static_cast<int>(kFrame.height));
    const reference::Plane grid = to_reference(kGrid, hidden), own = to_reference(kWindow, object),
                           below = to_reference(kFrame, before);
    for (int y = 0; y < expected.height; ++y)
      for (int x = 0; x < expected.width; ++x) {
        const int u = x - kLeft, v = y - kTop;
        const bool drawn = u >= 0 && v >= 0 && u < own.width && v < own.height;
        expected.at(x, y) =
            reference::over(drawn ? own.at(u, v) : reference::Vec4{},
                            reference::darkness(grid, view, x + .5, y + .5), below.at(x, y));
      }
    // A pixel of the flattest view is fifty along the ground.
    expect_near(download(frame), expected, view.sine < .1 ? 5e-3 : 1e-3,
                "radius " + std::to_string(view.radius));
  }
}

TEST_F(InsertionTest, DrawsAgainOnlyWhatChanged) {
  Insertion insertion(device, kFrame);
  insertion.set_mesh(Mesh::sphere());
  const Pixels before = flat(.5F, 1);
  Insertion::Params params;
  const Pixels first = draw(insertion, before, params);
  EXPECT_EQ(draw(insertion, before, params), first);
  EXPECT_EQ(insertion.drawn(), 1u);
  EXPECT_EQ(insertion.shadows(), 1u);
  params.shadow = .3F;
  draw(insertion, before, params);
  EXPECT_EQ(insertion.drawn(), 1u);
  params.yaw = 30;
  draw(insertion, before, params);
  EXPECT_EQ(insertion.drawn(), 2u);
  EXPECT_EQ(insertion.shadows(), 1u) << "it turns with the object";
  params.pitch = 10;
  draw(insertion, before, params);
  EXPECT_EQ(insertion.drawn(), 3u);
  EXPECT_EQ(insertion.shadows(), 2u);
}

TEST_F(InsertionTest, WhatWasNeverComputedIsDrawnWhenItIsForgotten) {
  const Pixels before = flat(.5F, 1);
  const auto inserted = [&](bool fails) {
    make_light();
    Insertion insertion(device, kFrame);
    insertion.set_mesh(Mesh::sphere());
    if (fails) {
      const Plane picture = plane(kFrame, before);
      gpu::Commands commands(device);
      commands.begin();
      light->record(commands, {{.25F, .5F, .75F}, 0, 2}, {});
      insertion.record(commands, picture, {}, *light);
      light->forget();
      insertion.forget();
    }
    return draw(insertion, before, {});
  };
  EXPECT_EQ(inserted(true), inserted(false));
}

TEST_F(InsertionTest, CoversWhatIsTransparent) {
  Insertion insertion(device, kFrame);
  insertion.set_mesh(Mesh::sphere());
  const Pixels drawn = draw(insertion, flat(.9F, 0), {});
  EXPECT_EQ(at(drawn, 80, 60)[3], 1);
  EXPECT_NEAR(at(drawn, 80, 60)[2], .75, 6e-3);
  EXPECT_EQ(at(drawn, 2, 2)[3], 0);
  const float* shadow = at(drawn, 80, 95);
  EXPECT_GT(shadow[3], .2) << "the shadow is black that covers";
  EXPECT_NEAR(shadow[2], 0, 1e-6);
}

TEST_F(InsertionTest, AnythingGoesAtAnySize) {
  for (const Extent extent : {Extent{1, 1}, {16, 16}, {3, 200}, {1000, 10}}) {
    Insertion insertion(device, extent);
    insertion.set_mesh(Mesh::sphere());
    for (const float value : {kNan, kInf, -kInf, 0.0F, 1.0F, -1.0F, 4.0F, 1e30F}) {
      ASSERT_TRUE(
          all_finite(draw(insertion, flat(.5F, 1, extent),
                          {value, value, value, value, value, value, value, value, value}, extent)))
          << value;
    }
    for (const float x : {-1.0F, 0.0F, 1.0F, 2.0F})
      for (const float size : {.01F, 1.0F, 4.0F})
        draw(insertion, flat(.5F, 1, extent), {.x = x, .y = 1 - x, .size = size}, extent);
  }
}

}  // namespace inverse::testing
