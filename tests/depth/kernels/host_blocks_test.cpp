// SPDX-License-Identifier: LGPL-2.1-or-later
// Blocks of a volume that leave the device and come back.
#include "kernels/depth/streaming/host_blocks.hpp"

#include <map>

#include "tests/depth/kernels/volume_fixture.hpp"

namespace inverse::testing {
namespace {

constexpr size_t kVoxels = VolumeData::kBlockVoxels;

using Blocks = std::map<uint32_t, std::vector<uint32_t>>;  // voxels, then colors

Blocks blocks_of(const VolumeData& data) {
  Blocks blocks;
  for (size_t n = 0; n < data.keys.size(); ++n) {
    std::vector<uint32_t>& words = blocks[data.keys[n]];
    EXPECT_TRUE(words.empty()) << "twice";
    words.assign(&data.voxels[n * kVoxels], &data.voxels[n * kVoxels] + kVoxels);
    words.insert(words.end(), &data.colors[2 * n * kVoxels],
                 &data.colors[2 * n * kVoxels] + 2 * kVoxels);
  }
  return blocks;
}

reference::Voxel voxel_of(const std::vector<uint32_t>& block, size_t place) {
  const uint32_t first = block[kVoxels + place], second = block[2 * kVoxels + place];
  const auto log = [](uint32_t u) { return -7 + 8.5 * (u & 0xffff) / 65535.0; };
  return {double{VolumeData::distance_of(block[place])},
          double(VolumeData::weight_of(block[place])),
          {log(first), log(first >> 16), log(second)},
          (second >> 16) / 65535.0};
}

Camera toward(const Vec3& target) { return camera_at(160, 120, {-0.2, 0.2, 0.1}, target); }

class HostBlocksTest : public VolumeFixture {
 protected:
  static constexpr uint32_t kPool = 4096;

  void see(Volume& volume, const Camera& camera) {
    const Seen seen = look(camera);
    integrate(volume, camera, reference::normals(camera, seen.depth), seen.layers);
  }
  /// Frames that add nothing, of which the host believes that so many blocks are free.
  void move(HostBlocks& host, Volume& volume, const Camera& camera, uint32_t free_blocks,
            int frames, uint64_t strokes = 0) {
    const auto on_device = pose_of(camera);
    for (int i = 0; i < frames; ++i)
      run([&](gpu::Commands& commands) {
        host.record(commands, number_++, volume, {lens_of(camera), extent_of(camera), on_device},
                    {host_pose(camera), free_blocks}, strokes);
      });
  }
  VolumeData all(HostBlocks& host, const Volume& volume) {
    VolumeData data = volume.data();
    host.append_to(data);
    return data;
  }
  size_t on_device(const Volume& volume) { return volume.data().keys.size(); }

  const Camera ahead_ = toward({-0.2, 0.6, 2});
  /// Of all that it knows, the way there sees nothing.
  const Camera away_ = camera_at(160, 120, {20, 0, -20}, {40, 1, -30});
  uint64_t number_ = 0;
};

TEST_F(HostBlocksTest, LeaveAndComeBackAsTheyWere) {
  Volume volume(device, {.voxel = 0.02F, .blocks = kPool});
  HostBlocks host(device);
  see(volume, ahead_);
  const Blocks before = blocks_of(volume.data());
  ASSERT_GT(before.size(), 300U);
  move(host, volume, ahead_, 0, 40);
  EXPECT_EQ(host.size(), 0U) << "what is in sight stays";
  move(host, volume, away_, kPool, 8);
  EXPECT_EQ(host.size(), 0U) << "there is room";
  move(host, volume, away_, 0, 60);
  EXPECT_EQ(on_device(volume), 0U);
  EXPECT_EQ(host.size(), before.size());
  EXPECT_EQ(blocks_of(all(host, volume)), before);
  Volume::View view(device, extent_of(ahead_));
  const auto share_seen = [&] {
    const auto pose = pose_of(ahead_);
    run([&](gpu::Commands& commands) {
      volume.record_march(commands, lens_of(ahead_), pose, view);
    });
    const Pixels depth = download(view.depth);
    return double(std::ranges::count_if(depth, [](float z) { return z > 0; })) /
           double(depth.size());
  };
  EXPECT_EQ(share_seen(), 0);
  move(host, volume, ahead_, kPool, 60);
  EXPECT_GT(share_seen(), 0.95);
  EXPECT_EQ(host.size(), 0U);
  EXPECT_EQ(blocks_of(all(host, volume)), before);
  // In the middle of all moves, too, none is lost and none there twice.
  for (int i = 0; i < 12; ++i) {
    move(host, volume, i % 4 < 2 ? away_ : ahead_, i % 4 < 2 ? 0 : kPool, 1 + i % 3);
    EXPECT_EQ(blocks_of(all(host, volume)), before) << i;
  }
}

TEST_F(HostBlocksTest, BecomeOneWithWhatWasMadeAnew) {
  Volume volume(device, {.voxel = 0.02F, .blocks = kPool});
  HostBlocks host(device);
  see(volume, ahead_);
  const Blocks before = blocks_of(volume.data());
  move(host, volume, away_, 0, 60);
  ASSERT_EQ(on_device(volume), 0U);
  see(volume, toward({0.3, 0.5, 2}));
  see(volume, toward({0.1, 0.5, 2}));
  const Blocks anew = blocks_of(volume.data());
  move(host, volume, ahead_, kPool, 60);
  const Blocks after = blocks_of(all(host, volume));
  size_t both = 0;
  for (const auto& [key, words] : after) {
    const auto a = before.find(key), b = anew.find(key);
    ASSERT_TRUE(a != before.end() || b != anew.end());
    if (a == before.end() || b == anew.end()) {
      EXPECT_EQ(words, (a == before.end() ? b : a)->second);
      continue;
    }
    ++both;
    for (size_t i = 0; i < kVoxels; ++i) {
      const reference::Voxel expected =
                                 reference::merged(voxel_of(a->second, i), voxel_of(b->second, i)),
                             found = voxel_of(words, i);
      ASSERT_EQ(found.weight, expected.weight);
      ASSERT_NEAR(found.sure, expected.sure, 2e-5);
      if (expected.weight > 0) {
        ASSERT_NEAR(found.distance, expected.distance, 1e-4);
      }
      for (size_t c = 0; c < 3 && expected.sure > 0; ++c)
        ASSERT_NEAR(found.color[c], expected.color[c], 5e-4);
    }
  }
  EXPECT_GT(both, 200U);
  EXPECT_EQ(host.size(), 0U);
}

// The count of free blocks that the host has is old.
TEST_F(HostBlocksTest, StayOnTheHostWhereNoBlockIsFree) {
  Volume volume(device, {.voxel = 0.02F, .blocks = 700});
  HostBlocks host(device);
  see(volume, ahead_);
  const Blocks before = blocks_of(volume.data());
  move(host, volume, away_, 0, 60);
  const size_t left = host.size();
  ASSERT_EQ(left, before.size());
  // Fills the pool with another part of the room.
  see(volume, camera_at(160, 120, {-0.2, 0.2, 0.1}, {-2, 0.6, -2}));
  see(volume, camera_at(160, 120, {-0.2, 0.2, 0.1}, {2, 0.6, -2}));
  const size_t filled = on_device(volume);
  move(host, volume, ahead_, 700, 60);
  EXPECT_LE(on_device(volume), 700U);
  EXPECT_EQ(host.size() + on_device(volume) - filled, left) << "none is lost";
  EXPECT_GT(host.size(), 0U);
}

TEST_F(HostBlocksTest, DropStrokesThatHaveChanged) {
  for (const bool changed : {false, true}) {
    Volume volume(device, {.voxel = 0.02F, .blocks = kPool});
    HostBlocks host(device);
    see(volume, ahead_);
    VolumeData data = volume.data();
    for (uint32_t& word : data.voxels) word |= 7U << 24;
    volume.restore(data);
    number_ = 0;
    move(host, volume, away_, 0, 60, 1);
    move(host, volume, ahead_, kPool, 60, changed ? 2 : 1);
    ASSERT_EQ(host.size(), 0U);
    for (const uint32_t word : volume.data().voxels) ASSERT_EQ(word >> 24, changed ? 0U : 7U);
  }
}

TEST_F(HostBlocksTest, ThatAFileHasBeyondThePoolAreKept) {
  Volume volume(device, {.voxel = 0.02F, .blocks = kPool});
  see(volume, ahead_);
  VolumeData data = volume.data();
  const Blocks before = blocks_of(data);
  HostBlocks host(device);
  host.take_rest(data, 100);
  EXPECT_EQ(data.keys.size(), 100U);
  volume.restore(data);
  EXPECT_EQ(host.size(), before.size() - 100);
  EXPECT_EQ(blocks_of(all(host, volume)), before);
}

TEST_F(HostBlocksTest, NoMoreLeaveOnceTheHostHasEnough) {
  constexpr uint32_t kSmall = 700;
  Volume volume(device, {.voxel = 0.02F, .blocks = kSmall});
  HostBlocks host(device);
  see(volume, ahead_);
  const size_t there = on_device(volume), enough = HostBlocks::kMaxPools * kSmall;
  VolumeData elsewhere{.voxel = 0.02F, .truncation = 4};
  for (size_t n = 0; n < enough; ++n)
    elsewhere.keys.push_back(VolumeData::key_of({int(n % 1000), 500, int(n / 1000) - 900}));
  elsewhere.voxels.resize(enough * kVoxels);
  elsewhere.colors.resize(2 * enough * kVoxels);
  host.take_rest(elsewhere, 0);
  ASSERT_EQ(host.size(), enough);
  move(host, volume, away_, 0, 20);
  EXPECT_EQ(host.size(), enough);
  EXPECT_EQ(on_device(volume), there);
}

}  // namespace
}  // namespace inverse::testing
