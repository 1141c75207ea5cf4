// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <optional>

#include "gst/base/filter.hpp"
#include "gst/base/frames/light_pictures.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "kernels/palette/scene_palette.hpp"
#include "kernels/quality_levels.hpp"
#include "rate_controller.hpp"

namespace inverse {

/// What a decomposer shows where pixels go out.
enum class Show {
  reflectance,
  shading,
  input,
  mosaic,
  clusters,
  direct,  ///< the last three: of decomposers that make layers of light
  indirect,
  layer,
};

/// The parameters that every decomposer has.
struct DecomposerParams {
  Show show = Show::reflectance;
  int layer = 0;  ///< base color, of Show::layer
  Quality quality = Quality::medium;
  double target_fps = 0;      ///< frames a second to hold; 0: any
  double latency_budget = 0;  ///< ms that a frame may take; 0: any time
  /// Computes what follows from the properties, once all are read.
  void derive() {}
};

/// What every decomposer of reflectance and shading shares: `show`, keeping the layers of pictures
/// that come again, and `target-fps`/`latency-budget`. A method derives from it and fills the
/// layers.
///
/// A picture that came again keeps the layers of the frame before without running the method, where
/// the method's parameters are the same, `adaptive` is on and the method has settled on it. For
/// that the planes of the last frame are held, and editors have to copy them; so they are held only
/// while repeats go on (FrameContext::hold).
class Decomposer : public Filter {
 public:
  explicit Decomposer(std::span<const double> level_costs)
      : rate_controller_(level_costs), logged_level_(rate_controller_.level()) {}
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override;
  void release() override;
  void process(FrameContext& frame) final;
  void took(uint64_t number, double milliseconds) final;
  void late(double milliseconds) final;
  void describe(GstStructure* stats, uint64_t number) const final;

 protected:
  /// What there is to know of the parameters in force for a frame.
  struct Settings {
    Show show = Show::reflectance;
    int layer = 0;
    bool adaptive = true;
    bool changed = false;  ///< the method's differ from those of the frame before
  };
  /// Takes the parameters for the next frame, and chooses the level of work by them.
  virtual Settings next_settings(RateController& controller) = 0;
  /// Runs the method: fills `frame.layers` from its input layer. Returns the method's own number
  /// for the frame.
  virtual uint64_t decompose(FrameContext& frame) = 0;
  /// Whether running the method again on the same picture is worth nothing. `done` is a frame (the
  /// method's number) of that picture with the same parameters that is completed; nothing where
  /// there is none yet.
  virtual bool settled(std::optional<uint64_t> done) const = 0;
  /// Whether a frame (the method's number) took what others of its level will.
  virtual bool typical(uint64_t /*number*/) const { return true; }
  /// Nothing of a frame (the method's number) is left to be done on the device.
  virtual void done(uint64_t /*number*/) {}
  /// Draws every pixel in the color of what it counts as.
  virtual void draw_clusters(FrameContext& frame, const Plane& target);
  /// Adds to the stats what the method tells of a completed frame (the method's number).
  virtual void describe_method(GstStructure* stats, uint64_t number) const = 0;

  void reset() override;

  /// The layers that a decomposer makes.
  enum class Makes { intrinsic, global };
  /// What `quality` tells of itself.
  struct QualityText {
    const char* sets;  ///< which parameters it stands for
    /// The name of the enumeration of its values, and what each of them means. Of a type of its own
    /// where that is something else.
    const char* type = "GstInverseQuality";
    std::array<const char*, 4> values = {
        "The least work without visible loss on most video",
        "Live video: sharp shadows, small objects and steady colors as well",
        "More iterations, for files", "Many iterations, for reference"};
  };
  /// The properties of DecomposerParams, then the method's own.
  template <typename P>
  static PropertyTable<P> properties(const QualityText& quality, const PropertyTable<P>& own,
                                     Makes makes = Makes::intrinsic) {
    const bool global = makes == Makes::global;
    PropertyTable<P> table{
        choice<P>("show", &P::show, global ? "GstInverseGlobalShow" : "GstInverseShow",
                  show_choices(makes),
                  "Layer to show as ordinary video; elements that take layers get all of them"),
        choice<P>("quality", &P::quality, quality.type, quality_choices(quality), quality.sets),
        number<P>("target-fps", &P::target_fps, 0., 1000.,
                  "Frames a second to hold by reducing the work for each, down from quality; 0 = "
                  "no target"),
        number<P>("latency-budget", &P::latency_budget, 0., 1e5,
                  "Longest time for a frame in this element, ms, held by reducing the work; 0 = no "
                  "limit"),
    };
    if (global)
      table.push_back(number<P>("layer", &P::layer, 0, static_cast<int>(kMaxBases) - 1,
                                "Base color whose layer show=layer shows"));
    table.insert(table.end(), own.begin(), own.end());
    return table;
  }

 private:
  static std::vector<Choice> show_choices(Makes makes);
  static std::vector<Choice> quality_choices(const QualityText& text);
  /// Whether a frame keeps the layers of the one before, and why, for the log.
  struct Decision {
    bool keep;
    const char* reason;
  };
  Decision decide(const FrameContext& frame, const Settings& settings);
  void draw(FrameContext& frame, const Settings& settings);

  /// What became of one of the last frames.
  struct Past {
    uint64_t method = 0;  // the method's number of the frame whose layers it has
    bool kept = false;
    size_t level = 0;  // of RateController
    uint64_t kept_so_far = 0;
  };
  const Past& past(uint64_t number) const { return past_[number]; }

  std::shared_ptr<gpu::Device> device_;
  std::optional<PlanePool> planes_;
  // Made when they are first asked for.
  std::optional<Mosaic> mosaic_;
  std::optional<ScenePalette> palette_;
  LightPictures light_;

  gpu::FrameRing<Past> past_;
  std::optional<Layers> held_;             // of the frame before
  uint64_t shown_ = 0, shown_before_ = 0;  // frames of this picture, and of the one before
  std::optional<uint64_t> same_;  // the first frame (FrameContext's number) of this picture with
                                  // these parameters
  uint64_t last_method_ = 0;      // the last frame's number
  std::optional<std::pair<Show, int>> drawn_;  // how the frame before was drawn
  uint64_t kept_ = 0;                          // frames since `configure`
  RateController rate_controller_;
  size_t logged_level_;
};

/// A decomposer whose frames all go through one object of the method, made anew for each size:
/// `Method(device, extent)`, with `reset()` for what it remembers of earlier frames. `P` derives
/// from DecomposerParams and Method::Params and has `adaptive`.
template <typename Method, typename P>
class MethodDecomposer : public Decomposer {
 public:
  MethodDecomposer(const PropertyTable<P>& table,
                   const QualityLevels<typename Method::Params>& quality_levels)
      : Decomposer(quality_levels.costs()),
        parameters_(table, preset_of(quality_levels)),
        quality_levels_(quality_levels) {}
  PropertyStore& parameters() override { return parameters_; }
  bool looks_for_repeats() const override {
    P now = parameters_.snapshot();
    now.derive();
    return now.adaptive;
  }

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    Decomposer::configure(device, extent);
    method_.emplace(device, extent);
  }
  void release() override {
    method_.reset();
    Decomposer::release();
  }
  void reset() override {
    Decomposer::reset();
    method_->reset();
  }

 protected:
  Settings next_settings(RateController& controller) override {
    P next = parameters_.snapshot();
    controller.aim({next.target_fps, next.latency_budget}, quality_levels_.top(next.quality));
    if (controller.level() != quality_levels_.top(next.quality))
      next = parameters_.snapshot(quality_levels_.levels[controller.level()].set);
    next.derive();
    const typename Method::Params &before = params_, &now = next;
    const bool changed = before != now;
    params_ = next;
    return {params_.show, params_.layer, params_.adaptive, changed};
  }
  /// In force for this frame.
  const P& params() const { return params_; }

  std::optional<Method> method_;
  Parameters<P> parameters_;

 private:
  /// What a quality stands for.
  static typename Parameters<P>::Preset preset_of(
      const QualityLevels<typename Method::Params>& quality_levels) {
    return [&quality_levels](const P& set) {
      P params;
      params.quality = set.quality;
      quality_levels.set(params, set.quality);
      return params;
    };
  }

  const QualityLevels<typename Method::Params>& quality_levels_;
  P params_;
};

}  // namespace inverse
