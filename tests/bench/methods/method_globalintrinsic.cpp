// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic in the benchmark.
#include "adaptive_settings.hpp"
#include "kernels/global/global_levels.hpp"
#include "quality_level_settings.hpp"

namespace inverse::bench {
namespace {

using Params = GlobalIntrinsic::Params;
using Effort = Setting::Effort;

class GlobalSolver final : public Solver {
 public:
  GlobalSolver(DeviceSession& session, Size size, const Params& params, bool shares)
      : session_(session),
        params_(params),
        shares_(shares),
        method_(session.device(), {uint32_t(size.width), uint32_t(size.height)}) {}

  Decomposition run(const Image& frame, bool continues, Cost& cost) override {
    const bool repeated = continues && before_.data == frame.data;
    before_ = frame;
    return session_.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method_.record(commands, input, params_, {!continues, shares_, repeated});
        },
        cost);
  }

 private:
  DeviceSession& session_;
  Params params_;
  bool shares_;
  GlobalIntrinsic method_;
  Image before_;
};

}  // namespace

Method globalintrinsic(DeviceSession& session) {
  const auto make = [&session](const Params& params,
                               bool shares = false) -> decltype(Setting::make) {
    return [&session, params, shares](Size size) -> std::unique_ptr<Solver> {
      return std::make_unique<GlobalSolver>(session, size, params, shares);
    };
  };
  std::vector<Setting> all = quality_level_settings(
      global_levels(), [&](const Params& params) { return make(params); }, Effort::full);

  const struct {
    const char* part;
    void (*leave_out)(Params&);
  } parts[] = {{"color of light", [](Params& p) { p.light.slope = 0; }},
               {"measured amount", [](Params& p) { p.amount = 0.5F; }},
               {"residual", [](Params& p) { p.residual = 0; }},
               {"own-color exclusion", [](Params& p) { p.own = 0; }},
               {"neutrality", [](Params& p) { p.neutral = 0; }},
               {"near light", [](Params& p) { p.near_share = 0; }}};
  double order = 0;
  for (const auto& [part, leave_out] : parts) {
    Params params;
    leave_out(params);
    Setting s{.curve = "without",
              .name = part,
              .order = order++,
              .parameters = {{"without", part}},
              .make = make(params),
              .photographs = true,
              .effort = Effort::full};
    all.push_back(s);
    s.stills = false, s.video = true;
    all.push_back(s);
  }
  // Cost of separate layers of indirect light, by their number; 0: none.
  for (const int colors : {0, 1, 2, 4, 8, 16}) {
    Params params;
    if (colors > 0) params.base_colors = colors;
    all.push_back({.curve = "base colors",
                   .name = colors > 0 ? std::to_string(colors) : "no layers",
                   .order = double(colors),
                   .parameters = {{"base-colors", std::to_string(params.base_colors)},
                                  {"shares", colors > 0 ? "true" : "false"}},
                   .make = make(params, colors > 0),
                   .stills = false,
                   .video = true,
                   .effort = Effort::full});
  }
  // Time saved by skipping, and the part saved by reusing a scene's light.
  const std::pair<const char*, void (*)(Params&)> modes[] = {
      {"off", [](Params& p) { p.adaptive = false; }},
      {"on", [](Params&) {}},
      {"scene's light", [](Params& p) { leave_nothing_out(p); }}};
  order = 0;
  for (const auto& [name, set] : modes) {
    Params params;
    set(params);
    all.push_back(adaptive_setting(name, order++, params, make(params)));
  }
  Params converged;
  converged.cycles = 200;
  converged.adaptive = false;
  return {"globalintrinsic",
          "method",
          "Indirect light gathered from the image itself, its amount measured, divided out before "
          "intrinsicdecomp's solve",
          all,
          make(converged),
          {}};
}

}  // namespace inverse::bench
