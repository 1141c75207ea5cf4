// SPDX-License-Identifier: LGPL-2.1-or-later
// What is remembered of a scene along known paths.
#include "kernels/volume/memory/scene_memory.hpp"

#include <cmath>

#include "tests/kernels/volume/volume_fixture.hpp"

namespace inverse::testing {
namespace {

constexpr float kUnit = 0.0005F;

class SceneMemoryTest : public VolumeFixture {
 protected:
  static SceneMemory::Params params() {
    SceneMemory::Params params;
    params.volume.voxel = 0.02F;
    params.volume.blocks = 8192;
    return params;
  }
  static Camera around(double t) {
    return camera_at(160, 120,
                     {0.5 * std::sin(t) - 0.2, 0.2 + 0.1 * std::cos(2 * t), 0.15 * std::cos(t)},
                     {0.1 * std::cos(t) - 0.2, 0.6, 2});
  }

  struct Frame {
    Camera camera;
    Pixels layers;
    std::vector<uint16_t> steps;
    SceneMemory::Depth depth() const {
      return {reinterpret_cast<const std::byte*>(steps.data()),
              size_t{2} * uint32_t(camera.width),
              extent_of(camera),
              kUnit,
              lens_of(camera),
              {}};
    }
  };
  static Frame seen_by(const Camera& camera) {
    const Seen seen = look(camera);
    Frame frame{camera, to_pixels(seen.layers), {}};
    for (const double z : seen.depth)
      frame.steps.push_back(uint16_t(std::lround(std::min(z / double{kUnit}, 65535.0))));
    return frame;
  }
  static Pose pose_of_camera(const Camera& camera) {
    Pose pose;
    for (size_t c = 0; c < 4; ++c) pose.rotation[c] = float(camera.rotation[c]);
    for (size_t c = 0; c < 3; ++c) pose.place[c] = float(camera.place[c]);
    return pose;
  }

  /// Shows `memory` a frame whose true layers are found. What was known of it before: ln R and
  /// confidence; empty: nothing.
  Pixels show(SceneMemory& memory, const Frame& frame, const SceneMemory::Depth& depth) {
    return show(memory, {extent_of(frame.camera), upload(frame.layers)}, depth);
  }
  Pixels show(SceneMemory& memory, const Plane& layers, const SceneMemory::Depth& depth) {
    std::optional<KnownReflectance> known;
    run([&](gpu::Commands& commands) {
      known = memory.record_recall(commands, number_, depth, layers);
      memory.record_remember(commands, layers);
    });
    ++number_;
    return known && download(known->valid)[0] > 0 ? download(known->reflectance) : Pixels();
  }
  SceneMemory::Findings found(const SceneMemory& memory) const {
    return memory.findings(number_ - 1);
  }

  /// Mean distance of ln R from the truth where it is known, and the share where it is.
  struct Match {
    double distance = 0, share = 0;
  };
  static Match match(const Pixels& known, const Frame& frame) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < known.size(); i += 4) {
      if (!(known[i + 3] > 0)) continue;
      ++count;
      for (size_t c = 0; c < 3; ++c)
        sum += std::abs(double{known[i + c]} - std::log(double{frame.layers[i + c]})) / 3;
    }
    return {sum / std::max(count, 1.0), count / double(known.size() / 4)};
  }

 private:
  uint64_t number_ = 0;
};

TEST_F(SceneMemoryTest, KnowsWhatItHasSeen) {
  SceneMemory memory(device, extent_of(around(0)), params());
  for (int i = 0; i < 12; ++i) {
    const Frame frame = seen_by(around(0.04 * i));
    const Pixels known = show(memory, frame, frame.depth());
    if (i == 0) {
      EXPECT_TRUE(known.empty());
      continue;
    }
    const Match m = match(known, frame);
    EXPECT_LT(m.distance, 0.06) << i;
    EXPECT_GT(m.share, 0.9) << i;
    EXPECT_TRUE(found(memory).found);
    EXPECT_GT(found(memory).matched, 0.8F);
    EXPECT_GT(found(memory).blocks, 300U);
    EXPECT_LE(found(memory).blocks_visible, found(memory).blocks);
  }
}

// Too far apart to be followed.
TEST_F(SceneMemoryTest, TakesPosesThatAreGiven) {
  SceneMemory::Params given = params();
  given.track = false;
  SceneMemory memory(device, extent_of(around(0)), given);
  for (int i = 0; i < 4; ++i) {
    const Frame frame = seen_by(around(1.5 * i));
    SceneMemory::Depth depth = frame.depth();
    depth.pose = pose_of_camera(frame.camera);
    const Pixels known = show(memory, frame, depth);
    if (i > 0) {
      EXPECT_LT(match(known, frame).distance, 0.1) << i;
      EXPECT_GT(match(known, frame).share, 0.3) << i;
    }
  }
}

TEST_F(SceneMemoryTest, AddsNothingWhileTheCameraIsLost) {
  SceneMemory memory(device, extent_of(around(0)), params());
  const Frame frame = seen_by(around(0));
  Pixels before;
  for (int i = 0; i < 3; ++i) before = show(memory, frame, frame.depth());
  ASSERT_FALSE(before.empty());
  const uint32_t blocks = found(memory).blocks;
  std::vector<uint16_t> wrong[] = {std::vector<uint16_t>(frame.steps.size(), 0),
                                   std::vector<uint16_t>(frame.steps.size(), 65535), frame.steps};
  for (uint16_t& step : wrong[2]) step = uint16_t(step / 2);
  const Pixels black(frame.layers.size(), 0);
  for (uint32_t i = 0; i < 3; ++i) {
    SceneMemory::Depth depth = frame.depth();
    depth.rows = reinterpret_cast<const std::byte*>(wrong[i].data());
    EXPECT_TRUE(show(memory, {extent_of(frame.camera), upload(black)}, depth).empty());
    EXPECT_FALSE(found(memory).found);
    EXPECT_EQ(found(memory).frames_lost, i + 1);
    EXPECT_EQ(found(memory).blocks, blocks);
  }
  const Pixels after = show(memory, frame, frame.depth());
  ASSERT_FALSE(after.empty()) << "it is found again where it was";
  EXPECT_LT(match(after, frame).distance, match(before, frame).distance + 0.01);
}

TEST_F(SceneMemoryTest, PicturesMayHaveAnotherSize) {
  SceneMemory memory(device, extent_of(around(0)), params());
  const Frame frame = seen_by(around(0));
  const Extent size{320, 240}, small = extent_of(frame.camera);
  Pixels layers;
  for (uint32_t y = 0; y < size.height; ++y)
    for (uint32_t x = 0; x < size.width; ++x) {
      const auto from = frame.layers.begin() + 4 * (y / 2 * small.width + x / 2);
      layers.insert(layers.end(), from, from + 4);
    }
  const Plane large{size, upload(layers)};
  show(memory, large, frame.depth());
  const Match m = match(show(memory, large, frame.depth()), frame);
  EXPECT_LT(m.distance, 0.06);
  EXPECT_GT(m.share, 0.9);
}

// At its bound it goes on with what it has.
TEST_F(SceneMemoryTest, CountsWhatFindsNoMemory) {
  SceneMemory::Params few = params();
  few.volume.blocks = 64;
  SceneMemory memory(device, extent_of(around(0)), few);
  const Frame frame = seen_by(around(0));
  show(memory, frame, frame.depth());
  EXPECT_EQ(found(memory).blocks, 64U);
  EXPECT_GT(found(memory).blocks_refused, 0U);
}

}  // namespace
}  // namespace inverse::testing
