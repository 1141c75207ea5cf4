// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicdecompthesis in the benchmark: its two solvers are two methods.
#include <tuple>

#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "kernels/thesis/chapter3/thesis_levels.hpp"
#include "methods.hpp"

namespace inverse::bench {
namespace {

class ThesisSolver final : public Solver {
 public:
  ThesisSolver(DeviceSession& session, Size size, const ThesisParams& params)
      : session_(session),
        method_(session.device(), {uint32_t(size.width), uint32_t(size.height)}) {
    method_.set_params(params);
  }

  Decomposition run(const Image& frame, bool continues, Cost& cost) override {
    if (!continues) method_.reset();
    return session_.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          Layers layers;
          method_.record(commands, *input, layers);
          return layers;
        },
        cost);
  }

 private:
  DeviceSession& session_;
  ThesisDecomposition method_;
};

using Effort = Setting::Effort;

/// The thesis' method with one term removed.
void add_ablations(Method& method, const ThesisParams& base,
                   const std::function<decltype(Setting::make)(const ThesisParams&)>& make) {
  const std::pair<const char*, float ThesisParams::*> terms[] = {
      {"data", &ThesisParams::w_data},
      {"intensity weight", &ThesisParams::w_intensity},
      {"sparsity", &ThesisParams::w_reflectance},
      {"shading", &ThesisParams::w_shading},
      {"chromaticity", &ThesisParams::w_chromaticity},
      {"samples", &ThesisParams::w_non_local},
      {"clusters", &ThesisParams::w_clustering}};
  for (const auto& [term, weight] : terms) {
    ThesisParams params = base;
    params.*weight = 0;
    method.settings.push_back({.curve = "without",
                               .name = term,
                               .parameters = {{"without", term}},
                               .make = make(params),
                               .photographs = weight == &ThesisParams::w_non_local,
                               .effort = Effort::full});
  }
}

/// The reweighting as printed (3.19), with samples and without.
void add_printed(Method& method, ThesisParams params,
                 const std::function<decltype(Setting::make)(const ThesisParams&)>& make) {
  params.irls = ThesisParams::Irls::printed;
  for (const char* name : {"printed", "printed, without samples"}) {
    method.settings.push_back({.curve = "IRLS weight",
                               .name = name,
                               .parameters = {{"irls", name}},
                               .make = make(params),
                               .photographs = true,
                               .effort = Effort::full});
    params.w_non_local = 0;
  }
}

}  // namespace

Method thesis(DeviceSession& session, ThesisParams::Solver solver) {
  const bool pcg = solver == ThesisParams::Solver::pcg;
  Method method{pcg ? "thesis PCG" : "thesis Schwarz",
                "method",
                pcg ? "Chapter 3 of the thesis, conjugate gradients over whole levels"
                    : "Chapter 3 of the thesis, additive Schwarz on 16 x 16 blocks",
                {},
                {},
                {}};
  const auto make = [&session](const ThesisParams& params) {
    return [&session, params](Size size) -> std::unique_ptr<Solver> {
      return std::make_unique<ThesisSolver>(session, size, params);
    };
  };
  ThesisParams base;
  base.solver = solver;
  const auto add = [&](const char* curve, const ThesisParams& params, const std::string& name,
                       double order, Effort effort, const char* preset = "") {
    const bool is_base = params.irls_iterations == base.irls_iterations &&
                         params.pcg_iterations == base.pcg_iterations &&
                         params.levels == base.levels;
    method.settings.push_back({.curve = curve,
                               .name = name,
                               .order = order,
                               .parameters = {{"irls", std::to_string(params.irls_iterations)},
                                              {"pcg", std::to_string(params.pcg_iterations)},
                                              {"levels", std::to_string(params.levels)}},
                               .make = make(params),
                               .preset = preset,
                               .base = is_base,
                               .effort = effort});
  };
  // The work-precision curve: reweightings x iterations; the thesis uses "4x8".
  for (const auto& [irls, iterations] :
       {std::pair{1, 4}, {1, 8}, {2, 8}, {3, 8}, {4, 8}, {7, 8}, {16, 8}, {16, 16}}) {
    ThesisParams params = base;
    params.irls_iterations = irls;
    params.pcg_iterations = iterations;
    const char* preset = "";
    for (const auto& [quality, name] : kQualities) {
      ThesisParams p;
      thesis_levels().set(p, quality);
      if (p.solver == solver && p.irls_iterations == irls && p.pcg_iterations == iterations)
        preset = name;
    }
    // Other data sets use only the default; other settings take seconds.
    const bool odd = (!*preset || irls == 16) && irls != base.irls_iterations;
    add("iterations", params, std::to_string(irls) + "x" + std::to_string(iterations),
        irls * iterations,
        odd                                   ? Effort::full
        : irls == base.irls_iterations && pcg ? Effort::brief
                                              : Effort::usual,
        preset);
  }
  for (const int levels : {1, 2, 3, 4, 5}) {
    ThesisParams params = base;
    params.levels = levels;
    add("levels", params, std::to_string(levels), levels, Effort::full);
  }
  for (const int times : {1, 2})
    method.settings.push_back(
        {.curve = "resolution",
         .name = times == 1 ? "1/2" : "1/4",
         .order = -double(times),
         .parameters = {{"resolution", times == 1 ? "1/2" : "1/4"}},
         .make = [make, base,
                  times](Size size) { return at_lower_resolution(size, times, make(base)); },
         .effort = Effort::full});
  if (pcg) {
    add_ablations(method, base, make);
    add_printed(method, base, make);
  }
  Setting video{.curve = "video",
                .name = "4x8",
                .make = make(base),
                .preset = pcg ? "medium" : "",
                .stills = false,
                .video = true,
                .effort = Effort::full};
  if (pcg) {
    const std::tuple<const char*, const char*, void (*)(ThesisParams&)> variants[] = {
        {"keyframes", "none", [](ThesisParams& p) { p.keyframes = 0; }},
        {"without", "samples", [](ThesisParams& p) { p.w_non_local = 0; }},
        {"without", "clusters", [](ThesisParams& p) { p.w_clustering = 0; }}};
    for (const auto& [curve, name, change] : variants) {
      ThesisParams params = base;
      change(params);
      method.settings.push_back({.curve = curve,
                                 .name = name,
                                 .parameters = {{curve, name}},
                                 .make = make(params),
                                 .stills = false,
                                 .video = true,
                                 .effort = Effort::full});
    }
  } else {
    video.sets = {"own"};  // the other solver of the same energy is measured on all
  }
  method.settings.push_back(video);
  ThesisParams converged = base;
  converged.irls_iterations = pcg ? 24 : 32;
  converged.pcg_iterations = pcg ? 16 : 8;
  method.converged = make(converged);
  return method;
}

}  // namespace inverse::bench
