// SPDX-License-Identifier: LGPL-2.1-or-later
// Shading by the normal alone against brute-force integration. Errors are relative to the largest
// value that D or S has anywhere.
#include "kernels/environment/lit_sphere.hpp"

#include <algorithm>
#include <functional>

#include "common/error.hpp"
#include "light_map.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

using Rgb = std::array<float, 3>;

Environment painted(uint32_t rows, const std::function<Rgb(uint32_t, uint32_t)>& color) {
  std::vector<float> rgb;
  for (uint32_t y = 0; y < rows; ++y)
    for (uint32_t x = 0; x < 2 * rows; ++x)
      for (const float c : color(x, y)) rgb.push_back(c);
  return {{2 * rows, rows}, std::move(rgb)};
}

/// One pixel as bright as the sun.
Environment lamp(uint32_t column, uint32_t row) {
  return painted(128, [&](uint32_t x, uint32_t y) -> Rgb {
    return x == column && y == row ? Rgb{1e5F, 8e4F, 6e4F} : Rgb{};
  });
}

/// A room: bright windows and lamps before dark walls.
Environment room(unsigned seed, uint32_t rows) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0, 1);
  struct Window {
    float x, y, w, h, power;
  };
  std::vector<Window> windows;
  for (int i = 0; i < 6; ++i)
    windows.push_back({2 * value(random), value(random), .05F + .2F * value(random),
                       .05F + .2F * value(random), 20 * value(random)});
  return painted(rows, [&](uint32_t column, uint32_t row) -> Rgb {
    const float x = static_cast<float>(column) / static_cast<float>(rows);
    const float y = static_cast<float>(row) / static_cast<float>(rows);
    Rgb c{.2F + .1F * y, .2F, .3F - .1F * y};
    for (const Window& w : windows)
      if (std::fabs(x - w.x) < w.w && std::fabs(y - w.y) < w.h) c = {w.power, .9F * w.power, .7F};
    return c;
  });
}

class LitSphereTest : public GpuTest {
 protected:
  /// The table for one surface.
  Pixels table(LitSphere& sphere, const Surface& surface, const LitSphere::View& view = {}) {
    run([&](gpu::Commands& commands) { sphere.record(commands, surface, view); });
    return download(sphere.table());
  }
  /// Some normals that are in the middle of the table's pixels, with their pixels.
  struct Probe {
    size_t pixel;
    reference::Vec3 normal;
  };
  static std::vector<Probe> probes(uint32_t side, uint32_t step) {
    std::vector<Probe> result;
    for (uint32_t y = step / 2; y < side; y += step)
      for (uint32_t x = step / 2; x < side; x += step) {
        const double px = 2 * (x + .5) / side - 1, py = 1 - 2 * (y + .5) / side;
        const double r2 = px * px + py * py;
        if (r2 >= 1) continue;
        const double scale = std::sqrt(2 - r2);
        result.push_back({size_t{y} * side + x, {px * scale, py * scale, 1 - r2}});
      }
    return result;
  }
  /// The largest errors of D and S over all probes, relative to the largest value of each.
  std::pair<double, double> errors(const Environment& light, float shininess, float rotation = 0) {
    LitSphere sphere(device);
    sphere.set_light(light);
    const uint32_t side = sphere.table().extent.width;
    const Pixels d = table(sphere, {{1, 1, 1}, 0, shininess}, {1, rotation});
    const float gain = Surface::lobe_gain(shininess);
    const Pixels s = table(sphere, {{0, 0, 0}, 1 / gain, shininess}, {1, rotation});
    const reference::LightMap map = light_map(light);
    double d_error = 0, s_error = 0, d_top = 0, s_top = 0;
    // Probes may miss the peak of a narrow highlight.
    for (size_t i = 0; i < s.size(); ++i)
      if (i % 4 < 3) update_max(s_top, double{s[i]});
    for (const Probe& probe : probes(side, 19)) {
      const auto expected = reference::shade(map, probe.normal, shininess, rotation);
      for (size_t c = 0; c < 3; ++c) {
        update_max(d_error, std::fabs(d[4 * probe.pixel + c] - expected.diffuse[c]));
        update_max(s_error, std::fabs(s[4 * probe.pixel + c] - expected.specular[c]));
        update_max(d_top, expected.diffuse[c]);
        update_max(s_top, expected.specular[c]);
      }
    }
    return {d_error / d_top, s_error / s_top};
  }
};

constexpr std::array<float, 9> kExponents{2, 8, 32, 39, 41, 63, 65, 200, 1024};

}  // namespace

// A turned viewer sees normals turned to the light, and reflections from where they come then.
TEST_F(LitSphereTest, ViewersMayBeTurned) {
  const Environment light = room(4, 64);
  const reference::LightMap map = light_map(light);
  LitSphere sphere(device);
  sphere.set_light(light);
  const uint32_t side = sphere.table().extent.width;
  const float half = std::sqrt(.5F);
  double largest = 0, top = 0;
  for (const std::array<float, 4>& q : {std::array<float, 4>{half, 0, 0, half},
                                        {0, .6F, 0, .8F},
                                        {.5F, -.5F, .1F, .7F},
                                        {2, 0, 0, 0}}) {
    const Pixels got = table(sphere, {{1, 1, 1}, 0, 2}, {1, 0, q});
    const double length = std::sqrt(double{q[0]} * q[0] + double{q[1]} * q[1] +
                                    double{q[2]} * q[2] + double{q[3]} * q[3]);
    const reference::Vec3 axis{q[0] / length, q[1] / length, q[2] / length};
    for (const Probe& probe : probes(side, 19)) {
      // v + 2 w (a × v) + 2 a × (a × v)
      const auto cross = [](const reference::Vec3& a, const reference::Vec3& b) {
        return reference::Vec3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                               a[0] * b[1] - a[1] * b[0]};
      };
      const reference::Vec3 once = cross(axis, probe.normal), twice = cross(axis, once);
      reference::Vec3 normal = probe.normal;
      for (size_t c = 0; c < 3; ++c) normal[c] += 2 * (q[3] / length * once[c] + twice[c]);
      const auto expected = reference::shade(map, normal, 2).diffuse;
      for (size_t c = 0; c < 3; ++c) {
        update_max(largest, std::fabs(got[4 * probe.pixel + c] - expected[c]));
        update_max(top, expected[c]);
      }
    }
  }
  EXPECT_LT(largest / top, .01);
  // About y it is a turn of the light, for highlights as well.
  const float angle = .9F;
  const Surface shiny{{.3F, .3F, .3F}, .5F, 200};
  const Pixels turned =
                   table(sphere, shiny, {1, 0, {0, -std::sin(angle / 2), 0, std::cos(angle / 2)}}),
               rotated = table(sphere, shiny, {1, angle});
  for (size_t i = 0; i < turned.size(); ++i)
    ASSERT_NEAR(turned[i], rotated[i], 1e-4 * (1 + rotated[i]));
}

TEST_F(LitSphereTest, WhiteUnderLightOfOneIsOne) {
  LitSphere sphere(device);
  sphere.set_light(Environment::uniform({1, 1, 1}));
  const Pixels d = table(sphere, {{1, .5F, .25F}, 0, 2});
  for (const Probe& probe : probes(sphere.table().extent.width, 1)) {
    ASSERT_NEAR(d[4 * probe.pixel], 1, 6e-3);
    ASSERT_NEAR(d[4 * probe.pixel + 2], .25, 2e-3);
  }
}

TEST_F(LitSphereTest, MatchesIntegrationInRooms) {
  for (unsigned seed = 0; seed < 2; ++seed)
    for (const float s : kExponents) {
      const auto [d, g] = errors(room(seed, 128), s, seed == 1 ? 1.1F : 0);
      EXPECT_LT(d, .005) << "seed " << seed;
      EXPECT_LT(g, .06) << "seed " << seed << " shininess " << s;
    }
}

TEST_F(LitSphereTest, MatchesIntegrationUnderATinyBrightLamp) {
  for (const auto& [column, row] : {std::pair{128u, 40u}, {70u, 64u}, {190u, 20u}, {250u, 1u}})
    for (const float s : kExponents) {
      const auto [d, g] = errors(lamp(column, row), s);
      EXPECT_LT(d, .005) << column << "," << row;
      EXPECT_LT(g, .1) << column << "," << row << " shininess " << s;
    }
}

TEST_F(LitSphereTest, MatchesIntegrationOfCoarseMaps) {
  for (const uint32_t rows : {5u, 16u, 33u})
    for (const float s : {2.0F, 32.0F}) {
      const auto [d, g] = errors(room(7, rows), s);
      EXPECT_LT(d, .02) << rows;
      EXPECT_LT(g, .05) << rows << " shininess " << s;
    }
}

// Light from behind glances off the rim alone: it rises above its horizon.
TEST_F(LitSphereTest, TheRimUnderLightFromBehindIsSmooth) {
  const Environment light = painted(64, [](uint32_t column, uint32_t) -> Rgb {
    return column < 24 || column >= 104 ? Rgb{1, 1, 1} : Rgb{};
  });
  const reference::LightMap map = light_map(light);
  LitSphere sphere(device);
  sphere.set_light(light);
  const uint32_t side = sphere.table().extent.width;
  for (const float s : {2.0F, 20.0F, 39.0F, 41.0F}) {
    const Pixels got = table(sphere, {{0, 0, 0}, 1 / Surface::lobe_gain(s), s});
    double error = 0, top = 0;
    for (const Probe& probe : probes(side, 5)) {
      if (probe.normal[2] > .5) continue;
      const double expected = reference::shade(map, probe.normal, s).specular[0];
      update_max(error, std::fabs(got[4 * probe.pixel] - expected));
      update_max(top, expected);
    }
    EXPECT_LT(error, .12 * top) << "shininess " << s;
  }
}

TEST_F(LitSphereTest, ChangesWithWhatItShowsAndNotElse) {
  LitSphere sphere(device);
  sphere.set_light(room(1, 32));
  const Surface red{{.5F, .1F, .1F}, .2F, 50};
  const Pixels first = table(sphere, red);
  EXPECT_EQ(sphere.version(), 1u);
  const Pixels again = table(sphere, red);
  EXPECT_EQ(sphere.version(), 1u);
  EXPECT_EQ(first, again);
  const Pixels twice = table(sphere, red, {2, 0});
  EXPECT_EQ(sphere.version(), 2u);
  for (size_t i = 0; i < first.size(); ++i) {
    const float factor = i % 4 < 3 ? 2 : 1;
    ASSERT_NEAR(twice[i], factor * first[i], 1e-4 * twice[i]);
  }
  sphere.set_light(room(2, 32));
  EXPECT_NE(table(sphere, red), first);
  EXPECT_EQ(sphere.version(), 3u);
}

TEST_F(LitSphereTest, NothingIsInfiniteOrNegative) {
  LitSphere sphere(device, 16);
  expect_error(ErrorKind::internal, "a lit sphere without light", [&] { table(sphere, {}); });
  for (const Environment& light :
       {lamp(0, 0), Environment::uniform({0, 0, 0}), Environment::uniform({1e9F, 1e9F, 1e9F})}) {
    sphere.set_light(light);
    for (const float value : {kNan, kInf, -kInf, -1.0F, 0.0F, 1e30F})
      for (const float shininess : {kNan, kInf, -3.0F, 0.0F, 2.0F, 64.0F, 1024.0F, 1e9F})
        ASSERT_TRUE(
            are_light(table(sphere, {{value, .5F, value}, value, shininess}, {value, value})))
            << value << " " << shininess;
  }
}

}  // namespace inverse::testing
