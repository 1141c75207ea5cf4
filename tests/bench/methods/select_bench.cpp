// SPDX-License-Identifier: LGPL-2.1-or-later
// How well one click selects an object: overlap (intersection over union) with the true one.
//
//   select-bench FOLDER…
//
// The folders hold scenes of ./dev bench with object numbers (build-bench/tests/bench/scenes;
// import-scenes). An object is what is connected in a frame, by 0.5 to 50 % of it. The click is on
// its pixel that is farthest from its border. Beside it: selection by the key under the click, as
// by intrinsicrecolor's defaults, and the part of that which is connected to the click. "followed":
// the same object in the last frame of a video, without another click.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "kernels/edit/selection/selection.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/bench/support/timing.hpp"
#include "tests/lab.hpp"

namespace inverse::bench {
namespace {

constexpr double kSmallest = .005, kLargest = .5;  // shares of the frame
constexpr size_t kMostFrames = 16;

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

/// The pixel of a part that is farthest from its border (in steps along x and y).
size_t deepest(const std::vector<size_t>& part, const Mask& mask, int width, int height) {
  Mask rest = mask;
  std::vector<size_t> now = part;
  size_t last = part.front();
  while (!now.empty()) {
    std::vector<size_t> left;
    for (const size_t n : now) {
      const int x = static_cast<int>(n) % width, y = static_cast<int>(n) / width;
      const bool inner = x > 0 && y > 0 && x + 1 < width && y + 1 < height && rest[n - 1] &&
                         rest[n + 1] && rest[n - static_cast<size_t>(width)] &&
                         rest[n + static_cast<size_t>(width)];
      if (inner) left.push_back(n);
    }
    last = now[now.size() / 2];
    Mask next(mask.size());
    for (const size_t n : left) next[n] = true;
    rest = next;
    now = left;
  }
  return last;
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
    object.click = deepest(part, object.mask, id.width, id.height);
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
  std::vector<double> click, key, connected, followed;
};

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? NAN : sum / static_cast<double>(values.size());
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
    const int x = static_cast<int>(object.click) % first.id.width,
              y = static_cast<int>(object.click) / first.id.width;
    const SelectionStroke stroke{
        .points = {{static_cast<float>(x) + .5F, static_cast<float>(y) + .5F}}};
    Selection selection(lab.device(), extent);
    for (size_t t = 0; t < frames.size(); ++t) {
      Layers layers = frames[t];
      lab.run([&](gpu::Commands& commands) {
        const std::span<const SelectionStroke> strokes(&stroke, t == 0 ? 1 : 0);
        selection.record(commands, layers, {}, {strokes, extent}, nullptr);
      });
      if (t == 0) figures.click.push_back(overlap(selected(lab, layers), object.mask));
      if (t == 0 || t + 1 < frames.size()) continue;
      Mask truth(object.mask.size());
      for (size_t n = 0; n < truth.size(); ++n) truth[n] = scene.frames[t].id.data[n] == object.id;
      figures.followed.push_back(overlap(selected(lab, layers), truth));
    }
    SelectionParams by_key;
    by_key.by = SelectBy::key;
    by_key.soft = false;
    for (size_t c = 0; c < 3; ++c) by_key.color.key[c] = reflectance[4 * object.click + c];
    Layers layers = frames[0];
    Selection keyed(lab.device(), extent);
    lab.run([&](gpu::Commands& commands) { keyed.record(commands, layers, by_key, {}, nullptr); });
    const Mask mask = selected(lab, layers);
    figures.key.push_back(overlap(mask, object.mask));
    Mask seen(mask.size()), part(mask.size());
    for (const size_t n : connected(object.click, first.id.width, first.id.height, seen,
                                    [&](size_t m) { return mask[m]; }))
      part[n] = true;
    figures.connected.push_back(overlap(part, object.mask));
  }
  std::printf("| %s %s | %zu | %.2f | %.2f | %.2f | %.2f |\n", scene.set.c_str(),
              scene.name.c_str(), figures.click.size(), mean(figures.click), mean(figures.key),
              mean(figures.connected), mean(figures.followed));
  for (const auto part : {&Figures::click, &Figures::key, &Figures::connected, &Figures::followed})
    (all.*part).insert((all.*part).end(), (figures.*part).begin(), (figures.*part).end());
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
  if (all.click.empty()) throw std::runtime_error("usage: select-bench FOLDER…");
  std::printf("| all: mean | %zu | %.2f | %.2f | %.2f | %.2f |\n", all.click.size(),
              mean(all.click), mean(all.key), mean(all.connected), mean(all.followed));
  std::printf("| all: median | | %.2f | %.2f | %.2f | %.2f |\n", median(all.click), median(all.key),
              median(all.connected), all.followed.empty() ? NAN : median(all.followed));
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
