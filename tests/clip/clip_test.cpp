// SPDX-License-Identifier: LGPL-2.1-or-later
// The clip renderer against closed forms: light in a sphere, a lamp and a window over a plane; and
// the committed ground truth of the clip.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tools/clip/denoise.hpp"
#include "tools/clip/transport.hpp"

namespace inverse::clip {
namespace {

constexpr int kThreads = 2;

Paint gray(float value) { return {Pattern::kPlain, {{value, value, value}}, 1, ""}; }

float mean(const std::vector<Vec3>& plane) {
  double sum = 0;
  for (Vec3 v : plane) sum += v.x + v.y + v.z;
  return static_cast<float>(sum / static_cast<double>(3 * plane.size()));
}

// Seen from its center, a sphere with a lamp at the center is lit alike everywhere, and every
// bounce of a diffuse sphere spreads evenly: shading after n bounces is direct · (ρ + ρ² + … + ρⁿ).
TEST(ClipTransport, LightInASphereIsAGeometricSeries) {
  constexpr float kRadius = 2, kReflectance = 0.6f, kIntensity = 3;
  Scene scene;
  scene.primitives = {{Shape::kEllipsoid, {kRadius, kRadius, kRadius}, {}, {}, gray(kReflectance)}};
  scene.lamp = {{0, 0, 0}, 1e-3f, kIntensity};
  scene.window = {{0, 0.9f, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}, 0};
  scene.camera = {{0, 0, 0.1f}, {0, 0, -1}, 0.9f};
  Layers layers =
      render(scene, 24, 18, {.samples = 64, .soft_samples = 64, .bounces = 3}, kThreads);
  float direct = kIntensity / (kRadius * kRadius);
  float series = kReflectance + kReflectance * kReflectance + std::pow(kReflectance, 3.0f);
  for (size_t i = 0; i < layers.lamp.size(); ++i) {
    ASSERT_NEAR(layers.reflectance[i].y, kReflectance, 1e-5f);
    ASSERT_NEAR(layers.lamp[i].y, direct, 0.002f * direct);
  }
  // Bounces after the first choose between lamp and (dark) window, so their mean is noisy.
  EXPECT_NEAR(mean(layers.indirect), direct * series, 0.01f * direct * series);
}

// A lamp gives intensity · cos / d². A parallel square window of half side 1 at height 1 gives its
// radiance times the form factor 4 · (1 / 2π) · 2 · (1 / √2) atan(1 / √2).
TEST(ClipTransport, LampAndWindowOverAPlane) {
  Scene scene;
  scene.primitives = {{Shape::kRectangle, {50, 0, 50}, {}, {}, gray(0.5f)}};
  scene.lamp = {{3, 4, 0}, 1e-3f, 50};
  scene.window = {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, 0.7f};
  scene.camera = {{0, 0.9f, 0.01f}, {0, 0, 0}, 0.02f};
  Layers layers =
      render(scene, 4, 4, {.samples = 1024, .soft_samples = 1024, .bounces = 1}, kThreads);
  for (Vec3 v : layers.lamp) EXPECT_NEAR(v.y, 50 * (4.0f / 5) / 25, 0.01f);
  double window = 0;
  for (float v : layers.window) window += v / 16;
  double form_factor = 4 / kPi * std::atan(1 / std::sqrt(2.0)) / std::sqrt(2.0);
  EXPECT_NEAR(window, 0.7 * form_factor, 1e-3);
}

// A ball between lamp and plane: the hidden part is dark, the rest is lit.
TEST(ClipTransport, ShadowsAreHard) {
  Scene scene;
  scene.primitives = {{Shape::kRectangle, {5, 0, 5}, {}, {}, gray(0.5f)},
                      {Shape::kEllipsoid, {0.2f, 0.2f, 0.2f}, {0, 1, 0}, {}, gray(0.5f)}};
  scene.lamp = {{0, 3, 0}, 1e-3f, 1};
  scene.window = {{0, 4, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}, 0};
  auto shading = [&](float x) {
    scene.camera = {{x, 0.5f, 0.01f}, {x, 0, 0}, 0.01f};
    return mean(
        render(scene, 2, 2, {.samples = 16, .soft_samples = 1, .bounces = 1}, kThreads).lamp);
  };
  float edge = 0.2f * 3 / std::sqrt(2 * 2 - 0.2f * 0.2f);  // the tangent cone at the floor
  EXPECT_EQ(shading(0), 0);
  EXPECT_EQ(shading(edge - 0.02f), 0);
  EXPECT_NEAR(shading(edge + 0.02f), 3 * 1 / std::pow(9 + edge * edge, 1.5f), 2e-3f);
}

struct FlatDump {
  int width = 0, height = 0, channels = 0, frames = 0;
  std::vector<float> values;
};

FlatDump read_truth() {
  const char* path = std::getenv("CLIP_TRUTH");
  if (!path) throw std::runtime_error("CLIP_TRUTH must name tests/data/clip/clip.f32");
  std::ifstream file(path, std::ios::binary);
  std::string line, magic;
  std::getline(file, line);
  FlatDump dump;
  std::istringstream(line) >> magic >> dump.width >> dump.height >> dump.channels >> dump.frames;
  if (magic != "F32") throw std::runtime_error(std::string("not a flat dump: ") + path);
  dump.values.resize(static_cast<size_t>(dump.width) * dump.height * dump.channels * dump.frames);
  file.read(reinterpret_cast<char*>(dump.values.data()),
            static_cast<std::streamsize>(dump.values.size() * sizeof(float)));
  if (!file || file.peek() != EOF) throw std::runtime_error("wrong length of the flat dump");
  return dump;
}

TEST(ClipTruth, InputIsReflectanceTimesShading) {
  FlatDump dump = read_truth();
  ASSERT_EQ(dump.channels, 9);
  for (size_t i = 0; i < dump.values.size(); i += 9) {
    for (size_t c = 0; c < 3; ++c) {
      float reflectance = dump.values[i + 3 + c], shading = dump.values[i + 6 + c];
      ASSERT_NEAR(dump.values[i + c], reflectance * shading, 1e-6f);
      ASSERT_GT(reflectance, 0);
      ASSERT_LE(reflectance, 1);
      ASSERT_GT(shading, 0);
    }
  }
}

TEST(ClipTruth, AgreesWithTheScene) {
  FlatDump dump = read_truth();
  ASSERT_EQ(dump.frames, 2);
  constexpr int kFrames[] = {45, 104};
  constexpr int kLastFrame = 124;
  for (int f = 0; f < dump.frames; ++f) {
    Scene scene = still_life(static_cast<float>(kFrames[f]) / kLastFrame);
    Layers layers =
        render(scene, dump.width, dump.height, {.samples = 16, .soft_samples = 16}, kThreads);
    denoise(layers, 4, kThreads);
    size_t pixels = layers.reflectance.size();
    const float* truth = dump.values.data() + static_cast<size_t>(f) * pixels * 9;
    double reflectance_error = 0, shading_error = 0, shading_sum = 0, shading_bias = 0;
    for (size_t i = 0; i < pixels; ++i) {
      Vec3 s = layers.lamp[i] + layers.indirect[i];
      for (int c = 0; c < 3; ++c) {
        double shading = s[c] + layers.window[i], expected = truth[9 * i + 6 + c];
        reflectance_error += std::fabs(layers.reflectance[i][c] - truth[9 * i + 3 + c]);
        shading_error += std::fabs(shading - expected);
        shading_bias += shading - expected;
        shading_sum += expected;
      }
    }
    EXPECT_LT(reflectance_error / static_cast<double>(3 * pixels), 0.01);
    EXPECT_LT(shading_error / shading_sum, 0.03);
    EXPECT_LT(std::fabs(shading_bias / shading_sum), 0.005);
    std::printf("frame %d: mean |dR| %.5f, |dS| / S %.4f, bias %.5f\n", kFrames[f],
                reflectance_error / static_cast<double>(3 * pixels), shading_error / shading_sum,
                shading_bias / shading_sum);
  }
}

}  // namespace
}  // namespace inverse::clip
