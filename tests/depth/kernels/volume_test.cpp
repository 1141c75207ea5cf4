// SPDX-License-Identifier: LGPL-2.1-or-later
// The volume against its specification, and against the scene that it was made from.
#include "kernels/depth/volume.hpp"

#include <Eigen/Geometry>
#include <random>

#include "tests/depth/kernels/volume_fixture.hpp"

namespace inverse::testing {
namespace {

constexpr Volume::Params kParams{.voxel = 0.02F, .blocks = 8192};

reference::Volume specified(const Volume::Params& params) {
  return {.voxel = double{params.voxel},
          .truncation = double{params.truncation} * double{params.voxel},
          .max_depth = double{params.max_depth},
          .memory = double{params.memory},
          .blocks = {}};
}

std::vector<Camera> walk(int count) {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double t = 0.4 * i;
    cameras.push_back(camera_at(
        160, 120, {0.5 * std::sin(t) - 0.2, 0.2 + 0.1 * std::cos(2 * t), 0.15 * std::cos(t)},
        {0.1 * std::cos(t) - 0.2, 0.6, 2}));
  }
  return cameras;
}

using VolumeTest = VolumeFixture;

TEST_F(VolumeTest, AgreesWithSpecification) {
  Volume volume(device, kParams);
  reference::Volume expected = specified(kParams);
  for (const Camera& camera : walk(4)) {
    const Seen seen = look(camera);
    const reference::Plane surface = reference::normals(camera, seen.depth);
    integrate(volume, camera, surface, seen.layers);
    expected.allocate(camera, surface);
    expected.integrate(camera, surface, seen.layers);
  }
  const auto keys = words(volume.keys()), voxels = words(volume.voxels()),
             colors = words(volume.colors()), colored_of = words(volume.colored());
  size_t blocks = 0, missing = 0, count = 0, off = 0, weights = 0, colored = 0, off_color = 0;
  for (size_t b = 0; b < keys.size(); ++b) {
    if (keys[b] == 0xffffffff) continue;
    ++blocks;
    uint32_t with_color = 0;
    for (size_t n = 0; n < 512; ++n) with_color += colors[1024 * b + 512 + n] >> 16 > 0;
    EXPECT_EQ(colored_of[b], with_color);
    const auto found = expected.blocks.find(
        {int(keys[b] & 2047) - 1024, int(keys[b] >> 22) - 512, int(keys[b] >> 11 & 2047) - 1024});
    if (found == expected.blocks.end()) {
      ++missing;  // rounding moved a place into it
      continue;
    }
    for (size_t n = 0; n < 512; ++n) {
      const reference::Voxel& v = found->second[n];
      const uint32_t word = voxels[512 * b + n];
      const double distance = std::max(double(int16_t(word & 0xffff)) / 32767, -1.0);
      ++count;
      // A pixel beside the one that is meant has another depth.
      off += std::abs(distance - v.distance) > 2e-3;
      weights += (word >> 16 & 255) != v.weight;
      if (v.sure == 0) continue;
      ++colored;
      const uint32_t c[] = {colors[1024 * b + n], colors[1024 * b + 512 + n]};
      const double red = -7 + 8.5 * (c[0] & 0xffff) / 65535.0,
                   blue = -7 + 8.5 * (c[1] & 0xffff) / 65535.0;
      off_color += std::abs(red - v.color[0]) > 2e-3 || std::abs(blue - v.color[2]) > 2e-3 ||
                   std::abs((c[1] >> 16) / 65535.0 - v.sure) > 1e-3;
    }
  }
  EXPECT_GT(blocks, 500U);
  EXPECT_NEAR(double(blocks), double(expected.blocks.size()), 0.01 * double(blocks));
  EXPECT_LE(missing, blocks / 100);
  EXPECT_LE(off, count / 200);
  EXPECT_LE(weights, count / 200);
  EXPECT_GT(colored, 20 * blocks);
  EXPECT_LE(off_color, colored / 100);

  const Camera camera = camera_at(80, 60, {0.1, 0.25, 0.05}, {-0.1, 0.6, 2});
  Volume::View view(device, extent_of(camera));
  const auto pose = pose_of(camera);
  run([&](gpu::Commands& commands) { volume.record_march(commands, lens_of(camera), pose, view); });
  const Pixels depth = download(view.depth);
  size_t both = 0, one = 0, same = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const double found = double{depth[size_t(y) * size_t(camera.width) + size_t(x)]},
                   meant = expected.march(camera, x, y, 0.5, 4);
      one += (found > 0) != (meant > 0);
      both += found > 0 && meant > 0;
      same += found > 0 && meant > 0 && std::abs(found - meant) < 0.1 * double{kParams.voxel};
    }
  EXPECT_GT(both, depth.size() * 9 / 10);
  EXPECT_LT(one, depth.size() / 30);
  EXPECT_GT(same, both * 95 / 100);
}

// A view is rendered anew where the camera has moved by more than it may, or the scene changed.
TEST_F(VolumeTest, KeepsAViewThatNothingChanges) {
  Volume volume(device, kParams);
  const auto add = [&](const Camera& camera) {
    const Seen seen = look(camera);
    integrate(volume, camera, reference::normals(camera, seen.depth), seen.layers);
  };
  Camera before = walk(1)[0];
  add(before);
  Volume::View view(device, extent_of(before));
  const auto renders = [&](const Camera& camera) {
    const auto pose = pose_of(camera);
    run([&](gpu::Commands& commands) {
      volume.record_march(commands, lens_of(camera), pose, view);
    });
    return words(view.outdated)[0] == 1;
  };
  EXPECT_TRUE(renders(before));
  EXPECT_FALSE(renders(before));
  const double turn = 0.5 / std::max(before.fx, before.fy), shift = double{kParams.voxel} / 3;
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  int kept = 0;
  for (int i = 0; i < 60; ++i) {
    // By about as much as it may, about any axis.
    const double by = i % 3 == 0 ? 1e-3 : std::exp(0.4 * normal(engine));
    if (std::abs(by - 1) < 0.02) continue;  // within rounding of single precision
    Eigen::Vector3d axis(normal(engine), normal(engine), normal(engine)),
        way(normal(engine), normal(engine), normal(engine));
    Camera camera = before;
    const Eigen::Quaterniond was(before.rotation[3], before.rotation[0], before.rotation[1],
                                 before.rotation[2]),
        now = Eigen::AngleAxisd(i % 2 ? by * turn : 0, axis.normalized()) * was;
    const double sign = i % 5 == 0 ? -1 : 1;  // the same turn
    camera.rotation = {sign * now.x(), sign * now.y(), sign * now.z(), sign * now.w()};
    for (size_t c = 0; c < 3; ++c)
      camera.place[c] += (i % 2 ? 0 : by * shift) * way.normalized()[Eigen::Index(c)];
    const bool moved = reference::elsewhere(camera, before, turn, shift);
    EXPECT_EQ(renders(camera), moved) << i << ' ' << by;
    if (moved)
      before = camera;
    else
      ++kept;
  }
  EXPECT_GT(kept, 20);
  EXPECT_LT(kept, 55);
  Camera far = before;
  far.place = {1e30, 0, 0};
  EXPECT_TRUE(renders(far));
  far.place[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(renders(far)) << "of a pose that is no number nothing is kept";
  EXPECT_TRUE(renders(before));
  add(walk(2)[1]);
  EXPECT_TRUE(renders(before)) << "the scene has changed";
  EXPECT_FALSE(renders(before));
  before.fx *= 1.1;
  EXPECT_TRUE(renders(before)) << "the lens has changed";
}

TEST_F(VolumeTest, ShowsWhatItHasSeen) {
  Volume volume(device, kParams);
  const std::vector<Camera> cameras = walk(6);
  for (const Camera& camera : cameras) {
    const Seen seen = look(camera);
    integrate(volume, camera, reference::normals(camera, seen.depth), seen.layers);
  }
  const Camera camera = camera_at(120, 90, {0.1, 0.25, 0.05}, {-0.1, 0.6, 2});
  const Seen truth = look(camera);
  const reference::Plane normals = reference::normals(camera, truth.depth);
  Volume::View view(device, extent_of(camera));
  const auto pose = pose_of(camera);
  run([&](gpu::Commands& commands) { volume.record_march(commands, lens_of(camera), pose, view); });
  const Pixels depth = download(view.depth), surface = download(view.surface),
               reflectance = download(view.reflectance);
  size_t seen = 0, near = 0, facing = 0, colored = 0;
  for (size_t n = 0; n < depth.size(); ++n) {
    if (depth[n] <= 0) continue;
    ++seen;
    near += std::abs(double{depth[n]} - truth.depth[n]) < 0.5 * double{kParams.voxel};
    double cosine = 0, color = 0;
    for (size_t c = 0; c < 3; ++c) {
      cosine += double{surface[4 * n + c]} * normals.data[n][c];
      color = std::max(
          color, std::abs(double{reflectance[4 * n + c]} - std::log(truth.layers.data[n][c])));
    }
    facing += cosine > std::cos(0.2);
    colored += color < 0.1;
  }
  const double all = double(depth.size());
  EXPECT_GT(double(seen), 0.97 * all);
  EXPECT_GT(double(near), 0.94 * all);
  EXPECT_GT(double(facing), 0.92 * all);
  EXPECT_GT(double(colored), 0.85 * all);
}

// Poles of two to four pixels before a wall, at even and odd columns: each pixel of one is seen,
// though rays start from where those of every second pixel came near a surface. The view's own
// depths are told from the specification's.
TEST_F(VolumeTest, SeesWhatIsThin) {
  constexpr Volume::Params kFine{.voxel = 0.01F, .blocks = 8192};
  const Camera camera = camera_at(160, 120, {0, 0, 0}, {0, 0, 2});
  Seen seen = look(camera);
  const auto pole_at = [](int x) {
    for (int n = 0; n < 9; ++n)
      if (const int first = 8 + 17 * n; x >= first && x < first + 2 + n % 3) return true;
    return false;
  };
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      seen.depth[size_t(y * camera.width + x)] = pole_at(x) ? 1.2 : 1.8;
  const reference::Plane surface = reference::normals(camera, seen.depth);
  Volume volume(device, kFine);
  reference::Volume expected = specified(kFine);
  expected.allocate(camera, surface);
  for (int times = 0; times < 3; ++times) {
    integrate(volume, camera, surface, seen.layers);
    expected.integrate(camera, surface, seen.layers);
  }
  Volume::View view(device, extent_of(camera));
  const auto pose = pose_of(camera);
  run([&](gpu::Commands& commands) { volume.record_march(commands, lens_of(camera), pose, view); });
  const Pixels depth = download(view.depth);
  size_t poles = 0, missed = 0;
  for (int y = 8; y < camera.height - 8; ++y)
    for (int x = 0; x < camera.width; ++x) {
      if (!pole_at(x) || expected.march(camera, x, y, 0.5, 4) > 1.3) continue;
      ++poles;
      const float found = depth[size_t(y * camera.width + x)];
      missed += !(found > 1.1F && found < 1.3F);
    }
  EXPECT_GT(poles, 1500U);
  EXPECT_LE(missed, poles * 23 / 100);
}

TEST_F(VolumeTest, CountsWhatHasNoRoom) {
  const Camera camera = walk(1)[0];
  const Seen seen = look(camera);
  const reference::Plane surface = reference::normals(camera, seen.depth);
  Volume small(device, {.voxel = 0.02F, .blocks = 100});
  const auto state_of = [&](const Volume& volume) { return words(volume.state()); };
  using shaders::depth_allocate;
  integrate(small, camera, surface, seen.layers);
  auto state = state_of(small);
  EXPECT_EQ(state[depth_allocate::kFree], 0U);
  EXPECT_EQ(state[depth_allocate::kMade], 100U);
  EXPECT_GT(state[depth_allocate::kRefused], 100U);
  EXPECT_EQ(state[depth_allocate::kListed], 100U);
  run([&](gpu::Commands& commands) { small.record_clear(commands); });
  EXPECT_EQ(state_of(small)[depth_allocate::kFree], 100U);
  // 164 m from the origin the keys of blocks of 16 cm end.
  Camera far = camera;
  far.place[0] += 200;
  Volume volume(device, kParams);
  integrate(volume, far, surface, seen.layers);
  state = state_of(volume);
  EXPECT_GT(state[depth_allocate::kOutside], 1000U);
  EXPECT_EQ(state[depth_allocate::kMade], 0U);
  integrate(volume, camera, surface, seen.layers);
  state = state_of(volume);
  EXPECT_EQ(state[depth_allocate::kOutside], 0U);
  EXPECT_GT(state[depth_allocate::kMade], 300U);
}

TEST_F(VolumeTest, IgnoresDepthThatIsNone) {
  const Camera camera = walk(1)[0];
  const Seen seen = look(camera);
  constexpr double kBad[] = {0,
                             -1,
                             std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(),
                             1e30,
                             65.535};
  for (const double bad : kBad) {
    reference::Plane surface = reference::normals(camera, seen.depth);
    for (auto& p : surface.data) p[3] = bad;
    Volume volume(device, kParams);
    integrate(volume, camera, surface, seen.layers);
    const auto state = words(volume.state());
    EXPECT_EQ(state[shaders::depth_allocate::kFree], kParams.blocks) << bad;
    EXPECT_EQ(state[shaders::depth_allocate::kOutside], 0U) << bad;
  }
}

}  // namespace
}  // namespace inverse::testing
