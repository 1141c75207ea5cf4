// SPDX-License-Identifier: LGPL-2.1-or-later
// What the meta of layers says of a remembered scene.
#include <algorithm>
#include <array>
#include <cmath>

#include "gst/inverse/inverse_depth_meta.h"
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

using Vector = std::array<double, 3>;

/// A frame as it came, and what its layers say.
struct Frame {
  GstInverseDepthMeta meta;  // without its image
  std::vector<uint16_t> depth;
  guint version = 0;
  bool writable = false;  // its layers can be replaced
  bool replaced = false;  // and one of the roles of the scene could be
  std::vector<float> surface, pose;
};

std::vector<Frame> run(int width, int height, const std::string& source,
                       const std::string& decomposer) {
  std::vector<Frame> frames;
  size_t seen = 0;
  const LineResult line = run_line(
      "rgbdtestsrc is-live=false samples=1 " + source +
          " ! video/x-raw,width=" + std::to_string(width) + ",height=" + std::to_string(height) +
          " ! identity name=before ! " + decomposer +
          " ! identity name=layers ! intrinsiccompose ! video/x-raw,format=RGBA ! "
          "appsink name=out sync=false",
      240, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "before"), "src", [&](GstBuffer* buffer) {
          GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer);
          if (!meta) return;
          frames.push_back({.meta = *meta,
                            .depth = std::vector<uint16_t>(size_t{meta->width} * meta->height),
                            .surface = {},
                            .pose = {}});
          gst_buffer_extract(meta->depth, 0, frames.back().depth.data(),
                             2 * frames.back().depth.size());
        });
        watch_buffers(find_element(pipeline, "layers"), "src", [&](GstBuffer* buffer) {
          if (seen == frames.size()) return;
          Frame& frame = frames[seen++];
          frame.version =
              gst_inverse_layers_meta_version(gst_buffer_get_inverse_layers_meta(buffer));
          frame.surface = layer_of(buffer, GST_INVERSE_ROLE_SURFACE);
          frame.pose = layer_of(buffer, GST_INVERSE_ROLE_POSE);
          const Buffer copy(gst_buffer_copy(buffer));
          frame.writable = replace_layer(copy.get(), GST_INVERSE_ROLE_MASK,
                                         layer_of(buffer, GST_INVERSE_ROLE_INTRINSIC));
          for (const GstInverseRole role : {GST_INVERSE_ROLE_SURFACE, GST_INVERSE_ROLE_POSE})
            frame.replaced |= replace_layer(copy.get(), role, layer_of(buffer, role));
        });
      });
  EXPECT_TRUE(line.first_error().empty()) << line.first_error();
  EXPECT_EQ(seen, frames.size());
  return frames;
}

/// What turns a direction of the camera into the world's, by the quaternion.
Vector turned(const std::vector<float>& pose, const Vector& v) {
  const double x = double{pose[0]}, y = double{pose[1]}, z = double{pose[2]}, w = double{pose[3]};
  const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  Vector result{};
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 3; ++c) result[r] += rows[r][c] * v[c];
  return result;
}

/// The point of a pixel in the world.
Vector world_of(const Frame& frame, int width, size_t i) {
  const double z = double{frame.surface[4 * i + 3]};
  const auto x = double(i % size_t(width)), y = double(i / size_t(width));
  Vector point = turned(frame.pose, {(x - double{frame.pose[10]}) / double{frame.pose[8]} * z,
                                     (y - double{frame.pose[11]}) / double{frame.pose[9]} * z, z});
  for (size_t c = 0; c < 3; ++c) point[c] += double{frame.pose[4 + c]};
  return point;
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

// The second size is twice that of the view, so that every pixel of it is shown by four.
class SceneLayers : public ::testing::TestWithParam<std::pair<int, int>> {};
INSTANTIATE_TEST_SUITE_P(Sizes, SceneLayers,
                         ::testing::Values(std::pair{160, 120}, std::pair{384, 120}));

TEST_P(SceneLayers, AreTheTruthOfTheRoom) {
  const auto [width, height] = GetParam();
  const double pixel = width > 320 ? 2 : 1;  // of the view
  const auto frames =
      run(width, height, "num-buffers=4 depth-noise=0 speed=4", "intrinsicdecomp quality=low");
  ASSERT_EQ(frames.size(), 4U);
  for (size_t n = 0; n < frames.size(); ++n) {
    const Frame& frame = frames[n];
    EXPECT_EQ(frame.version, 3U);
    EXPECT_TRUE(frame.writable);
    EXPECT_FALSE(frame.replaced);
    ASSERT_EQ(frame.surface.size(), size_t(4 * width * height));
    ASSERT_EQ(frame.pose.size(), 12U);
    EXPECT_EQ(frame.pose[7], 1) << "the camera is found";
    EXPECT_NEAR(frame.pose[8], frame.meta.fx, 1e-3);
    EXPECT_NEAR(frame.pose[9], frame.meta.fy, 1e-3);
    EXPECT_NEAR(frame.pose[10], frame.meta.cx, pixel / 2);
    EXPECT_NEAR(frame.pose[11], frame.meta.cy, pixel / 2);
    for (size_t r = 0; r < 3; ++r) {
      EXPECT_NEAR(frame.pose[4 + r], frame.meta.pose[4 * r + 3], 0.01) << n;
      for (size_t c = 0; c < 3; ++c) {
        Vector axis{};
        axis[c] = 1;
        EXPECT_NEAR(turned(frame.pose, axis)[r], frame.meta.pose[4 * r + c], 0.01) << n;
      }
    }
    std::vector<double> depths, lengths, floor, below;
    size_t known = 0;
    for (size_t i = 0; i < frame.depth.size(); ++i) {
      const float* s = &frame.surface[4 * i];
      if (!(s[3] > 0)) continue;
      ++known;
      const Vector normal{double{s[0]}, double{s[1]}, double{s[2]}};
      lengths.push_back(std::abs(std::hypot(normal[0], normal[1], normal[2]) - 1));
      depths.push_back(std::abs(double{s[3]} - frame.meta.unit * frame.depth[i]));
      const Vector at = world_of(frame, width, i);
      below.push_back(at[1]);
      if (at[1] > 1.215) floor.push_back(turned(frame.pose, normal)[1]);
    }
    EXPECT_GT(known, frame.depth.size() * 9 / 10);
    EXPECT_LT(*std::ranges::max_element(lengths), 1e-4);
    EXPECT_LT(quantile(depths, 0.5), 0.01) << n;
    EXPECT_LT(quantile(depths, 0.9), 0.05) << n;
    // The floor is at y = 1.23 m, and its normal points up, which is -y.
    EXPECT_LT(*std::ranges::max_element(below), 1.26) << n;
    ASSERT_GT(floor.size(), 200U);
    EXPECT_LT(quantile(floor, 0.5), -0.98) << n;
    for (size_t i = 0; pixel > 1 && i < frame.depth.size(); i += 2)
      ASSERT_TRUE(
          std::equal(&frame.surface[4 * i], &frame.surface[4 * i + 4], &frame.surface[4 * i + 4]))
          << i;
  }
}

TEST(SceneLayersMissing, AreAbsentWithoutAScene) {
  for (const std::string decomposer : {"intrinsicdecomp quality=low scene::remember=false",
                                       "globalintrinsic scene::remember=false"}) {
    const auto frames = run(96, 72, "num-buffers=2", decomposer);
    ASSERT_EQ(frames.size(), 2U);
    for (const Frame& frame : frames) {
      EXPECT_EQ(frame.version, 3U);
      EXPECT_TRUE(frame.surface.empty());
      EXPECT_TRUE(frame.pose.empty());
      EXPECT_FALSE(frame.replaced);
    }
  }
}

}  // namespace inverse::testing
