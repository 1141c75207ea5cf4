// SPDX-License-Identifier: LGPL-2.1-or-later
// Light from what it does to an object: against light that is known, and where little is seen of
// it.
#include "kernels/environment/environment_fit.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/error.hpp"
#include "kernels/environment/normal_map.hpp"
#include "light_map.hpp"
#include "normal_map_file.hpp"
#include "tests/expect_error.hpp"

namespace inverse::testing {
namespace {

using Point = EnvironmentFit::Point;
using reference::Vec3;

constexpr double kPi = 3.14159265358979323846;
constexpr std::array<float, 3> kAlbedo{.6F, .3F, .15F};
constexpr float kAlpha = .4F;

/// A reddish window up at the left, a bluish one at the right, a gray rest.
Environment windows() {
  constexpr Extent kExtent{64, 32};
  std::vector<float> rgb;
  for (uint32_t row = 0; row < kExtent.height; ++row)
    for (uint32_t column = 0; column < kExtent.width; ++column) {
      const bool left = row >= 6 && row < 12 && column >= 18 && column < 26;
      const bool right = row >= 12 && row < 18 && column >= 40 && column < 44;
      const std::array color = left    ? std::array{9.F, 7.F, 5.F}
                               : right ? std::array{5.F, 6.F, 8.F}
                                       : std::array{.4F, .4F, .4F};
      rgb.insert(rgb.end(), color.begin(), color.end());
    }
  return {kExtent, std::move(rgb)};
}

Normal sphere(double x, double y) {
  const double z2 = 1 - x * x - y * y;
  if (!(z2 > 0)) return {};
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(std::sqrt(z2))};
}

/// What an object with these normals, at places −1…1 of the picture, shows under a light.
template <typename Shape>
std::vector<Point> seen(const Environment& light, Shape shape,
                        std::array<float, 3> albedo = kAlbedo, float alpha = kAlpha,
                        int side = 48) {
  const reference::LightMap map = light_map(light);
  std::vector<Point> points;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      const Normal n = shape(2 * (column + .5) / side - 1, 1 - 2 * (row + .5) / side);
      if (!(n[2] > 0)) continue;
      const Vec3 normal{n[0], n[1], n[2]};
      const Vec3 d = reference::shade(map, normal, 1, 0, 1).diffuse;
      Point point{n};
      for (size_t c = 0; c < 3; ++c) point.diffuse[c] = static_cast<float>(albedo[c] * d[c]);
      const double azimuth = std::atan2(2. * n[2] * n[0], 2. * n[2] * n[2] - 1);
      const double polar = std::acos(std::clamp(2. * n[2] * n[1], -1., 1.));
      const int at_column = std::clamp(static_cast<int>((azimuth / (2 * kPi) + .5) * 2 * map.rows),
                                       0, 2 * map.rows - 1);
      const int at_row = std::clamp(static_cast<int>(polar / kPi * map.rows), 0, map.rows - 1);
      const Vec3& e = map.at(at_column, at_row);
      point.mirror = static_cast<float>(alpha * (e[0] + e[1] + e[2]) / 3 / kPi);
      points.push_back(point);
    }
  return points;
}

/// Root mean square error of D over its mean, for normals that face the camera or do not.
double error_of(const Environment& truth, const Environment& light, bool facing) {
  const reference::LightMap a = light_map(truth), b = light_map(light);
  double squares = 0, mean = 0;
  int count = 0;
  for (int i = 0; i < 100; ++i) {
    const double z = 1 - 2 * (i + .5) / 100, r = std::sqrt(1 - z * z);
    const Vec3 n{r * std::cos(2.399963 * i), r * std::sin(2.399963 * i), z};
    const Vec3 want = reference::shade(a, n, 1, 0, 1).diffuse;
    const Vec3 got = reference::shade(b, n, 1, 0, 1).diffuse;
    for (size_t c = 0; c < 3; ++c) {
      mean += want[c] / 300;
      if ((z > 0) != facing) continue;
      squares += (want[c] - got[c]) * (want[c] - got[c]);
      ++count;
    }
  }
  return std::sqrt(squares / count) / mean;
}

void expect_light(const std::optional<Environment>& light, float largest) {
  ASSERT_TRUE(light.has_value());
  for (const float v : light->rgb()) {
    ASSERT_GE(v, 0);
    ASSERT_LE(v, largest);
  }
}

std::optional<Environment> fitted(const std::vector<Point>& points,
                                  std::array<float, 3> albedo = kAlbedo, float alpha = kAlpha,
                                  float noise = EnvironmentFit::Params{}.noise) {
  EnvironmentFit fit;
  EnvironmentFit::Params params;
  params.noise = noise;
  fit.add(points, params);
  return fit.light(albedo, alpha, params);
}

double correlation(const Environment& truth, const Environment& light) {
  double ab = 0, aa = 0, bb = 0, a_sum = 0, b_sum = 0, all = 0;
  const auto gray = [](const Environment& e, size_t i) {
    return static_cast<double>(e.rgb()[3 * i] + e.rgb()[3 * i + 1] + e.rgb()[3 * i + 2]) / 3;
  };
  for (size_t i = 0; i < truth.extent().pixels(); ++i) {
    const double area = truth.solid_angle(static_cast<uint32_t>(i / truth.extent().width));
    const double a = gray(truth, i), b = gray(light, i);
    a_sum += area * a, b_sum += area * b, all += area;
    ab += area * a * b, aa += area * a * a, bb += area * b * b;
  }
  return (ab - a_sum * b_sum / all) /
         std::sqrt((aa - a_sum * a_sum / all) * (bb - b_sum * b_sum / all));
}

}  // namespace

TEST(EnvironmentFit, WhiteLightHasRadianceOne) {
  const auto light = fitted(seen(Environment::uniform({1, 1, 1}), sphere));
  expect_light(light, 1.2F);
  for (const float v : light->rgb()) EXPECT_NEAR(v, 1, .1);
}

TEST(EnvironmentFit, FindsTheLightOfASphere) {
  const Environment truth = windows();
  const auto points = seen(truth, sphere);
  const auto light = fitted(points, kAlbedo, kAlpha, .05F);  // these layers are right
  expect_light(light, 20);
  EXPECT_LT(error_of(truth, *light, true), .06);
  const auto doubted = fitted(points);
  EXPECT_LT(error_of(truth, *doubted, true), .15);
  EXPECT_LT(error_of(truth, *doubted, false), .2) << "behind the object, by its mirror image";
  EXPECT_GT(correlation(truth, *light), .9);
}

TEST(EnvironmentFit, WithoutAMirrorImageLowFrequenciesStay) {
  const Environment truth = windows();
  auto points = seen(truth, sphere, kAlbedo, 0);
  const auto light = fitted(points, kAlbedo, 0);
  expect_light(light, 20);
  EXPECT_LT(error_of(truth, *light, true), .12);
  // What is behind is a guess, and must stay one of the size of what is seen.
  EXPECT_LT(error_of(truth, *light, false), .8);
}

TEST(EnvironmentFit, ABlackObjectShowsLightByItsGloss) {
  const Environment truth = windows();
  const auto light = fitted(seen(truth, sphere, {0, 0, 0}), {0, 0, 0});
  expect_light(light, 20);
  EXPECT_GT(correlation(truth, *light), .9);
  EXPECT_FALSE(fitted(seen(truth, sphere, {0, 0, 0}, 0), {0, 0, 0}, 0)) << "black and dull";
}

TEST(EnvironmentFit, AChannelWithoutAlbedoHasTheLightOfTheOthers) {
  const Environment truth = windows();
  const std::array<float, 3> albedo{.7F, .5F, 0};
  auto points = seen(truth, sphere, albedo);
  for (Point& p : points) p.diffuse[2] = .003F;  // what a camera's noise leaves there
  const auto light = fitted(points, albedo);
  expect_light(light, 20);
  EXPECT_LT(error_of(truth, *light, true), .25);
}

TEST(EnvironmentFit, FlatRoundAndTinyObjectsGiveSoundLight) {
  const Environment truth = windows();
  const auto flat = [](double x, double y) {
    return std::fabs(x) < .8 && std::fabs(y) < .8 ? Normal{.28F, .1F, .9548F} : Normal{};
  };
  const auto cylinder = [](double x, double y) {
    return std::fabs(y) < .9 ? sphere(x, 0) : Normal{};
  };
  const auto tiny = [](double x, double y) { return sphere(8 * x, 8 * y); };
  const auto front = [&](auto shape) {
    const auto light = fitted(seen(truth, shape));
    expect_light(light, 60);
    // The mean of D where it is seen best.
    const Normal n = shape(.0, .0);
    const Vec3 normal{n[0], n[1], n[2]};
    const Vec3 want = reference::shade(light_map(truth), normal, 1, 0, 1).diffuse;
    const Vec3 got = reference::shade(light_map(*light), normal, 1, 0, 1).diffuse;
    return std::fabs(got[1] / want[1] - 1);
  };
  EXPECT_LT(front(flat), .15);
  EXPECT_LT(front(cylinder), .15);
  EXPECT_LT(front(tiny), .25);
}

TEST(EnvironmentFit, ClippedPointsAreIgnored) {
  const Environment truth = windows();
  auto points = seen(truth, sphere);
  for (Point& p : points)
    if (p.normal[0] < -.3F && p.normal[1] > .2F) {
      p.clipped = true;
      p.diffuse = {1, 1, 1};
    }
  const auto light = fitted(points);
  expect_light(light, 30);
  EXPECT_LT(error_of(truth, *light, true), .15);
}

TEST(EnvironmentFit, BadPointsAreIgnored) {
  const Environment truth = windows();
  auto points = seen(truth, sphere);
  const auto clean = fitted(points);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 50; ++i) {
    points.push_back({{nan, 0, 1}, {1, 1, 1}, false, 1});
    points.push_back({{0, 0, 1}, {1, nan, 1}, false, 1});
    points.push_back({{0, 0, 1}, {1, 1, 1}, false, std::numeric_limits<float>::infinity()});
    points.push_back({{1, 0, 0}, {5, 5, 5}, false, 9});
  }
  EXPECT_EQ(fitted(points)->rgb(), clean->rgb());
  EXPECT_FALSE(fitted({}));
  EXPECT_FALSE(fitted(std::vector<Point>(EnvironmentFit::kMinPoints - 1, {{0, 0, 1}, {1, 1, 1}})));
}

TEST(EnvironmentFit, ViewsAreAveraged) {
  const Environment truth = windows();
  const auto points = seen(truth, sphere);
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0, .25F);
  EnvironmentFit one, many;
  for (int view = 0; view < 40; ++view) {
    auto noisy = points;
    const float tilt = noise(random), side = noise(random);
    for (Point& p : noisy)
      for (float& v : p.diffuse) v *= std::max(0.F, 1 + tilt * p.normal[1] + side * p.normal[0]);
    if (!view) one.add(noisy, {});
    many.add(noisy, {});
  }
  EXPECT_EQ(many.count(), 40u);
  EXPECT_LT(error_of(truth, *many.light(kAlbedo, kAlpha, {}), true),
            .7 * error_of(truth, *one.light(kAlbedo, kAlpha, {}), true));
  many.reset();
  EXPECT_FALSE(many.light(kAlbedo, kAlpha, {}));
}

namespace {

/// The mean angle, in degrees, between inflated normals and those of a body.
template <typename Shape>
double angle(Shape shape, uint32_t side, const GridWindow& window) {
  std::vector<uint8_t> mask;
  std::vector<Normal> truth;
  for (uint32_t row = 0; row < side; ++row)
    for (uint32_t column = 0; column < side; ++column) {
      truth.push_back(shape(2 * (column + .5) / side - 1, 1 - 2 * (row + .5) / side));
      mask.push_back(truth.back()[2] > 0);
    }
  const auto normals = inflated_normals(mask, side, window);
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < mask.size(); ++i) {
    const Normal &a = truth[i], &b = normals[i];
    if (!mask[i]) {
      EXPECT_EQ(b, Normal{});
      continue;
    }
    const uint32_t x = i % side, y = static_cast<uint32_t>(i) / side;
    if (x < window.left || x >= window.right || y < window.top || y >= window.bottom) continue;
    EXPECT_NEAR(b[0] * b[0] + b[1] * b[1] + b[2] * b[2], 1, 1e-4);
    sum += std::acos(std::clamp(double{a[0] * b[0] + a[1] * b[1] + a[2] * b[2]}, -1., 1.));
    ++count;
  }
  return sum / count * 180 / kPi;
}

}  // namespace

TEST(InflatedNormals, AreThoseOfASphere) {
  const auto ball = [](double x, double y) { return sphere(x / .66, y / .66); };
  EXPECT_LT(angle(ball, 128, {0, 0, 128, 128}), 2);
  const auto off = [](double x, double y) { return sphere((x - .3) / .5, (y + .2) / .5); };
  EXPECT_LT(angle(off, 100, {0, 0, 100, 100}), 3) << "also where the side is no power of two";
}

TEST(InflatedNormals, GoOnWhereTheFrameEnds) {
  const auto ball = [](double x, double y) { return sphere(x / .8, y / .8); };
  // Half of the ball is outside of the frame: a symmetric half, as the mirrored one continues it.
  EXPECT_LT(angle(ball, 128, {64, 0, 128, 128}), 3);
}

TEST(InflatedNormals, DegenerateMasksHaveNormals) {
  const GridWindow all{0, 0, 32, 32};
  EXPECT_EQ(inflated_normals({}, 32, all), std::vector<Normal>(32 * 32));
  for (const bool full : {false, true}) {
    std::vector<uint8_t> mask(32 * 32, full);
    mask[5 * 32 + 7] = 1;
    const auto normals = inflated_normals(mask, 32, all);
    EXPECT_NEAR(normals[5 * 32 + 7][2], 1, 1e-2) << "a point, or no outline at all, faces us";
  }
  for (const Normal& n : inflated_normals(std::vector<uint8_t>(32 * 32, 1), 32, {9, 9, 9, 9}))
    EXPECT_EQ(n, Normal{}) << "nothing of it is in the frame";
}

namespace {

class NormalMapFile : public ::testing::Test {
 protected:
  /// A map without a warning.
  NormalMap load() const {
    std::string warning;
    NormalMap map = NormalMap::load(file.path(), warning);
    EXPECT_EQ(warning, "");
    return map;
  }
  void expect_refused(const std::string& text) const {
    expect_error(ErrorKind::file, text, [&] { load(); });
  }
  NormalMapPath file;
};

}  // namespace

TEST_F(NormalMapFile, IsReadAndScaled) {
  // Left facing us, right to the right by 60 degrees, below none and facing away.
  const std::vector<uint8_t> codes{128, 128, 255, 238, 128, 191, 0, 0, 0, 128, 128, 0};
  for (const uint32_t bits : {8U, 16U}) {
    std::vector<uint8_t> samples;
    for (const uint8_t code : codes) samples.insert(samples.end(), bits / 8, code);
    file.write(png(2, 2, 3, bits, samples));
    const NormalMap map = load();
    EXPECT_NEAR(map.at(0, 0)[2], 1, .01);
    EXPECT_NEAR(map.at(1, 0)[0], .866, .01);
    EXPECT_NEAR(map.at(1, 0)[2], .5, .01);
    EXPECT_NEAR(map.at(.5F, 0)[0], .5, .02) << "between the two";
    EXPECT_EQ(map.at(0, 1)[2], 0);
    EXPECT_EQ(map.at(1, 1)[2], 0);
  }
  file.write(png(2, 1, 4, 8, {128, 128, 255, 20, 128, 128, 255, 255}));
  EXPECT_EQ(load().at(0, 0)[2], 0) << "transparent";
}

TEST_F(NormalMapFile, APhotographGetsAWarning) {
  std::mt19937 random(1);
  std::vector<uint8_t> samples(size_t{64} * 64 * 3);
  for (uint8_t& s : samples) s = static_cast<uint8_t>(random());
  file.write(png(64, 64, 3, 8, samples));
  std::string warning;
  NormalMap::load(file.path(), warning);
  EXPECT_NE(warning.find(file.path() + ": of what it has for normals, 3"), std::string::npos)
      << warning;
}

TEST_F(NormalMapFile, InvalidFilesAreRefusedByName) {
  expect_refused("No such file");
  file.write({'n', 'o'});
  expect_refused("no PNG");
  file.write(png(8, 8, 1, 8, std::vector<uint8_t>(64, 3)));
  expect_refused("gray");
  auto cut = png(64, 64, 3, 8, std::vector<uint8_t>(64 * 64 * 3, 200));
  cut.resize(cut.size() / 2);
  file.write(cut);
  expect_refused("no PNG");
  file.write(png(90000, 90000, 3, 8, {1, 2, 3}));
  expect_refused("no PNG (too large)");
  file.write(png(8000, 8000, 3, 8, {1, 2, 3}));
  expect_refused("ends too early for 8000x8000");
}

}  // namespace inverse::testing
