// SPDX-License-Identifier: LGPL-2.1-or-later
// How well clicks select an object: overlap (intersection over union) with the true one after 1, 3
// and 6 of them.
//
//   select-bench FOLDER…
//
// The folders hold scenes of ./dev bench with object numbers (build-bench/tests/bench/scenes;
// import-scenes). An object is what is connected in a frame, by 0.5 to 50 % of it. The click is on
// its pixel that is farthest from its border; the next ones are where the most is wrong. Beside it:
// selection by the key under the click, as by intrinsicrecolor's defaults, and the part of that
// which is connected to the click. "followed": after one click, the same object in the last frame
// of a video, without another.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "kernels/edit/selection/selection.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/lab.hpp"

namespace inverse::bench {
namespace {

constexpr double kSmallest = .005, kLargest = .5;  // shares of the frame
constexpr size_t kMostFrames = 16;
constexpr float kBrush = 3;  // radius, pixels

using Mask = std::vector<bool>;

/// The pixels that are connected to `start` by pixels for which `inside` is true.
template <typename Inside>
std::vector<size_t> connected(size_t start, int width, int height, std::vector<bool>& seen,
                              Inside inside) {
  std::vector<size_t> part{start};
  seen[start] = true;
  for (size_t i = 0; i < part.size(); ++i) {
    const int x = static_cast<int>(part[i]) % width, y = static_cast<int>(part[i]) / width;
    const auto visit = [&](int u, int v) {
      if (u < 0 || v < 0 || u >= width || v >= height) return;
      const size_t n = static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u);
      if (seen[n] || !inside(n)) return;
      seen[n] = true;
      part.push_back(n);
    };
    visit(x - 1, y), visit(x + 1, y), visit(x, y - 1), visit(x, y + 1);
  }
  return part;
}

struct Object {
  float id = 0;
  size_t click = 0;  // pixel
  Mask mask;
};

struct Deepest {
  size_t pixel = 0;
  int depth = 0;  ///< steps along x and y to the border
};

/// The pixel of a mask that is farthest from its border.
Deepest deepest(Mask rest, int width, int height) {
  std::vector<size_t> now;
  for (size_t n = 0; n < rest.size(); ++n)
    if (rest[n]) now.push_back(n);
  Deepest found;
  while (!now.empty()) {
    std::vector<size_t> left;
    for (const size_t n : now) {
      const int x = static_cast<int>(n) % width, y = static_cast<int>(n) / width;
      const bool inner = x > 0 && y > 0 && x + 1 < width && y + 1 < height && rest[n - 1] &&
                         rest[n + 1] && rest[n - static_cast<size_t>(width)] &&
                         rest[n + static_cast<size_t>(width)];
      if (inner) left.push_back(n);
    }
    found = {now[now.size() / 2], found.depth + 1};
    Mask next(rest.size());
    for (const size_t n : left) next[n] = true;
    rest = next;
    now = left;
  }
  return found;
}

std::vector<Object> objects_of(const Image& id) {
  const size_t pixels = id.data.size();
  Mask seen(pixels);
  std::vector<Object> objects;
  for (size_t n = 0; n < pixels; ++n) {
    if (seen[n]) continue;
    const float own = id.data[n];
    const auto part =
        connected(n, id.width, id.height, seen, [&](size_t m) { return id.data[m] == own; });
    const double share = static_cast<double>(part.size()) / static_cast<double>(pixels);
    if (own < 0 || share < kSmallest || share > kLargest) continue;
    Object object{own, 0, Mask(pixels)};
    for (const size_t m : part) object.mask[m] = true;
    object.click = deepest(object.mask, id.width, id.height).pixel;
    objects.push_back(std::move(object));
  }
  return objects;
}

double overlap(const Mask& a, const Mask& b) {
  size_t both = 0, either = 0;
  for (size_t n = 0; n < a.size(); ++n) both += a[n] && b[n], either += a[n] || b[n];
  return either ? static_cast<double>(both) / static_cast<double>(either) : 1;
}

Mask selected(const Lab& lab, const Layers& layers) {
  const Pixels pixels = lab.download(layers[Role::mask]->buffer);
  Mask mask(pixels.size() / 4);
  for (size_t n = 0; n < mask.size(); ++n) mask[n] = pixels[4 * n] > .5F;
  return mask;
}

struct Figures {
  std::vector<double> clicks[3], key, connected, followed;
};
constexpr size_t kClicks[] = {1, 3, 6};

SelectionStroke click_on(size_t pixel, int width, bool subtract) {
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  SelectionStroke stroke;
  stroke.subtract = subtract;
  stroke.points = {{static_cast<float>(x) + .5F, static_cast<float>(y) + .5F}};
  stroke.radius = kBrush;
  return stroke;
}

/// The click on the pixel that is farthest inside of what is wrong; none if no wrong part is wider
/// than the brush, as a click there would cover what is right.
std::optional<SelectionStroke> next_click(const Mask& mask, const Mask& truth, int width,
                                          int height) {
  Mask missing(mask.size()), extra(mask.size());
  for (size_t n = 0; n < mask.size(); ++n)
    missing[n] = truth[n] && !mask[n], extra[n] = mask[n] && !truth[n];
  const Deepest in_missing = deepest(missing, width, height),
                in_extra = deepest(extra, width, height);
  const bool subtract = in_extra.depth > in_missing.depth;
  const Deepest& worst = subtract ? in_extra : in_missing;
  if (worst.depth <= 2 * kBrush) return {};
  return click_on(worst.pixel, width, subtract);
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? NAN : sum / static_cast<double>(values.size());
}

void print(const Figures& of) {
  std::printf(" %zu |", of.key.size());
  for (const auto& clicks : of.clicks) std::printf(" %.2f |", mean(clicks));
  std::printf(" %.2f | %.2f | %.2f |\n", mean(of.key), mean(of.connected), mean(of.followed));
}

/// The layers of each frame, decomposed one after another.
std::vector<Layers> decompose(const Lab& lab, const Scene& scene, Extent extent) {
  ScaledIntrinsic method(lab.device(), extent);
  std::vector<Layers> result;
  const size_t count = scene.video ? std::min(scene.frames.size(), kMostFrames) : 1;
  for (size_t t = 0; t < count; ++t) {
    const Image frame = through_8_bits(scene.frames[t].input);
    Pixels pixels;
    for (size_t n = 0; n < extent.pixels(); ++n) {
      for (size_t c = 0; c < 3; ++c) pixels.push_back(frame.data[3 * n + c]);
      pixels.push_back(1);
    }
    const PlanePtr input = lab.plane(extent, pixels);
    lab.run([&](gpu::Commands& commands) {
      result.push_back(method.record(commands, input, {}, {.reset = t == 0}));
    });
  }
  return result;
}

void measure(const Lab& lab, const Scene& scene, Figures& all) {
  const TruthFrame& first = scene.frames.front();
  if (first.id.empty()) return;
  const Extent extent{static_cast<uint32_t>(first.input.width),
                      static_cast<uint32_t>(first.input.height)};
  const std::vector<Layers> frames = decompose(lab, scene, extent);
  const Pixels reflectance = lab.download(frames[0][Role::model]->buffer);
  Figures figures;
  for (const Object& object : objects_of(first.id)) {
    const SelectionStroke stroke = click_on(object.click, first.id.width, false);
    Selection selection(lab.device(), extent);
    const auto select = [&](Selection& with, const Layers& frame,
                            std::span<const SelectionStroke> strokes) {
      Layers layers = frame;
      lab.run([&](gpu::Commands& commands) {
        with.record(commands, layers, {}, {strokes, extent}, nullptr);
      });
      return selected(lab, layers);
    };
    for (size_t t = 0; t < frames.size(); ++t) {
      const Mask mask = select(selection, frames[t], {&stroke, t == 0 ? size_t{1} : 0});
      if (t == 0 || t + 1 < frames.size()) continue;
      Mask truth(object.mask.size());
      for (size_t n = 0; n < truth.size(); ++n) truth[n] = scene.frames[t].id.data[n] == object.id;
      figures.followed.push_back(overlap(mask, truth));
    }
    Selection corrected(lab.device(), extent);
    std::optional<SelectionStroke> next = stroke;
    Mask mask;
    for (size_t count = 1, at = 0; at < std::size(kClicks); ++count) {
      if (next) mask = select(corrected, frames[0], {&*next, 1});
      if (count == kClicks[at]) figures.clicks[at++].push_back(overlap(mask, object.mask));
      if (next) next = next_click(mask, object.mask, first.id.width, first.id.height);
    }
    SelectionParams by_key;
    by_key.by = SelectBy::key;
    by_key.soft = false;
    for (size_t c = 0; c < 3; ++c) by_key.color.key[c] = reflectance[4 * object.click + c];
    Layers layers = frames[0];
    Selection keyed(lab.device(), extent);
    lab.run([&](gpu::Commands& commands) { keyed.record(commands, layers, by_key, {}, nullptr); });
    mask = selected(lab, layers);
    figures.key.push_back(overlap(mask, object.mask));
    Mask seen(mask.size()), part(mask.size());
    for (const size_t n : connected(object.click, first.id.width, first.id.height, seen,
                                    [&](size_t m) { return mask[m]; }))
      part[n] = true;
    figures.connected.push_back(overlap(part, object.mask));
  }
  std::printf("| %s %s |", scene.set.c_str(), scene.name.c_str());
  print(figures);
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (size_t i = 0; i < std::size(kClicks); ++i) append(all.clicks[i], figures.clicks[i]);
  append(all.key, figures.key);
  append(all.connected, figures.connected);
  append(all.followed, figures.followed);
}

void run(int argc, char** argv) {
  const Lab lab;
  std::printf(
      "| scene | objects | click | key | key, connected | followed |\n"
      "|---|---|---|---|---|---|\n");
  Figures all;
  for (int i = 1; i < argc; ++i)
    for (const Scene& scene : read_scenes(argv[i])) {
      measure(lab, scene, all);
      std::fflush(stdout);
    }
  if (all.key.empty()) throw std::runtime_error("usage: select-bench FOLDER…");
  std::printf("| all |");
  print(all);
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  inverse::bench::run(argc, argv);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "select-bench: %s\n", error.what());
  return 1;
}
