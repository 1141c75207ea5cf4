// SPDX-License-Identifier: LGPL-2.1-or-later
// Touch against the truth of the virtual room.
//
//   touch-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--seen N]
//               [--path orbit|wall|table|still] [--update] [--pictures FOLDER] TARGET…
//
// TARGET: ball, dark-ball, box, book, table or print, what a hand touches that comes into the
// picture every six seconds. The scene is seen for N frames before (80), then it is frozen
// (--update: added to all the time) and touch is looked for. The first touch of three frames puts a
// filled stroke there. Prints, of each target: the share of frames with a touch that was found and
// the distance of the place found from the true one; the share of frames with a hand that is at
// least 5 cm away from all in which a touch was found, and of those between; intersection over
// union of what is in front with the hand, and the share of other pixels that are taken for it; the
// largest share of the picture that the hand covers; root of the mean square distance of the camera
// from its true place with the hand, and without one; and, of plain things, intersection over union
// of the filled stroke with the thing from then on. --pictures writes every frame with a hand,
// marked.
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "kernels/depth/memory/scene_memory.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "rgbd_source.hpp"
#include "room_truth.hpp"
#include "tests/bench/metrics/png_file.hpp"

namespace inverse::bench {
namespace {

constexpr float kAway = 0.05F;  // meters
constexpr float kBrush = 6;     // pixels
constexpr int kTouched = 3;     // frames with a touch before the stroke is put

struct Settings : RgbdSettings {
  std::string path = "table", pictures;
  int seen = 80;
  bool update = false;
};

const std::pair<const char*, HandTarget> kTargets[] = {
    {"ball", HandTarget::ball}, {"dark-ball", HandTarget::dark_ball}, {"box", HandTarget::box},
    {"book", HandTarget::book}, {"table", HandTarget::table},         {"print", HandTarget::print},
    {"none", HandTarget::none}};

struct Counts {
  double frames = 0, found = 0;
  double share() const { return found / std::max(frames, 1.0); }
};

struct Result {
  Counts touching, away, between, bare;
  std::vector<double> off;  // meters
  double squares = 0, frames = 0, lost = 0, covered = 0;
  Overlap front;
  double others = 0, taken = 0;  // pixels without a hand; of these, those in front
  Overlap filled;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// The plain solid that a target is; null: it has print.
const Solid* thing_of(const RoomScene& scene, HandTarget target) {
  if (target != HandTarget::dark_ball) return nullptr;
  for (const Solid& solid : scene.solids)
    if (solid.kind == Solid::Kind::ball && solid.paint == Solid::Paint::plain) return &solid;
  return nullptr;
}

void write_picture(const std::string& path, Extent extent, const Pixels& picture,
                   const std::vector<uint32_t>& kinds, const std::vector<uint32_t>& ids,
                   const std::optional<std::array<float, 2>>& found) {
  Image image(int(extent.width), int(extent.height), 3);
  for (size_t i = 0; i < extent.pixels(); ++i) {
    std::array<float, 3> color{picture[4 * i], picture[4 * i + 1], picture[4 * i + 2]};
    if (!kinds.empty() && (kinds[i] & 1U) != 0) color[2] = std::min(color[2] + 0.3F, 1.0F);
    if (!ids.empty() && ids[i] != 0) color[1] = std::min(color[1] + 0.4F, 1.0F);
    const auto x = float(i % extent.width), y = float(i / extent.width);
    if (found && std::hypot(x - (*found)[0], y - (*found)[1]) < 3) color = {1, 0, 0};
    for (size_t c = 0; c < 3; ++c) image.data[3 * i + c] = std::clamp(color[c], 0.0F, 1.0F);
  }
  write_png(path, image);
}

std::vector<uint32_t> words(const Lab& lab, const gpu::BufferPtr& buffer) {
  const Pixels floats = lab.download(buffer);
  std::vector<uint32_t> result(floats.size());
  memcpy(result.data(), floats.data(), 4 * floats.size());
  return result;
}

Result play(const Lab& lab, const Settings& settings, const std::string& name) {
  const auto source = open_rgbd(lab, settings.path, settings);
  const RoomScene scene = furnished_room();
  const Solid* thing = thing_of(scene, settings.hand);
  const Extent extent = source->extent();
  ScaledIntrinsic::Params params;
  const auto& levels = intrinsic_levels();
  levels.levels[levels.top(Quality::medium)].set(params);
  ScaledIntrinsic method(lab.device(), extent);
  SceneMemory::Params made;
  made.max_width = extent.width;
  SceneMemory memory(lab.device(), extent, made);
  Result result;
  StrokesPtr placed;
  int touched = 0, since = 0;
  gpu::Commands commands(lab.device());
  for (int n = 0; n < source->frames(); ++n) {
    const RgbdFrame frame = source->frame(lab, n);
    const View view{extent, source->lens(), frame.pose, frame.true_depth};
    const std::vector<uint16_t> steps = millimeters_of(lab, frame);
    const SceneMemory::Depth depth =
        depth_of(steps, *source, n == 0 ? std::optional(frame.pose) : std::nullopt);
    memory.set_strokes(placed);
    memory.set_update(settings.update || n < settings.seen);
    memory.set_touch(n >= settings.seen);
    commands.begin();
    const auto input = std::make_shared<Plane>(Plane{extent, frame.picture});
    const auto known = memory.record_recall(commands, uint64_t(n), depth, *input);
    const auto seen = memory.seen_strokes();
    const Layers layers = method.record(commands, input, params,
                                        {.reset = n == 0, .known = known ? &*known : nullptr});
    memory.record_remember(commands, *layers[Role::intrinsic]);
    commands.submit();
    commands.wait();
    const auto found = memory.findings(uint64_t(n));
    const auto there = memory.view(uint64_t(n));
    if (!found || !there) {
      ++result.lost;
      continue;
    }
    double square = 0;
    for (size_t c = 0; c < 3; ++c)
      square += std::pow(double{there->pose.place[c]} - double{frame.pose.place[c]}, 2);
    if (n >= settings.seen) result.squares += square, ++result.frames;
    const auto touch = memory.touch(uint64_t(n));
    const bool sighted = !frame.bare_depth.empty();
    double covered = 0;
    std::vector<uint32_t> kinds;
    if (sighted) {
      kinds = words(lab, memory.touch_kinds());
      const Pixels measured = lab.download(frame.depth);
      for (size_t i = 0; i < kinds.size(); ++i) {
        const bool hand = frame.true_depth[i] < frame.bare_depth[i] - 1e-4F;
        covered += hand;
        if (!(measured[i] > 0)) continue;
        const bool front = (kinds[i] & shaders::depth_touch_compare::TOUCH_FRONT) != 0;
        result.front.add(front, hand);
        result.others += !hand;
        result.taken += front && !hand;
      }
      covered /= double(extent.pixels());
      result.covered = std::max(result.covered, covered);
    }
    const float free = sighted ? clearance(scene, frame.hand.parts) : 1;
    Counts& counts = covered == 0            ? result.bare
                     : frame.hand.touches    ? result.touching
                     : free >= kAway - 1e-3F ? result.away
                                             : result.between;
    if (n >= settings.seen) {
      ++counts.frames;
      counts.found += touch.has_value();
    }
    if (touch && frame.hand.touches && sighted) {
      double off = 0;
      for (size_t c = 0; c < 3; ++c)
        off += std::pow(double{touch->place[c]} - double{frame.hand.contact[c]}, 2);
      result.off.push_back(std::sqrt(off));
    }
    touched = touch ? touched + 1 : 0;
    if (touched == kTouched && !placed) {
      const float z = to_camera(there->pose, touch->place)[2];
      Stroke stroke{Stroke::Kind::recolor, {}, kBrush, true};
      stroke.balls.push_back(
          {touch->place[0], touch->place[1], touch->place[2], kBrush * z / source->lens().fx});
      placed = std::make_shared<const StrokeList>(StrokeList{{stroke}, extent});
      since = n;
    }
    std::vector<uint32_t> ids;
    if (placed && seen) {
      ids = words(lab, seen->ids);
      for (size_t i = 0; thing && n > since + 8 && i < ids.size(); ++i) {
        if (sighted && frame.true_depth[i] < frame.bare_depth[i] - 1e-4F) continue;
        if (view.depth[i] > 0 && view.depth[i] < 4.8F)
          result.filled.add(ids[i] != 0, on(*thing, view.point(i)));
      }
    }
    if (settings.pictures.empty() || !sighted) continue;
    std::optional<std::array<float, 2>> at;
    if (touch) {
      const auto p = to_camera(there->pose, touch->place);
      at = {source->lens().fx * p[0] / p[2] + source->lens().cx,
            source->lens().fy * p[1] / p[2] + source->lens().cy};
    }
    char file[32];
    snprintf(file, sizeof file, "-%03d.png", n);
    write_picture(settings.pictures + "/" + name + file, extent, lab.download(frame.picture), kinds,
                  ids, at);
  }
  return result;
}

int run(int count, char** arguments) {
  Settings settings;
  settings.frames = 200;
  settings.rate = 10;
  std::vector<std::string> names;
  const Options options =
      rgbd_options(settings, {{"--path", text(settings.path)},
                              {"--seen", integer(settings.seen)},
                              {"--pictures", text(settings.pictures)},
                              {"--update", flag([&] { settings.update = true; })}});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: touch-bench [options] TARGET…");
  settings.hand_from = settings.seen;
  const Lab lab;
  printf(
      "| target | touching: found | off, median mm | 90 %% | away: found | between | no hand | IoU "
      "of "
      "the hand | others taken | covers | rms mm | without | lost | IoU of the thing |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  const auto rms = [](const Result& r) {
    return 1000 * std::sqrt(r.squares / std::max(r.frames, 1.0));
  };
  settings.hand = HandTarget::none;
  const Result bare = play(lab, settings, "none");
  for (const std::string& name : names) {
    const auto* target =
        std::ranges::find_if(kTargets, [&](const auto& known) { return name == known.first; });
    if (target == std::end(kTargets)) throw std::runtime_error("there is no target " + name);
    settings.hand = target->second;
    Result r = play(lab, settings, name);
    std::ranges::sort(r.off);
    const double nine = r.off.empty() ? 0 : r.off[r.off.size() * 9 / 10];
    printf(
        "| %s | %.3f of %.0f | %.1f | %.1f | %.3f of %.0f | %.3f of %.0f | %.3f of %.0f | %.3f | "
        "%.4f | %.2f | %.2f | %.2f | %.0f | %.3f |\n",
        name.c_str(), r.touching.share(), r.touching.frames, 1000 * median(r.off), 1000 * nine,
        r.away.share(), r.away.frames, r.between.share(), r.between.frames, r.bare.share(),
        r.bare.frames, r.front.iou(), r.taken / std::max(r.others, 1.0), r.covered, rms(r),
        rms(bare), r.lost, r.filled.iou());
    fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("touch-bench", inverse::bench::run, argc, argv);
}
