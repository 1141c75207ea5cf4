// SPDX-License-Identifier: LGPL-2.1-or-later
// Geometry of a still scene: depth and normals of files, and light on them.
#include "kernels/edit/relight/surface_file.hpp"

#include <cmath>

#include "kernels/edit/relight/relight.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/environment/normal_map_file.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/edit/relight.hpp"

namespace inverse::testing {
namespace {

constexpr float kFocal = 80;
constexpr Extent kFrame{96, 64};
using Vector = std::array<double, 3>;

/// Depth codes, 1000 a meter, of a plane n·P = d in camera axes (x right, y down, z forward).
std::vector<float> plane_codes(const Vector& n, double d, Extent extent, double focal) {
  std::vector<float> codes;
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x) {
      const double across = (x + .5 - extent.width / 2.0) / focal;
      const double down = (y + .5 - extent.height / 2.0) / focal;
      codes.push_back(static_cast<float>(1000 * d / (n[0] * across + n[1] * down + n[2])));
    }
  return codes;
}

std::vector<uint8_t> codes_of_16_bits(const std::vector<float>& depth) {
  std::vector<uint8_t> bytes;
  for (const float code : depth) {
    const auto word = static_cast<uint16_t>(code);
    bytes.push_back(static_cast<uint8_t>(word >> 8));
    bytes.push_back(static_cast<uint8_t>(word & 255));
  }
  return bytes;
}

}  // namespace

TEST(DepthMap, NormalsOfPlanesAreExact) {
  for (const Vector& n : {Vector{0, 0, 1}, {.3, -.4, .8}, {-.6, .2, .7}}) {
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const DepthMap map(kFrame, plane_codes(n, 2.5, kFrame, kFocal));
    const auto surface = map.surface(kFrame, kFocal, 1000);
    for (const SurfacePixel& pixel : surface) {
      // To the viewer: against the camera's z.
      ASSERT_NEAR(pixel[0], -n[0] / length, 2e-4);
      ASSERT_NEAR(pixel[1], -n[1] / length, 2e-4);
      ASSERT_NEAR(pixel[2], n[2] / length, 2e-4);
    }
    // A frame of another size: the same plane, with that frame's focal length.
    const Extent large{150, 100};
    const float focal = kFocal * 150 / 96;
    const auto scaled =
        DepthMap(kFrame, plane_codes(n, 2.5, kFrame, kFocal)).surface(large, focal, 1000);
    ASSERT_EQ(scaled.size(), large.pixels());
    for (const SurfacePixel& pixel : scaled) ASSERT_NEAR(pixel[2], n[2] / length, 2e-3);
  }
}

TEST(DepthMap, EdgesAreNotSlopes) {
  std::vector<float> codes;
  for (uint32_t n = 0; n < kFrame.pixels(); ++n) codes.push_back(n % 96 < 40 ? 1000.F : 3000.F);
  const DepthMap map(kFrame, codes);
  for (const Extent frame : {kFrame, Extent{201, 77}})
    for (const SurfacePixel& pixel : map.surface(frame, kFocal, 1000)) {
      ASSERT_NEAR(pixel[2], 1, 1e-5);
      ASSERT_TRUE(std::abs(pixel[3] - 1) < 1e-5F || std::abs(pixel[3] - 3) < 1e-5F) << pixel[3];
    }
  EXPECT_EQ(map.median(), 3000);
}

TEST(DepthMap, HolesAreFilledFromAround) {
  std::vector<float> codes(kFrame.pixels(), 2000);
  for (uint32_t n = 0; n < codes.size(); ++n)
    if (n % 96 > 20 && n % 96 < 60) codes[n] = 0;
  for (const SurfacePixel& pixel : DepthMap(kFrame, codes).surface(kFrame, kFocal, 1000)) {
    ASSERT_NEAR(pixel[3], 2, 1e-5);
    ASSERT_NEAR(pixel[2], 1, 1e-5);
  }
  for (const Extent tiny : {Extent{1, 1}, Extent{1, 9}, Extent{2, 1}})
    for (const Extent frame : {Extent{1, 1}, Extent{3, 5}})
      for (const SurfacePixel& pixel :
           DepthMap(tiny, std::vector<float>(tiny.pixels(), 7)).surface(frame, .5F, 1))
        for (const float v : pixel) ASSERT_TRUE(std::isfinite(v));
}

TEST(SurfaceFile, GrayIsDepthAndColorNormals) {
  const NormalMapPath file;
  std::string warning;
  file.write(png(2, 1, 1, 16, {0x03, 0xe8, 0x0b, 0xb8}));  // 1000, 3000
  const SurfaceFile depth = SurfaceFile::load(file.path(), warning);
  EXPECT_TRUE(depth.has_depth());
  EXPECT_EQ(depth.surface({2, 1}, 1, 1000)[1][3], 3);
  EXPECT_EQ(depth.median(), 3000);
  file.write(png(2, 1, 1, 8, {100, 200}));
  EXPECT_EQ(SurfaceFile::load(file.path(), warning).surface({2, 1}, 1, 100)[1][3], 2)
      << "codes of 8 bits are not scaled";
  file.write(png(2, 1, 3, 8, {128, 238, 191, 0, 0, 0}));  // 60 degrees up; none
  const SurfaceFile normals = SurfaceFile::load(file.path(), warning);
  EXPECT_FALSE(normals.has_depth());
  const auto surface = normals.surface({2, 1}, 1, 1000);
  EXPECT_NEAR(surface[0][1], -.866, .01) << "up is negative here";
  EXPECT_EQ(surface[1], (SurfacePixel{0, 0, 1, 0}));
}

TEST(SurfaceFile, BadOnesAreRefusedInWords) {
  const NormalMapPath file;
  const auto refused = [&](const std::string& text) {
    std::string warning;
    expect_error(ErrorKind::file, text, [&] { SurfaceFile::load(file.path(), warning); });
  };
  refused("No such file");
  file.write({'n', 'o'});
  refused("no PNG");
  file.write(png(8, 8, 1, 16, std::vector<uint8_t>(128, 0)));
  refused("it is black");
  file.write(png(8, 8, 3, 8, std::vector<uint8_t>(192, 0)));
  refused("no normal");
  auto cut = png(64, 64, 1, 16, std::vector<uint8_t>(64 * 64 * 2, 200));
  cut.resize(cut.size() / 2);
  file.write(cut);
  refused("no PNG");
}

class SurfaceLightTest : public GpuTest {};

// A lamp in the room, in meters, against the equation in camera axes.
TEST_F(SurfaceLightTest, DepthLightsAsItIs) {
  const Vector n{.3, -.4, .8};
  const auto codes = plane_codes(n, 2.5, kFrame, kFocal);
  const NormalMapPath file;
  file.write(png(kFrame.width, kFrame.height, 1, 16, codes_of_16_bits(codes)));
  std::string warning;
  Relight relight(device, kFrame);
  relight.set_surface(std::make_shared<const SurfaceFile>(SurfaceFile::load(file.path(), warning)));
  Layers layers;
  layers.extent = kFrame;
  layers[Role::intrinsic] = shared_plane(kFrame, Pixels(kFrame.pixels() * 4, 1));
  const float degrees = 2 * std::atan(48 / kFocal) * 180 / 3.14159265F;
  // 2 m before the camera: 1.5 m above a plane at 3.5 m.
  const Lamp lamp{.position = {30, 20, 1.5F}, .power = .8F, .radius = 0};
  run([&](gpu::Commands& commands) {
    relight.record(commands, layers,
                   {.lamps = {lamp}, .ambient = 0, .field_of_view = degrees, .plane_depth = 3.5F});
  });
  EXPECT_EQ(relight.plane_depth(), 3.5F);
  const Pixels got = download(layers[Role::intrinsic]);
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  const Vector at{(30 - 48) * 2 / 80.0, (20 - 32) * 2 / 80.0, 2};
  for (uint32_t k = 0; k < kFrame.pixels(); ++k) {
    const double z = codes[k] / 1000, x = (k % 96 + .5 - 48) / 80 * z,
                 y = (k / 96 + .5 - 32) / 80 * z;
    const reference::SceneLamp in_camera{.place = at, .light = {.8, .8, .8}};
    const auto light = reference::light_on(
        {{x, y, z}, {-n[0] / length, -n[1] / length, -n[2] / length}}, {in_camera});
    ASSERT_NEAR(double{got[4 * k + 3]}, light[0], 2e-2 * light[0] + 1e-3) << k;
  }
}

}  // namespace inverse::testing
