// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/quality_levels.hpp"
#include "layer_view.hpp"
#include "rate_controller.hpp"

namespace inverse {

class Interaction;

/// The parameters that every decomposer has.
struct DecomposerParams : ShowParams {
  Quality quality = Quality::medium;
  double target_fps = 0;      ///< frames a second to hold; 0: any
  double latency_budget = 0;  ///< ms for a frame; 0: any
  /// Adapts the defaults to what is set of other properties.
  void take_defaults(const DecomposerParams& /*set*/) {}
  /// Computes what follows from the properties, once all are read.
  void derive() {}
};

/// What Decomposer needs of the parameters in force for a frame.
struct FrameSettings {
  ShowParams view;
  bool adaptive = true;
  bool changed = false;  ///< the method's differ from those of the frame before
};

/// The properties of a decomposer and its quality levels (MethodSettings).
class DecomposerSettings {
 public:
  virtual ~DecomposerSettings() = default;
  virtual PropertyStore& store() = 0;
  /// Work of the quality levels, lowest first (RateController).
  virtual std::vector<double> level_costs() const = 0;
  /// The property at the moment. From any thread.
  virtual bool adaptive() const = 0;
  /// Reads the parameters for the next frame, and chooses the level of work by them.
  virtual FrameSettings next(RateController& controller) = 0;
};

/// The method of a decomposer, for frames of one size on one device. Calls come as for Filter.
class DecompositionMethod {
 public:
  virtual ~DecompositionMethod() = default;
  virtual DecomposerSettings& settings() = 0;
  virtual void configure(const std::shared_ptr<gpu::Device>& device, Extent extent,
                         const Log& log) = 0;
  virtual void release() = 0;
  virtual void reset() = 0;
  /// Fills `frame.layers` from its input layer. Returns the method's own number for the frame.
  virtual uint64_t decompose(FrameContext& frame) = 0;
  /// Whether another run on the same picture would change nothing visible. `completed` is a
  /// completed frame (the method's number) of that picture with the same parameters; empty if there
  /// is none yet.
  virtual bool converged(std::optional<uint64_t> completed) const = 0;
  /// Whether the time of a frame (the method's number) predicts that of others at its level.
  virtual bool typical(uint64_t /*number*/) const { return true; }
  /// A frame (the method's number) is completed.
  virtual void completed(uint64_t /*number*/) {}
  /// Draws every pixel in the color of its cluster; false: LayerView::draw_palette does.
  virtual bool draw_clusters(FrameContext& /*frame*/, const Plane& /*target*/) { return false; }
  /// What of a frame (the method's number) was skipped, and what was run although it might be
  /// skipped: "stage: reason".
  struct Work {
    std::vector<std::string> skipped, run;
  };
  virtual Work work(uint64_t /*number*/) const { return {}; }
  /// Adds fields about a completed frame (the method's number).
  virtual void describe(GstStructure* stats, uint64_t number) const = 0;
  /// Whether users have asked for something since the last frame that shows in its layers.
  virtual bool requested() const { return false; }
  /// Strokes and the remembered scene; null if the method has neither.
  virtual Interaction* interaction() { return nullptr; }
  /// As in Filter.
  virtual void ended() {}
  virtual void navigate(const Log& /*log*/, const MouseEvent& /*event*/) {}
  virtual void flushed() {}
};

/// The parameters of a method that has quality levels. `P` derives from DecomposerParams and
/// MethodParams, and has `adaptive`.
template <typename P, typename MethodParams>
class MethodSettings final : public DecomposerSettings {
 public:
  /// `complete` adds to the parameters of a frame what takes more than the properties.
  MethodSettings(const PropertyTable<P>& table, const QualityLevels<MethodParams>& levels,
                 std::function<void(P&)> complete = {})
      : parameters_(table,
                    [&levels](const P& set) {
                      return defaults(set, levels.levels[levels.top(set.quality)]);
                    }),
        levels_(levels),
        complete_(std::move(complete)) {}
  PropertyStore& store() override { return parameters_; }
  std::vector<double> level_costs() const override { return levels_.costs(); }
  bool adaptive() const override { return properties().adaptive; }
  /// As the properties say at the moment. From any thread.
  P properties() const {
    P now = parameters_.snapshot();
    now.derive();
    return now;
  }
  FrameSettings next(RateController& controller) override {
    P next = parameters_.snapshot();
    const size_t top = levels_.top(next.quality);
    controller.set_goal({next.target_fps, next.latency_budget}, top);
    if (controller.level() != top)
      next = parameters_.snapshot(
          [&](P& params) { params = defaults(params, levels_.levels[controller.level()]); });
    next.derive();
    if (complete_) complete_(next);
    const MethodParams &before = params_, &now = next;
    const bool changed = before != now;
    params_ = next;
    return {params_, params_.adaptive, changed};
  }
  /// In force for this frame.
  const P& params() const { return params_; }

 private:
  /// The properties that are not set, at a level of work.
  static P defaults(const P& set, const Level<MethodParams>& level) {
    P params;
    params.quality = set.quality;
    level.set(params);
    params.take_defaults(set);
    return params;
  }

  Parameters<P> parameters_;
  const QualityLevels<MethodParams>& levels_;
  std::function<void(P&)> complete_;
  P params_;
};

/// The text of the property `quality`.
struct QualityText {
  const char* sets;  ///< which parameters it stands for
  /// The name of the enumeration, and what each of its values means.
  const char* type = "GstInverseQuality";
  std::array<const char*, 4> values = {"Half resolution: fastest, more flicker",
                                       "Live video: sharp shadows, small objects, steady colors",
                                       "More iterations, for files",
                                       "Many iterations, for reference"};
  std::vector<Choice> choices() const;
};

/// The properties of DecomposerParams, then the method's own.
template <typename P>
PropertyTable<P> decomposer_properties(const QualityText& quality, const PropertyTable<P>& own,
                                       Makes makes = Makes::intrinsic) {
  const bool global = makes == Makes::global;
  PropertyTable<P> table{
      choice<P>("show", &P::show, global ? "GstInverseGlobalShow" : "GstInverseShow",
                show_choices(makes),
                "Layer to show as ordinary video; elements that take layers get all of them"),
      choice<P>("quality", &P::quality, quality.type, quality.choices(), quality.sets),
      number<P>("target-fps", &P::target_fps, 0., 1000.,
                "Frames a second to hold by reducing the work for each, down from quality; 0 = "
                "no target"),
      number<P>("latency-budget", &P::latency_budget, 0., 1e5,
                "Maximum time for a frame in this element, ms, held by reducing the work; 0 = no "
                "limit"),
  };
  table.append({number<P>("shading-scale", &P::shading_scale, 0.f, 100.f,
                          "Factor on light that is shown, before it is clipped at 1")});
  if (global)
    table.append({number<P>("layer", &P::layer, 0, static_cast<int>(kMaxBases) - 1,
                            "Base color whose layer show=layer shows")});
  table.append(own);
  return table;
}

}  // namespace inverse
