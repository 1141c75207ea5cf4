// SPDX-License-Identifier: LGPL-2.1-or-later
// Environment maps: what they are, and their files.
#include "kernels/environment/environment.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "common/error.hpp"
#include "kernels/environment/prefiltered_light.hpp"
#include "tests/expect_error.hpp"
#include "tests/replaced_file.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

class EnvironmentTest : public ::testing::Test {
 protected:
  const std::string& folder() const { return folder_.path(); }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string written(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }
  static std::string load_error(const std::string& path) {
    return error_of([&] { Environment::load(path); }, ErrorKind::file);
  }

 private:
  TemporaryFolder folder_;
};

std::vector<float> random_radiance(Extent extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> exponent(-6, 14);
  std::vector<float> rgb(3 * extent.pixels());
  for (float& value : rgb) value = std::exp2(exponent(random));
  return rgb;
}

std::string contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void expect_near(const Environment& a, const Environment& b) {
  ASSERT_EQ(a.extent(), b.extent());
  for (size_t i = 0; i < a.rgb().size(); i += 3) {
    const float top = std::max({a.rgb()[i], a.rgb()[i + 1], a.rgb()[i + 2]});
    for (size_t c = 0; c < 3; ++c)  // eight bits share an exponent
      ASSERT_NEAR(a.rgb()[i + c], b.rgb()[i + c], top / 127) << i;
  }
}

}  // namespace

TEST_F(EnvironmentTest, AnEarlierFileIsReplacedAndALinkIsFollowed) {
  namespace fs = std::filesystem;
  const std::string file = written("light.hdr", "of before"), link = path("link.hdr");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(file, link);
  Environment::uniform({1, 2, 3}).save(link);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_NEAR(Environment::load(file).rgb()[1], 2, .02);
  Environment::uniform({1, 1, 1}).save("/dev/null");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder()), {}), 2) << "no draft stays";
}

TEST_F(EnvironmentTest, DirectionsAreThoseOfTheCamera) {
  const Environment map = Environment::uniform({1, 1, 1});
  const double w = map.extent().width, h = map.extent().height;
  const auto expect = [&](double column, double row, double x, double y, double z) {
    const auto d = map.direction(column, row);
    EXPECT_NEAR(d[0], x, 1e-12);
    EXPECT_NEAR(d[1], y, 1e-12);
    EXPECT_NEAR(d[2], z, 1e-12);
  };
  expect(w / 2, h / 2, 0, 0, 1);
  expect(.75 * w, h / 2, 1, 0, 0);
  expect(0, h / 2, 0, 0, -1);
  expect(w / 2, 0, 0, 1, 0);
  double sphere = 0;
  for (uint32_t row = 0; row < map.extent().height; ++row) sphere += w * map.solid_angle(row);
  EXPECT_NEAR(sphere, 4 * M_PI, 1e-12);
}

TEST_F(EnvironmentTest, ComesBackFromAFile) {
  for (const uint32_t rows : {2u, 3u, 16u, 64u}) {  // from 8 columns on, files have runs
    const Environment map({2 * rows, rows}, random_radiance({2 * rows, rows}, rows));
    map.save(path("map.hdr"));
    expect_near(Environment::load(path("map.hdr")), map);
  }
  const Environment dark = Environment::uniform({0, 0, 0});
  dark.save(path("dark.hdr"));
  EXPECT_EQ(Environment::load(path("dark.hdr")), dark);
}

TEST_F(EnvironmentTest, APanoramaIsWhatTheObjectSees) {
  // Four by two, without runs: red at its left, which is at the right of who looks back at it.
  std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
  for (int row = 0; row < 2; ++row)
    bytes += std::string("\x80\x00\x00\x81", 4) + std::string(12, '\0');
  const Environment map = Environment::load(written("red.hdr", bytes));
  EXPECT_FLOAT_EQ(map.rgb()[3 * 3], 1);
  EXPECT_FLOAT_EQ(map.rgb()[0], 0);
  EXPECT_GT(map.direction(3.5 - .01, 1)[0], 0) << "x right";
}

TEST_F(EnvironmentTest, TheExposureOfAFileIsDividedOut) {
  const auto file = [&](const std::string& header) {
    std::string bytes = "#?RADIANCE\n" + header + "FORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
    for (int i = 0; i < 8; ++i) bytes += "\x80\x80\x80\x81";
    return written("exposed.hdr", bytes);
  };
  const auto rgb = Environment::load(file("EXPOSURE= 4\nCOLORCORR= 1 2 .5\nEXPOSURE=0.5\n")).rgb();
  for (const auto& [channel, value] : {std::pair{0u, .5}, {1u, .25}, {2u, 1.}})
    EXPECT_FLOAT_EQ(rgb[channel], value);
  for (const char* none : {"0", "-1", "nan", "inf", "1e-40"})
    expect_contains(load_error(file(std::string("EXPOSURE=") + none + "\n")), "exposure");
  EXPECT_FLOAT_EQ(Environment::load(file("EXPOSURE=of no number\n")).rgb()[0], 1);
}

TEST_F(EnvironmentTest, InvalidFilesAreErrorsWithTheirCause) {
  expect_contains(load_error("/nowhere/map.hdr"), "/nowhere/map.hdr");
  expect_contains(load_error("file:///nowhere/map.hdr"), "a path is needed, not a URI");
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  expect_contains(load_error(written("size.hdr", head + "-Y -5 +X 10\n")), "a size below 0");
  // With all its pixels, but also much that is none.
  std::string pixels = head + "-Y 2 +X 4\n";
  for (int i = 0; i < 8; ++i) pixels += "\x80\x80\x80\x81";
  const std::string sparse = written("sparse.hdr", pixels);
  std::filesystem::resize_file(sparse, uint64_t{900} << 20);
  expect_contains(load_error(sparse), "larger than a map of 4x2 pixels can be");
  expect_contains(load_error(written("up.hdr", head + "+Y 5 +X 10\n")), "rows from the top");
  expect_contains(load_error(path(".")), "is no file");
  expect_contains(load_error(written("empty.hdr", "")), "ends too early");
  expect_contains(load_error(written("text.hdr", std::string(300, 'x'))), "no Radiance picture");
  Environment({32, 16}, random_radiance({32, 16}, 1)).save(path("whole.hdr"));
  const std::string whole = contents(path("whole.hdr"));
  for (size_t length = 1; length < whole.size(); length += 37) {
    const std::string text = load_error(written("part.hdr", whole.substr(0, length)));
    // A width that is cut short is another width.
    EXPECT_TRUE(text.find("ends too early") != std::string::npos ||
                text.find("twice as wide as high") != std::string::npos)
        << length << ": " << text;
  }
  expect_contains(load_error(written("part.hdr", whole.substr(0, whole.size() - 1))), "too early");
  const std::string flat =
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n" + std::string(32, '\x80');
  EXPECT_EQ(load_error(written("flat.hdr", flat)), "");
  for (size_t less = 1; less < 4; ++less)
    expect_contains(load_error(written("flat.hdr", flat.substr(0, flat.size() - less))),
                    "too early");
  // Any byte may be wrong: an error or a map, nothing else.
  std::mt19937 random(3);
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    load_error(written("noise.hdr", bytes));
  }
  std::string square = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + std::string(16, '\1');
  expect_contains(load_error(written("square.hdr", square)), "is 2x2");
  const std::string huge = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 2000000\n";
  expect_contains(load_error(written("huge.hdr", huge + std::string(64, '\1'))),
                  "is 2000000x1000000");
  const Environment map = Environment::uniform({1, 1, 1});
  expect_error(ErrorKind::output, "cannot be written: there is no folder /nowhere",
               [&] { map.save("/nowhere/map.hdr"); });
}

// Whatever is put under its name meanwhile.
TEST_F(EnvironmentTest, AFileIsReadFromOneOpening) {
  const auto bytes = [&](uint32_t rows, float value) {
    Environment({2 * rows, rows}, std::vector<float>(size_t{6} * rows * rows, value))
        .save(path("one.hdr"));
    return contents(path("one.hdr"));
  };
  const ReplacedFile file("map.hdr", {bytes(64, 1), bytes(4, 2), bytes(4, 4), bytes(4, 8)});
  if (!file.works()) GTEST_SKIP() << "no leases on this file system";
  const Environment map = Environment::load(file.path());
  EXPECT_EQ(file.openings(), 1);
  EXPECT_EQ(map.extent(), (Extent{128, 64}));
  for (const float value : map.rgb()) ASSERT_EQ(value, 1);
}

// In a folder that others may write to, a link may lie where the draft will be.
TEST_F(EnvironmentTest, ADraftDoesNotFollowALink) {
  const std::string victim = written("victim", "somebody's"), map = path("map.hdr");
  for (int i = 0; i < 1000; ++i)
    std::filesystem::create_symlink(
        victim, map + "." + std::to_string(getpid()) + "-" + std::to_string(i) + ".new");
  expect_error(ErrorKind::output, "is in the way: remove it", [&] {
    Environment::uniform({1, 1, 1}).save(map);
  });
  EXPECT_EQ(contents(victim), "somebody's");
  EXPECT_FALSE(std::filesystem::exists(map));
}

TEST_F(EnvironmentTest, InvalidRadianceBecomesTheNearestValidValue) {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  std::vector<float> rgb(3 * 16 * 8, 1.F);
  rgb[5] = 70000;
  rgb[6] = kInf;
  rgb[7] = -kInf;
  rgb[8] = std::numeric_limits<float>::quiet_NaN();
  rgb[9] = -1;
  size_t changed = 0;
  const Environment map = Environment::bounded({16, 8}, rgb, changed, "a map");
  EXPECT_EQ(changed, 4u);
  EXPECT_EQ(map.rgb()[6], 70000) << "a sun that a half float could not hold, and no brighter one";
  for (const size_t i : {7u, 8u, 9u}) EXPECT_EQ(map.rgb()[i], 0);
  for (const auto& [bad, expected] : {std::pair{kInf, 65504.F}, {1e12F, 1e9F}}) {
    std::fill(rgb.begin(), rgb.end(), bad);
    const Environment all = Environment::bounded({16, 8}, rgb, changed, "a map");
    EXPECT_EQ(all.rgb()[0], expected) << "the brightest does not become dark";
  }
}

TEST_F(EnvironmentTest, InvalidRadianceIsRefused) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), -1e-3F,
                          std::numeric_limits<float>::infinity(), 2e9F}) {
    std::vector<float> rgb(3 * 8, 1.0F);
    rgb[3 * 6 + 1] = bad;
    expect_error(ErrorKind::file, "column 2 of row 1", [&] { Environment({4, 2}, rgb); });
  }
  expect_error(ErrorKind::file, "has 5 values", [] { Environment({4, 2}, std::vector<float>(5)); });
  expect_error(ErrorKind::file, "is 0x0", [] { Environment({0, 0}, {}); });
  expect_error(ErrorKind::file, "is 2x1", [] { Environment({2, 1}, std::vector<float>(6)); });
}

TEST_F(EnvironmentTest, TheStudioIsNeutralAndLightsFromUpLeft) {
  const Environment studio = Environment::studio();
  std::array<double, 3> moment{};
  double irradiance = 0;  // mean over all normals of D = mean radiance
  for (uint32_t y = 0; y < studio.extent().height; ++y)
    for (uint32_t x = 0; x < studio.extent().width; ++x) {
      const float* c = &studio.rgb()[3 * (size_t{y} * studio.extent().width + x)];
      ASSERT_EQ(c[0], c[1]);
      ASSERT_EQ(c[0], c[2]);
      ASSERT_GT(c[0], 0);
      const auto w = studio.direction(x + .5, y + .5);
      for (size_t i = 0; i < 3; ++i) moment[i] += studio.solid_angle(y) * c[0] * w[i];
      irradiance += studio.solid_angle(y) * c[0] / (4 * M_PI);
    }
  EXPECT_LT(moment[0], 0);
  EXPECT_GT(moment[1], 0);
  EXPECT_GT(moment[2], 0);
  EXPECT_NEAR(irradiance, .5, .02);
}

TEST(PrefilteredLightTest, LightIsNeitherLostNorMade) {
  // One bright pixel anywhere counts the same on all levels, as does light from everywhere.
  for (const auto& [column, row] : {std::pair{0u, 3u}, {100u, 63u}, {101u, 40u}, {30u, 110u}}) {
    std::vector<float> rgb(size_t{3} * 256 * 128, 0.0F);
    rgb[3 * (row * 256 + column)] = 1000;
    const Environment map({256, 128}, rgb);
    const PrefilteredLight light(map);
    const double flux = 1000 * map.solid_angle(row);
    double cells = 0;
    for (size_t i = 0; i < light.cells.size(); i += 2) cells += light.cells[i][0];
    EXPECT_NEAR(cells, flux, 1e-4 * flux);
    size_t texel = 0;
    for (uint32_t level = 0; level < light.levels; ++level) {
      const uint32_t rows = light.rows >> level;
      const Environment size({2 * rows, rows}, std::vector<float>(size_t{6} * rows * rows));
      double sum = 0;
      for (uint32_t y = 0; y < rows; ++y)
        for (uint32_t x = 0; x < 2 * rows; ++x)
          sum += size.solid_angle(y) * light.texels[texel++][0];
      EXPECT_NEAR(sum, flux, (level < 3 ? .06 : .3) * flux)
          << "level " << level << " of row " << row;
    }
    EXPECT_EQ(texel, light.texels.size());
  }
  const PrefilteredLight flat(Environment::uniform({1, 2, 3}));
  for (const auto& texel : flat.texels) {
    ASSERT_NEAR(texel[0], 1, 1e-5);
    ASSERT_NEAR(texel[2], 3, 1e-5);
  }
}

}  // namespace inverse::testing
