// SPDX-License-Identifier: LGPL-2.1-or-later
// Meshes drawn by compute, against brute force and against areas that are known.
#include "tests/material/reference/raster.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>

#include "common/error.hpp"
#include "kernels/environment/lit_sphere.hpp"
#include "kernels/material/raster/rasterizer.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/material/reference/room.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

/// A mesh as it is, without being prepared.
Mesh soup(const std::vector<reference::Triangle>& triangles) {
  Mesh mesh;
  for (const auto& triangle : triangles)
    for (const auto& p : triangle) {
      mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(
          {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
      mesh.normals.push_back({0, 0, 1});
    }
  return mesh;
}

std::vector<reference::Triangle> random_triangles(unsigned seed, size_t count, double width,
                                                  double height, double reach) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(0, 1);
  std::vector<reference::Triangle> triangles(count);
  for (auto& triangle : triangles) {
    const double x = value(random) * width, y = value(random) * height, z = value(random) - .5;
    // The depth of steep ones depends on the last bit of the sample's position.
    const double tilt = reach > 1000 ? 100 : 0;
    for (auto& p : triangle)
      p = {static_cast<float>(x + reach * (value(random) - .5)),
           static_cast<float>(y + reach * (value(random) - .5)),
           static_cast<float>(100 * z + tilt * (value(random) - .5))};
  }
  return triangles;
}

/// The triangles that may be seen in each cell of 8 x 8 pixels.
class Cells {
 public:
  Cells(const std::vector<reference::Triangle>& triangles, Extent extent)
      : columns_((extent.width + 7) / 8),
        rows_((extent.height + 7) / 8),
        cells_(size_t{columns_} * rows_) {
    for (const auto& t : triangles) {
      const auto cell = [&](size_t axis, double beyond, uint32_t count) {
        const auto [low, high] = std::minmax({t[0][axis], t[1][axis], t[2][axis]});
        return static_cast<uint32_t>(
            std::clamp(std::floor((beyond < 0 ? low : high) / 8 + beyond), 0.0, count - 1.0));
      };
      for (uint32_t y = cell(1, -.2, rows_); y <= cell(1, .2, rows_); ++y)
        for (uint32_t x = cell(0, -.2, columns_); x <= cell(0, .2, columns_); ++x)
          cells_[size_t{y} * columns_ + x].push_back(t);
    }
  }
  const std::vector<reference::Triangle>& at(uint32_t x, uint32_t y) const {
    return cells_[size_t{y / 8} * columns_ + x / 8];
  }

 private:
  uint32_t columns_, rows_;
  std::vector<std::vector<reference::Triangle>> cells_;
};

/// Pixels are the unit, y goes down: the mesh's own axes but for the sign of y.
MeshView pixels() {
  MeshView view;
  view.turn[1] = {0, -1, 0};
  return view;
}

class RasterTest : public GpuTest {
 protected:
  Pixels depth(const Mesh& mesh, const MeshView& view, Extent extent) {
    Rasterizer rasterizer(device, mesh);
    const Plane picture = plane(extent);
    run([&](gpu::Commands& commands) { rasterizer.depth(commands, view, picture); });
    return download(picture);
  }
  /// Compares the points that are not right beside an edge, of one pixel in `step` of a row and one
  /// row in as many.
  void expect_as_reference(const std::vector<reference::Triangle>& triangles, Extent extent,
                           const std::string& what, uint32_t step = 1) {
    // Where pixels have large numbers edges are known less well.
    const double beside = std::max(4e-3, 1e-5 * std::max(extent.width, extent.height));
    const Pixels drawn = depth(soup(triangles), pixels(), extent);
    const Cells cells(triangles, extent);
    size_t wrong = 0, near_edges = 0;
    for (uint32_t y = 0; y < extent.height; y += step)
      for (uint32_t x = 0; x < extent.width; x += step) {
        double count = 0, sum = 0, margin = 1e300;
        for (const auto& point : reference::kSamplePoints) {
          const auto hit = reference::look(cells.at(x, y), x + point[0], y + point[1]);
          margin = std::min(margin, hit.margin);
          if (hit.triangle < 0) continue;
          ++count;
          sum += hit.depth;
        }
        const float* pixel = &drawn[4 * (size_t{y} * extent.width + x)];
        if (margin < beside) {
          ++near_edges;
          continue;
        }
        const double depth = count > 0 ? sum / count : 0;
        if (pixel[1] != count / 8 || std::fabs(pixel[0] - depth) > .05 + 1e-3 * std::fabs(depth))
          ++wrong;
      }
    EXPECT_EQ(wrong, 0u) << what;
    EXPECT_LT(near_edges, extent.pixels() / (2 * step * step) + 8)
        << what << ": nothing was compared";
  }
};

double total(const Pixels& drawn) {
  double sum = 0;
  for (size_t i = 1; i < drawn.size(); i += 4) sum += drawn[i];
  return sum;
}

/// A sphere whose radius varies from corner to corner, closed.
Mesh bumpy_sphere(unsigned seed) {
  Mesh mesh = Mesh::sphere();
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> angle(0, 6.28F);
  const float a = angle(random), b = angle(random), c = angle(random);
  for (auto& p : mesh.positions) {
    const float bump =
        1 + .08F * std::sin(5 * p[0] + a) * std::sin(5 * p[1] + b) + .05F * std::sin(9 * p[2] + c);
    for (float& v : p) v *= bump;
  }
  return mesh;
}

MeshView turned(unsigned seed, float scale, float x, float y) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  float q[4], length = 0;
  for (float& v : q) {
    v = normal(random);
    length += v * v;
  }
  for (float& v : q) v /= std::sqrt(length);
  const float w = q[0], i = q[1], j = q[2], k = q[3];
  MeshView view;
  view.turn = {{{1 - 2 * (j * j + k * k), 2 * (i * j - k * w), 2 * (i * k + j * w)},
                {2 * (i * j + k * w), 1 - 2 * (i * i + k * k), 2 * (j * k - i * w)},
                {2 * (i * k - j * w), 2 * (j * k + i * w), 1 - 2 * (i * i + j * j)}}};
  view.scale = scale;
  view.x = x;
  view.y = y;
  return view;
}

}  // namespace

TEST_F(RasterTest, MatchesBruteForce) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    expect_as_reference(random_triangles(seed, 40, 61, 37, 20), {61, 37}, "middling");
    expect_as_reference(random_triangles(seed, 300, 40, 40, 4), {40, 40}, "small");
    expect_as_reference(random_triangles(seed, 6, 33, 65, 2000), {33, 65}, "huge");
  }
}

TEST_F(RasterTest, MoreThanSmallGroupsAndTilesHold) {
  // Groups of 256, in more pixels than tiles of 8 x 8 have bits for, and more corners than a row of
  // invocations: 768 places of 200 triangles each, apart from each other.
  std::mt19937 random(7);
  std::vector<reference::Triangle> triangles;
  for (int place = 0; place < 768; ++place) {
    const int column = place % 32, row = place / 32;
    for (auto t : random_triangles(random(), 200, 32, 32, 4)) {
      // Tips of slivers reach further than they are: edges are inclusive.
      const auto across = [&](size_t axis) { return t[1][axis] - t[0][axis]; };
      const double area =
          std::fabs(across(0) * (t[2][1] - t[0][1]) - across(1) * (t[2][0] - t[0][0]));
      if (area < 1) t[2] = {t[0][0] - across(1), t[0][1] + across(0), t[2][2]};
      for (auto& p : t) {
        p[0] += 96 * column + 20;
        p[1] += 96 * row + 40;
      }
      triangles.push_back(t);
    }
  }
  // Seconds of work in one submit: on a busy machine more than the default timeout.
  device->set_timeout(600);
  expect_as_reference(triangles, {3072, 2304}, "many", 3);
}

TEST_F(RasterTest, CoverageIsArea) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(8, 92);
  for (int i = 0; i < 20; ++i) {
    reference::Triangle t;
    for (auto& p : t) p = {value(random), value(random), 0};
    const double area = std::fabs((t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) -
                                  (t[1][1] - t[0][1]) * (t[2][0] - t[0][0])) /
                        2;
    double perimeter = 0;
    for (size_t k = 0; k < 3; ++k)
      perimeter += std::hypot(t[k][0] - t[(k + 1) % 3][0], t[k][1] - t[(k + 1) % 3][1]);
    EXPECT_NEAR(total(depth(soup({t}), pixels(), {100, 100})), area, .02 * perimeter + .5);
  }
  // An edge through a pixel: as much as it covers, to an eighth.
  const reference::Triangle half{{{-50, -50, 0}, {3.5, -50, 0}, {3.5, 500, 0}}};
  const Pixels drawn = depth(soup({half}), pixels(), {16, 4});
  EXPECT_EQ(drawn[4 * 3 + 1], .5F);
  EXPECT_EQ(drawn[4 * 2 + 1], 1);
  EXPECT_EQ(drawn[4 * 4 + 1], 0);
}

TEST_F(RasterTest, ClosedMeshesHaveNoCracks) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const float scale = 3 + 12 * static_cast<float>(seed * seed);
    const auto side = static_cast<uint32_t>(2.4F * scale);
    const float middle = static_cast<float>(side) / 2 + .1F * static_cast<float>(seed);
    const Pixels drawn =
        depth(bumpy_sphere(seed), turned(seed, scale, middle, middle), {side, side});
    size_t inside = 0;
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x) {
        const float r =
            std::hypot(static_cast<float>(x) + .5F - middle, static_cast<float>(y) + .5F - middle);
        if (r > .86F * scale - 1.5F) continue;
        ++inside;
        ASSERT_EQ(drawn[4 * (size_t{y} * side + x) + 1], 1) << seed << " " << x << "," << y;
        ASSERT_GT(drawn[4 * (size_t{y} * side + x)], 0) << "the far side shows";
      }
    EXPECT_GT(inside, seed ? 100u : 0u);
  }
}

TEST_F(RasterTest, MatchesRaysBehindALens) {
  constexpr Extent kSize{61, 47};
  MeshView view;
  view.lens = {50, 44, 28.3F, 25.1F};
  view.turn[1] = {0, -1, 0};  // y down, z forward
  view.turn[2] = {0, 0, -1};
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(-1, 1);
    std::vector<reference::Triangle> triangles(60);
    // Some before the camera, some around it, and some behind it.
    for (auto& triangle : triangles) {
      const float x = value(random), y = value(random), z = 1.5F + 2.5F * value(random);
      for (auto& p : triangle)
        p = {x + .4F * value(random), y + .4F * value(random), z + .4F * value(random)};
    }
    Mesh mesh = soup(triangles);
    const Pixels drawn = depth(mesh, view, kSize);
    size_t wrong = 0, near_edges = 0, covered = 0;
    for (uint32_t y = 0; y < kSize.height; ++y)
      for (uint32_t x = 0; x < kSize.width; ++x) {
        double count = 0, sum = 0;
        bool beside = false;
        for (const auto& point : reference::kSamplePoints) {
          const auto look = [&](double dx, double dy) {
            return reference::look_through(
                triangles, {(x + point[0] + dx - 28.3) / 50, (y + point[1] + dy - 25.1) / 44, 1},
                0.02);
          };
          const auto hit = look(0, 0);
          for (const double off : {-.01, .01})
            beside = beside || look(off, 0).triangle != hit.triangle ||
                     look(0, off).triangle != hit.triangle;
          if (hit.triangle < 0) continue;
          ++count;
          sum += 1 / hit.depth;
        }
        const float* pixel = &drawn[4 * (size_t{y} * kSize.width + x)];
        near_edges += beside;
        if (beside) continue;
        covered += count > 0;
        const double expected = count > 0 ? sum / count : 0;
        wrong += pixel[1] != count / 8 || std::fabs(pixel[0] - expected) > 1e-3 * (1 + expected);
      }
    EXPECT_EQ(wrong, 0U);
    EXPECT_LT(near_edges, kSize.pixels() / 4);
    EXPECT_GT(covered, kSize.pixels() / 20);
  }
}

TEST_F(RasterTest, APartOfAPictureIsDrawnAlone) {
  const auto triangles = random_triangles(3, 40, 20, 12, 9);
  Rasterizer rasterizer(device, soup(triangles));
  const Plane whole = plane({20, 12}), sheet = plane({64, 40}, random_pixels({64, 40}, 1));
  const Pixels before = download(sheet);
  run([&](gpu::Commands& commands) {
    rasterizer.depth(commands, pixels(), whole);
    rasterizer.depth(commands, pixels(), sheet, {31, 7}, {20, 12});
  });
  const Pixels alone = download(whole), part = download(sheet);
  for (size_t y = 0; y < 40; ++y)
    for (size_t x = 0; x < 64; ++x) {
      const bool in = x >= 31 && x < 51 && y >= 7 && y < 19;
      const float* expected = in ? &alone[4 * ((y - 7) * 20 + x - 31)] : &before[4 * (y * 64 + x)];
      ASSERT_TRUE(std::equal(expected, expected + 4, &part[4 * (y * 64 + x)])) << x << " " << y;
    }
}

TEST_F(RasterTest, TheNearerOneIsSeenWhateverTheOrder) {
  const reference::Triangle near{{{-90, -90, 5}, {200, -90, 5}, {-90, 200, 5}}};
  const reference::Triangle far{{{-90, -90, -7}, {200, -90, -7}, {-90, 200, -7}}};
  for (const auto& order : {std::vector{near, far}, std::vector{far, near}}) {
    const Pixels drawn = depth(soup(order), pixels(), {20, 20});
    for (size_t i = 0; i < drawn.size(); i += 4) ASSERT_NEAR(drawn[i], 5, 1e-4);
  }
}

TEST_F(RasterTest, OneTriangleMayCoverALargePicture) {
  const reference::Triangle all{{{-2e4, -2e4, 0}, {6e4, -2e4, 0}, {-2e4, 6e4, 0}}};
  for (const Extent extent : {Extent{1, 1}, {8192, 16}, {16, 4320}, {1000, 700}}) {
    const Pixels drawn = depth(soup({all}), pixels(), extent);
    EXPECT_EQ(total(drawn), static_cast<double>(extent.pixels()));
  }
}

TEST_F(RasterTest, ThousandsInOnePixelAndOnesWithoutArea) {
  auto crowd = random_triangles(1, 5000, .8, .8, .3);
  for (auto& t : crowd)
    for (auto& p : t) {
      p[0] += 20.1;
      p[1] += 9.1;
    }
  const Pixels first = depth(soup(crowd), pixels(), {40, 20});
  EXPECT_EQ(first[4 * (9 * 40 + 20) + 1], 1);
  EXPECT_LE(total(first), 9);
  EXPECT_EQ(depth(soup(crowd), pixels(), {40, 20}), first) << "the same on every run";
  const reference::Triangle line{{{2, 2, 0}, {30, 15, 0}, {16, 8.5, 0}}};
  const reference::Triangle point{{{7.5, 7.5, 0}, {7.5, 7.5, 0}, {7.5, 7.5, 0}}};
  EXPECT_EQ(total(depth(soup({line, point}), pixels(), {40, 20})), 0);
  const reference::Triangle beside{{{-50, 2, 0}, {-30, 9, 0}, {-40, 30, 0}}};
  EXPECT_EQ(total(depth(soup({beside}), pixels(), {40, 20})), 0);
}

TEST_F(RasterTest, ASphereLooksLikeItsLitSphere) {
  std::vector<float> rgb;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      rgb.insert(rgb.end(), {static_cast<float>(y) / 16, static_cast<float>(x) / 32, .2F});
  LitSphere lit(device);
  lit.set_light(Environment({64, 32}, rgb));
  constexpr uint32_t kSide = 200;
  constexpr float kRadius = 90;
  Rasterizer rasterizer(device, Mesh::sphere());
  const Plane picture = plane({kSide, kSide});
  run([&](gpu::Commands& commands) {
    lit.record(commands, {{.8F, .5F, .3F}, .3F, 40}, {});
    rasterizer.draw(commands, turned(3, kRadius, kSide / 2.0F, kSide / 2.0F), lit.table(), picture);
  });
  const Pixels drawn = download(picture), table = download(lit.table());
  const uint32_t side = lit.table().extent.width;
  double largest = 0;
  for (uint32_t y = 0; y < kSide; ++y)
    for (uint32_t x = 0; x < kSide; ++x) {
      const double nx = (x + .5 - kSide / 2.) / kRadius, ny = -(y + .5 - kSide / 2.) / kRadius;
      const double r2 = nx * nx + ny * ny;
      const float* pixel = &drawn[4 * (size_t{y} * kSide + x)];
      if (r2 > 1.05) {
        ASSERT_EQ(pixel[3], 0);
      }
      if (r2 > .9) continue;
      ASSERT_EQ(pixel[3], 1);
      const double scale = 1 / std::sqrt(1 + std::sqrt(1 - r2));
      const auto at = [&](double v) { return (v + 1) / 2 * side - .5; };
      const auto column = static_cast<size_t>(std::lround(at(nx * scale)));
      const auto row = static_cast<size_t>(std::lround(at(-ny * scale)));
      for (size_t c = 0; c < 3; ++c)
        largest =
            std::max<double>(largest, std::fabs(pixel[c] - table[4 * (row * side + column) + c]));
    }
  EXPECT_LT(largest, .03);
}

TEST(MeshTest, PreparesBadMeshes) {
  Mesh mesh;
  mesh.positions = {{10, 10, 10}, {14, 10, 10}, {10, 13, 10},
                    {10, 10, 22}, {kNan, 0, 0}, {99, 99, 99}};
  mesh.normals = {{0, 0, 0}, {kNan, 0, 0}};
  mesh.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 0, 1, 4, 0, 1, 77, 0, 0, 1};
  mesh.prepare("test");
  EXPECT_EQ(mesh.triangles(), 4u);
  ASSERT_EQ(mesh.positions.size(), 4u);
  float reach = 0;
  for (size_t i = 0; i < 4; ++i) {
    const auto &p = mesh.positions[i], &n = mesh.normals[i];
    update_max(reach, std::hypot(p[0], p[1], p[2]));
    EXPECT_NEAR(std::hypot(n[0], n[1], n[2]), 1, 1e-5);
    EXPECT_GT(p[0] * n[0] + p[1] * n[1] + p[2] * n[2], 0) << "outwards";
  }
  EXPECT_NEAR(reach, 1, 1e-6);
}

TEST(MeshTest, MeshesThatCannotBeDrawnAreErrors) {
  const auto expect_refused = [](Mesh mesh, const std::string& text) {
    expect_error(ErrorKind::file, text, [&] { mesh.prepare("a.obj"); });
  };
  expect_refused({}, "mesh a.obj has no triangle");
  expect_refused({{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {}, {0, 1, 2}}, "no triangle");
  Mesh many{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {}};
  for (size_t i = 0; i <= Mesh::kMaxTriangles; ++i)
    many.indices.insert(many.indices.end(), {0, 1, 2});
  expect_refused(many, "1000001 triangles; at most 1000000");
}

}  // namespace inverse::testing
