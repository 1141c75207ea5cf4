// SPDX-License-Identifier: LGPL-2.1-or-later
// Light of a lamp in a remembered scene, with its shadows, against the room rendered with that
// lamp.
//
//   room-lamp-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--voxel M] [--lamp X,Y,Z]…
//                   [--out FOLDER] orbit|wall…
//
// The camera walks through the virtual room (rgbd_source.hpp) and is followed by depth, with the
// noise and holes of a sensor. A white lamp of power 1 and the radius of intrinsicrelight's default
// is added; the truth is the room's exact geometry under that lamp alone, with traced shadows, 16
// rays a pixel. The scored frames are every 15th from the second half on. Without --lamp four
// places are scored. The constants of scene_light.comp and shadow.glsl were chosen with another
// one:
// --lamp -0.9,-0.7,-0.3 --frames 60 orbit.
//
// Prints a table, a row for each path and lamp. rms: of the lamp's shading, over that of the truth;
// LMSE: k = 20; each with shadows and without. IoU: of the pixels in shadow, where less than half
// of the lamp's light arrives, among those whose surface faces the lamp by 5 degrees or more and is
// not at an edge. Then the shares of these that are in shadow, and that the scene has lit without
// shadows. ms: median device time of intrinsicrelight's work on a frame.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "kernels/depth/memory/scene_memory.hpp"
#include "kernels/depth/virtual_room/virtual_room.hpp"
#include "kernels/edit/relight/relight.hpp"
#include "rgbd_source.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/metrics/png_file.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

using Vec3 = std::array<double, 3>;

struct Settings : RgbdSettings {
  Settings() { frames = 120; }
  double voxel = 0.01;
  std::vector<Lamp::Vector> lamps;
  std::string out;
};

double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// A channel of pixels.
Image channel(const Pixels& pixels, Extent extent, size_t c) {
  Image image(int(extent.width), int(extent.height), 1);
  for (size_t i = 0; i < extent.pixels(); ++i) image.data[i] = pixels[4 * i + c];
  return image;
}

/// The light of a lamp on exact geometry as if nothing were in its way; 0 where the surface does
/// not face it, NaN at edges.
Image unshadowed(const std::vector<float>& depth, Extent extent, const Lens& lens, const Pose& pose,
                 const Lamp::Vector& lamp) {
  constexpr double kJump = 0.02, kFacing = 0.087;  // of the depth; sine of five degrees
  const auto in_camera = to_camera(pose, lamp);
  const Vec3 at{double{in_camera[0]}, double{in_camera[1]}, double{in_camera[2]}};
  const auto point = [&](uint32_t x, uint32_t y) {
    const double z = double{depth[size_t{y} * extent.width + x]};
    return Vec3{(x - double{lens.cx}) / double{lens.fx} * z,
                (y - double{lens.cy}) / double{lens.fy} * z, z};
  };
  Image light(int(extent.width), int(extent.height), 1);
  std::ranges::fill(light.data, std::nanf(""));
  for (uint32_t y = 1; y + 1 < extent.height; ++y)
    for (uint32_t x = 1; x + 1 < extent.width; ++x) {
      const Vec3 p = point(x, y), l = point(x - 1, y), r = point(x + 1, y), u = point(x, y - 1),
                 d = point(x, y + 1);
      double jump = 0;
      for (const Vec3& q : {l, r, u, d}) jump = std::max(jump, std::abs(q[2] - p[2]));
      // Within a plane 1 / z is linear.
      const double bend_x = std::abs(1 / l[2] + 1 / r[2] - 2 / p[2]),
                   bend_y = std::abs(1 / u[2] + 1 / d[2] - 2 / p[2]);
      if (jump > kJump * p[2] || std::max(bend_x, bend_y) * p[2] > 1e-3) continue;
      const Vec3 a = minus(d, u), b = minus(r, l);
      const Vec3 n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
      const Vec3 to = minus(at, p);
      const double cosine = dot(n, to) / std::sqrt(dot(n, n) * dot(to, to));
      light.data[size_t{y} * extent.width + x] =
          float(cosine > kFacing ? cosine / dot(to, to) : 0.0);
    }
  return light;
}

struct Sums {
  double squares = 0, truth = 0, lmse = 0;
  int frames = 0;
  void add(const Image& estimate, const Image& of_truth) {
    squares += mse(estimate, of_truth, {});
    truth += mse(Image(of_truth.width, of_truth.height, 1), of_truth, {});
    lmse += bench::lmse(estimate, of_truth, {});
    ++frames;
  }
  double rms() const { return std::sqrt(squares / truth); }
  double mean_lmse() const { return lmse / frames; }
};

struct Row {
  Sums with, without;
  std::vector<double> times, times_without;  // ms
  double both = 0, either = 0, shadow = 0, counted = 0, known = 0;
};

/// One lamp beside the truth.
class Scored {
 public:
  Scored(const Lab& lab, const Lamp::Vector& place, Extent extent)
      : place_(place), relight_(lab.device(), extent), room_(lab.device(), alone(place)) {}

  void score(const Lab& lab, const RgbdFrame& frame, const Lens& lens, Extent extent,
             const std::shared_ptr<const SeenScene>& scene, const std::string& picture) {
    const auto truth = lab.buffer(extent.pixels()), layers = lab.buffer(extent.pixels());
    const auto pose = pose_on(lab, frame.pose);
    constexpr uint32_t kRays = 4;  // along a side of a pixel
    lab.run([&](gpu::Commands& commands) {
      room_.record(commands, lens, extent, pose, kRays, layers, truth);
    });
    const Image true_light = channel(lab.download(truth), extent, 3);
    const Image with = light(lab, extent, scene, true), without = light(lab, extent, scene, false);
    row.with.add(with, true_light);
    row.without.add(without, true_light);
    const Image free = unshadowed(frame.true_depth, extent, lens, frame.pose, place_);
    for (size_t i = 0; i < free.data.size(); ++i) {
      if (!(free.data[i] > 0)) continue;
      const bool dark = true_light.data[i] < free.data[i] / 2,
                 found = with.data[i] < without.data[i] / 2;
      row.both += dark && found;
      row.either += dark || found;
      row.shadow += dark;
      row.known += without.data[i] > 0;
      row.counted += 1;
    }
    if (!picture.empty()) write(picture, {true_light, with, without});
  }

  Row row;

 private:
  static RoomScene alone(const Lamp::Vector& place) {
    RoomScene scene = furnished_room();
    scene.lamps = {{place, 1}};
    scene.ambient = 0;
    return scene;
  }
  Image light(const Lab& lab, Extent extent, const std::shared_ptr<const SeenScene>& scene,
              bool shadows) {
    Layers layers{extent, {}};
    layers[Role::intrinsic] = lab.plane(extent, Pixels(4 * extent.pixels(), 1));
    layers.scene = scene;
    RelightParams params;
    params.lamps = {{.position = place_, .power = 1, .room = true}};
    params.ambient = 0;
    params.shadows = shadows;
    gpu::Commands commands(lab.device());
    commands.begin();
    relight_.record(commands, layers, params);
    commands.stage("relight");
    commands.submit();
    commands.wait();
    (shadows ? row.times : row.times_without).push_back(commands.device_ms());
    return channel(lab.download(layers[Role::intrinsic]->buffer), extent, 3);
  }
  /// Beside each other, half as bright.
  static void write(const std::string& path, const std::vector<Image>& images) {
    const int width = images[0].width, height = images[0].height;
    Image all(width * int(images.size()), height, 1);
    for (int k = 0; k < int(images.size()); ++k)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          all.data[size_t(y) * size_t(all.width) + size_t(k * width + x)] =
              images[size_t(k)].at(x, y, 0) / 2;
    write_png(path, all);
  }

  Lamp::Vector place_;
  Relight relight_;
  VirtualRoom room_;
};

void run_one(const Lab& lab, const std::string& name, const Settings& settings) {
  const auto source = open_rgbd(lab, name, settings);
  const Extent extent = source->extent();
  std::vector<std::unique_ptr<Scored>> lamps;
  for (const Lamp::Vector& place : settings.lamps)
    lamps.push_back(std::make_unique<Scored>(lab, place, extent));
  walk_scene(lab, *source, float(settings.voxel),
             [&](int n, const RgbdFrame& frame, const auto& scene) {
               for (size_t k = 0; k < lamps.size(); ++k)
                 lamps[k]->score(lab, frame, source->lens(), extent, scene,
                                 settings.out.empty()
                                     ? ""
                                     : settings.out + "/" + name + "-" + std::to_string(k) + "-" +
                                           std::to_string(n) + ".png");
             });
  for (size_t k = 0; k < lamps.size(); ++k) {
    const Lamp::Vector& place = settings.lamps[k];
    const Row& row = lamps[k]->row;
    printf(
        "| %s | %.1f, %.1f, %.1f | %.3f | %.3f | %.4f | %.4f | %.3f | %.2f | %.3f | %.1f | %.1f "
        "|\n",
        name.c_str(), double{place[0]}, double{place[1]}, double{place[2]}, row.with.rms(),
        row.without.rms(), row.with.mean_lmse(), row.without.mean_lmse(), row.both / row.either,
        row.shadow / row.counted, row.known / row.counted, median(row.times),
        median(row.times_without));
  }
  fflush(stdout);
}

int run(int count, char** arguments) {
  Settings settings;
  std::vector<std::string> names;
  const Options options = rgbd_options(settings, {{"--voxel", number(settings.voxel)},
                                                  {"--out", text(settings.out)},
                                                  {"--lamp", places(settings.lamps)}});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: room-lamp-bench [options] orbit|wall…");
  if (settings.lamps.empty())
    settings.lamps = {{.9F, -.6F, -.4F}, {-.2F, 0, .9F}, {.6F, 0, 1.5F}, {1.3F, .3F, 1.1F}};
  const Lab lab;
  printf(
      "| | lamp | rms | without shadows | LMSE | without shadows | IoU | in shadow | known | ms | "
      "without shadows |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) run_one(lab, name, settings);
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("room-lamp-bench", inverse::bench::run, argc, argv);
}
