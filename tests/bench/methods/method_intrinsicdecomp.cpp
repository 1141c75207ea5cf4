// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecomp in the benchmark.
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "adaptive_settings.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "quality_level_settings.hpp"

namespace inverse::bench {
namespace {

using Params = ScaledIntrinsic::Params;
using Effort = Setting::Effort;
using Make = decltype(Setting::make);

class IntrinsicSolver final : public Solver {
 public:
  IntrinsicSolver(DeviceSession& session, Size size, const Params& params)
      : session_(session),
        params_(params),
        method_(session.device(), {uint32_t(size.width), uint32_t(size.height)}) {}

  Decomposition run(const Image& frame, bool continues, Cost& cost) override {
    const bool repeated = continues && before_.data == frame.data;
    before_ = frame;
    return session_.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method_.record(commands, input, params_, {!continues, repeated});
        },
        cost);
  }

 private:
  DeviceSession& session_;
  Params params_;
  ScaledIntrinsic method_;
  Image before_;
};

/// The settings of one run.
class Settings {
 public:
  explicit Settings(DeviceSession& session) : session_(session) {}

  Make make(const Params& params) const {
    return [&session = session_, params](Size size) -> std::unique_ptr<Solver> {
      return std::make_unique<IntrinsicSolver>(session, size, params);
    };
  }

  /// The levels of the element; presets are some of them.
  void add_quality_levels() {
    all = quality_level_settings(
        intrinsic_levels(), [this](const Params& params) { return make(params); }, Effort::usual);
  }

  /// Fixed numbers of multigrid cycles: convergence of the solve.
  void add_cycles() {
    for (const uint32_t cycles : {1U, 2U, 3U, 4U, 6U, 8U, 12U, 24U}) {
      Params params;
      params.cycles = cycles;
      params.adaptive = false;
      const bool between = cycles == 3 || cycles == 6 || cycles == 12;
      all.push_back({.curve = "cycles",
                     .name = std::to_string(cycles),
                     .order = double(cycles),
                     .parameters = {{"cycles", std::to_string(cycles)}, {"adaptive", "false"}},
                     .make = make(params),
                     .effort = between ? Effort::full : Effort::usual});
    }
  }

  /// Shading of a smaller frame, upsampled without a guide.
  void add_resolutions() {
    for (const int times : {1, 2})
      all.push_back({.curve = "resolution",
                     .name = times == 1 ? "1/2" : "1/4",
                     .order = -double(times),
                     .parameters = {{"resolution", times == 1 ? "1/2" : "1/4"}},
                     .make = [inner = make({}), times](Size size) {
                       return at_lower_resolution(size, times, inner);
                     }});
  }

  /// Coarse cycles per cycle.
  void add_coarse_cycles() {
    for (const uint32_t cycles : {1U, 4U}) {
      Params params;
      params.multigrid.cell_cycles = cycles;
      all.push_back({.curve = "coarse cycles",
                     .name = std::to_string(cycles),
                     .order = double(cycles),
                     .parameters = {{"cell-cycles", std::to_string(cycles)}},
                     .make = make(params),
                     .effort = Effort::full});
    }
  }

  /// The network of the prior in the folder that INVERSE_MODELS names.
  void add_networks() {
    const char* models = std::getenv("INVERSE_MODELS");
    if (!models) return;
    const std::string file = std::string(models) + "/intrinsic/prior.net";
    if (!std::filesystem::exists(file)) return;
    Params params;  // with the interval of runs that the element has at its default quality
    intrinsic_levels().set(params, Quality::medium);
    params.prior.network = PriorModel::load(file);
    all.push_back({.curve = "prior",
                   .name = "learned",
                   .parameters = {{"prior", "learned"}},
                   .make = make(params),
                   .stills = true,
                   .video = true,
                   .photographs = true,
                   .effort = Effort::brief});
  }

  /// One term removed. A weight that must be positive becomes a thousandth.
  void add_ablations() {
    constexpr float kNearlyNone = 1e-3F;
    const struct {
      const char* term;
      void (*leave_out)(Params&);
      bool video;
    } terms[] = {
        {"color of light", [](Params& p) { p.light.slope = 0; }, false},
        {"chroma", [](Params& p) { p.prior.chroma_weight = 0; }, false},
        {"paint on edges", [](Params& p) { p.prior.reflectance_weight = kNearlyNone; }, false},
        {"light on edges", [](Params& p) { p.prior.shading_weight = kNearlyNone; }, false},
        {"value", [](Params& p) { p.prior.value_weight = kNearlyNone; }, false},
        {"temporal anchor", [](Params& p) { p.anchor.anchor_weight = 0; }, true},
        {"holding", [](Params& p) { p.anchor.hold = 0; }, true},
        {"growing trust", [](Params& p) { p.anchor.anchor_frames = 1; }, true}};
    double order = 0;
    for (const auto& [term, leave_out, video] : terms) {
      Params params;
      leave_out(params);
      all.push_back({.curve = "without",
                     .name = term,
                     .order = order++,
                     .parameters = {{"without", term}},
                     .make = make(params),
                     .stills = !video,
                     .video = video,
                     .photographs = true,
                     .effort = Effort::full});
    }
  }

  /// Half and twice each hand-set weight, jointly: the sensitivity to the scenes used for tuning.
  void add_weights() {
    const std::pair<const char*, float> factors[] = {{"/2", 0.5F}, {"", 1.0F}, {"·2", 2.0F}};
    double order = 0;
    for (const auto& [light, shading] : factors)
      for (const auto& [value, value_weight] : factors)
        for (const auto& [chroma, chroma_weight] : factors) {
          Params params;
          params.prior.shading_weight *= shading;
          params.prior.value_weight *= value_weight;
          params.prior.chroma_weight *= chroma_weight;
          all.push_back({.curve = "weights",
                         .name = std::string("b") + light + " v" + value + " g" + chroma,
                         .order = order++,
                         .parameters = {{"shading-weight", text_of(double(shading))},
                                        {"value-weight", text_of(double(value_weight))},
                                        {"chroma-weight", text_of(double(chroma_weight))}},
                         .make = make(params),
                         .lmse_only = true,
                         .effort = Effort::full});
        }
  }

  /// Turns off all of adaptivity except one part.
  template <typename Tolerance>
  static void only(Params& params, Tolerance tolerance) {
    const float kept = params.tolerances.*tolerance;
    leave_nothing_out(params);
    params.tolerances.*tolerance = kept;
  }

  /// Time saved by skipping: all of it, and each part alone. Add a new part here.
  void add_adaptive() {
    const std::pair<const char*, void (*)(Params&)> modes[] = {
        {"off", [](Params& p) { p.adaptive = false; }},
        {"on", [](Params&) {}},
        {"edges of tiles", [](Params& p) { only(p, &Tolerances::edge); }},
        {"cycles", [](Params& p) { only(p, &Tolerances::cycle); }},
        {"chroma bins", [](Params& p) { only(p, &Tolerances::chroma); }},
        {"anchor of pixels", [](Params& p) { only(p, &Tolerances::gate); }},
        {"half resolution", [](Params& p) { only(p, &Tolerances::half); }}};
    double order = 0;
    for (const auto& [name, set] : modes) {
      Params params;
      set(params);
      all.push_back(adaptive_setting(name, order++, params, make(params)));
    }
  }

  std::vector<Setting> all;

 private:
  DeviceSession& session_;
};

}  // namespace

Method intrinsicdecomp(DeviceSession& session) {
  Settings settings(session);
  settings.add_quality_levels();
  settings.add_cycles();
  settings.add_resolutions();
  settings.add_coarse_cycles();
  settings.add_networks();
  settings.add_ablations();
  settings.add_weights();
  settings.add_adaptive();
  Params converged;
  converged.cycles = 200;
  converged.adaptive = false;
  return {"intrinsicdecomp",
          "method",
          "One log-shading unknown a pixel, multigrid with a learned edge prior",
          settings.all,
          settings.make(converged),
          {}};
}

}  // namespace inverse::bench
