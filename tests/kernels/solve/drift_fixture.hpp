// SPDX-License-Identifier: LGPL-2.1-or-later
// Reflectance of what stays in view, while a camera moves or a bright thing comes and goes: its
// common change over a second or two.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/kernels/intrinsic/intrinsic_fixture.hpp"

namespace inverse::testing::drift {

inline constexpr Extent kWorld{640, 480}, kView{160, 120};
inline constexpr int kFrames = 48, kSpan = 40;
inline constexpr float kBright = 1;

struct Camera {
  double x, y, step;  ///< upper left corner in the world, and world pixels a view's pixel
};

/// A bright disk in the view, pixels.
struct Disk {
  double x, y, radius;
  bool covers(double at_x, double at_y, double margin) const {
    return std::hypot(at_x - x, at_y - y) < radius + margin;
  }
};

/// R.rgb, S of every frame of a video, of views of one picture.
using Decompose = std::function<Pixels(const PlanePtr&, bool first)>;

class DriftTest : public IntrinsicTest {
 protected:
  /// Means of step x step world pixels would do; bilinear samples of a picture of large tiles do.
  static Pixels view(const Pixels& world, const Camera& camera, const Disk& disk) {
    Pixels pixels;
    for (uint32_t y = 0; y < kView.height; ++y)
      for (uint32_t x = 0; x < kView.width; ++x)
        for (size_t c = 0; c < 4; ++c)
          pixels.push_back(disk.covers(x, y, 0) ? kBright
                                                : sample(world, kWorld, camera.x + camera.step * x,
                                                         camera.y + camera.step * y, c));
    return pixels;
  }
  static float sample(const Pixels& pixels, Extent extent, double x, double y, size_t c) {
    const auto at = [&](double column, double row) {
      const auto i = static_cast<size_t>(std::clamp(column, 0.0, extent.width - 1.0));
      const auto j = static_cast<size_t>(std::clamp(row, 0.0, extent.height - 1.0));
      return pixels[4 * (j * extent.width + i) + c];
    };
    const double fx = x - std::floor(x), fy = y - std::floor(y);
    const auto top = at(x, y) * (1 - fx) + at(x + 1, y) * fx;
    return static_cast<float>(top * (1 - fy) +
                              (at(x, y + 1) * (1 - fx) + at(x + 1, y + 1) * fx) * fy);
  }

  /// Whether the disk covers a point of the world in a frame of a span.
  static bool covered(const std::function<Camera(int)>& camera,
                      const std::function<Disk(int)>& disk, int first, double x, double y) {
    for (int k = first; k <= first + kSpan; ++k) {
      const Camera now = camera(k);
      if (disk(k).covers((x - now.x) / now.step, (y - now.y) / now.step, 3)) return true;
    }
    return false;
  }

  /// |median| over points that both frames show of the change of ln mean R, kSpan frames apart.
  double drift(const Pixels& world, const std::function<Camera(int)>& camera,
               const std::function<Disk(int)>& disk, const Decompose& decompose) {
    std::vector<Pixels> layers;
    for (int k = 0; k < kFrames; ++k)
      layers.push_back(decompose(input(kView, view(world, camera(k), disk(k))), k == 0));
    double sum = 0;
    int count = 0;
    for (int k = 4; k + kSpan < kFrames; ++k, ++count) {
      const Camera a = camera(k), b = camera(k + kSpan);
      std::vector<double> changes;
      for (double y = 4; y < kWorld.height; y += 7)
        for (double x = 4; x < kWorld.width; x += 7) {
          const double from[] = {(x - a.x) / a.step, (y - a.y) / a.step};
          const double to[] = {(x - b.x) / b.step, (y - b.y) / b.step};
          const auto inside = [](const double* p) {
            return p[0] > 3 && p[1] > 3 && p[0] < kView.width - 4 && p[1] < kView.height - 4;
          };
          if (!inside(from) || !inside(to) || covered(camera, disk, k, x, y)) continue;
          const auto brightness = [&](const Pixels& pixels, const double* p) {
            double mean = 0;
            for (size_t c = 0; c < 3; ++c)
              mean += static_cast<double>(sample(pixels, kView, p[0], p[1], c));
            return std::log(mean / 3 + 2e-3);
          };
          changes.push_back(brightness(layers[static_cast<size_t>(k + kSpan)], to) -
                            brightness(layers[static_cast<size_t>(k)], from));
        }
      std::nth_element(changes.begin(), changes.begin() + static_cast<long>(changes.size() / 2),
                       changes.end());
      sum += std::abs(changes[changes.size() / 2]);
    }
    return sum / count;
  }

  /// The bound is on the mean over worlds (seeds): shots of single ones are above it.
  void check(const char* name, const std::function<Decompose()>& method, double bound,
             const std::vector<unsigned>& seeds) {
    std::vector<Pixels> worlds;
    for (const unsigned seed : seeds) worlds.push_back(scene(kWorld, seed));
    const auto still = [](int) { return Camera{100, 80, 2}; };
    const auto nothing = [](int) { return Disk{0, 0, -9}; };
    const auto enters = [](int k) { return Disk{std::max(100.0, 260.0 - 8 * k), 60, 35}; };
    const struct {
      const char* name;
      std::function<Camera(int)> camera;
      std::function<Disk(int)> disk;
    } shots[] = {{"zoom",
                  [](int k) {
                    return Camera{60 + 1.6 * k, 40 + 1.2 * k, 3 - 0.02 * k};
                  },
                  nothing},
                 {"pan",
                  [](int k) {
                    return Camera{20.0 + 3 * k, 40.0 + k, 2};
                  },
                  nothing},
                 {"a bright thing enters", still, enters},
                 {"a bright thing leaves", still, [&](int k) { return enters(kFrames - 1 - k); }}};
    for (const auto& shot : shots) {
      double found = 0;
      for (const Pixels& world : worlds)
        found += drift(world, shot.camera, shot.disk, method()) / double(worlds.size());
      std::printf("%s, %s: common drift of ln R over %d frames %.4f\n", name, shot.name, kSpan,
                  found);
      EXPECT_LT(found, bound) << name << ", " << shot.name;
    }
  }
};

}  // namespace inverse::testing::drift
