// SPDX-License-Identifier: LGPL-2.1-or-later
// Lamps: where they are, and the kernels against their specification.
#include "kernels/edit/relight/relight.hpp"

#include <array>
#include <cmath>

#include "tests/kernels/edit/edit_fixture.hpp"
#include "tests/reference/edit/relight.hpp"

namespace inverse::testing {
namespace {

constexpr double kPi = 3.14159265358979323846;

double linear_of(uint32_t code) {
  const double v = (code & 255) / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

/// A lamp seen along z: places are in widths of the frame, from its center.
reference::SceneLamp in_scene(const Lamp& lamp, Extent frame, double strength) {
  reference::SceneLamp result{.kind = static_cast<reference::SceneLamp::Kind>(lamp.kind)};
  const double width = frame.width;
  result.place = {(double{lamp.position[0]} - frame.width / 2.0) / width,
                  (double{lamp.position[1]} - frame.height / 2.0) / width,
                  double{lamp.position[2]}};
  const double length =
      std::hypot(double{lamp.direction[0]}, double{lamp.direction[1]}, double{lamp.direction[2]});
  for (size_t c = 0; c < 3; ++c) {
    result.axis[c] = double{lamp.direction[c]} / length;
    result.light[c] =
        double{lamp.power} * strength * linear_of(lamp.color >> (16 - 8 * static_cast<int>(c)));
  }
  result.angle = double{lamp.angle} * kPi / 180;
  result.softness = double{lamp.softness};
  result.radius = double{lamp.radius};
  return result;
}

/// All kinds; the last ones are extreme: no radius in the picture plane, far away, behind it.
std::vector<Lamp> lamps_of(Extent frame) {
  using Kind = Lamp::Kind;
  const float w = static_cast<float>(frame.width), h = static_cast<float>(frame.height);
  return {
      {.kind = Kind::point, .position = {w / 3, h / 2, .2F}, .color = 0xff8040, .power = .1F},
      {.kind = Kind::spot,
       .position = {w / 2, h / 4, .4F},
       .direction = {.2F, .1F, -1},
       .color = 0x3050ff,
       .power = .5F,
       .angle = 25},
      {.kind = Kind::directional, .direction = {-3, 1, -2}, .color = 0x80ff80, .power = .7F},
      {.kind = Kind::spot,
       .position = {w, h, .5F},
       .direction = {0, 0, -1e6F},
       .power = 2,
       .angle = 40,
       .softness = 0},
      {.kind = Kind::point, .position = {w / 2, h / 2, 0}, .power = 1e6F, .radius = 0},
      {.kind = Kind::point, .position = {-1e6F, 1e6F, 1000}, .power = 1e6F},
      {.kind = Kind::point, .position = {w / 4, h / 4, -1}, .power = 1e6F},
      {.kind = Kind::directional, .direction = {1, 1e-6F, 0}, .power = 1},
  };
}

class RelightTest : public EditorTest {
 protected:
  void record(Relight& relight, Layers& layers, const RelightParams& params) {
    run([&](gpu::Commands& commands) { relight.record(commands, layers, params); });
  }
};

/// What the layers have beside R and S.
struct Beside {
  bool light = false, slope = false, shares = false, mask = false;
};

}  // namespace

TEST(Lamps, AreWhereTheyAreSeen) {
  const Extent frame{640, 480};
  Lamp lamp{.position = {100, 50, .3F}};
  EXPECT_EQ(place_of(lamp, frame), (Place{100, 50}));
  move_to(lamp, {7, 8}, frame);
  EXPECT_EQ(lamp.position, (Lamp::Vector{7, 8, .3F}));
  // The sun: behind the viewer it is seen in the middle; from the right, at the right rim.
  Lamp sun{.kind = Lamp::Kind::directional, .direction = {0, 0, -5}};
  EXPECT_EQ(place_of(sun, frame), (Place{320, 240}));
  for (const Place place : {Place{400, 240}, {320, 100}, {250, 300}}) {
    move_to(sun, place, frame);
    EXPECT_NEAR(place_of(sun, frame)[0], place[0], 1e-3);
    EXPECT_NEAR(place_of(sun, frame)[1], place[1], 1e-3);
    EXPECT_LT(sun.direction[2], 0);
  }
  move_to(sun, {640, 240}, frame);
  EXPECT_NEAR(sun.direction[0], -1, 1e-6);
  EXPECT_NEAR(place_of(sun, frame)[0], 560, 1e-3);
  for (const Extent tiny : {Extent{1, 1}, Extent{1, 4000}}) {
    move_to(sun, {0, 0}, tiny);
    for (const float v : sun.direction) EXPECT_TRUE(std::isfinite(v));
  }
  EXPECT_EQ(scaled({10, 10}, {100, 50}, {200, 200}), (Place{20, 40}));
  EXPECT_EQ(scaled({10, 10}, {}, {200, 200}), (Place{10, 10}));
}

TEST(Lamps, DepthPutsThemOntoTheRayOfTheirPixel) {
  const View view{{320, 256}, 266.3F, 3.5F};
  const Lamp::Vector at = view.place(105, 57, .7F);  // 2.8 m from the camera
  EXPECT_NEAR(at[0], (105 - 160) * 2.8 / 266.3, 1e-5);
  EXPECT_NEAR(at[1], (57 - 128) * 2.8 / 266.3, 1e-5);
  EXPECT_NEAR(at[2], .7, 1e-5);
  EXPECT_NEAR(view.place(105, 57, 900)[2], 3.49, 1e-5) << "not behind the camera";
}

TEST_F(RelightTest, AgreesWithReference) {
  const Beside all[] = {{},
                        {.mask = true},
                        {.light = true, .shares = true},
                        {.slope = true},
                        {true, true, true, true}};
  for (const Extent extent : kOddSizes)
    for (const Beside& beside : all)
      for (const float ambient : {1.F, .3F}) {
        if (extent.pixels() > 20000 && !beside.mask) continue;
        const std::string what = name_of(extent) + (beside.light ? " light" : "") +
                                 (beside.slope ? " slope" : "") + (beside.mask ? " mask" : "");
        const unsigned seed = extent.width;
        const Pixels pixels = layers_over_24_stops(extent, seed),
                     light = layers_over_24_stops(extent, seed + 1),
                     shares = layers_over_24_stops(extent, seed + 3);
        Pixels matte = layers_over_24_stops(extent, seed + 2);
        for (float& m : matte)
          if (std::abs(m) < 1e-30F) m = 0;  // devices may round products with it to 0
        Layers frame = layers(extent, pixels);
        if (beside.light)
          frame[Role::light] = frame[Role::model_light] = shared_plane(extent, light);
        if (beside.shares) frame[indirect_role(0)] = shared_plane(extent, shares);
        if (beside.slope) frame[Role::slope] = shared_plane({1, 1}, {.4F, -.7F, 1, 0});
        if (beside.mask) frame[Role::mask] = shared_plane(extent, matte);
        const RelightParams params{.lamps = lamps_of(extent),
                                   .ambient = ambient,
                                   .strength = .5F,
                                   .surface = RelightParams::Surface::flat};
        Relight relight(device, extent);
        record(relight, frame, params);
        const Pixels got = download(frame[Role::intrinsic]), lit = download(frame[Role::light]);
        const Pixels shared = beside.shares ? download(frame[indirect_role(0)]) : Pixels();
        std::vector<reference::SceneLamp> lamps;
        for (const Lamp& lamp : params.lamps) lamps.push_back(in_scene(lamp, extent, .5));
        ASSERT_TRUE(are_light(got) && are_light(lit)) << what;
        for (uint32_t n = 0; n < extent.pixels(); ++n) {
          const double x = n % extent.width + .5, y = n / extent.width + .5;
          const reference::Surface surface{{(x - extent.width / 2.0) / extent.width,
                                            (y - extent.height / 2.0) / extent.width, 0},
                                           {0, 0, 1}};
          const double share =
              beside.mask ? std::min(reference::finite(double{matte[4 * n]}), 1.0) : 1;
          reference::Rgb added = reference::light_on(surface, lamps);
          for (double& v : added) v *= share;
          reference::LightLayers before;
          if (beside.light) before.light = pixel_of(light, n);
          if (beside.slope) before.slope = {double{.4F}, double{-.7F}};
          const auto expected = reference::relight(pixel_of(pixels, n), before,
                                                   1 - share * (1 - double{ambient}), added);
          const auto near = [&](float value, double truth, const char* name) {
            ASSERT_NEAR(double{value}, truth, 2e-4 * std::abs(truth) + 1e-6)
                << what << " " << name << ", pixel " << n;
          };
          for (size_t c = 0; c < 4; ++c) {
            ASSERT_NO_FATAL_FAILURE(near(got[4 * n + c], expected.intrinsic[c], "intrinsic"));
            ASSERT_NO_FATAL_FAILURE(near(lit[4 * n + c], expected.light[c], "light"));
            if (beside.shares) {
              const double t = reference::finite(double{shares[4 * n + c]});
              ASSERT_NO_FATAL_FAILURE(near(shared[4 * n + c], expected.kept * t, "share"));
            }
          }
        }
      }
}

// R S' C(S') L' is R (S C(S) L + E): the color of a lamp is exact in the composed picture.
TEST_F(RelightTest, LampsKeepTheirColorInLightOfAnotherColor) {
  const Extent extent{8, 8};
  Pixels pixels(extent.pixels() * 4, .5F);
  Layers frame = layers(extent, pixels);
  frame[Role::slope] = shared_plane({1, 1}, {.6F, -1, 1, 0});
  Relight relight(device, extent);
  const Lamp sun{.kind = Lamp::Kind::directional, .color = 0xff0000, .power = 2};
  record(relight, frame, {.lamps = {sun}, .surface = RelightParams::Surface::flat});
  const Pixels intrinsic = download(frame[Role::intrinsic]), light = download(frame[Role::light]);
  const auto shade = [](double s) {  // S C(S)
    const double red = std::exp(.5 * .6 * (std::log(s) + 1));
    return reference::Rgb{s * red, s, s / red};
  };
  const auto before = shade(.5), after = shade(double{intrinsic[3]});
  EXPECT_NEAR(after[0] * light[0], before[0] + 2, 1e-4);
  EXPECT_NEAR(after[1] * light[1], before[1], 1e-5);
  EXPECT_NEAR(after[2] * light[2], before[2], 1e-5);
  EXPECT_EQ(download(frame[Role::model_light]), Pixels(extent.pixels() * 4, 1));
}

TEST_F(RelightTest, WhiteLampsInWhiteLightChangeShadingAlone) {
  const Extent extent{40, 9};
  const Pixels pixels = random_pixels(extent, 4);
  Layers frame = layers(extent, pixels);
  Relight relight(device, extent);
  const RelightParams params{.lamps = {{.kind = Lamp::Kind::directional, .power = 1}},
                             .surface = RelightParams::Surface::flat};
  record(relight, frame, params);
  EXPECT_EQ(frame[Role::light], nullptr);
  const Pixels once = download(frame[Role::intrinsic]);
  for (size_t i = 0; i < once.size(); ++i)
    ASSERT_NEAR(once[i], pixels[i] + (i % 4 == 3 ? 1 : 0), 1e-6);
  // Shared planes stay as they were, and own ones are written in place.
  EXPECT_EQ(download(frame[Role::model]), pixels);
  const Plane* first = frame[Role::intrinsic].get();
  record(relight, frame, params);
  EXPECT_EQ(frame[Role::intrinsic].get(), first);
  const Layers branch = frame;
  record(relight, frame, params);
  EXPECT_NE(frame[Role::intrinsic], branch[Role::intrinsic]);
}

TEST_F(RelightTest, ReliefAgreesWithReferenceAndFollows) {
  for (const Extent extent : kOddSizes) {
    Relief relief(device, extent);
    std::vector<double> cells;
    const std::array<float, 4> gains{1, 1.05F, 1.3F, 40};
    for (const float gain : gains) {
      Pixels pixels = layers_over_24_stops(extent, 5);
      for (float& p : pixels) p *= gain;
      const Plane frame = plane(extent, pixels);
      run([&](gpu::Commands& commands) { relief.record(commands, frame); });
      const auto now =
          reference::log_cells(reference_of(pixels), extent.width, extent.height, relief.factor());
      if (cells.empty()) cells = now;
      for (size_t i = 0; i < cells.size(); ++i) cells[i] = reference::follow_cell(cells[i], now[i]);
      const Extent grid = relief.grid();
      ASSERT_EQ(grid.pixels(), cells.size());
      auto slopes = reference::relief_slopes(cells, grid.width, grid.height, Relief::kMinCells);
      reference::bound_slopes(slopes);
      const Pixels got = download(relief.slopes());
      for (size_t i = 0; i < slopes.size(); ++i)
        for (size_t c = 0; c < 2; ++c)
          ASSERT_NEAR(double{got[4 * i + c]}, slopes[i][c], 2e-4)
              << name_of(extent) << ", gain " << gain << ", cell " << i;
    }
    relief.reset();
    const Plane dark = plane(extent, Pixels(extent.pixels() * 4, 0));
    run([&](gpu::Commands& commands) { relief.record(commands, dark); });
    for (const float slope : download(relief.slopes())) ASSERT_EQ(slope, 0);
  }
}

TEST_F(RelightTest, SlopesTurnTheNormal) {
  for (const Extent extent : {Extent{64, 48}, Extent{700, 300}, Extent{3, 1}}) {
    const Pixels pixels = random_pixels(extent, 8, .2F, 1.F);
    Layers frame = layers(extent, pixels);
    Relight relight(device, extent);
    // Without the extreme ones, which amplify the rounding of slopes.
    const std::vector<Lamp> all = lamps_of(extent);
    const RelightParams params{
        .lamps = {all.begin(), all.begin() + 4}, .ambient = 0, .strength = .5F, .relief = 1.5F};
    record(relight, frame, params);
    const Pixels got = download(frame[Role::intrinsic]);
    const uint32_t factor = (std::max(extent.width, extent.height) - 1) / Relief::kMaxCells + 1;
    const unsigned columns = (extent.width - 1) / factor + 1,
                   rows = (extent.height - 1) / factor + 1;
    auto slopes = reference::relief_slopes(
        reference::log_cells(reference_of(pixels), extent.width, extent.height, factor), columns,
        rows, Relief::kMinCells);
    reference::bound_slopes(slopes);
    std::vector<reference::SceneLamp> lamps;
    for (const Lamp& lamp : params.lamps) lamps.push_back(in_scene(lamp, extent, .5));
    for (uint32_t n = 0; n < extent.pixels(); ++n) {
      const double x = n % extent.width + .5, y = n / extent.width + .5;
      const auto slope =
          reference::slope_at(slopes, columns, rows, x / factor - .5, y / factor - .5);
      const double nx = -1.5 * slope[0], ny = -1.5 * slope[1];
      const double length = std::sqrt(nx * nx + ny * ny + 1);
      const reference::Rgb light = reference::light_on(
          {{(x - extent.width / 2.0) / extent.width, (y - extent.height / 2.0) / extent.width, 0},
           {nx / length, ny / length, 1 / length}},
          lamps);
      const double gray = (light[0] + light[1] + light[2]) / 3;
      ASSERT_NEAR(double{got[4 * n + 3]}, gray, 1e-3 * gray + 1e-4) << name_of(extent) << " " << n;
    }
  }
}

TEST_F(RelightTest, NeutralSettingsRecordNothing) {
  const Extent extent{16, 16};
  Layers frame = layers(extent, random_pixels(extent, 3));
  const Layers before = frame;
  Relight relight(device, extent);
  const std::vector<Lamp> lamps = lamps_of(extent);
  for (const RelightParams& params :
       {RelightParams{}, RelightParams{.lamps = lamps, .strength = 0},
        RelightParams{.lamps = lamps, .strength = kNan}, RelightParams{.lamps = {{.power = 0}}},
        RelightParams{.markers = true}})
    run([&](gpu::Commands& commands) {
      relight.record(commands, frame, params);
      EXPECT_EQ(commands.dispatches(), 0u);
    });
  EXPECT_EQ(frame.planes, before.planes);
}

TEST_F(RelightTest, MarkersAreDrawnWhereLampsAre) {
  const Extent extent{120, 60};
  const Pixels pixels = random_pixels(extent, 4, .2F, .3F);
  Layers frame = layers(extent, pixels);
  Relight relight(device, extent);
  record(relight, frame,
         {.lamps = {{.position = {30.5F, 20.5F, .3F}, .color = 0x00ff00, .power = 0}},
          .markers = true});
  const Pixels got = download(frame[Role::intrinsic]), light = download(frame[Role::light]);
  const auto at = [&](int x, int y) { return static_cast<size_t>(4 * (y * 120 + x)); };
  const size_t middle = at(30, 20), ring = at(32, 20), away = at(35, 20);
  EXPECT_EQ(got[middle], 0);
  EXPECT_EQ(got[middle + 1] * got[middle + 3] * light[middle + 1], 1);
  EXPECT_EQ(got[ring + 1], 0);
  for (size_t c = 0; c < 4; ++c) EXPECT_EQ(got[away + c], pixels[away + c]);
}

}  // namespace inverse::testing
