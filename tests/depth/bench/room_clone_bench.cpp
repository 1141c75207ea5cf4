// SPDX-License-Identifier: LGPL-2.1-or-later
// An object that is put into a remembered scene, against the room rendered with it.
//
//   room-clone-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--voxel M] [--radius M]
//                    [--place X,Y,Z]… [--out FOLDER] orbit|wall…
//
// The camera walks through the virtual room (rgbd_source.hpp) and is followed by depth, with the
// noise and holes of a sensor. A white ball is put at a place, under the room's light as it is at
// its center: lamps that are points, and even surroundings. The truth is the room rendered with
// that ball, 16 rays a pixel. The scored frames are every 15th from the second half on. Without
// --place four places are scored; nothing was chosen by them.
//
// Prints a table, a row for each path and place. mask: intersection over union of the ball's
// pixels. light: rms error of shading on these, over the rms of the truth. shadow: intersection
// over union of other pixels that lose more than a fifth of their light to the ball. lost: rms
// error of the share of light that is lost, over that of the truth.
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "kernels/depth/memory/scene_memory.hpp"
#include "kernels/depth/virtual_room/virtual_room.hpp"
#include "kernels/material/raster/room_insertion.hpp"
#include "rgbd_source.hpp"
#include "room_truth.hpp"
#include "tests/bench/metrics/png_file.hpp"

namespace inverse::bench {
namespace {

struct Settings : RgbdSettings {
  Settings() { frames = 120; }
  double voxel = 0.01, radius = 0.12;
  std::vector<Point> places;
  std::string out;
};

RoomScene with_ball(const Point& center, float radius) {
  RoomScene scene = furnished_room();
  scene.solids.push_back({Solid::Kind::ball,
                          center,
                          {radius, radius, radius},
                          0,
                          Solid::Paint::plain,
                          1,
                          {1, 1, 1},
                          {}});
  return scene;
}

/// The room's light at a place: each lamp in the pixels around its direction.
Environment light_at(const Point& place) {
  constexpr uint32_t kRows = 128;
  const RoomScene scene = furnished_room();
  std::vector<float> rgb(3 * 2 * kRows * kRows, scene.ambient);
  const Environment grid({2 * kRows, kRows}, rgb);
  for (const RoomLamp& lamp : scene.lamps) {
    double to[3], square = 0;
    for (size_t c = 0; c < 3; ++c) {
      to[c] = double{lamp.place[c]} - double{place[c]};
      square += to[c] * to[c];
    }
    // The map has y up and z to the camera.
    const double way[] = {to[0] / std::sqrt(square), -to[1] / std::sqrt(square),
                          -to[2] / std::sqrt(square)};
    std::vector<uint32_t> pixels;
    double area = 0;
    for (uint32_t y = 0; y < kRows; ++y)
      for (uint32_t x = 0; x < 2 * kRows; ++x) {
        const auto d = grid.direction(x + 0.5, y + 0.5);
        if (d[0] * way[0] + d[1] * way[1] + d[2] * way[2] < std::cos(0.03)) continue;
        pixels.push_back(y * 2 * kRows + x);
        area += grid.solid_angle(y);
      }
    for (const uint32_t pixel : pixels)
      for (size_t c = 0; c < 3; ++c)
        rgb[3 * pixel + c] += float(3.14159265 * double{lamp.power} / square / area);
  }
  return {{2 * kRows, kRows}, rgb};
}

struct Row {
  Overlap mask, shadow;
  double light = 0, light_truth = 0, lost = 0, lost_truth = 0;
};

/// One place beside the truth.
class Scored {
 public:
  Scored(const Lab& lab, const Point& place, float radius, Extent extent)
      : radius_(radius),
        center_{place[0], place[1] - radius, place[2]},
        place_(place),
        insertion_(lab.device(), extent),
        sphere_(lab.device()),
        bare_(lab.device(), furnished_room()),
        room_(lab.device(), with_ball(center_, radius)) {
    insertion_.set_mesh(Mesh::sphere());
    sphere_.set_light(light_at(center_));
  }

  void score(const Lab& lab, const RgbdFrame& frame, const Lens& lens, Extent extent,
             const std::shared_ptr<const SeenScene>& scene, const std::string& picture) {
    const auto render = [&](VirtualRoom& room, Pixels& truth) {
      constexpr uint32_t kRays = 4;  // along a side of a pixel
      const auto out = lab.buffer(extent.pixels()), layers = lab.buffer(extent.pixels());
      lab.run([&](gpu::Commands& commands) {
        room.record(commands, lens, extent, pose_on(lab, frame.pose), kRays, layers, out);
      });
      truth = lab.download(out);
      return lab.download(layers);
    };
    Pixels bare_truth, truth;
    const Pixels bare = render(bare_, bare_truth), with = render(room_, truth);
    const Pixels seen = lab.download(scene->pose->buffer);
    Pose pose;
    std::copy_n(seen.begin(), 4, pose.rotation.begin());
    std::copy_n(seen.begin() + 4, 3, pose.place.begin());
    // White surfaces, so that the frame is the light; black where the ball is not.
    Layers layers = intrinsic_layers(lab.plane(extent, Pixels(4 * extent.pixels(), 0)),
                                     lab.plane(extent, Pixels(4 * extent.pixels(), 1)), nullptr);
    layers.scene = scene;
    RoomInsertion::Params params;
    params.place = place_;
    params.size = 2 * radius_;
    params.shadow = 1;
    params.softness = 0;
    lab.run([&](gpu::Commands& commands) {
      insertion_.record(commands, layers, pose, params, sphere_, {{1, 1, 1}, 0, 2}, {});
    });
    const Pixels drawn = lab.download(layers[Role::input]->buffer),
                 lit = lab.download(layers[Role::intrinsic]->buffer);
    Image image(int(extent.width), int(2 * extent.height), 3);
    for (size_t i = 0; i < extent.pixels(); ++i) {
      // Depths are of centers, so the border may be off by half a pixel.
      const bool is_ball = with[4 * i + 3]<bare[4 * i + 3] - 1e-4F, inside = drawn[4 * i]> 0;
      const double all = double{bare_truth[4 * i + 3]}, left = double{truth[4 * i + 3]};
      const double there = double{lit[4 * i + 3]};
      row.mask.add(inside, is_ball);
      for (size_t c = 0; c < 3; ++c) {
        const double paint = double{bare_truth[4 * i + c]};
        image.data[3 * i + c] = with[4 * i + c];
        image.data[3 * (extent.pixels() + i) + c] =
            float(is_ball && inside ? double{drawn[4 * i]} : paint * all * there);
      }
      if (is_ball != inside) continue;
      if (is_ball) {
        const double light = double{drawn[4 * i]};
        row.light += (light - left) * (light - left);
        row.light_truth += left * left;
        continue;
      }
      const double lost = 1 - left / all, hidden = 1 - there;
      row.shadow.add(hidden > 0.2, lost > 0.2);
      row.lost += (lost - hidden) * (lost - hidden);
      row.lost_truth += lost * lost;
    }
    if (!picture.empty()) {
      for (float& v : image.data) v = std::pow(std::min(v, 1.F), 1 / 2.2F);
      write_png(picture, image);
    }
  }

  Row row;

 private:
  float radius_;
  Point center_, place_;
  RoomInsertion insertion_;
  LitSphere sphere_;
  VirtualRoom bare_, room_;
};

void run_one(const Lab& lab, const std::string& name, const Settings& settings) {
  const auto source = open_rgbd(lab, name, settings);
  const Extent extent = source->extent();
  std::vector<std::unique_ptr<Scored>> places;
  for (const Point& place : settings.places)
    places.push_back(std::make_unique<Scored>(lab, place, float(settings.radius), extent));
  walk_scene(lab, *source, float(settings.voxel),
             [&](int n, const RgbdFrame& frame, const auto& scene) {
               for (size_t k = 0; k < places.size(); ++k)
                 places[k]->score(lab, frame, source->lens(), extent, scene,
                                  settings.out.empty()
                                      ? ""
                                      : settings.out + "/" + name + "-" + std::to_string(k) + "-" +
                                            std::to_string(n) + ".png");
             });
  for (size_t k = 0; k < places.size(); ++k) {
    const Point& place = settings.places[k];
    const Row& row = places[k]->row;
    printf("| %s | %.2f, %.2f, %.2f | %.3f | %.3f | %.3f | %.3f |\n", name.c_str(),
           double{place[0]}, double{place[1]}, double{place[2]}, row.mask.iou(),
           std::sqrt(row.light / row.light_truth), row.shadow.iou(),
           std::sqrt(row.lost / row.lost_truth));
  }
  fflush(stdout);
}

int run(int count, char** arguments) {
  Settings settings;
  std::vector<std::string> names;
  const Options options = rgbd_options(settings, {{"--voxel", number(settings.voxel)},
                                                  {"--radius", number(settings.radius)},
                                                  {"--out", text(settings.out)},
                                                  {"--place", places(settings.places)}});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: room-clone-bench [options] orbit|wall…");
  if (settings.places.empty())
    settings.places = {
        {.35F, .47F, .3F}, {-.3F, .47F, .32F}, {-.9F, 1.23F, -.4F}, {.95F, 1.23F, .7F}};
  const Lab lab;
  printf("| | place | mask | light | shadow | lost |\n|---|---|---|---|---|---|\n");
  for (const std::string& name : names) run_one(lab, name, settings);
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("room-clone-bench", inverse::bench::run, argc, argv);
}
