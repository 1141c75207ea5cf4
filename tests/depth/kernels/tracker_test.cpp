// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracking along known paths.
#include "kernels/depth/tracking/tracker.hpp"

#include <random>

#include "tests/depth/kernels/volume_fixture.hpp"
#include "tests/depth/reference/tracking.hpp"

namespace inverse::testing {
namespace {

using Path = Camera (*)(double t);

class TrackerTest : public VolumeFixture {
 protected:
  gpu::BufferPtr scalars(const std::vector<double>& values) {
    const Pixels floats(values.begin(), values.end());
    return upload(gpu::Element::scalar, floats.data(), floats.size());
  }
  /// The largest errors of the pose along a path, and whether it was found in every frame.
  struct Errors {
    double place = 0;  ///< meters
    double turn = 0;   ///< radians
    bool found = true;
  };

  Errors follow(Path path, Scene scene, const Tracker::Params& params) {
    Volume volume(device, {.voxel = 0.02F, .blocks = 8192});
    const Extent extent = extent_of(path(0));
    Tracker tracker(device, extent);
    Volume::View view(device, extent);
    Errors errors;
    for (int i = 0; i < 30; ++i) {
      const Camera camera = path(0.05 * i);
      const Lens lens = lens_of(camera);
      const Seen seen = look(camera, scene);
      const Pixels depth(seen.depth.begin(), seen.depth.end());
      const auto picture = upload(to_pixels(seen.layers)),
                 depths = upload(gpu::Element::scalar, depth.data(), depth.size()),
                 truth = pose_of(camera);
      run([&](gpu::Commands& commands) {
        tracker.record_frame(commands, lens, depths, picture);
        if (i == 0)
          tracker.record_pose(commands, truth);
        else
          tracker.record_align(commands, params);
        volume.record_integrate(commands, {lens, extent, tracker.pose(), depths, tracker.surface()},
                                picture, {});
        volume.record_march(commands, lens, tracker.pose(), view);
        tracker.record_target(commands, view, picture);
      });
      const Pixels pose = download(tracker.pose());
      double off = 0, same = 0;
      for (size_t c = 0; c < 3; ++c) off += std::pow(double{pose[4 + c]} - camera.place[c], 2);
      for (size_t c = 0; c < 4; ++c) same += double{pose[c]} * camera.rotation[c];
      errors.place = std::max(errors.place, std::sqrt(off));
      errors.turn = std::max(errors.turn, 2 * std::acos(std::min(1.0, std::abs(same))));
      errors.found = errors.found && (i == 0 || download(tracker.found())[0] == 1);
    }
    return errors;
  }
};

/// What reference::align compares, without normals: depth and ln brightness at a level.
struct Level {
  Camera camera;
  std::vector<double> depth, brightness;
  reference::Sight sight(const Camera& posed) const {
    Camera estimate = camera;
    estimate.rotation = posed.rotation, estimate.place = posed.place;
    return {estimate, reference::normals(camera, depth), brightness};
  }
};
/// The same at half of the size.
Level half_of(const Level& fine) {
  const Camera& c = fine.camera;
  Level half{{c.fx / 2, c.fy / 2, (c.cx + 0.5) / 2 - 0.5, (c.cy + 0.5) / 2 - 0.5, (c.width + 1) / 2,
              (c.height + 1) / 2, c.rotation, c.place},
             {},
             {}};
  reference::halve(c.width, c.height, fine.depth, fine.brightness, half.depth, half.brightness);
  return half;
}

Camera around(double t) {
  return camera_at(160, 120,
                   {0.5 * std::sin(t) - 0.2, 0.2 + 0.1 * std::cos(2 * t), 0.15 * std::cos(t)},
                   {0.1 * std::cos(t) - 0.2, 0.6, 2});
}

Camera along_a_wall(double t) {
  return camera_at(160, 120, {0.3 * t, 0.1 * std::sin(3 * t), 0.5},
                   {0.3 * t, 0.1 * std::sin(3 * t), 2});
}

// One step at each level, from a frame with holes and noise to a view of another pose.
TEST_F(TrackerTest, StepsAgreeWithReference) {
  const Camera view_camera = around(0.1), frame_camera = around(0.13), start = around(0.117);
  const Extent extent = extent_of(view_camera);
  const Lens lens = lens_of(view_camera);
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  const auto seen_by = [&](const Camera& camera) {
    Seen seen = look(camera);
    for (double& z : seen.depth) z = engine() % 16 == 0 ? 0 : z * (1 + 0.001 * normal(engine));
    return seen;
  };
  const Seen seen = seen_by(frame_camera), target = seen_by(view_camera);
  for (size_t level = 0; level < 3; ++level) {
    Tracker::Params params;
    params.steps = {};
    params.steps[level] = 1;
    Tracker tracker(device, extent);
    std::vector<double> depth =
                            reference::smooth(view_camera.width, view_camera.height, seen.depth),
                        brightness = reference::log_brightness(seen.layers),
                        view_depth = target.depth, view_brightness;
    // The view's reflectance is known but for squares, which look like the frame. Its light is a
    // little darker.
    Volume::View view(device, extent);
    Pixels reflectance, layers;
    for (size_t n = 0; n < target.depth.size(); ++n) {
      const auto& r = target.layers.data[n];
      const size_t x = n % extent.width, y = n / extent.width;
      const bool known = x / 16 % 4 > 0 || y / 16 % 3 > 0;
      for (size_t c = 0; c < 3; ++c) reflectance.push_back(float(std::log(r[c])));
      reflectance.push_back(known ? 0.5F : 0);
      layers.insert(layers.end(), {0, 0, 0, 0.95F});
      view_brightness.push_back(known ? std::log((r[0] + r[1] + r[2]) / 3 * double{0.95F})
                                      : brightness[n]);
    }
    view.depth = scalars(view_depth);
    view.surface = upload(to_pixels(reference::normals(view_camera, view_depth)));
    view.pose = pose_of(view_camera);
    view.reflectance = upload(reflectance);
    const auto depths = scalars(seen.depth), lit = upload(layers), view_pose = pose_of(view_camera),
               start_pose = pose_of(start), picture = upload(to_pixels(seen.layers));
    run([&](gpu::Commands& commands) {
      tracker.record_frame(commands, lens, depths, picture);
      tracker.record_pose(commands, view_pose);
      tracker.record_target(commands, view, lit);
      tracker.record_pose(commands, start_pose);
      tracker.record_align(commands, params);
    });
    Level frame{view_camera, depth, brightness}, model{view_camera, view_depth, view_brightness};
    for (size_t l = 0; l < level; ++l) frame = half_of(frame), model = half_of(model);
    const reference::Alignment expected =
        reference::align(frame.sight(start), model.sight(view_camera),
                         {double{params.max_distance[level]}, double{params.min_cosine},
                          double{params.photometric[level]}, double{params.damping}});
    const Pixels pose = download(tracker.pose());
    double moved = 0;
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(double{pose[4 + c]}, expected.camera.place[c], 2e-4) << level;
      moved = std::max(moved, std::abs(expected.camera.place[c] - start.place[c]));
    }
    for (size_t c = 0; c < 4; ++c)
      EXPECT_NEAR(double{pose[c]}, expected.camera.rotation[c], 2e-4) << level;
    EXPECT_GT(moved, 3e-3) << level;
    if (level > 0) continue;  // only the last step at full size reports
    const Pixels found = download(tracker.found());
    EXPECT_EQ(found[0], 1);
    EXPECT_NEAR(double{found[4]}, expected.rms, 1e-4);
    EXPECT_NEAR(double{found[5]}, expected.share, 2e-3);
  }
}

// A lost camera is found only where the frame looks like the view, unless that is plain.
TEST_F(TrackerTest, ALostCameraMustSeeWhatTheViewShows) {
  const Camera view_camera = along_a_wall(0), frame_camera = along_a_wall(0.02);
  const Extent extent = extent_of(view_camera);
  const Seen seen = look(frame_camera, Scene::wall), target = look(view_camera, Scene::wall);
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> any(0, 1);
  enum class Shown { same, other, plain };
  for (const Shown shown : {Shown::same, Shown::other, Shown::plain}) {
    // Light that falls off, and squares of paint.
    reference::Plane picture = seen.layers, known = target.layers;
    for (reference::Plane* plane : {&picture, &known})
      for (size_t n = 0; n < plane->size(); ++n) {
        const size_t x = n % extent.width, y = n / extent.width;
        const bool dark = (x / 12 + y / 12) % 2 == 0;
        const double light = plane == &picture ? 0.4 + 0.003 * double(x) : 1;
        const double paint = shown == Shown::plain ? 0.5 : dark ? 0.2 : 0.6;
        for (size_t c = 0; c < 3; ++c) plane->data[n][c] = paint * light;
      }
    if (shown == Shown::other)
      for (size_t n = 0; n < picture.size(); ++n)
        for (size_t c = 0; c < 3; ++c)
          picture.data[n][c] = n / extent.width / 8 % 2 == 0 ? 0.2 : 0.5 + 0.01 * any(engine);
    Volume::View view(device, extent);
    Pixels reflectance;
    for (const auto& r : known.data) {
      for (size_t c = 0; c < 3; ++c) reflectance.push_back(float(std::log(r[c])));
      reflectance.push_back(1);
    }
    view.depth = scalars(target.depth);
    view.surface = upload(to_pixels(reference::normals(view_camera, target.depth)));
    view.pose = pose_of(view_camera);
    view.reflectance = upload(reflectance);
    Tracker tracker(device, extent);
    const Pixels ones(4 * extent.pixels(), 1);
    const auto depths = scalars(seen.depth), lit = upload(ones), start = pose_of(frame_camera),
               frame = upload(to_pixels(picture));
    Tracker::Params params;
    params.steps = {1, 0, 0};
    run([&](gpu::Commands& commands) {
      tracker.record_frame(commands, lens_of(view_camera), depths, frame);
      tracker.record_pose(commands, start);
      tracker.record_target(commands, view, lit);
      tracker.record_lost(commands);
      tracker.record_align(commands, params);
    });
    const Pixels found = download(tracker.found());
    EXPECT_EQ(found[0], shown == Shown::other ? 0 : 1) << int(shown);
    // The same by the specification, at a quarter of the size.
    std::vector<double> view_brightness;
    for (const auto& r : known.data) view_brightness.push_back(std::log((r[0] + r[1] + r[2]) / 3));
    const Level of_frame{view_camera,
                         reference::smooth(view_camera.width, view_camera.height, seen.depth),
                         reference::log_brightness(picture)},
        of_view{view_camera, target.depth, view_brightness};
    const reference::Agreement expected = reference::agreement(
        half_of(half_of(of_frame)).sight(frame_camera),
        half_of(half_of(of_view)).sight(view_camera), double{params.max_distance[2]});
    const float* alike = &found[4 * size_t{shaders::depth_tracking_move::kAlike}];
    if (shown != Shown::plain) {
      EXPECT_NEAR(double{alike[0]}, expected.correlation, 5e-3) << int(shown);
    }
    EXPECT_NEAR(double{alike[1]}, expected.frame, 2e-3 + 0.01 * expected.frame);
    EXPECT_NEAR(double{alike[2]}, expected.view, 2e-3 + 0.01 * expected.view);
    EXPECT_NEAR(double{alike[3]}, expected.count, 0.01 * expected.count);
    EXPECT_GT(expected.count, 1000);
  }
}

TEST_F(TrackerTest, FollowsACamera) {
  const Errors errors = follow(around, Scene::room, {});
  EXPECT_TRUE(errors.found);
  EXPECT_LT(errors.place, 0.01);
  EXPECT_LT(errors.turn, 0.01);
}

// Without steps, the pose is where the search starts.
TEST_F(TrackerTest, StartsWhereTheMotionLeads) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> any(-1, 1);
  Tracker tracker(device, {32, 24});
  Tracker::Params params;
  params.steps = {};
  for (const double scale : {1e-6, 0.01, 1.0, 1e4}) {
    const auto random_camera = [&] {
      Camera camera = camera_at(32, 24, {scale * any(engine), scale * any(engine), any(engine)},
                                {any(engine), any(engine), scale + 2});
      return camera;
    };
    const Camera before = random_camera(), last = random_camera();
    const auto first = pose_of(before), second = pose_of(last);
    const Camera expected = reference::predict(before, last);
    for (const float found : {0.0F, 1.0F, 2.0F, 9.0F}) {
      const auto state = upload(Pixels{1, 0, found, 0});
      run([&](gpu::Commands& commands) {
        tracker.record_pose(commands, first);
        tracker.record_align(commands, params);
        tracker.record_pose(commands, second);
        commands.copy(state, tracker.found(), state->bytes());
        tracker.record_align(commands, params);
      });
      const Camera& start = found < 2 ? last : expected;
      const Pixels pose = download(tracker.pose());
      double same = 0;
      for (size_t c = 0; c < 4; ++c) same += double{pose[c]} * start.rotation[c];
      EXPECT_NEAR(std::abs(same), 1, 1e-5);
      for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(double{pose[4 + c]}, start.place[c], 1e-6 * (1 + scale)) << found;
    }
  }
}

TEST_F(TrackerTest, FollowsPaintWhereGeometrySlides) {
  Tracker::Params params;
  const Errors both = follow(along_a_wall, Scene::wall, params);
  params.photometric = {};
  const Errors geometry = follow(along_a_wall, Scene::wall, params);
  EXPECT_GT(geometry.place, 0.2);
  EXPECT_LT(both.place, 0.01);
  EXPECT_TRUE(both.found);
}

// Without a match the pose stays, and nothing becomes NaN.
TEST_F(TrackerTest, SaysThatItIsLost) {
  const Camera camera = around(0);
  const Extent extent = extent_of(camera);
  const Lens lens = lens_of(camera);
  const Seen seen = look(camera);
  const auto picture = upload(to_pixels(seen.layers)), start = pose_of(camera);
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const auto moved = [&](auto change) {
    std::vector<double> depth = seen.depth;
    for (size_t n = 0; n < depth.size(); ++n) depth[n] = change(depth[n], n);
    return depth;
  };
  const std::vector<double> frames[] = {
      std::vector<double>(seen.depth.size(), 0),
      std::vector<double>(seen.depth.size(), nan),
      std::vector<double>(seen.depth.size(), infinity),
      moved([](double z, size_t) { return 2 * z; }),
      // A few bad pixels do no harm.
      moved([&](double z, size_t n) { return n % 97 == 0   ? nan
                                             : n % 89 == 0 ? infinity
                                                           : z; }),
  };
  for (size_t i = 0; i < std::size(frames); ++i) {
    Volume volume(device, {.voxel = 0.02F, .blocks = 8192});
    Tracker tracker(device, extent);
    Volume::View view(device, extent);
    const auto good = scalars(seen.depth), depth = scalars(frames[i]);
    run([&](gpu::Commands& commands) {
      tracker.record_frame(commands, lens, good, picture);
      tracker.record_pose(commands, start);
      volume.record_integrate(commands, {lens, extent, tracker.pose(), good, tracker.surface()},
                              picture, {});
      volume.record_march(commands, lens, tracker.pose(), view);
      tracker.record_target(commands, view, picture);
      tracker.record_frame(commands, lens, depth, picture);
      tracker.record_align(commands, {});
    });
    const bool fine = i + 1 == std::size(frames);
    EXPECT_EQ(download(tracker.found())[0], fine ? 1 : 0) << i;
    const Pixels pose = download(tracker.pose()), before = download(start);
    for (size_t c = 0; c < 8; ++c)
      EXPECT_NEAR(double{pose[c]}, double{before[c]}, fine ? 2e-3 : 0) << i;
  }
}

}  // namespace
}  // namespace inverse::testing
