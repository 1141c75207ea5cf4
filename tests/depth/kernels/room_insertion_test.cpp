// SPDX-License-Identifier: LGPL-2.1-or-later
// An object in a remembered scene: the kernels against their specification, and what must hold of
// the whole.
#include "kernels/material/raster/room_insertion.hpp"

#include <set>

#include "kernels/material_raster_draw_room.spv.hpp"
#include "tests/depth/kernels/remembered_room.hpp"
#include "tests/material/reference/room.hpp"
#include "tests/reference/environment/lit_sphere.hpp"

namespace inverse::testing {
namespace {

using Room = shaders::material_raster_cast;
constexpr Extent kFrame{128, 96};

double dot3(const Vec3& a, const Vec3& b) { return reference::dot(a, b); }

/// An object and light on it: random directions, widths and fluxes, the first ones lamps.
struct Lit {
  reference::RoomObject object;
  std::vector<reference::Beam> beams;
  size_t lamps;
};
Lit random_light(unsigned seed, const Vec3& center, double radius, size_t count, size_t lamps) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> value(0, 1);
  Lit lit{{center, radius}, {}, lamps};
  const auto unit = [](Vec3 v) {
    const double length = std::sqrt(dot3(v, v));
    for (double& x : v) x /= length;
    return v;
  };
  for (size_t k = 0; k < count; ++k) {
    reference::Beam beam;
    beam.z = unit({normal(random), -std::abs(normal(random)) - .2, normal(random)});
    beam.x = unit({-beam.z[1], beam.z[0], 0});
    beam.y = {beam.z[1] * beam.x[2] - beam.z[2] * beam.x[1],
              beam.z[2] * beam.x[0] - beam.z[0] * beam.x[2],
              beam.z[0] * beam.x[1] - beam.z[1] * beam.x[0]};
    const double length = .6 + .4 * value(random);
    for (size_t c = 0; c < 3; ++c) beam.mean[c] = length * beam.z[c];
    beam.radius = .8 * value(random);
    beam.flux = value(random);
    lit.beams.push_back(beam);
  }
  return lit;
}

class RoomInsertionTest : public RememberedRoom {
 protected:
  /// The table `room` (room.glsl), for a picture of the whole frame.
  static Pixels table_of(const Lit& lit) {
    Pixels table;
    const auto add = [&](std::initializer_list<double> row) {
      for (const double v : row) table.push_back(float(v));
    };
    const auto& [x, y, z, w] = kCamera.rotation;
    add({x, y, z, w});
    add({kCamera.place[0], kCamera.place[1], kCamera.place[2], 0});
    add({0, 0, 0, 1});
    const auto& c = lit.object.center;
    add({c[0], c[1], c[2], lit.object.radius});
    add({0, 0, double(kCamera.width) / kFrame.width, double(kCamera.height) / kFrame.height});
    add({double(kCamera.width), double(kCamera.height), double(lit.beams.size()),
         double(lit.lamps)});
    for (const auto& b : lit.beams) {
      add({b.mean[0], b.mean[1], b.mean[2], b.flux});
      add({b.x[0], b.x[1], b.x[2], b.radius});
      add({b.y[0], b.y[1], b.y[2], 0});
      add({b.z[0], b.z[1], b.z[2], 0});
    }
    return table;
  }
  Pixels probes_of(const Lit& lit, const Volume& volume) {
    const gpu::Program<shaders::material_raster_probes> program(device);
    const auto room = upload(table_of(lit)), reached = buffer(2 * kProbes);
    run([&](gpu::Commands& commands) {
      commands.dispatch(
          program,
          {.room = room, .table = volume.table(), .voxels = volume.voxels(), .reached = reached},
          {.table_mask = volume.table_mask(),
           .voxel = kParams.voxel,
           .truncation = kParams.truncation * kParams.voxel},
          {kProbes});
    });
    return download(reached);
  }
  Pixels hidden_by(const Lit& lit, const Pixels& maps, const Pixels& surface, float softness) {
    const gpu::Program<shaders::material_raster_cast> program(device);
    const Extent grid = cast_extent();
    const auto hidden = buffer(grid.pixels());
    run([&](gpu::Commands& commands) {
      commands.dispatch(program,
                        {.room = upload(table_of(lit)),
                         .surface = upload(surface),
                         .maps = upload(maps),
                         .table = volume_->table(),
                         .voxels = volume_->voxels(),
                         .hidden = hidden},
                        {.lens = lens_of(kCamera).values(),
                         .size = extent_of(kCamera),
                         .table_mask = volume_->table_mask(),
                         .voxel = kParams.voxel,
                         .truncation = kParams.truncation * kParams.voxel,
                         .strength = 1,
                         .softness = softness},
                        {static_cast<uint32_t>(grid.pixels())});
    });
    return download(hidden);
  }
  static Extent cast_extent() {
    const Extent view = extent_of(kCamera);
    return {(view.width + Room::kCastStep - 1) / Room::kCastStep,
            (view.height + Room::kCastStep - 1) / Room::kCastStep};
  }
  /// The pixel of the view that shadows have at a place of theirs.
  static size_t cast_pixel(size_t i) {
    const Extent view = extent_of(kCamera), grid = cast_extent();
    return Room::kCastStep * (i / grid.width * view.width + i % grid.width);
  }

  static constexpr uint32_t kProbes = Room::kProbes * Room::kProbes * Room::kProbes;
};

/// Between the ball, the box and the camera; then half in the floor, around the ball, far away.
const std::vector<std::pair<Vec3, double>> kObjects{
    {{-.1, .75, 1.6}, .2}, {{-.1, .95, 1.4}, .15}, {{.3, .5, 1.4}, .3}, {{40, -30, 20}, 1}};

/// Maps of round and of ragged objects.
Pixels random_maps(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0, 1);
  constexpr size_t kSide = size_t{Room::kMapSide} * Room::kMapColumns;
  Pixels maps(8 * kSide * kSide);
  for (size_t y = 0; y < 2 * kSide; ++y)
    for (size_t x = 0; x < kSide; ++x) {
      float* map = &maps[4 * (y * kSide + x)];
      const float u = float(x % 64) + .5F - 32, v = float(y % 64) + .5F - 32,
                  left = 900 - u * u - v * v;
      if (x < 64)
        map[0] = left > 0 ? std::sqrt(left) : 0, map[1] = left > 0 ? 1 : 0;
      else if (left > 0 && value(random) < .7F)
        map[0] = 60 * value(random) - 30, map[1] = std::round(8 * value(random)) / 8;
    }
  return maps;
}

}  // namespace

TEST_F(RoomInsertionTest, ProbesAgreeWithSpecification) {
  size_t closed = 0, dark = 0;
  for (unsigned n = 0; n < kObjects.size(); ++n) {
    const Lit lit = random_light(n, kObjects[n].first, kObjects[n].second, 6, n == 3 ? 0 : 5);
    const Pixels got = probes_of(lit, *volume_);
    size_t off = 0, rays = 0;
    for (int i = 0; i < int(kProbes); ++i) {
      const auto expected = reference::probe(expected_, lit.object, lit.beams, lit.lamps, i);
      const float* first = &got[8 * size_t(i)];
      closed += !expected;
      // A ray that grazes a surface is counted either way.
      if (bool(expected) != (first[0] >= 0)) ++off;
      if (!expected || first[0] < 0) continue;
      for (size_t k = 0; k < 8; ++k, ++rays) {
        off += std::abs(double{first[k]} - (*expected)[k]) > 0.1;
        dark += (*expected)[k] < 0.5;
      }
    }
    EXPECT_LE(off, 8 + rays / 25) << n;
  }
  EXPECT_GT(closed, 20U);
  EXPECT_GT(dark, 100U);
  const Volume empty(device, kParams);
  for (const float v : probes_of(random_light(1, {0, 0, 1}, .3, 8, 8), empty)) ASSERT_EQ(v, 1);
}

TEST_F(RoomInsertionTest, ShadowsAgreeWithSpecification) {
  size_t in_shadow = 0;
  for (unsigned run = 0; run < 3 * kObjects.size(); ++run) {
    const auto& [center, radius] = kObjects[run % kObjects.size()];
    const Lit lit = random_light(10 + run, center, radius, run % 4 == 2 ? 16 : 5, 2);
    const Pixels maps = random_maps(run);
    const float softness = .1F * float(run % 3);
    const Pixels got = hidden_by(lit, maps, surface_, softness);
    const reference::Plane of_maps = to_reference(
        {Room::kMapSide * Room::kMapColumns, 2 * Room::kMapSide * Room::kMapRows}, maps);
    size_t off = 0, compared = 0;
    for (size_t n = 0; n < got.size() / 4; ++n) {
      const size_t i = cast_pixel(n);
      const auto seen = pixel_of(surface_, i);
      // Without a normal it is no surface.
      const bool known =
          seen[3] > 0 && seen[0] * seen[0] + seen[1] * seen[1] + seen[2] * seen[2] > .5;
      ASSERT_EQ(got[4 * n + 3], known ? surface_[4 * i + 3] : 0);
      if (!known) continue;
      Vec3 at = kCamera.ray(double(i % size_t(kCamera.width)), double(i / size_t(kCamera.width)));
      for (double& v : at) v *= seen[3];
      const double expected = reference::hidden_share(
          of_maps, lit.object, lit.beams, double{softness}, expected_, kCamera.to_world(at),
          kCamera.turned({seen[0], seen[1], seen[2]}));
      ++compared;
      in_shadow += expected > .1;
      // A tap beside the border of a pixel of the map, or a ray that grazes a surface.
      off += std::abs(double{got[4 * n]} - expected) > .03;
      ASSERT_GE(got[4 * n], 0);
      ASSERT_LE(got[4 * n], 1);
    }
    EXPECT_GT(compared, 500U);
    EXPECT_LE(off, compared / 50) << run;
  }
  EXPECT_GT(in_shadow, 300U);
}

TEST_F(RoomInsertionTest, SurfacesThatAreNoneHaveNoShadow) {
  Pixels broken = surface_;
  std::mt19937 random(3);
  const float extremes[] = {kNan, -kNan, kInf, -kInf, 0, -1, 1e30F, 1e-30F};
  for (size_t n = 0; n < broken.size(); n += 4)
    if (random() % 3 == 0) broken[n + random() % 4] = extremes[random() % std::size(extremes)];
  const Lit lit = random_light(4, kObjects[0].first, kObjects[0].second, 5, 2);
  const Pixels maps = random_maps(1), whole = hidden_by(lit, maps, surface_, .1F),
               got = hidden_by(lit, maps, broken, .1F);
  for (size_t n = 0; n < got.size(); n += 4) {
    const float* given = &broken[4 * cast_pixel(n / 4)];
    ASSERT_TRUE(got[n] >= 0 && got[n] <= 1);
    if (std::equal(given, given + 4, &surface_[4 * cast_pixel(n / 4)])) {
      ASSERT_EQ(got[n], whole[n]);
    }
    const float depth = given[3];
    if (!(depth > 0 && depth < 65504) || std::isnan(given[0])) {
      ASSERT_EQ(got[n + 3], 0);
    }
  }
}

TEST_F(RoomInsertionTest, LayersAgreeWithSpecification) {
  constexpr Extent kSize{50, 37};
  const gpu::Program<shaders::material_raster_insert> program(device);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> value(0, 1);
  for (int n = 0; n < 8; ++n) {
    const bool light = n & 1, slope = n & 2, extreme = n & 4;
    Pixels frame = random_pixels(kSize, 1), model = random_pixels(kSize, 2, 0.01F, 2),
           intrinsic = random_pixels(kSize, 3, 0.01F, 2), was = random_pixels(kSize, 4, .3F, 2),
           is = random_pixels(kSize, 5, .3F, 2), object = random_pixels({20, 15}, 6);
    for (size_t i = 0; i < object.size(); i += 4) {
      const float coverage = std::round(10 * object[i + 3] - 1) / 8;
      object[i + 3] = std::clamp(coverage, 0.F, 1.F);
      for (size_t c = 0; c < 3; ++c)
        object[i + c] *= object[i + 3] * (random() % 20 == 0 ? 300.F : 1.F);
    }
    const float extremes[] = {kNan, kInf, -kInf, 0, -1, 1e30F, 1e-30F};
    if (extreme)
      for (Pixels* pixels : {&frame, &model, &intrinsic, &was, &is})
        for (float& v : *pixels)
          if (random() % 10 == 0) v = extremes[random() % std::size(extremes)];
    const Pixels tone{.3F, -1.F, 1, 0};
    Pixels hidden(4 * kSize.pixels());
    for (size_t i = 0; i < hidden.size(); i += 4) {
      hidden[i] = random() % 2 ? 0 : value(random);
      hidden[i + 3] = 1 + value(random) * .001F;
    }
    const auto out_frame = buffer(kSize.pixels()), out_model = buffer(kSize.pixels()),
               out = buffer(kSize.pixels());
    run([&](gpu::Commands& commands) {
      commands.dispatch_rows(program,
                             {.frame = upload(frame),
                              .model = upload(model),
                              .intrinsic = upload(intrinsic),
                              .model_light = upload(was),
                              .light = upload(is),
                              .slope = upload(tone),
                              .picture = upload(object),
                              .hidden = upload(hidden),
                              .inserted_frame = gpu::by_rows(out_frame),
                              .inserted_model = gpu::by_rows(out_model),
                              .inserted = gpu::by_rows(out)},
                             {.size = kSize,
                              .view = kSize,
                              .window = {35, -4},
                              .window_size = {20, 15},
                              .step = 1,
                              .albedo = .4F,
                              .has_light = light ? 1U : 0U,
                              .has_slope = slope ? 1U : 0U,
                              .first_row = 0},
                             {kSize.width, kSize.height, shaders::material_raster_insert::kRows});
    });
    const Pixels got_frame = download(out_frame), got_model = download(out_model),
                 got = download(out);
    size_t covered = 0;
    for (size_t i = 0; i < kSize.pixels(); ++i) {
      const int x = int(i % kSize.width) - 35, y = int(i / kSize.width) + 4;
      reference::Vec4 over{};
      if (x >= 0 && x < 20 && y < 15) over = pixel_of(object, size_t(y * 20 + x));
      if (!(over[3] > 0)) {
        // All bits stay but those of S in shadow.
        ASSERT_EQ(memcmp(&got_frame[4 * i], &frame[4 * i], 16), 0);
        ASSERT_EQ(memcmp(&got_model[4 * i], &model[4 * i], 16), 0);
        ASSERT_EQ(memcmp(&got[4 * i], &intrinsic[4 * i], 12), 0);
        if (!(hidden[4 * i] > 0)) {
          ASSERT_EQ(memcmp(&got[4 * i], &intrinsic[4 * i], 16), 0);
        }
      }
      ++covered;
      for (size_t c = 0; c < 4 && over[3] > 0; ++c) {
        ASSERT_TRUE(got[4 * i + c] >= 0 && got[4 * i + c] <= 65504);
        ASSERT_TRUE(got_model[4 * i + c] >= 0 && got_model[4 * i + c] <= 65504);
        ASSERT_TRUE(std::isfinite(got_frame[4 * i + c]));
      }
      if (extreme) continue;
      reference::RoomPixel before;
      const auto three = [&](const Pixels& from) {
        const auto p = pixel_of(from, i);
        return Vec3{p[0], p[1], p[2]};
      };
      before.frame = three(frame);
      before.model = pixel_of(model, i);
      before.intrinsic = pixel_of(intrinsic, i);
      if (light) before.model_light = three(was), before.light = three(is);
      if (slope) before.slope = {double{tone[0]}, double{tone[1]}};
      const auto after = reference::inserted(before, over, double{.4F}, double{hidden[4 * i]});
      for (size_t c = 0; c < 4; ++c) {
        if (c < 3) {
          ASSERT_NEAR(got_frame[4 * i + c], after.frame[c], 1e-4 * (1 + after.frame[c]));
        }
        ASSERT_NEAR(got_model[4 * i + c], after.model[c], 1e-3 * (1 + after.model[c])) << n;
        ASSERT_NEAR(got[4 * i + c], after.intrinsic[c], 1e-3 * (1 + after.intrinsic[c])) << n;
      }
    }
    EXPECT_GT(covered, 100U);
  }
}

// Shadows at each second pixel are shown in between by distance, on one surface.
TEST_F(RoomInsertionTest, ShadowsAreInterpolated) {
  constexpr Extent kSize{50, 37}, kGrid{25, 19};
  const gpu::Program<shaders::material_raster_insert> program(device);
  const Pixels ones(4 * kSize.pixels(), 1);
  Pixels hidden(4 * kGrid.pixels());
  const auto share = [](double x, double y) { return .2 + .01 * x + .005 * y; };
  const auto depth = [](size_t x) { return x < 15 ? 1.F : 2.F; };
  for (size_t i = 0; i < kGrid.pixels(); ++i) {
    const size_t x = i % kGrid.width, y = i / kGrid.width;
    hidden[4 * i] = depth(x) == 1 ? float(share(2. * double(x), 2. * double(y))) : 0;
    hidden[4 * i + 3] = depth(x);
  }
  const auto white = upload(ones), out = buffer(kSize.pixels()), rest = buffer(kSize.pixels()),
             model = buffer(kSize.pixels());
  run([&](gpu::Commands& commands) {
    commands.dispatch_rows(program,
                           {.frame = white,
                            .model = white,
                            .intrinsic = white,
                            .model_light = white,
                            .light = white,
                            .slope = white,
                            .picture = white,
                            .hidden = upload(hidden),
                            .inserted_frame = gpu::by_rows(rest),
                            .inserted_model = gpu::by_rows(model),
                            .inserted = gpu::by_rows(out)},
                           {.size = kSize,
                            .view = kSize,
                            .window = {0, 0},
                            .window_size = {0, 0},
                            .step = 2,
                            .albedo = 1,
                            .has_light = 0,
                            .has_slope = 0,
                            .first_row = 0},
                           {kSize.width, kSize.height, shaders::material_raster_insert::kRows});
  });
  const Pixels got = download(out);
  for (size_t i = 0; i < kSize.pixels(); ++i) {
    const size_t x = i % kSize.width, y = i / kSize.width;
    if (x == 29) continue;  // half way between both surfaces
    // Those of one surface beside the other are not interpolated across.
    const double expected = x > 29 ? 0 : share(double(std::min<size_t>(x, 28)), double(y));
    ASSERT_NEAR(got[4 * i + 3], 1 - expected, 1e-5) << x << " " << y;
  }
}

// The object's picture: a ball among the scene's surfaces, under light that the scene keeps from
// it.
TEST_F(RoomInsertionTest, PicturesAgreeWithSpecification) {
  const Lit lit = random_light(7, {-.2, .85, 1.75}, .3, 6, 4);  // half behind the box, in the ball
  std::vector<reference::Probe> probes;
  Pixels reached;
  std::mt19937 random(2);
  std::uniform_real_distribution<float> value(0, 1);
  for (uint32_t i = 0; i < kProbes; ++i) {
    reference::Probe probe;
    if (random() % 4) {
      probe.emplace();
      for (double& v : *probe) v = double{value(random)};
    }
    for (size_t k = 0; k < 8; ++k) reached.push_back(probe ? float((*probe)[k]) : k ? 1 : -1);
    probes.push_back(probe);
  }
  LitSphere sphere(device);
  std::vector<float> rgb;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x)
      rgb.insert(rgb.end(), {static_cast<float>(y) / 16, static_cast<float>(x) / 32, .2F});
  sphere.set_light(Environment({64, 32}, rgb));
  const Mesh mesh = Mesh::sphere();
  Rasterizer rasterizer(device, mesh);
  const Plane picture = plane(kFrame);
  const Vec3 seen = kCamera.to_camera(lit.object.center);
  MeshView view;
  const float scale = float(kFrame.width) / float(kCamera.width);
  view.scale = float(lit.object.radius);
  view.x = float(seen[0]), view.y = float(-seen[1]), view.z = float(-seen[2]);
  view.lens = {float(kCamera.fx) * scale, float(kCamera.fy) * scale,
               (float(kCamera.cx) + .5F) * scale, (float(kCamera.cy) + .5F) * scale};
  run([&](gpu::Commands& commands) {
    sphere.record(commands, {{.8F, .5F, .3F}, 0, 2}, {});
    rasterizer.draw_in_room(commands, view, sphere.table(),
                            {upload(table_of(lit)), upload(surface_), upload(reached)}, picture);
  });
  const Pixels got = download(picture);
  const reference::Plane table = to_reference(sphere.table().extent, download(sphere.table()));
  size_t compared = 0, off = 0, whole = 0, none = 0, partly = 0;
  for (uint32_t y = 0; y < kFrame.height; ++y)
    for (uint32_t x = 0; x < kFrame.width; ++x) {
      // The ball exactly, and the scene at the four pixels of the view around this one.
      reference::Vec4 sum{};
      bool rim = false;
      for (const auto& point : reference::kSamplePoints) {
        const double u = x + point[0], v = y + point[1];
        const Vec3 ray{(u - double{view.lens[2]}) / double{view.lens[0]},
                       (v - double{view.lens[3]}) / double{view.lens[1]}, 1};
        const double a = dot3(ray, ray), b = dot3(ray, seen),
                     c = dot3(seen, seen) - lit.object.radius * lit.object.radius,
                     d = b * b - a * c;
        rim = rim ||
              std::abs(d) < .12 * b * b * lit.object.radius * lit.object.radius / dot3(seen, seen);
        if (d <= 0) continue;
        const double depth = (b - std::sqrt(d)) / a;
        Vec3 normal, at;
        for (size_t k = 0; k < 3; ++k) {
          at[k] = depth * ray[k];
          normal[k] = (at[k] - seen[k]) / lit.object.radius;
        }
        const double on_x = std::clamp((x + .5) / double{scale} - .5, 0., kCamera.width - 1.),
                     on_y = std::clamp((y + .5) / double{scale} - .5, 0., kCamera.height - 1.);
        double open = 0;
        for (int n = 0; n < 4; ++n) {
          const int px = std::min(int(on_x) + n % 2, kCamera.width - 1),
                    py = std::min(int(on_y) + n / 2, kCamera.height - 1);
          const double wx = on_x - int(on_x), wy = on_y - int(on_y);
          const double there = double{surface_[4 * size_t(py * kCamera.width + px) + 3]};
          const double noise = 0.0012 + 0.0019 * (there - 0.4) * (there - 0.4);
          if (!(there > 0) || depth <= there + noise)
            open += (n % 2 ? wx : 1 - wx) * (n / 2 ? wy : 1 - wy);
          if (std::abs(depth - there - noise) < .004) rim = true;
        }
        const Vec3 color = reference::lit_lookup(table, {normal[0], -normal[1], -normal[2]});
        const double share = reference::reached_share(probes, lit.object, lit.beams, lit.lamps,
                                                      kCamera.to_world(at), kCamera.turned(normal));
        for (size_t k = 0; k < 3; ++k) sum[k] += open * share * color[k] / 8;
        sum[3] += open / 8;
      }
      if (rim) continue;
      ++compared;
      whole += sum[3] > .999;
      none += sum[3] == 0;
      partly += sum[3] > 0 && sum[3] < .99;
      const float* pixel = &got[4 * (size_t{y} * kFrame.width + x)];
      bool good = std::abs(double{pixel[3]} - sum[3]) < .01;
      for (size_t k = 0; k < 3; ++k) good = good && std::abs(double{pixel[k]} - sum[k]) < .03;
      off += !good;
    }
  EXPECT_GT(whole, 100U);
  EXPECT_GT(none, 1000U);
  EXPECT_GT(partly, 10U);
  EXPECT_LE(off, compared / 200);
}

TEST_F(RoomInsertionTest, ObjectsStandAtTheirPlaceFromAllSides) {
  RoomInsertion insertion(device, kFrame);
  insertion.set_mesh(Mesh::sphere());
  LitSphere sphere(device, 32);
  sphere.set_light(Environment::uniform({1, 1, 1}));
  const RoomInsertion::Params params{.place = {-.05F, 1, 1.4F}, .size = .3F};
  const Vec3 center{-.05, .85, 1.4};
  const auto at = insertion.center(params);
  for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(double{at[c]}, center[c], 1e-3);
  for (const Camera& camera : {kCamera, camera_at(64, 48, {-.5, .3, .2}, {-.1, .7, 2}),
                               camera_at(64, 48, {.5, .1, .4}, {-.3, .8, 1.6})}) {
    const Pixels surface = seen_by(camera), white(4 * kFrame.pixels(), 1);
    Layers layers =
        intrinsic_layers(shared_plane(kFrame, white), shared_plane(kFrame, white), nullptr);
    layers.scene = scene(camera, surface, *volume_);
    run([&](gpu::Commands& commands) {
      insertion.record(commands, layers, host_pose(camera), params, sphere,
                       {{.25F, .25F, .25F}, 0, 2}, {});
    });
    const Pixels frame = download(layers[Role::input]),
                 intrinsic = download(layers[Role::intrinsic]),
                 model = download(layers[Role::model]);
    double count = 0, sx = 0, sy = 0, dark = 0, floor = 0;
    for (size_t y = 0; y < kFrame.height; ++y)
      for (size_t x = 0; x < kFrame.width; ++x) {
        const size_t i = 4 * (y * kFrame.width + x);
        if (frame[i] < .5F) {
          ++count;
          sx += double(x) + .5, sy += double(y) + .5;
          ASSERT_NEAR(model[i] * model[i + 3], frame[i], 2e-3);
          // All of the pixel: R is the albedo, and their product the color.
          if (frame[i] < .26F) {
            ASSERT_NEAR(intrinsic[i], .25, .05);
            ASSERT_NEAR(intrinsic[i] * intrinsic[i + 3], frame[i], 5e-3);
          }
        } else if (frame[i] == 1) {
          ASSERT_EQ(model[i + 3], 1);
          dark += intrinsic[i + 3] < .7F;
          ++floor;
        }
      }
    const Vec3 seen = camera.to_camera(center);
    EXPECT_GT(count, 150);
    EXPECT_NEAR(sx / count, 2 * (camera.fx * seen[0] / seen[2] + camera.cx + .5), 2);
    EXPECT_NEAR(sy / count, 2 * (camera.fy * seen[1] / seen[2] + camera.cy + .5), 2);
    EXPECT_GT(dark, .05 * count) << "its shadow";
    EXPECT_LT(dark, floor / 8);
  }
}

TEST_F(RoomInsertionTest, ExtremesAreFiniteAndPlanesOfOthersStay) {
  RoomInsertion insertion(device, kFrame);
  insertion.set_mesh(Mesh::sphere());
  LitSphere sphere(device, 32);
  sphere.set_light(Environment::studio());
  const Pixels before = random_pixels(kFrame, 3, .1F, 1);
  const PlanePtr shared = shared_plane(kFrame, before);
  const RoomInsertion::Params extremes[] = {
      {.place = {kNan, kInf, -kInf}, .size = kNan, .yaw = kInf, .shadow = kNan, .softness = -1},
      {.place = {.1F, .25F, .05F}, .size = .5F},  // around the camera
      {.place = {.1F, .25F, .05F}, .size = 100},
      {.place = {0, 1, -3}, .size = .3F},  // behind it
      {.place = {-.1F, .9F, 1.4F}, .size = 0},
      {.place = {-.1F, .9F, 1.4F}, .size = 1e-5F},
      {.place = {1e30F, 1e30F, 1e30F}, .size = 1e30F},
      {.place = {0, .3F, .1F}, .size = .08F, .shadow = 5, .softness = 9}};
  for (const auto& params : extremes)
    for (const float intensity : {1.F, 0.F, 1e30F}) {
      Layers layers = intrinsic_layers(shared, shared, nullptr);
      layers.scene = scene(kCamera, surface_, *volume_);
      Pose odd = host_pose(kCamera);
      for (float& v : odd.rotation) v *= 3;  // no unit quaternion
      run([&](gpu::Commands& commands) {
        insertion.record(commands, layers, odd, params, sphere, {{0, 0, 0}, 1, 1024},
                         {intensity, kNan, {{0, 0, 0, 0}, {}}});
      });
      EXPECT_EQ(download(shared), before);
      for (const Role role : {Role::input, Role::model, Role::intrinsic})
        for (const float v : download(layers[role])) ASSERT_TRUE(v >= 0 && v <= 65504);
    }
}

}  // namespace inverse::testing
