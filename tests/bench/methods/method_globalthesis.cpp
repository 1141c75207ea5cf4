// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsicthesis in the benchmark.
#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "kernels/thesis/chapter5/correction/misclustering_correction.hpp"
#include "kernels/thesis/chapter5/global_thesis_levels.hpp"
#include "methods.hpp"
#include "tests/lab.hpp"
#include "truth_clicks.hpp"

namespace inverse::bench {
namespace {

using Params = GlobalThesisParams;
using Effort = Setting::Effort;

/// Minimum number of pixels of a base color: a thousandth of 320 × 240.
constexpr std::size_t kMinPixels = 77;

/// The default of the element.
Params default_params() {
  Params params;
  global_thesis_levels().set(params, Quality::medium);
  return params;
}

/// The same for single frames, which have no keyframes.
Params still_params() {
  Params params = default_params();
  params.keyframes = 0;
  params.cut_chroma = 0;
  return params;
}

/// The base colors of a scene after the element has shown one frame repeatedly: clusters, corrected
/// if clicked, refined.
class FoundColors {
 public:
  enum class Clicks : std::uint8_t {
    none,
    corrected,    ///< at pixels that are misclustered by the truth; the method chooses the color
                  ///< (5.11)
    true_colors,  ///< there, with the true color; never refined
  };
  struct Found {
    BaseColors initial, refined;
    /// (slot or −1, region or 0) a pixel, on the device; null: no region is marked.
    PlanePtr regions;
    std::map<std::string, std::vector<double>> figures;
  };

  explicit FoundColors(DeviceSession& session) : session_(session) {}

  /// Computed once for the last requested frame.
  const Found& of(const TruthFrame& frame, Clicks clicks) {
    if (frame.input.data != frame_) found_.clear();
    frame_ = frame.input.data;
    const auto known = found_.find(clicks);
    return known != found_.end() ? known->second
                                 : found_.emplace(clicks, find(frame, clicks)).first->second;
  }

 private:
  /// The cluster of every pixel, or the color of its region instead.
  std::vector<int> slots(const GlobalThesis& method, const MarkedRegions& regions) const {
    const Pixels features = lab_.download(method.features());
    Pixels marked;
    if (!regions.regions().empty()) marked = lab_.download(regions.plane().buffer);
    std::vector<int> result(method.extent().pixels());
    for (std::size_t n = 0; n < result.size(); ++n) {
      result[n] = int(features[4 * n + 3]);
      if (!marked.empty() && marked[4 * n] >= 0) result[n] = int(marked[4 * n]);
    }
    return result;
  }

  Found find(const TruthFrame& frame, Clicks clicks) {
    const Extent extent{uint32_t(frame.input.width), uint32_t(frame.input.height)};
    const PlanePtr input = session_.upload(frame.input);
    GlobalThesis method(session_.device(), extent);
    MarkedRegions regions(session_.device(), extent);
    Params params = still_params(), brief = params;
    brief.refine_rounds = 0;
    brief.steps = brief.pcg_iterations = 1;  // clusters need no solve
    const auto show = [&] {
      std::uint64_t number = 0;
      Layers layers;
      lab_.run([&](gpu::Commands& c) {
        GlobalThesis::Hints hints;
        hints.regions = &regions;
        number = method.record(c, *input, layers, hints);
      });
      method.collect(number);
      regions.collect(regions.last());
    };
    method.set_params(brief);
    lab_.run([&](gpu::Commands& c) { method.record_colors(c, *input); });
    method.collect_colors();
    show();
    Found found;
    found.initial = method.colors();
    if (clicks != Clicks::none) {
      mark(method, regions, frame, clicks, show, found.figures);
      show();
      found.regions = std::make_shared<Plane>(Plane{
          extent, gpu::Buffer::create(session_.device(), gpu::Element::vec4, extent.pixels())});
      lab_.run([&](gpu::Commands& c) {
        const gpu::BufferPtr from = regions.plane().buffer;
        c.copy(from, found.regions->buffer, from->bytes());
      });
    }
    const std::vector<int> assigned = slots(method, regions);
    params.refine_rounds = clicks == Clicks::true_colors ? 0 : Params{}.refine_rounds;
    method.set_params(params);
    method.refine();
    int frames = 0;
    for (; method.refining() && frames < 2 * params.refine_rounds; ++frames) show();
    found.refined = method.colors();
    for (const bool initial : {true, false})
      found.figures[initial ? "base_before" : "base_after"] = base_color_errors(
          frame.reflectance, assigned, initial ? found.initial.colors() : found.refined.colors(),
          initial, kMinPixels);
    found.figures["refining_frames"] = {double(frames)};
    const TrueSlots truth(frame.reflectance, frame.mask, found.initial.colors());
    const std::vector<std::uint8_t> wrong = truth.wrong(assigned);
    found.figures["misclustered"] = {std::accumulate(wrong.begin(), wrong.end(), 0.0) /
                                     double(wrong.size())};
    return found;
  }

  /// Clicks by the truth, and waits for the decisions.
  void mark(GlobalThesis& method, MarkedRegions& regions, const TruthFrame& frame, Clicks clicks,
            const std::function<void()>& show,
            std::map<std::string, std::vector<double>>& figures) const {
    const TrueSlots true_slots(frame.reflectance, frame.mask, method.colors().colors());
    const std::vector<int> assigned = slots(method, regions);
    const int width = frame.input.width;
    std::vector<Component> where = wrong_components(
        assigned, true_slots.wrong(assigned), true_slots.nearest(), width, frame.input.height);
    where.resize(std::min<std::size_t>(where.size(), MarkedRegions::kMaxRegions));
    std::map<int, int> truth;  // color of a region
    for (const Component& component : where) {
      const int number = regions.click(component.click() % width, component.click() / width);
      truth[number] = component.right;
      if (clicks == Clicks::true_colors) regions.set_color(number, component.right);
    }
    show();
    figures["clicks"] = {double(where.size())};
    if (clicks == Clicks::true_colors) return;
    // Candidates are decomposed with the method's own settings.
    Params params = still_params();
    params.refine_rounds = 0;
    const Params own = method.params();
    method.set_params(params);
    MisclusteringCorrection correction(session_.device(), method.extent());
    const auto undecided = [&] {
      return std::any_of(regions.regions().begin(), regions.regions().end(),
                         [](const auto& r) { return r.number > 0 && r.color < 0; });
    };
    constexpr int kMaxDecisions = 2 * MarkedRegions::kMaxRegions * BaseColors::kMaxColors;
    for (int k = 0; undecided() && k < kMaxDecisions; ++k) {
      std::uint64_t number = 0;
      lab_.run([&](gpu::Commands& c) { number = correction.record(c, method, regions); });
      correction.collect(number, regions);
      for (const int region : correction.take_hopeless()) regions.remove(region);
    }
    method.set_params(own);
    double right = 0;
    for (const auto& region : regions.regions())
      right += region.number > 0 && truth.count(region.number) > 0 &&
               truth.at(region.number) == region.color;
    figures["clicks_right"] = {right};
  }

  DeviceSession& session_;
  const Lab lab_{session_.device()};
  std::vector<float> frame_;
  std::map<Clicks, Found> found_;
};

/// A frame of a running video: with base colors that were found before.
class StillSolver final : public Solver {
 public:
  struct Options {
    FoundColors::Clicks clicks = FoundColors::Clicks::none;
    bool refined = true;
    bool reports = false;  ///< report statistics of the base colors
  };
  StillSolver(DeviceSession& session, std::shared_ptr<FoundColors> palette, Size size,
              const Params& params, const Options& options)
      : session_(session),
        palette_(std::move(palette)),
        options_(options),
        method_(session.device(), {uint32_t(size.width), uint32_t(size.height)}) {
    method_.set_params(params);
  }

  void show(const TruthFrame& truth) override { truth_ = &truth; }

  Decomposition run(const Image& frame, bool /*continues*/, Cost& cost) override {
    const FoundColors::Found& found = palette_->of(*truth_, options_.clicks);
    method_.reset();
    method_.set_base_colors(options_.refined ? found.refined : found.initial);
    GlobalThesis::Hints hints;
    hints.fixed_regions = found.regions.get();
    std::uint64_t number = 0;
    Decomposition d = session_.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          Layers layers;
          number = method_.record(commands, *input, layers, hints);
          return layers;
        },
        cost);
    if (options_.reports) d.figures = found.figures;
    d.figures["layers"] = {double(method_.stats(number).layers)};
    return d;
  }

 private:
  DeviceSession& session_;
  std::shared_ptr<FoundColors> palette_;
  Options options_;
  GlobalThesis method_;
  const TruthFrame* truth_ = nullptr;
};

/// A video from its first frame on; base colors are refined while it runs.
class VideoSolver final : public Solver {
 public:
  VideoSolver(DeviceSession& session, Size size, const Params& params)
      : session_(session),
        method_(session.device(), {uint32_t(size.width), uint32_t(size.height)}) {
    method_.set_params(params);
  }

  Decomposition run(const Image& frame, bool continues, Cost& cost) override {
    if (!continues) {
      method_.reset();
      const PlanePtr input = session_.upload(frame);
      gpu::Commands commands(session_.device());
      commands.begin();
      method_.record_colors(commands, *input);
      commands.submit();
      commands.wait();
      method_.collect_colors();
    }
    std::uint64_t number = 0;
    Decomposition d = session_.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          Layers layers;
          number = method_.record(commands, *input, layers);
          return layers;
        },
        cost);
    method_.collect(number);
    return d;
  }

 private:
  DeviceSession& session_;
  GlobalThesis method_;
};

}  // namespace

Method globalintrinsicthesis(DeviceSession& session) {
  Method method{"globalintrinsicthesis",
                "method",
                "Chapter 5 of the thesis: direct light and a layer of indirect light for each base "
                "color",
                {},
                {},
                {}};
  const auto palette = std::make_shared<FoundColors>(session);
  const auto add = [&](Setting setting, const Params& params, const StillSolver::Options& options) {
    setting.make = [&session, palette, params, options](Size size) -> std::unique_ptr<Solver> {
      return std::make_unique<StillSolver>(session, palette, size, params, options);
    };
    setting.layers_only = true;
    setting.sets = {"own", "cornell", "room"};  // others would take half an hour more
    setting.effort = Effort::full;
    method.settings.push_back(setting);
  };
  const auto& table = global_thesis_levels();
  for (std::size_t k = 0; k < table.levels.size(); ++k) {
    Params params = still_params();
    table.levels[k].set(params);
    Setting s{.curve = "quality",
              .name = std::to_string(params.steps) + "x" + std::to_string(params.pcg_iterations),
              .order = double(k),
              .parameters = {{"steps", std::to_string(params.steps)},
                             {"pcg-iterations", std::to_string(params.pcg_iterations)}}};
    for (const auto& [quality, name] : kQualities)
      if (table.top(quality) == k) s.preset = name;
    s.base = s.photographs = k == table.top(Quality::medium);
    const bool base = s.base;
    add(std::move(s), params, {.reports = base});
  }
  const struct {
    const char* curve;
    const char* name;
    StillSolver::Options options;
    void (*change)(Params&);
  } variants[] = {
      {"without", "refinement", {.refined = false}, [](Params&) {}},
      {"without", "sparsity term", {}, [](Params& p) { p.lambda_i_sparsity = 0; }},
      {"without", "soft Retinex weight", {}, [](Params& p) { p.alpha_sr = 1e4F; }},
      {"with", "correction", {FoundColors::Clicks::corrected, true, true}, [](Params&) {}},
      {"with",
       "correction, no refinement",
       {FoundColors::Clicks::corrected, false},
       [](Params&) {}},
      {"with",
       "true colors, no refinement",
       {FoundColors::Clicks::true_colors, false},
       [](Params&) {}}};
  double order = 0;
  for (const auto& [curve, name, options, change] : variants) {
    Params params = still_params();
    change(params);
    add({.curve = curve, .name = name, .order = order++, .parameters = {{curve, name}}}, params,
        options);
  }
  method.settings.push_back({.curve = "video",
                             .name = "as it ships",
                             .make = [&session](Size size) -> std::unique_ptr<Solver> {
                               return std::make_unique<VideoSolver>(session, size,
                                                                    default_params());
                             },
                             .preset = "medium",
                             .stills = false,
                             .video = true,
                             .layers_only = true,
                             .sets = {"cornell", "room"},
                             .effort = Effort::full});
  return method;
}

}  // namespace inverse::bench
