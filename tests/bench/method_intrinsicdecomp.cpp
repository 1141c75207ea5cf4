// intrinsicdecomp in the benchmark.
#include <optional>

#include "kernels/intrinsic/ladder.hpp"
#include "tests/bench/methods.hpp"

namespace inverse::bench {
namespace {

using Params = ScaledIntrinsic::Params;

class IntrinsicSolver final : public Solver {
 public:
  IntrinsicSolver(DeviceSession& session, Size size, const Params& params)
      : session_(session),
        params_(params),
        method_(session.device(), {uint32_t(size.width), uint32_t(size.height)}) {}

  Decomposition run(const Image& frame, bool continues, Cost& cost) override {
    return session_.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method_.record(commands, input, params_, {!continues})[Role::intrinsic];
        },
        cost);
  }

 private:
  DeviceSession& session_;
  Params params_;
  ScaledIntrinsic method_;
};

}  // namespace

Method intrinsicdecomp(DeviceSession& session) {
  Method method{"intrinsicdecomp",
                "method",
                "One log-shading unknown a pixel, multigrid with a learned edge prior",
                {},
                {},
                {}};
  const auto make = [&session](const Params& params) {
    return [&session, params](Size size) -> std::unique_ptr<Solver> {
      return std::make_unique<IntrinsicSolver>(session, size, params);
    };
  };
  using Effort = Setting::Effort;
  // The work-precision curve of single frames: multigrid cycles, all of them run.
  for (const uint32_t cycles : {1U, 2U, 3U, 4U, 6U, 8U, 12U, 24U}) {
    Params params;
    params.cycles = cycles;
    params.settled = 0;
    method.settings.push_back(
        {.curve = "cycles",
         .name = std::to_string(cycles),
         .order = double(cycles),
         .parameters = {{"cycles", std::to_string(cycles)}},
         .make = make(params),
         .base = cycles == Params{}.cycles,
         .effort = cycles == 3 || cycles == 6 ? Effort::usual : Effort::brief});
  }
  // The presets, on stills and on videos.
  for (const auto& [quality, name] : kQualities)
    method.settings.push_back({.curve = "quality",
                               .name = name,
                               .order = double(quality),
                               .parameters = {{"quality", name}},
                               .make = make(intrinsic_ladder().preset(quality)),
                               .preset = name,
                               .video = true,
                               .effort = Effort::brief});
  // Half resolution with guided upsampling.
  Params half;
  half.half_resolution = true;
  method.settings.push_back({.curve = "resolution",
                             .name = "1/2",
                             .order = -1,
                             .parameters = {{"half-resolution", "true"}},
                             .make = make(half)});
  // Cycles below the finest levels in every cycle.
  for (const uint32_t cycles : {1U, 4U}) {
    Params params;
    params.multigrid.cell_cycles = cycles;
    method.settings.push_back({.curve = "coarse cycles",
                               .name = std::to_string(cycles),
                               .order = double(cycles),
                               .parameters = {{"cell-cycles", std::to_string(cycles)}},
                               .make = make(params),
                               .effort = Effort::full});
  }
  // Videos: cycles of frames that continue the one before.
  for (const uint32_t cycles : {1U, 2U, 4U, 8U, 24U}) {
    Params params;
    params.warm_cycles = cycles;
    params.settled = 0;
    method.settings.push_back({.curve = "warm cycles",
                               .name = std::to_string(cycles),
                               .order = double(cycles),
                               .parameters = {{"warm-cycles", std::to_string(cycles)}},
                               .make = make(params),
                               .stills = false,
                               .video = true,
                               .effort = cycles == 2 ? Effort::brief : Effort::usual});
  }
  Params loose;
  loose.anchor.anchor_weight = 0;
  method.settings.push_back({.curve = "temporal anchor",
                             .name = "off",
                             .parameters = {{"temporal-weight", "0"}},
                             .make = make(loose),
                             .stills = false,
                             .video = true});
  // What leaving out saves: each line against the setting that does all the work.
  Params all, adaptive;
  all.adaptive = false;
  adaptive.adaptive = true;
  method.settings.push_back({.curve = "adaptive",
                             .name = "off",
                             .parameters = {{"adaptive", "false"}},
                             .make = make(all),
                             .stills = false,
                             .video = true,
                             .effort = Effort::brief});
  method.settings.push_back({.curve = "adaptive",
                             .name = "on",
                             .order = 1,
                             .parameters = {{"adaptive", "true"}},
                             .make = make(adaptive),
                             .stills = false,
                             .video = true,
                             .effort = Effort::brief,
                             .against = "adaptive/off"});
  Params converged;
  converged.settled = 0;
  converged.cycles = 200;
  method.converged = make(converged);
  return method;
}

}  // namespace inverse::bench
