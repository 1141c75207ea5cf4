// SPDX-License-Identifier: LGPL-2.1-or-later
// Strokes in a remembered scene against the truth of the virtual room.
//
//   scene-stroke-bench [--frames N] [--size WxH] [--rate FPS] [--noise N]
//
// The camera goes around the table. In frame 8 strokes are drawn: three lines, and one that fills
// in each plain thing that covers at least 300 pixels and does not stand on floor of its paint, at
// the pixel of it that is farthest from its border. Prints, of each line, intersection over union
// with the truth over all later frames: what is in its balls, put where the true depth and pose
// have them; of each filled thing, the same with all pixels of its paint, and their share that is
// filled; and LMSE of the later frames without strokes and with those of constant reflectance, of
// constant shading on the lines, or both.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "kernels/depth/memory/scene_memory.hpp"
#include "kernels/depth/virtual_room/virtual_room.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "rgbd_source.hpp"
#include "room_truth.hpp"
#include "tests/bench/metrics/metrics.hpp"

namespace inverse::bench {
namespace {

constexpr int kDrawn = 8;  // the frame
constexpr float kBrush = 4;

using Mask = std::vector<bool>;

/// The pixel of a mask that is farthest from its border, in steps of 4-neighbors, and how far.
std::pair<size_t, int> middle_of(Mask mask, Extent extent) {
  std::pair<size_t, int> result{0, 0};
  for (int depth = 1;; ++depth) {
    Mask eroded(mask.size());
    bool any = false;
    for (size_t at = 0; at < mask.size(); ++at) {
      if (!mask[at]) continue;
      result = {at, depth};
      const size_t x = at % extent.width, y = at / extent.width;
      eroded[at] = x > 0 && y > 0 && x + 1 < extent.width && y + 1 < extent.height &&
                   mask[at - 1] && mask[at + 1] && mask[at - extent.width] &&
                   mask[at + extent.width];
      any = any || eroded[at];
    }
    if (!any) return result;
    mask = std::move(eroded);
  }
}

Image image_of(const Pixels& pixels, Extent extent, int first, int channels) {
  Image image(int(extent.width), int(extent.height), channels);
  for (size_t i = 0; i < extent.pixels(); ++i)
    for (int c = 0; c < channels; ++c)
      image.data[i * size_t(channels) + size_t(c)] = pixels[4 * i + size_t(first + c)];
  return image;
}

/// Whether a point is in a ball of a stroke.
bool in(const Stroke& stroke, const Point& point) {
  return std::ranges::any_of(stroke.balls, [&](const auto& ball) {
    return std::hypot(ball[0] - point[0], ball[1] - point[1], ball[2] - point[2]) < ball[3];
  });
}

struct Drawn {
  StrokeList list;                   ///< as drawn
  std::vector<Stroke> truth;         ///< where each belongs
  std::vector<const Solid*> things;  ///< of each stroke; null: a line
};

Drawn draw(const View& view, const RoomScene& scene) {
  const auto width = float(view.extent.width), height = float(view.extent.height);
  Drawn drawn{{{}, view.extent}, {}, {}};
  const Solid& floor = scene.solids[1];
  const auto line = [&](float x0, float y0, float x1, float y1) {
    drawn.list.strokes.push_back(
        {Stroke::Kind::shading, {{x0 * width, y0 * height}, {x1 * width, y1 * height}}, kBrush});
    drawn.things.push_back(nullptr);
  };
  line(0.15F, 0.25F, 0.35F, 0.25F);
  line(0.3F, 0.65F, 0.6F, 0.62F);
  line(0.55F, 0.9F, 0.7F, 0.92F);
  for (const Solid& solid : scene.solids) {
    if (solid.kind == Solid::Kind::inside || solid.paint != Solid::Paint::plain ||
        solid.color == floor.color || solid.color == floor.other)
      continue;
    Mask mask(view.depth.size());
    size_t count = 0;
    for (size_t at = 0; at < mask.size(); ++at) count += mask[at] = on(solid, view.point(at));
    const auto [at, deep] = middle_of(mask, view.extent);
    if (count < 300 || float(deep) < kBrush) continue;
    drawn.list.strokes.push_back(
        {Stroke::Kind::reflectance,
         {{float(at % view.extent.width) + 0.5F, float(at / view.extent.width) + 0.5F}},
         kBrush,
         true});
    drawn.things.push_back(&solid);
  }
  for (const Stroke& stroke : drawn.list.strokes)
    drawn.truth.push_back(
        placed_in_scene(stroke, view.extent, {view.extent, view.lens, view.pose, view.depth})
            .value());
  return drawn;
}

/// Which strokes the solve has.
struct Solved {
  const char* name;
  bool shading, reflectance;
};

void run_one(const Lab& lab, RgbdSource& source, const Solved& solved, bool print) {
  const RoomScene scene = furnished_room();
  const Extent extent = source.extent();
  ScaledIntrinsic::Params params;
  const auto& levels = intrinsic_levels();
  levels.levels[levels.top(Quality::medium)].set(params);
  ScaledIntrinsic method(lab.device(), extent);
  SceneMemory::Params made;
  made.max_width = extent.width;
  SceneMemory memory(lab.device(), extent, made);
  Drawn drawn;
  StrokesPtr placed, in_solve;
  std::vector<Overlap> overlaps;
  double errors = 0, frames = 0, least = 1;
  gpu::Commands commands(lab.device());
  for (int n = 0; n < source.frames(); ++n) {
    const RgbdFrame frame = source.frame(lab, n);
    const View view{extent, source.lens(), frame.pose, frame.true_depth};
    const std::vector<uint16_t> steps = millimeters_of(lab, frame);
    const SceneMemory::Depth depth = depth_of(steps, source, frame.pose);
    memory.set_strokes(placed);
    memory.keep_views(n == kDrawn);
    commands.begin();
    const auto input = std::make_shared<Plane>(Plane{extent, frame.picture});
    const auto known = memory.record_recall(commands, uint64_t(n), depth, *input);
    const auto seen = memory.seen_strokes();
    const Layers layers = method.record(commands, input, params,
                                        {.reset = n == 0,
                                         .strokes = in_solve,
                                         .seen = seen ? &*seen : nullptr,
                                         .known = known ? &*known : nullptr});
    memory.record_remember(commands, *layers[Role::intrinsic]);
    commands.submit();
    commands.wait();
    if (n == kDrawn) {
      drawn = draw(view, scene);
      const auto saw = memory.view(uint64_t(n));
      if (!saw) throw std::runtime_error("the camera was lost");
      StrokeList all{{}, extent}, some{{}, extent};
      for (const Stroke& stroke : drawn.list.strokes) {
        const auto there = placed_in_scene(stroke, extent, *saw);
        if (!there) throw std::runtime_error("a stroke has no surface");
        all.strokes.push_back(*there);
        const bool shading = stroke.kind == Stroke::Kind::shading;
        if (shading ? solved.shading : solved.reflectance) some.strokes.push_back(*there);
      }
      placed = std::make_shared<const StrokeList>(all);
      if (!some.strokes.empty()) in_solve = std::make_shared<const StrokeList>(some);
      overlaps.resize(all.strokes.size());
      continue;
    }
    if (!placed || n < kDrawn + 4) continue;
    const Pixels pixels = lab.download(layers[Role::intrinsic]->buffer),
                 truth = lab.download(frame.layers);
    errors += score_lmse(image_of(pixels, extent, 0, 3), image_of(pixels, extent, 3, 1),
                         image_of(truth, extent, 0, 3), image_of(truth, extent, 3, 1), {});
    ++frames;
    if (!print || !seen) continue;
    const Pixels words = lab.download(seen->ids);
    std::vector<uint32_t> ids(words.size());
    memcpy(ids.data(), words.data(), 4 * ids.size());
    for (size_t k = 0; k < overlaps.size(); ++k) {
      const uint32_t id = seen->id_of(placed->strokes[k]);
      Overlap now;
      for (size_t at = 0; at < ids.size(); ++at) {
        if (!(view.depth[at] > 0) || view.depth[at] > 4.8F) continue;
        const Point point = view.point(at);
        const auto of_paint = [&](const Solid& solid) {
          return solid.paint == Solid::Paint::plain && solid.color == drawn.things[k]->color &&
                 on(solid, point);
        };
        now.add(ids[at] == id, drawn.things[k] ? std::ranges::any_of(scene.solids, of_paint)
                                               : in(drawn.truth[k], point));
      }
      overlaps[k].both += now.both;
      overlaps[k].either += now.either;
      overlaps[k].truth += now.truth;
      if (!drawn.things[k] && now.truth > 50) least = std::min(least, now.iou());
    }
  }
  for (size_t k = 0; k < overlaps.size() && print; ++k) {
    const Stroke::Point p = drawn.list.strokes[k].points[0];
    printf("| %s at %.0f, %.0f | %.0f | %.3f | %.3f |\n",
           drawn.things[k] ? drawn.things[k]->kind == Solid::Kind::ball ? "ball" : "box" : "line",
           double{p[0]}, double{p[1]}, overlaps[k].truth / std::max(frames, 1.0), overlaps[k].iou(),
           overlaps[k].both / std::max(overlaps[k].truth, 1.0));
  }
  if (print)
    printf(
        "\nleast of a frame, of lines with more than 50 pixels: %.3f\n\n| strokes | LMSE |\n"
        "|---|---|\n",
        least);
  printf("| %s | %.4f |\n", solved.name, errors / std::max(frames, 1.0));
  fflush(stdout);
}

int run(int count, char** arguments) {
  RgbdSettings settings;
  if (!read(rgbd_options(settings, {}), count, arguments, __FILE__)) return 1;
  const Lab lab;
  const auto source = open_rgbd(lab, "orbit", settings);
  printf("| | pixels a frame | intersection over union | share found |\n|---|---|---|---|\n");
  const Solved runs[] = {{"none", false, false},
                         {"constant reflectance in things", false, true},
                         {"constant shading on lines", true, false},
                         {"both", true, true}};
  for (const Solved& solved : runs) run_one(lab, *source, solved, &solved == &runs[0]);
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("scene-stroke-bench", inverse::bench::run, argc, argv);
}
