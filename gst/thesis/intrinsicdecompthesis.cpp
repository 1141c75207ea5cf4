// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecompthesis: chapters 3 and 4 of the thesis.

#include "gst/decompose/decomposer.hpp"
#include "gst/decompose/interaction.hpp"
#include "kernels/image/strokes/stroke_mask.hpp"
#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "kernels/thesis/chapter3/thesis_levels.hpp"

namespace inverse {
namespace {

struct Params : ThesisParams, DecomposerParams, InteractionParams {
  bool adaptive = true;
  Params() {
    scene_memory = false;
    scene_weight = 10;  // w_s (4.3)
  }
  void take_defaults(const Params& set) {
    if (set.formulation != Formulation::chapter4) return;
    set_chapter4(*this);
    scene_memory = true;
  }
};

PropertyTable<Params> own_properties() {
  using P = Params;
  PropertyTable<P> own{
      choice<P>("formulation", &P::formulation, "GstIntrinsicDecompThesisFormulation",
                {{static_cast<int>(P::Formulation::chapter3), "chapter3",
                  "Weights of channels and intensities, clusters of reflectance (3.3)"},
                 {static_cast<int>(P::Formulation::chapter4), "chapter4",
                  "None of these; by default remembers the scene of frames with depth (4.3)"}},
                "Chapter of the thesis whose energy is minimized, with its iterations and levels"),
      number<P>(
          "seed", &P::seed, 0u, G_MAXUINT,
          "Seed of sample positions and of the first clusters; equal seeds give equal layers"),
      flag<P>("adaptive", &P::adaptive,
              "Reuse layers of repeated pictures; false also turns residual-tolerance off"),
      tuning(number<P>("residual-tolerance", &P::residual_tolerance, 0.f, 1.f,
                       "Relative residual at which conjugate gradients end; 0 = all iterations")),
      tuning(choice<P>("solver", &P::solver, "GstIntrinsicDecompThesisSolver",
                       {{static_cast<int>(P::Solver::pcg), "pcg",
                         "Conjugate gradients with inverse diagonal, whole level"},
                        {static_cast<int>(P::Solver::schwarz), "schwarz",
                         "Additive Schwarz on shifted blocks of 16x16"}},
                       "What solves the linear system of a reweighting (thesis 3.5)")),
      tuning(choice<P>("irls", &P::irls, "GstIntrinsicDecompThesisIrls",
                       {{static_cast<int>(P::Irls::consistent), "consistent",
                         "Weights that minimize the energy (p/2)"},
                        {static_cast<int>(P::Irls::printed), "printed",
                         "As in Eq. 3.19: a sparsity 2/p times stronger"}},
                       "Form of the reweighting factor")),
      tuning(number<P>("levels", &P::levels, 0, 12,
                       "Levels of the Gaussian pyramid; 0 = three to five by resolution")),
      tuning(
          number<P>("irls-iterations", &P::irls_iterations, 1, 64, "Reweightings on each level")),
      tuning(number<P>(
          "pcg-iterations", &P::pcg_iterations, 1, 256,
          "Conjugate gradient steps for each reweighting (with solver=schwarz: for each block)")),
      tuning(number<P>("w-data", &P::w_data, 0.f, 1e6f, "Weight of the data term (Eq. 3.5)")),
      tuning(number<P>("w-intensity", &P::w_intensity, 0.f, 1.f,
                       "How much less dark pixels count (Eq. 3.6)")),
      tuning(number<P>("w-reflectance", &P::w_reflectance, 0.f, 1e6f,
                       "Weight of reflectance sparsity (Eq. 3.8)")),
      tuning(number<P>("w-shading", &P::w_shading, 0.f, 1e6f,
                       "Weight of shading smoothness (Eq. 3.9)")),
      tuning(number<P>("w-chromaticity", &P::w_chromaticity, 0.f, 1e6f,
                       "Weight of the chromaticity prior (Eq. 3.10)")),
      tuning(number<P>("w-non-local", &P::w_non_local, 0.f, 1e6f,
                       "Weight of the spatio-temporal samples (Eq. 3.12)")),
      tuning(number<P>("w-clustering", &P::w_clustering, 0.f, 1e6f,
                       "Weight of the reflectance clusters (Eq. 3.15)")),
      tuning(
          number<P>("w-cs", &P::w_cs, 0.f, 1.f, "Scale of the chromaticity similarity (Eq. 3.7)")),
      tuning(number<P>("p", &P::p, 0.f, 2.f,
                       "Exponent of reflectance sparsity; smaller is sparser (Eq. 3.8)")),
      tuning(
          number<P>("alpha-cs", &P::alpha_cs, 0.f, 1e4f,
                    "Fall-off of similarity with chromaticity distance, chromaticities of mean 1 "
                    "(Eq. 3.7)")),
      tuning(number<P>("alpha-clustering", &P::alpha_clustering, 0.f, 1e3f,
                       "Fall-off of the cluster weight with intensity 0...1 (Eq. 3.15)")),
      tuning(number<P>(
          "tau-cc", &P::tau_cc, 0.f, 3.f,
          "Chromaticity distance up to which samples bind and clusters merge (Eq. 3.13)")),
      tuning(number<P>("epsilon", &P::epsilon, 1e-6f, 1.f,
                       "Smallest reflectance step in a reweighting, log units")),
      tuning(number<P>("log-floor", &P::log_floor, 1e-6f, 0.5f,
                       "Smallest intensity before the logarithm, 1 = full scale")),
      tuning(number<P>("chroma-floor", &P::chroma_floor, 1e-6f, 0.5f,
                       "Added to intensities before chromaticities are taken, 1 = full scale")),
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
  own.append(interaction_properties<P>());
  return own;
}

const PropertyTable<Params>& table() {
  static const PropertyTable<Params> table = decomposer_properties<Params>(
      {"Sets iterations as a group; what is set explicitly wins",
       "GstIntrinsicDecompThesisQuality",
       {"Half of the thesis' iterations, in 60 % of the time",
        "As in the thesis: 4 reweightings of 8 iterations a level (3.6.5); chapter4: 7 of 7 (4.7)",
        "7 x 8 iterations, with which the thesis shows convergence; chapter4: 12 x 7",
        "16 x 16 iterations, for reference; chapter4: 28 x 14"}},
      own_properties());
  return table;
}

class ThesisMethod final : public DecompositionMethod {
 public:
  DecomposerSettings& settings() override { return settings_; }
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent,
                 const Log& log) override {
    method_.emplace(device, extent);
    mask_.emplace(device, extent);
    interaction_.configure(device, extent, log);
  }
  void release() override {
    method_.reset();
    mask_.reset();
    before_ = {};
    interaction_.release();
  }
  void reset() override {
    method_->reset();
    method_->set_strokes({});
    mask_->forget();
    before_ = {};
    interaction_.reset();
  }

  uint64_t decompose(FrameContext& frame) override {
    const Params& set = settings_.params();
    ThesisParams params = set;
    if (!set.adaptive) params.residual_tolerance = 0;
    method_->set_params(params);
    const uint64_t number = method_->recorded();
    const Interaction::Known known =
        interaction_.before(frame, number, set, frame.draw && set.show == Show::mosaic);
    take_strokes(frame, known);
    const PlanePtr input = frame.layers[Role::input];
    method_->record(frame.commands, *input, frame.layers, known.reflectance);
    if (mask_->unfilled() || (mask_->fills() && mask_->moves()))
      before_ = {input, frame.layers[Role::intrinsic]};
    interaction_.after(frame);
    return number;
  }

  // It does not start from the frame before: the same picture again would only add another keyframe
  // and another vote of the clusters.
  bool converged(std::optional<uint64_t>) const override { return !mask_->unfilled(); }
  bool requested() const override { return interaction_.requested(settings_.params()); }
  Interaction* interaction() override { return &interaction_; }
  void navigate(const Log& log, const MouseEvent& event) override {
    interaction_.navigate(log, event, settings_.properties());
  }
  void flushed() override { interaction_.flushed(); }
  void ended() override { interaction_.ended(settings_.properties()); }
  void completed(uint64_t number) override {
    interaction_.completed(number, method_->stats(number).strokes, settings_.properties());
  }

  Work work(uint64_t number) const override { return {method_->stats(number).skipped, {}}; }
  void describe(GstStructure* stats, uint64_t number) const override {
    const auto method = method_->stats(number);
    gst_structure_set(
        stats, "levels", G_TYPE_INT, method.levels, "irls-iterations", G_TYPE_INT,
        method.irls_iterations, "pcg-iterations", G_TYPE_INT, method.pcg_iterations, "iterations",
        G_TYPE_INT, method.iterations, "keyframes", G_TYPE_INT, method.keyframes, "residual",
        G_TYPE_DOUBLE, static_cast<double>(method.residual), "scale", G_TYPE_DOUBLE,
        static_cast<double>(method.scale), "clusters", G_TYPE_INT, method.cluster_count, nullptr);
    if (!method.energy.empty())
      gst_structure_set(stats, "energy", G_TYPE_DOUBLE, method.energy.back().total(), nullptr);
    interaction_.describe(stats, number, method.strokes);
  }

 private:
  /// Draws the strokes of `frame` and extends them, by the reflectance of the frame before.
  void take_strokes(FrameContext& frame, const Interaction::Known& known) {
    const StrokesPtr& list = known.strokes;
    const StrokeTracker* tracker = list ? known.tracker : nullptr;
    const SeenStrokes* seen = list ? known.seen : nullptr;
    StrokeMask::Reflectance reflectance;
    if (before_.intrinsic) {
      reflectance.reflectance = before_.intrinsic->buffer;
      if (mask_->moves()) {
        reflectance.frame_before = before_.input->buffer;
        reflectance.frame = frame.layers[Role::input]->buffer;
      }
      frame.commands.keep(before_.input);
      frame.commands.keep(before_.intrinsic);
    }
    if (list != mask_->list() || tracker != mask_->tracker()) {
      mask_->set(frame.commands, list, {tracker, seen});
      ThesisStrokes strokes{{}, mask_->pixels()};
      for (uint32_t k = 0; k < mask_->count(); ++k)
        strokes.kinds.push_back(list->strokes[k].kind == Stroke::Kind::shading
                                    ? ThesisStrokes::Kind::shading
                                    : ThesisStrokes::Kind::reflectance);
      method_->set_strokes(strokes);
    } else if (mask_->unfilled()) {
      mask_->fill(frame.commands, reflectance, seen);
    } else if (mask_->moves() && !mask_->empty()) {
      mask_->follow(frame.commands, reflectance, seen);
    }
    before_ = {};
    if (!mask_->empty()) frame.commands.stage("strokes");
  }

  MethodSettings<Params, ThesisParams> settings_{table(), thesis_levels()};
  std::optional<ThesisDecomposition> method_;
  Interaction interaction_;
  std::optional<StrokeMask> mask_;
  struct {
    PlanePtr input, intrinsic;
  } before_;  // the frame before, if it is needed to fill strokes
};

}  // namespace

extern const ElementInfo kIntrinsicDecompThesis;
const ElementInfo kIntrinsicDecompThesis{
    .factory = "intrinsicdecompthesis",
    .type_name = "GstIntrinsicDecompThesis",
    .long_name = "Intrinsic decomposition (thesis)",
    .klass = "Filter/Effect/Video",
    .description =
        "Decomposes video into reflectance and shading as in chapters 3 and 4 of Meka, Live "
        "Inverse "
        "Rendering; intrinsicdecomp is faster and more accurate",
    .sink = Flow::pixels,
    .src = Flow::pixels_or_layers,
    .layers = kIntrinsicLayers,
    .create = []() -> std::unique_ptr<Filter> {
      return std::make_unique<Decomposer>(std::make_unique<ThesisMethod>());
    },
    .actions = interaction_actions(),
    .navigation = true,
};

}  // namespace inverse
