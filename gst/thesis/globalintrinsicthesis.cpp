// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsicthesis: chapter 5 of the thesis.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "gst/base/color.hpp"
#include "gst/decompose/decomposer.hpp"
#include "kernels/image/view/mosaic.hpp"
#include "kernels/thesis/chapter5/global_thesis_levels.hpp"
#include "region_messages.hpp"
#include "region_requests.hpp"

namespace inverse {
namespace {

struct Params : GlobalThesisParams, DecomposerParams {
  bool adaptive = true;
  RegionProposals::Mode propose = RegionProposals::Mode::off;
  std::string marks;
};

PropertyTable<Params> own_properties() {
  using P = Params;
  return {
      number<P>(
          "seed", &P::seed, 0u, G_MAXUINT,
          "Seed of sample positions and of the first clusters; equal seeds give equal layers"),
      flag<P>("adaptive", &P::adaptive,
              "Reuse layers of repeated pictures once their base colors are refined"),
      tuning(number<P>("steps", &P::steps, 1, 64, "Gauss-Newton steps of a frame (5.7.1)")),
      tuning(number<P>("pcg-iterations", &P::pcg_iterations, 1, 256,
                       "Conjugate gradient steps for each (5.7.1)")),
      number<P>("base-colors", &P::clusters, 1, static_cast<int>(kMaxBases),
                "Number of chromaticity clusters to find; duplicates are removed (5.5.1)"),
      choice<P>(
          "propose", &P::propose, "GstGlobalIntrinsicThesisPropose",
          {{static_cast<int>(RegionProposals::Mode::off), "off",
            "Only clicks mark regions (5.5.2)"},
           {static_cast<int>(RegionProposals::Mode::report), "report",
            "Post a message for each such region"},
           {static_cast<int>(RegionProposals::Mode::correct), "correct",
            "Also mark them, with the most likely base color"}},
          "Treatment of regions that strong indirect light seems to give the wrong base color"),
      text<P>("marks", &P::marks,
              "Regions to mark once, as positions x,y in pixels with spaces between"),
      tuning(number<P>("lambda-data", &P::lambda_data, 0.f, 1e6f,
                       "Weight of the data term (Eq. 5.4)")),
      tuning(number<P>("lambda-clustering", &P::lambda_clustering, 0.f, 1e6f,
                       "Weight of the distance to clustered reflectance (Eq. 5.6)")),
      tuning(number<P>("lambda-r-sparsity", &P::lambda_r_sparsity, 0.f, 1e6f,
                       "Weight of reflectance sparsity (Eq. 5.7)")),
      tuning(number<P>("lambda-r-consistency", &P::lambda_r_consistency, 0.f, 1e6f,
                       "Weight of the spatio-temporal samples (Eq. 3.12)")),
      tuning(number<P>("lambda-monochrome", &P::lambda_monochrome, 0.f, 1e6f,
                       "Weight of gray shading (Eq. 5.9)")),
      tuning(number<P>("lambda-i-sparsity", &P::lambda_i_sparsity, 0.f, 1e6f,
                       "Weight of few indirect layers in a pixel (Eq. 5.11)")),
      tuning(number<P>("lambda-smoothness", &P::lambda_smoothness, 0.f, 1e6f,
                       "Weight of piecewise constant light (Eq. 5.12)")),
      tuning(number<P>("lambda-non-negativity", &P::lambda_non_negativity, 0.f, 1e6f,
                       "Weight of light that is not negative (Eq. 5.13)")),
      tuning(number<P>("lambda-ir", &P::lambda_ir, 1e-3f, 1e9f,
                       "Refinement: weight of small changes of the base colors (Eq. 5.14)")),
      tuning(number<P>("lambda-cr", &P::lambda_cr, 0.f, 1e9f,
                       "Refinement: weight of their chromaticity (Eq. 5.14)")),
      tuning(number<P>("refine-rounds", &P::refine_rounds, 0, 100,
                       "Maximum refinements of the base colors after a start, a cut or the action "
                       "refine, one a frame")),
      tuning(number<P>("refine-tolerance", &P::refine_tolerance, 0.f, 1.f,
                       "Change of a base color below which refinement ends")),
      tuning(
          number<P>("cut-chroma", &P::cut_chroma, 0.f, 1.f,
                    "Mean change of log chroma, divided by 0.5 (0…1), at which a cut is detected; "
                    "0 = never")),
      tuning(choice<P>("irls", &P::irls, "GstGlobalIntrinsicThesisIrls",
                       {{static_cast<int>(P::Irls::consistent), "consistent",
                         "Weights that minimize the energy (p/2)"},
                        {static_cast<int>(P::Irls::printed), "printed",
                         "As in Eq. 5.16: L1 terms twice as strong"}},
                       "Form of the reweighting factor")),
      tuning(number<P>("p", &P::p, 0.f, 2.f, "Exponent of reflectance sparsity (Eq. 5.7)")),
      tuning(
          number<P>("alpha-sr", &P::alpha_sr, 0.f, 1e4f,
                    "Rise of the soft color Retinex weight with steps of chromaticity (Eq. 5.10); "
                    "10000 = every pixel counts")),
      tuning(number<P>("w-intensity", &P::w_intensity, 0.f, 1.f,
                       "How much less dark pixels' samples count (Eq. 3.6)")),
      tuning(number<P>("tau-cc", &P::tau_cc, 0.f, 3.f,
                       "Chromaticity distance up to which samples bind (Eq. 3.13)")),
      tuning(number<P>("tau-merge", &P::tau_merge, 0.f, 3.f,
                       "Chromaticity distance up to which clusters merge (5.7.1)")),
      tuning(number<P>("tau-neutral", &P::tau_neutral, 0.f, 3.f,
                       "Base colors this near to white in chromaticity get no layer; 0 = all do")),
      tuning(number<P>("epsilon", &P::epsilon, 1e-4f, 1.f,
                       "Smallest light and step of light in a reweighting (5.6.4.1)")),
      tuning(number<P>("epsilon-r", &P::epsilon_r, 1e-4f, 1.f,
                       "Smallest reflectance step in a reweighting, log units")),
      tuning(number<P>("log-floor", &P::log_floor, 1e-6f, 0.5f,
                       "Smallest reflectance and light to start from, 1 = full scale")),
      tuning(number<P>("chroma-floor", &P::chroma_floor, 1e-6f, 0.5f,
                       "Added to intensities before chromaticities are taken, 1 = full scale")),
      tuning(number<P>("indirect-start", &P::indirect_start, 0.f, 1.f,
                       "Share of direct light that all indirect layers together start as")),
      tuning(flag<P>("line-search", &P::line_search,
                     "Shorten steps that raise the energy by more than 5 %")),
      tuning(flag<P>("warm-start", &P::warm_start,
                     "Begin where the last frame ended instead of at the clusters")),
      tuning(number<P>("samples", &P::samples, 0, 64,
                       "Spatio-temporal samples of a pixel (Eq. 3.12)")),
      tuning(number<P>("keyframes", &P::keyframes, 0, 5,
                       "Earlier frames to draw samples from; 0 for stills")),
      tuning(number<P>("keyframe-spacing", &P::keyframe_spacing, 1, 1000,
                       "Frames from one keyframe to the next")),
      tuning(flag<P>("resample", &P::resample,
                     "Draw new sample positions for every frame instead of keeping them")),
      tuning(flag<P>("energy", &P::energy, "Evaluate the energy of every frame for stats")),
  };
}

const PropertyTable<Params>& table() {
  static const PropertyTable<Params> table = decomposer_properties<Params>(
      {"Sets steps and pcg-iterations as a group; what is set explicitly wins",
       "GstGlobalIntrinsicThesisQuality",
       {"3 steps: energy 6 to 14 % above the converged one",
        "5 steps: 4 to 7 % above it; over a second per frame of 320x240 on two cores",
        "8 steps: 3 to 4 % above it", "16 steps: within 1 % of it, for reference"}},
      own_properties(), Makes::global);
  return table;
}

/// A mouse coordinate, which may be any number, as a pixel's; −1 if it is none.
int pixel_of(double coordinate) {
  if (std::isnan(coordinate)) return -1;
  return static_cast<int>(std::clamp(std::floor(coordinate), -1.0, double{G_MAXINT}));
}

class GlobalThesisMethod final : public DecompositionMethod {
 public:
  DecomposerSettings& settings() override { return settings_; }

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent,
                 const Log& log) override {
    log_ = log;
    method_.emplace(device, extent);
    extent_ = extent;
    forget_regions();
    regions_.emplace(device, extent);
    correction_.emplace(device, extent);
    proposals_.emplace(device, extent);
    messages_.forget();
    started_ = false;
    max_colors_ = GlobalThesis::max_layers(*device, extent);
    reported_limit_ = 0;
    // Those that later frames may need, too: for other scenes' colors, refinement, correction.
    method_->set_params(settings_.properties());
    method_->make_kernels();
    correction_->make_kernels(*method_);
  }
  void release() override {
    forget_regions();
    correction_.reset();
    proposals_.reset();
    regions_.reset();
    marks_.clear();
    messages_.forget();
    seen_ = false;
    method_.reset();
  }
  void reset() override {
    method_->reset();
    regions_->reset();
    correction_->reset();
    proposals_->reset();
    messages_.forget();
    started_ = false;
  }
  void flushed() override {
    // What was asked for before there was any frame is meant for the first one.
    if (seen_) requests_.forget_clicks();
  }
  void mark(int x, int y) { requests_.add({x, y, 0, RegionRequests::Click::What::frame}); }
  void unmark(int region) { requests_.add({0, 0, region, RegionRequests::Click::What::unmark}); }
  void refine() { requests_.refine(); }
  void navigate(const Log& /*log*/, const MouseEvent& event) override {
    if (event.kind == MouseEvent::Kind::press)
      requests_.add(
          {pixel_of(event.x), pixel_of(event.y), 0, RegionRequests::Click::What::picture});
  }

  // Marked regions and base colors are refined further while a picture stays.
  bool converged(std::optional<uint64_t> completed) const override {
    return completed.value_or(0) >= method_->scene_since() && messages_.empty() &&
           !regions_->has_lost() && !method_->refining() && !correction_->busy() &&
           requests_.empty() && !proposals_->pending(params().propose) &&
           since_click_ > kClickFrames;
  }

  void completed(uint64_t number) override {
    method_->collect(number);
    if (method_->stats(number).cut) {
      regions_->reset(MarkedRegions::Loss::cut);
      correction_->reset();
      proposals_->reset();
      messages_.forget();
    }
    const Numbers& numbers = numbers_[number];
    regions_->collect(numbers.regions);
    if (const auto result = correction_->collect(numbers.correction, *regions_))
      messages_.corrected(*result);
    for (const auto& proposal : proposals_->collect(numbers.proposals, *regions_))
      messages_.proposed(proposal);
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const auto method = method_->stats(number);
    guint regions = 0, decided = 0;
    for (const auto& region : regions_->regions()) {
      if (region.number > 0) ++regions;
      if (region.number > 0 && region.color >= 0) ++decided;
    }
    gst_structure_set(stats, "indirect-layers", G_TYPE_INT, method.layers, "colors", G_TYPE_INT,
                      method.colors, "steps", G_TYPE_INT, method.steps, "pcg-iterations",
                      G_TYPE_INT, method.pcg_iterations, "keyframes", G_TYPE_INT, method.keyframes,
                      "shortened-steps", G_TYPE_INT, method.shortened, "refining", G_TYPE_BOOLEAN,
                      method.refining, "cut", G_TYPE_BOOLEAN, method.cut, "change", G_TYPE_DOUBLE,
                      static_cast<double>(method.change), "regions", G_TYPE_UINT, regions,
                      "regions-decided", G_TYPE_UINT, decided, "regions-proposed", G_TYPE_UINT,
                      static_cast<guint>(proposals_->count()), nullptr);
    std::vector<guint> bases;
    for (const auto& color : method_->colors().layer_colors()) bases.push_back(srgb_color(color));
    set_color_list(stats, "base-colors", bases);
    if (!method.energy.empty())
      gst_structure_set(stats, "energy", G_TYPE_DOUBLE, method.energy.back().total(), nullptr);
  }

  uint64_t decompose(FrameContext& frame) override {
    method_->set_params(params());
    const Plane& input = *frame.layers[Role::input];
    seen_ = true;
    ++since_click_;
    take_marks(frame);
    take_clicks(frame);
    messages_.lost(regions_->take_lost());
    messages_.post(frame);
    report_color_limit(frame);
    if (!started_) {
      // The only frame that waits: the kernels are built for its base colors.
      method_->record_colors(frame.commands, input);
      frame.commands.submit();
      frame.commands.wait();
      method_->collect_colors();
      frame.commands.begin();
      started_ = true;
    }
    GlobalThesis::Hints hints;
    hints.regions = &*regions_;
    const PlanePtr kept = frame.layers[Role::input];
    const uint64_t number = method_->record(frame.commands, input, frame.layers, hints);
    frame.layers[Role::input] = kept;
    numbers_[number] = {regions_->last(), correction_->record(frame.commands, *method_, *regions_),
                        proposals_->record(frame.commands, *method_, *regions_, params().propose)};
    for (const int region : correction_->take_hopeless())
      regions_->remove(region, MarkedRegions::Loss::no_candidates);
    return number;
  }

 private:
  // Frames after a click in which its region is found and its colors are begun to be tried.
  static constexpr uint64_t kClickFrames = 50;

  /// Clicks on what `marks` names, when it was set anew.
  void take_marks(FrameContext& frame) {
    const std::string& marks = params().marks;
    if (marks == std::exchange(marks_, marks)) return;
    const auto positions = positions_of(marks);
    if (!positions)
      frame.warnings.push_back("marks=\"" + marks +
                               "\" is not understood; write positions in pixels as x,y, several "
                               "of them apart by spaces");
    else
      for (const auto& [x, y] : *positions) mark(x, y);
  }

  void take_clicks(FrameContext& frame) {
    const RegionRequests::Taken taken = requests_.take();
    if (taken.refine) method_->refine();
    if (!taken.clicks.empty()) since_click_ = 0;
    for (auto [x, y, region, what] : taken.clicks) {
      if (what == RegionRequests::Click::What::unmark) {
        proposals_->refuse(region);
        if (!regions_->remove(region))
          GST_CAT_WARNING_OBJECT(log_.category, log_.object, "no region %d is marked", region);
        continue;
      }
      if (what == RegionRequests::Click::What::picture && frame.draw &&
          params().show == Show::mosaic)
        std::tie(x, y) = Mosaic::shown_at(x, y, extent_);
      const int number = regions_->click(x, y);
      RegionMessages::post_marked(frame, x, y, number);
      if (number == 0)
        GST_CAT_WARNING_OBJECT(
            log_.category, log_.object,
            "a click at %d, %d was refused: outside the frame, or %d regions are marked", x, y,
            MarkedRegions::kMaxRegions);
    }
  }

  /// Fewer base colors than were asked for.
  void report_color_limit(FrameContext& frame) {
    const int wanted = params().clusters;
    if (wanted <= max_colors_ || wanted == std::exchange(reported_limit_, wanted)) return;
    GST_CAT_WARNING_OBJECT(
        log_.category, log_.object,
        "base-colors=%d, but the device can bind the layers of %d at %ux%u: make the frame smaller "
        "for more",
        wanted, max_colors_, extent_.width, extent_.height);
    frame.messages.emplace_back(gst_structure_new("inverse-base-colors-limited", "wanted",
                                                  G_TYPE_INT, wanted, "used", G_TYPE_INT,
                                                  max_colors_, nullptr));
  }
  /// Frames of another size may follow. Lost regions are reported with the next frame.
  void forget_regions() {
    flushed();
    if (!regions_) return;
    regions_->reset();
    messages_.lost(regions_->take_lost());
  }

  const Params& params() const { return settings_.params(); }

  Log log_{};
  MethodSettings<Params, GlobalThesisParams> settings_{table(), global_thesis_levels()};
  std::optional<GlobalThesis> method_;
  std::optional<MarkedRegions> regions_;
  std::optional<MisclusteringCorrection> correction_;
  std::optional<RegionProposals> proposals_;
  /// What a frame is to those, by the method's number.
  struct Numbers {
    uint64_t regions = 0, correction = 0, proposals = 0;
  };
  gpu::FrameRing<Numbers> numbers_;
  RegionMessages messages_;
  Extent extent_{};
  int max_colors_ = 0;                       // that the device has room for
  int reported_limit_ = 0;                   // base-colors when it was said that they are too many
  bool seen_ = false;                        // a frame since the stream began
  bool started_ = false;                     // the scene's base colors are known
  uint64_t since_click_ = kClickFrames + 1;  // frames
  RegionRequests requests_;
  std::string marks_;  // that were taken
};

GlobalThesisMethod& method_of(Filter& filter) {
  return static_cast<GlobalThesisMethod&>(static_cast<Decomposer&>(filter).method());
}

}  // namespace

extern const ElementInfo kGlobalIntrinsicThesis;
const ElementInfo kGlobalIntrinsicThesis{
    .factory = "globalintrinsicthesis",
    .type_name = "GstGlobalIntrinsicThesis",
    .long_name = "Global intrinsic decomposition (thesis)",
    .klass = "Filter/Effect/Video",
    .description =
        "Decomposes video into reflectance, direct light and one layer of bounced light for each "
        "base "
        "color, as in chapter 5 of Meka, Live Inverse Rendering; globalintrinsic is faster and "
        "more "
        "accurate",
    .sink = Flow::pixels,
    .src = Flow::pixels_or_layers,
    .layers = kGlobalLayers,
    .create = []() -> std::unique_ptr<Filter> {
      return std::make_unique<Decomposer>(std::make_unique<GlobalThesisMethod>());
    },
    .actions = {{"mark",
                 {G_TYPE_INT, G_TYPE_INT},
                 [](Filter& filter, const GValue* at) {
                   method_of(filter).mark(g_value_get_int(at), g_value_get_int(at + 1));
                 }},
                {"unmark",
                 {G_TYPE_INT},
                 [](Filter& filter, const GValue* region) {
                   method_of(filter).unmark(g_value_get_int(region));
                 }},
                {"refine", {}, [](Filter& filter, const GValue*) { method_of(filter).refine(); }}},
    .navigation = true,
};

}  // namespace inverse
