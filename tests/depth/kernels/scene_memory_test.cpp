// SPDX-License-Identifier: LGPL-2.1-or-later
// What is remembered of a scene along known paths.
#include "kernels/depth/memory/scene_memory.hpp"

#include <cmath>
#include <random>

#include "tests/depth/kernels/volume_fixture.hpp"
#include "tests/depth/reference/memory.hpp"

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

  static Camera turning(double t) {
    return camera_at(160, 120, {0.4 * t - 0.2, 0.2, 0}, {2 * t - 1, 0.5, 1.8});
  }
  /// With every second pixel, from the second on.
  static Camera thinned(Camera camera) {
    camera.fx /= 2, camera.fy /= 2;
    camera.cx = (camera.cx - 1) / 2, camera.cy = (camera.cy - 1) / 2;
    camera.width /= 2, camera.height /= 2;
    return camera;
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
    return memory.findings(number_ - 1).value();
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
    depth.pose = host_pose(frame.camera);
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

// It is tracked on before the host hears that it was lost, and stays where it is.
TEST_F(SceneMemoryTest, OneBadFrameDoesNotMoveTheCamera) {
  SceneMemory::Params with = params();
  with.keyframes = 1;  // the first frame, from which it cannot be found
  SceneMemory memory(device, extent_of(turning(0)), with);
  for (int i = 0; i < 40; ++i) {
    const Frame frame = seen_by(turning(0.025 * i));
    SceneMemory::Depth depth = frame.depth();
    if (i == 0) depth.pose = host_pose(frame.camera);
    const std::vector<uint16_t> nothing(frame.steps.size(), 0);
    if (i == 30) depth.rows = reinterpret_cast<const std::byte*>(nothing.data());
    const Pixels known = show(memory, frame, depth);
    EXPECT_EQ(found(memory).found, i != 30) << i;
    if (i > 30) {
      EXPECT_LT(match(known, frame).distance, 0.06) << i;
    }
  }
}

// After a jump to where it was long before, farther than it can be followed.
TEST_F(SceneMemoryTest, FindsALostCameraByItsKeyframes) {
  for (const uint32_t keyframes : {0U, 64U}) {
    SceneMemory::Params with = params();
    with.keyframes = keyframes;
    SceneMemory memory(device, extent_of(turning(0)), with);
    const Frame first = seen_by(turning(0));
    for (int i = 0; i <= 40; ++i) {
      const Frame frame = seen_by(turning(0.025 * i));
      SceneMemory::Depth depth = frame.depth();
      if (i == 0) depth.pose = host_pose(frame.camera);
      show(memory, frame, depth);
    }
    ASSERT_TRUE(found(memory).found);
    const std::vector<uint16_t> nothing(first.steps.size(), 0);
    SceneMemory::Depth blind = first.depth();
    blind.rows = reinterpret_cast<const std::byte*>(nothing.data());
    for (int i = 0; i < 4; ++i) show(memory, first, blind);
    Pixels known;
    for (int i = 0; i < 40 && known.empty(); ++i) known = show(memory, first, first.depth());
    EXPECT_EQ(found(memory).found, keyframes > 0);
    if (keyframes == 0) continue;
    EXPECT_GT(found(memory).keyframes, 1U);
    for (int i = 0; i < 6; ++i) {
      known = show(memory, first, first.depth());
      ASSERT_FALSE(known.empty()) << "it stays found";
    }
    EXPECT_LT(match(known, first).distance, 0.08);
    EXPECT_GT(match(known, first).share, 0.9);
  }
}

// After a seek the scene is the same, and the camera elsewhere in it.
TEST_F(SceneMemoryTest, LooksForTheCameraAfterASeek) {
  for (const bool posed : {false, true}) {
    SceneMemory memory(device, extent_of(turning(0)), params());
    const Frame first = seen_by(turning(0));
    EXPECT_FALSE(memory.look_for_camera()) << "nothing is known yet";
    for (int i = 0; i <= 40; ++i) {
      const Frame frame = seen_by(turning(0.025 * i));
      SceneMemory::Depth depth = frame.depth();
      if (i == 0) depth.pose = host_pose(frame.camera);
      show(memory, frame, depth);
    }
    const uint32_t blocks = found(memory).blocks;
    EXPECT_TRUE(memory.look_for_camera());
    SceneMemory::Depth depth = first.depth();
    if (posed) depth.pose = host_pose(first.camera);
    int frames = 1;
    Pixels known = show(memory, first, depth);
    for (; frames < 40 && !found(memory).found; ++frames) known = show(memory, first, depth);
    EXPECT_LE(frames, posed ? 1 : 12);
    for (int i = 0; i < 4; ++i) known = show(memory, first, depth);
    ASSERT_TRUE(found(memory).found);
    EXPECT_LT(match(known, first).distance, 0.08);
    EXPECT_GE(found(memory).blocks, blocks);
  }
}

// A thing that comes before 55 % of the picture does not lose a camera; but one that is lost is not
// found by the rest.
TEST_F(SceneMemoryTest, ALostCameraNeedsMoreThanOneThatIsFollowed) {
  SceneMemory memory(device, extent_of(turning(0)), params());
  const Frame bare = seen_by(turning(0));
  Frame covered = bare;
  for (size_t i = 0; i < covered.steps.size(); ++i)
    if (i % 160 < 88) covered.steps[i] = uint16_t(0.4F / kUnit);
  SceneMemory::Depth depth = bare.depth();
  depth.pose = host_pose(bare.camera);
  show(memory, bare, depth);
  for (int i = 0; i < 8; ++i) show(memory, bare, bare.depth());
  memory.set_update(false);
  for (int i = 0; i < 8; ++i) {
    show(memory, covered, covered.depth());
    EXPECT_TRUE(found(memory).found) << i << ", of which matched " << found(memory).matched;
  }
  memory.look_for_camera();
  for (int i = 0; i < 16; ++i) {
    show(memory, covered, covered.depth());
    EXPECT_FALSE(found(memory).found) << i << ", of which matched " << found(memory).matched;
  }
  int frames = 0;
  for (; frames < 16 && !found(memory).found; ++frames) show(memory, bare, bare.depth());
  EXPECT_LT(frames, 12);
}

// What is out of sight leaves the device and comes back.
TEST_F(SceneMemoryTest, RemembersMoreThanTheDeviceHasRoomFor) {
  SceneMemory::Params small = params();
  small.volume.blocks = 1650;
  SceneMemory memory(device, extent_of(turning(0)), small);
  uint32_t most = 0, refused = 0;
  Pixels known;
  const auto walk = [&](int from, int to) {
    for (int i = from; i != to; i += to > from ? 1 : -1) {
      const Frame frame = seen_by(turning(0.03 * i));
      SceneMemory::Depth depth = frame.depth();
      if (i == 0 && from == 0) depth.pose = host_pose(frame.camera);
      known = show(memory, frame, depth);
      const SceneMemory::Findings now = found(memory);
      EXPECT_TRUE(now.found || i == from) << i;
      most = std::max(most, now.blocks + now.blocks_host);
      refused += now.blocks_refused;
    }
  };
  walk(0, 90);
  EXPECT_GT(most, small.volume.blocks + 100);
  const SceneData saved = memory.data();
  EXPECT_GT(saved.volume.keys.size(), small.volume.blocks + 100);
  walk(90, -1);
  EXPECT_LE(found(memory).blocks, small.volume.blocks);
  EXPECT_EQ(refused, 0U);
  const Frame first = seen_by(turning(0));
  EXPECT_LT(match(known, first).distance, 0.08);
  EXPECT_GT(match(known, first).share, 0.9);
  // A file of it is not too large for the same pool.
  SceneMemory other(device, extent_of(turning(0)), small);
  other.restore(saved);
  for (int i = 0; i < 60; ++i) known = show(other, first, first.depth());
  EXPECT_TRUE(found(other).found);
  EXPECT_GT(match(known, first).share, 0.9);
}

// What a camera that stands still sees is known after a while; what changes, or comes into sight,
// is added again.
TEST_F(SceneMemoryTest, AStillCameraAddsNoMore) {
  SceneMemory::Params with = params();
  with.still = 6;
  SceneMemory memory(device, extent_of(around(0)), with);
  const Frame frame = seen_by(around(0));
  int added = 0;
  for (int i = 0; i < 40; ++i) {
    show(memory, frame, frame.depth());
    added += found(memory).added;
  }
  EXPECT_GE(added, 6);
  // The first frame has nothing to match, which the host hears some frames later.
  EXPECT_LE(added, 7 + int(gpu::kFramesInFlight));
  EXPECT_FALSE(found(memory).added);
  EXPECT_TRUE(found(memory).view_kept);
  // A thing in front of a quarter of the picture.
  std::vector<uint16_t> steps = frame.steps;
  for (size_t i = 0; i < steps.size(); ++i)
    if (i % 160 < 40) steps[i] = uint16_t(0.7F / kUnit);
  SceneMemory::Depth changed = frame.depth();
  changed.rows = reinterpret_cast<const std::byte*>(steps.data());
  added = 0;
  for (int i = 0; i < 12; ++i) {
    show(memory, frame, changed);
    added += found(memory).added;
  }
  EXPECT_GT(added, 1);
  for (int i = 0; i < 30; ++i) show(memory, frame, changed);
  EXPECT_FALSE(found(memory).added);
  added = 0;
  for (int i = 1; i < 16; ++i) {
    const Frame next = seen_by(around(0.04 * i));
    show(memory, next, next.depth());
    added += found(memory).added;
  }
  EXPECT_GT(added, 3);
}

TEST_F(SceneMemoryTest, WhatIsFrozenOrInFrontIsNotAdded) {
  const Frame frame = seen_by(around(0));
  std::vector<uint16_t> steps = frame.steps;
  for (size_t i = 0; i < steps.size(); ++i)
    if (i % 160 < 40) steps[i] = uint16_t(0.7F / kUnit);
  SceneMemory::Depth hidden = frame.depth();
  hidden.rows = reinterpret_cast<const std::byte*>(steps.data());
  enum class How { adds, frozen, touch };
  for (const How how : {How::adds, How::frozen, How::touch}) {
    SceneMemory memory(device, extent_of(around(0)), params());
    memory.set_update(how != How::frozen);
    EXPECT_FALSE(memory.known());
    if (how == How::frozen) {
      EXPECT_TRUE(show(memory, frame, frame.depth()).empty()) << "nothing is known";
      EXPECT_FALSE(memory.known());
      memory.set_update(true);
    }
    for (int i = 0; i < 4; ++i) show(memory, frame, frame.depth());
    ASSERT_TRUE(memory.known());
    const uint32_t blocks = found(memory).blocks;
    EXPECT_FALSE(found(memory).front) << "it was not looked for";
    memory.set_update(how != How::frozen);
    memory.set_touch(how == How::touch);
    for (int i = 0; i < 4; ++i) show(memory, frame, hidden);
    EXPECT_TRUE(found(memory).found);
    EXPECT_EQ(found(memory).blocks > blocks, how == How::adds) << int(how);
    EXPECT_EQ(found(memory).added, how != How::frozen);
    if (how != How::touch) continue;
    EXPECT_NEAR(found(memory).front.value(), 0.25, 0.03);
  }
}

TEST_F(SceneMemoryTest, KernelsAgreeWithReference) {
  gpu::Program<shaders::depth_memory_read_depth> read(device);
  gpu::Program<shaders::depth_memory_resize> resize(device);
  gpu::Program<shaders::depth_memory_thumbnail> thumbnail(device);
  gpu::Program<shaders::depth_memory_keep_found> keep(device);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const Extent extent : {Extent{1, 1}, Extent{5, 3}, Extent{80, 60}, Extent{131, 67}}) {
    const auto pixels = uint32_t(extent.pixels());
    std::vector<uint16_t> steps(pixels + pixels % 2);
    for (uint16_t& step : steps)
      step = uint16_t(random() % 8 == 0 ? 0xffff * (random() % 2) : random());
    Pixels brightness;
    reference::Plane plane(int(extent.width), int(extent.height));
    for (uint32_t i = 0; i < pixels; ++i) brightness.push_back(6 * unit(random) - 7);
    for (auto& p : plane.data)
      for (double& v : p) v = double{unit(random)};
    const Extent other{extent.width / 2 + 1, extent.height * 3};
    const auto image = upload(gpu::Element::word, steps.data(), steps.size() / 2),
               bright = upload(gpu::Element::scalar, brightness.data(), pixels),
               from = upload(to_pixels(plane)), lost = upload(Pixels(16, 0)),
               depth = gpu::Buffer::create(device, gpu::Element::scalar, pixels),
               kept = gpu::Buffer::create(device, gpu::Element::scalar, pixels),
               resized = gpu::Buffer::create(device, gpu::Element::vec4, other.pixels()),
               cells = gpu::Buffer::create(device, gpu::Element::vec4, 16 * 12);
    run([&](gpu::Commands& commands) {
      commands.dispatch(read, {.image = image, .depth = depth}, {.pixels = pixels, .unit = kUnit},
                        pixels);
      commands.dispatch(keep, {.depth = depth, .found = lost, .kept = kept}, {.pixels = pixels},
                        pixels);
      commands.dispatch(resize, {.plane = from, .resized = resized}, {.from = extent, .to = other},
                        uint32_t(other.pixels()));
      commands.dispatch(thumbnail, {.brightness = bright, .depth = depth, .thumbnail = cells},
                        {.size = extent}, 16 * 12);
    });
    steps.resize(pixels);
    const std::vector<double> meters = reference::read_depth(steps, double{kUnit});
    const Pixels got_depth = download(depth), got_kept = download(kept), got = download(resized),
                 got_cells = download(cells);
    for (uint32_t i = 0; i < pixels; ++i) {
      ASSERT_NEAR(double{got_depth[i]}, meters[i], 1e-5) << i;
      ASSERT_EQ(got_kept[i], 0);
    }
    const reference::Plane expected = reference::resize(plane, int(other.width), int(other.height));
    for (size_t i = 0; i < got.size(); ++i)
      ASSERT_NEAR(double{got[i]}, expected.data[i / 4][i % 4], 1e-5) << i;
    const auto cell =
        reference::thumbnail(int(extent.width), int(extent.height),
                             std::vector<double>(brightness.begin(), brightness.end()), meters);
    for (size_t i = 0; i < cell.depth.size(); ++i) {
      ASSERT_NEAR(double{got_cells[4 * i]}, cell.brightness[i], 1e-4) << i;
      ASSERT_NEAR(double{got_cells[4 * i + 1]}, cell.depth[i], 1e-3) << i;
    }
  }
}

TEST_F(SceneMemoryTest, WhatAFrameSeesAgreesWithReference) {
  gpu::Program<shaders::depth_memory_see> see(device);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> unit(0, 1);
  const float extremes[] = {0, -1, 1e-30F, 1e30F, kInf, kNan, 100};
  constexpr uint32_t kPixels = 4000;
  Pixels view, measured;
  for (uint32_t n = 0; n < kPixels; ++n) {
    const float z = 0.3F + 5 * unit(random);
    for (Pixels* to : {&view, &measured}) {
      const bool normal = random() % 8 > 0;
      for (int c = 0; c < 3; ++c) to->push_back(normal ? unit(random) - 0.5F : 0);
      const float off = to == &view ? 0 : 0.3F * unit(random) * unit(random);
      to->push_back(random() % 6 > 0 ? z + off : extremes[random() % std::size(extremes)]);
    }
  }
  const Pixels camera{.1F, .2F, .3F, .9F, 4, 5, 6, 0};
  for (const float found : {1.F, 0.F}) {
    const auto surface = buffer(kPixels), pose = buffer(3);
    const auto there = upload(view), here = upload(measured), at = upload(camera),
               state = upload(Pixels{found, 0, 0, 0});
    run([&](gpu::Commands& commands) {
      commands.dispatch(see,
                        {.view = there,
                         .measured = here,
                         .camera = at,
                         .found = state,
                         .surface = surface,
                         .pose = pose},
                        {.pixels = kPixels}, kPixels);
    });
    Pixels expected = camera;
    expected.insert(expected.end(), {found, 0, 0, 0});
    EXPECT_EQ(download(pose), expected);
    const Pixels got = download(surface);
    size_t off = 0;
    for (uint32_t n = 0; n < kPixels; ++n) {
      const reference::Vec4 meant =
          found > 0 ? reference::seen_surface(pixel_of(view, n), pixel_of(measured, n))
                    : reference::Vec4{};
      for (size_t c = 0; c < 4; ++c)
        if (double{got[4 * n + c]} != meant[c]) ++off;
    }
    EXPECT_LE(off, 8U) << "but for rounding at the limit";
  }
}

// Frames wait for who reads them while the memory goes on.
TEST_F(SceneMemoryTest, WhatAFrameSeesStays) {
  SceneMemory memory(device, extent_of(around(0)), params());
  std::vector<std::shared_ptr<const SeenScene>> seen;
  std::vector<Pixels> surfaces;
  const Frame other = seen_by(around(3));
  for (int i = 0; i < 6; ++i) {
    const Frame frame = seen_by(around(0.04 * i));
    // The last one is elsewhere, too far away to be followed there.
    const SceneMemory::Depth depth = i < 5 ? frame.depth() : other.depth();
    show(memory, frame, depth);
    run([&](gpu::Commands& commands) { seen.push_back(memory.record_seen(commands)); });
    ASSERT_NE(seen.back(), nullptr);
    surfaces.push_back(download(seen.back()->surface));
    const Pixels pose = download(seen.back()->pose);
    EXPECT_EQ(pose[8], found(memory).found ? 1 : 0);
    const Seen exact = look(frame.camera);
    size_t near = 0, all = 0;
    for (size_t n = 0; n < exact.depth.size(); ++n) {
      if (!(exact.depth[n] < 4)) continue;
      ++all;
      near += std::abs(double{surfaces.back()[4 * n + 3]} - exact.depth[n]) < 0.05;
    }
    if (found(memory).found) {
      EXPECT_GT(near, all * 9 / 10) << i;
    } else {
      EXPECT_EQ(surfaces.back(), Pixels(surfaces.back().size(), 0)) << i;
    }
  }
  EXPECT_FALSE(found(memory).found);
  for (size_t i = 0; i < seen.size(); ++i)
    EXPECT_EQ(download(seen[i]->surface), surfaces[i]) << "frame " << i;
}

TEST(KeyframesTest, KeepsWhatIsNewAndFindsWhatIsAlike) {
  Keyframes keyframes(2);
  const auto picture = [](float bright, float depth) {
    Keyframes::Picture picture{std::vector<float>(12, 0), std::vector<float>(12, depth)};
    for (size_t i = 0; i < 6; ++i) picture.brightness[i] = bright;
    return picture;
  };
  const auto at = [](float x) {
    Pose pose;
    pose.place[0] = x;
    return pose;
  };
  keyframes.add(picture(0, 1), at(1));
  keyframes.add(picture(0.05F, 1), at(2));
  EXPECT_EQ(keyframes.size(), 1U) << "the second is like the first";
  keyframes.add(picture(0, 3), at(3));
  keyframes.add(picture(2, 0), at(4));
  EXPECT_EQ(keyframes.size(), 2U) << "there is no room";
  const auto like = keyframes.like(picture(0, 2.5F), 5);
  ASSERT_EQ(like.size(), 2U);
  EXPECT_EQ(like[0].place[0], 3);
  // Light that is brighter everywhere is no difference; depth that only one knows is.
  Keyframes::Picture lit = picture(0, 1);
  for (float& b : lit.brightness) b += 1;
  EXPECT_NEAR(Keyframes::distance(lit, picture(0, 1)), 0, 1e-6);
  EXPECT_NEAR(Keyframes::distance(picture(0, 0), picture(0, 1)), 0.5, 1e-6);
  EXPECT_NEAR(Keyframes::distance(picture(0, 1), picture(0, 1.1F)), 0.5 * (1 - 1 / 1.1) / 0.2,
              1e-5);
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

// Thinned out, it knows the same.
TEST_F(SceneMemoryTest, LargeDepthImagesAreThinnedOut) {
  SceneMemory::Params small = params();
  small.max_width = 80;
  SceneMemory memory(device, extent_of(around(0)), small);
  for (int i = 0; i < 6; ++i) {
    const Frame frame = seen_by(around(0.02 * i)), thin = seen_by(thinned(frame.camera));
    const Pixels known = show(memory, frame, frame.depth());
    if (i == 0) continue;
    ASSERT_EQ(known.size(), thin.layers.size());
    EXPECT_LT(match(known, thin).distance, 0.1) << i;
    EXPECT_GT(match(known, thin).share, 0.85) << i;
  }
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
