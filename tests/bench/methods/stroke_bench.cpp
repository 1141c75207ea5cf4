// SPDX-License-Identifier: LGPL-2.1-or-later
// What strokes bring and cost: LMSE (k = 20) of intrinsicdecomp and, with the same strokes, of the
// thesis' method after 0, 1, 3 and 6 strokes, and the processor time of a frame of intrinsicdecomp
// with them.
//
//   stroke-bench [--fill] FOLDER…     --fill: the strokes are filled, in intrinsicdecomp alone
//   stroke-bench --figures FOLDER     the folder that stroke-scenes writes
//
// The folders hold scenes of ./dev bench (build-bench/tests/bench/scenes; import-scenes), of which
// the first frame is taken. A user who knows the truth draws each stroke: a dot of the radius .06
// of the smaller side where the solution differs most from the truth inside of it, and where
// shading or reflectance is truly constant (standard deviation of its logarithm at most .1); of the
// kind that is. Where intrinsicdecomp differs most: it sees nothing of the thesis' method.
//
// Figures are the stand-ins for those of the thesis, with strokes as there: also the standard
// deviation, inside of them, of what they say is constant.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "kernels/image/strokes/stroke_mask.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

constexpr double kConstant = 0.1;  // standard deviation that counts as constant, natural log units
constexpr float kRadius = 0.06F;   // of a stroke, in shorter sides of the frame
constexpr size_t kSteps[] = {0, 1, 3, 6};
constexpr size_t kTimed = 20;  // frames

double log_of(double value) { return std::log(std::max(value, 1e-4)); }

struct Moments {
  double sum = 0, squares = 0, count = 0;
  void add(double value) { sum += value, squares += value * value, ++count; }
  double deviation() const {
    return count > 0 ? std::sqrt(std::max(squares / count - std::pow(sum / count, 2), 0.0)) : 0;
  }
};

/// The stroke that this user draws next; nothing if none helps.
std::optional<Stroke> next_stroke(const TruthFrame& frame, const Decomposition& now,
                                  const std::vector<Stroke>& drawn, bool fill) {
  const int width = frame.input.width, height = frame.input.height;
  const float radius = kRadius * static_cast<float>(std::min(width, height));
  const int reach = std::max(static_cast<int>(radius), 1);
  std::optional<Stroke> best;
  double worst = 0;
  for (int cy = reach; cy < height - reach; cy += std::max(reach / 2, 1))
    for (int cx = reach; cx < width - reach; cx += std::max(reach / 2, 1)) {
      const Stroke::Point center{static_cast<float>(cx) + .5F, static_cast<float>(cy) + .5F};
      if (std::any_of(drawn.begin(), drawn.end(), [&](const Stroke& stroke) {
            return std::hypot(stroke.points[0][0] - center[0], stroke.points[0][1] - center[1]) <
                   radius;
          }))
        continue;
      Moments shading, reflectance, error;
      bool inside = true;
      for (int y = cy - reach; y <= cy + reach; ++y)
        for (int x = cx - reach; x <= cx + reach; ++x) {
          if (std::hypot(x - cx, y - cy) > reach) continue;
          if (!frame.mask.empty() && frame.mask.at(x, y, 0) < .5F) inside = false;
          double paint = 0;
          for (int c = 0; c < 3; ++c) paint += static_cast<double>(frame.reflectance.at(x, y, c));
          const double light = log_of(static_cast<double>(frame.shading.at(x, y, 0)));
          shading.add(light);
          reflectance.add(log_of(paint / 3));
          error.add(log_of(static_cast<double>(now.shading.at(x, y, 0))) - light);
        }
      const double constant = std::min(shading.deviation(), reflectance.deviation());
      if (!inside || constant > kConstant || error.deviation() <= worst) continue;
      worst = error.deviation();
      best = Stroke{shading.deviation() < reflectance.deviation() ? Stroke::Kind::shading
                                                                  : Stroke::Kind::reflectance,
                    {center},
                    radius,
                    fill};
    }
  return best;
}

/// One frame, solved without history; strokes that are filled need two.
Decomposition solve(DeviceSession& session, ScaledIntrinsic& method, const Image& frame,
                    const StrokesPtr& strokes) {
  Decomposition result;
  for (const bool reset : {true, false}) {
    Cost cost;
    result = session.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method.record(commands, input, {}, {.reset = reset, .strokes = strokes});
        },
        cost);
  }
  return result;
}

/// So by the thesis' method.
Decomposition solve(DeviceSession& session, ThesisDecomposition& method, const Image& frame,
                    const StrokesPtr& strokes) {
  ThesisStrokes drawn;
  if (strokes)
    for (const Stroke& stroke : strokes->strokes)
      drawn.kinds.push_back(stroke.kind == Stroke::Kind::shading
                                ? ThesisStrokes::Kind::shading
                                : ThesisStrokes::Kind::reflectance);
  method.reset();
  Cost cost;
  return session.run(
      frame,
      [&](gpu::Commands& commands, const PlanePtr& input) {
        if (strokes) {
          StrokeMask mask(session.device(), input->extent);
          mask.set(commands, strokes, {});
          drawn.mask = mask.pixels();
        }
        method.set_strokes(drawn);
        Layers layers;
        method.record(commands, *input, layers);
        return layers;
      },
      cost);
}

/// Median processor time of a frame of a still picture that is solved anew each time.
double cost_of(DeviceSession& session, Extent extent, const Image& frame,
               const StrokesPtr& strokes) {
  ScaledIntrinsic method(session.device(), extent);
  ScaledIntrinsic::Params params;
  params.adaptive = false;
  std::vector<double> costs;
  for (size_t i = 0; i < kTimed; ++i) {
    Cost cost;
    session.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method.record(commands, input, params, {.reset = i == 0, .strokes = strokes});
        },
        cost);
    if (i > 2) costs.push_back(cost.processor);
  }
  return median(costs);
}

/// A scene's first frame as 8 bits, and its size.
TruthFrame first_frame(const Scene& scene, Extent& extent) {
  TruthFrame frame = scene.frames.front();
  frame.input = through_8_bits(frame.input);
  extent = {static_cast<uint32_t>(frame.input.width), static_cast<uint32_t>(frame.input.height)};
  return frame;
}

double lmse_of(const Decomposition& now, const TruthFrame& frame) {
  return score_lmse(now.reflectance, now.shading, frame.reflectance, frame.shading, frame.mask);
}

void measure(DeviceSession& session, const Scene& scene, bool fill) {
  if (scene.frames.front().reflectance.empty()) return;
  Extent extent;
  const TruthFrame frame = first_frame(scene, extent);
  ScaledIntrinsic method(session.device(), extent);
  ThesisDecomposition thesis(session.device(), extent);
  std::vector<Stroke> drawn;
  std::vector<double> of_thesis;
  std::printf("| %s %s |", scene.set.c_str(), scene.name.c_str());
  Decomposition now = solve(session, method, frame.input, {});
  StrokesPtr strokes;
  for (size_t count = 0;; ++count) {
    if (std::find(std::begin(kSteps), std::end(kSteps), count) != std::end(kSteps)) {
      std::printf(" %.4f |", lmse_of(now, frame));
      if (!fill) of_thesis.push_back(lmse_of(solve(session, thesis, frame.input, strokes), frame));
    }
    if (count == kSteps[std::size(kSteps) - 1]) break;
    if (const auto next = next_stroke(frame, now, drawn, fill)) {
      drawn.push_back(*next);
      strokes = std::make_shared<StrokeList>(StrokeList{drawn, extent});
      now = solve(session, method, frame.input, strokes);
    }
  }
  for (const double lmse : of_thesis) std::printf(" %.4f |", lmse);
  const auto light = std::count_if(drawn.begin(), drawn.end(), [](const Stroke& stroke) {
    return stroke.kind == Stroke::Kind::shading;
  });
  std::printf(
      " %d, %d | %.2f |\n", static_cast<int>(light),
      static_cast<int>(drawn.size()) - static_cast<int>(light),
      cost_of(session, extent, frame.input, strokes) / cost_of(session, extent, frame.input, {}));
}

/// A user's strokes on a scene of stroke-scenes.
struct Figure {
  const char* scene;
  std::vector<Stroke> strokes;
};

std::vector<Figure> figures() {
  using Kind = Stroke::Kind;
  // Light comes from the left: what it does on a plane, or a shirt, is nearly constant downward.
  std::vector<Stroke> chart, shirt;
  for (int column = 0; column < 6; ++column) {
    const float x = 53 + 42.5F * static_cast<float>(column);
    chart.push_back({Kind::shading, {{x, 44}, {x, 186}}, 15});
  }
  for (const float x : {136.0F, 160.0F, 184.0F})
    shirt.push_back({Kind::shading, {{x, 94}, {x, 142}}, 12});
  return {{"chart", chart},
          {"cloth",
           {{Kind::reflectance,
             {{80, 30}, {236, 30}, {80, 110}, {236, 110}, {80, 180}, {236, 180}},
             24}}},
          {"shirt", shirt}};
}

/// Mean over strokes of the standard deviation of what each says is constant, natural log units.
double deviation(const std::vector<Stroke>& strokes, const Image& reflectance,
                 const Image& shading) {
  double sum = 0;
  for (const Stroke& stroke : strokes) {
    Moments moments;
    for (int y = 0; y < shading.height; ++y)
      for (int x = 0; x < shading.width; ++x) {
        if (!covers(stroke, {static_cast<float>(x) + .5F, static_cast<float>(y) + .5F})) continue;
        double paint = 0;
        for (int c = 0; c < 3; ++c) paint += static_cast<double>(reflectance.at(x, y, c)) / 3;
        moments.add(log_of(stroke.kind == Stroke::Kind::shading
                               ? static_cast<double>(shading.at(x, y, 0))
                               : paint));
      }
    sum += moments.deviation() / static_cast<double>(strokes.size());
  }
  return sum;
}

/// The deviation and LMSE of a method, without and with strokes.
template <typename Method>
void print_figure(DeviceSession& session, Method& method, const TruthFrame& frame,
                  const StrokesPtr& strokes) {
  const Decomposition before = solve(session, method, frame.input, {}),
                      after = solve(session, method, frame.input, strokes);
  std::printf(" %.3f | %.3f | %.4f | %.4f |",
              deviation(strokes->strokes, before.reflectance, before.shading),
              deviation(strokes->strokes, after.reflectance, after.shading), lmse_of(before, frame),
              lmse_of(after, frame));
}

void measure_figures(DeviceSession& session, const std::string& folder) {
  std::printf(
      "| scene | deviation of the truth | intrinsicdecomp: deviation, without | with | LMSE, "
      "without | with | thesis: deviation, without | with | LMSE, without | with |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  const std::vector<Scene> scenes = read_scenes(folder);
  for (const Figure& figure : figures()) {
    const auto scene = std::find_if(scenes.begin(), scenes.end(),
                                    [&](const Scene& s) { return s.name == figure.scene; });
    if (scene == scenes.end())
      throw std::runtime_error(folder + " has no scene " + figure.scene + ": run stroke-scenes");
    Extent extent;
    const TruthFrame frame = first_frame(*scene, extent);
    ScaledIntrinsic method(session.device(), extent);
    ThesisDecomposition thesis(session.device(), extent);
    const auto strokes = std::make_shared<StrokeList>(StrokeList{figure.strokes, extent});
    std::printf("| %s | %.3f |", figure.scene,
                deviation(figure.strokes, frame.reflectance, frame.shading));
    print_figure(session, method, frame, strokes);
    print_figure(session, thesis, frame, strokes);
    std::printf("\n");
  }
}

void run(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const bool fill = std::count(words.begin(), words.end(), "--fill") > 0;
  DeviceSession session("");
  if (words.size() == 2 && words[0] == "--figures") return measure_figures(session, words[1]);
  std::printf(
      "| scene | without | 1 stroke | 3 | 6 |%s of shading, of reflectance | time of a frame "
      "|\n|---|---|---|---|---|%s---|---|\n",
      fill ? "" : " thesis: without | 1 stroke | 3 | 6 |", fill ? "" : "---|---|---|---|");
  size_t measured = 0;
  for (const std::string& folder : words) {
    if (folder == "--fill") continue;
    for (const Scene& scene : read_scenes(folder)) {
      measure(session, scene, fill);
      std::fflush(stdout);
      ++measured;
    }
  }
  if (measured == 0)
    throw std::runtime_error("usage: stroke-bench [--fill] FOLDER…, or --figures FOLDER");
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  inverse::bench::run(argc, argv);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "stroke-bench: %s\n", error.what());
  return 1;
}
