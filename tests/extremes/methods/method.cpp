// SPDX-License-Identifier: LGPL-2.1-or-later
#include "method.hpp"

#include <cmath>

#include "tests/reference/image/light_color.hpp"

namespace inverse::extremes {

uint32_t Output::colors() const {
  uint32_t count = 0;
  for (size_t i = 3; i < bases.size(); i += 4) count += bases[i] > 0;
  return count;
}

namespace {

/// Gives reflectance the color of its light.
void tint(Pixels& intrinsic, const Pixels& slope) {
  const reference::LightColor light{double(slope[0]), 0, double(slope[1])};
  for (size_t i = 0; i < intrinsic.size(); i += 4) {
    const float* of = &intrinsic[i];
    const auto gray = reference::in_gray_light({of[0], of[1], of[2], of[3]}, light);
    for (size_t c = 0; c < 3; ++c) intrinsic[i + c] = float(gray[c]);
  }
}

}  // namespace

Method::Method(const Lab& lab, Solver solver, Extent extent)
    : lab_(lab), solver_(solver), extent_(extent) {
  if (solver == Solver::multigrid) {
    intrinsic_ = std::make_unique<IntrinsicDecomposition>(lab.device(), extent);
  } else if (solver == Solver::global) {
    global_ = std::make_unique<GlobalIntrinsic>(lab.device(), extent);
  } else if (solver == Solver::global_thesis) {
    global_thesis_ = std::make_unique<GlobalThesis>(lab.device(), extent);
  } else {
    thesis_ = std::make_unique<ThesisDecomposition>(lab.device(), extent);
    set(ThesisParams{});
  }
}

void Method::set(const ScaledIntrinsic::Params& params) {
  static_cast<ScaledIntrinsic::Params&>(params_) = params;
  if (!scaled_) scaled_ = std::make_unique<ScaledIntrinsic>(lab_.device(), extent_);
}

void Method::set(ThesisParams params) {
  params.solver =
      solver_ == Solver::schwarz ? ThesisParams::Solver::schwarz : ThesisParams::Solver::pcg;
  thesis_->set_params(params);
}

void Method::set(const Case& one) {
  if (intrinsic_) set(intrinsic_params_of(one));
  if (global_) set(global_params_of(one));
  if (thesis_) set(thesis_params_of(one));
  if (global_thesis_) set(global_thesis_params_of(one));
}

void Method::reset() {
  if (intrinsic_) intrinsic_->reset();
  if (scaled_) scaled_->reset();
  if (global_) global_->reset();
  if (thesis_) thesis_->reset();
  if (global_thesis_) global_thesis_->reset();
  first_ = true;
}

Output Method::decompose(const Pixels& frame) {
  const PlanePtr input = lab_.plane(extent_, frame);
  Layers layers;
  uint64_t number = 0;
  if (global_thesis_ && first_ && !global_thesis_->colors().given()) {
    lab_.run([&](gpu::Commands& commands) { global_thesis_->record_colors(commands, *input); });
    global_thesis_->collect_colors();
  }
  first_ = false;
  lab_.run([&](gpu::Commands& commands) {
    if (scaled_)
      layers = scaled_->record(commands, input, params_, {});
    else if (intrinsic_)
      layers = intrinsic_->record(commands, input, params_, {});
    else if (global_)
      layers = global_->record(commands, input, params_, {.shares = true});
    else if (thesis_)
      number = thesis_->record(commands, *input, layers);
    else
      number = global_thesis_->record(commands, *input, layers);
  });
  if (scaled_) {
    stats_.solve = scaled_->stats(scaled_->recorded() - 1);
    scale_ = scaled_->findings(scaled_->recorded() - 1).scale;
  } else if (intrinsic_) {
    static_cast<IntrinsicDecomposition::Stats&>(stats_.solve) =
        intrinsic_->stats(intrinsic_->recorded() - 1);
    scale_ = intrinsic_->findings().scale;
  } else if (global_) {
    found_ = global_->findings(global_->recorded() - 1);
    stats_ = global_->stats(global_->recorded() - 1);
    scale_ = found_.solve.scale;
  } else if (thesis_) {
    thesis_stats_ = thesis_->stats(number);
    scale_ = thesis_stats_.scale;
  } else {
    global_thesis_->collect(number);
    global_thesis_stats_ = global_thesis_->stats(number);
  }
  const auto download = [&](Role role) {
    return layers[role] ? lab_.download(layers[role]->buffer) : Pixels();
  };
  Output got{.intrinsic = download(Role::intrinsic),
             .slope = download(Role::slope),
             .light = download(Role::light),
             .bases = download(Role::bases)};
  for (uint32_t n = 0; n < kIndirectPlanes; ++n)
    if (layers[indirect_role(n)]) got.shares.push_back(download(indirect_role(n)));
  if (!got.slope.empty()) tint(got.intrinsic, got.slope);
  return got;
}

Output Method::decompose_unscaled(const Pixels& frame) {
  Output got = decompose(frame);
  const float scale = std::exp(scale_);
  for (size_t i = 0; i < got.intrinsic.size(); ++i)
    got.intrinsic[i] *= i % 4 == 3 ? scale : 1 / scale;
  return got;
}

float max_light(Solver solver) {
  return solver == Solver::multigrid || solver == Solver::global ? 1e4F : 65504.0F;
}

std::vector<double> rgb_of(const Pixels& pixels) {
  std::vector<double> rgb;
  for (size_t i = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c)
      rgb.push_back(static_cast<double>(finite_light(pixels[i + c], 3e38F)));
  return rgb;
}

}  // namespace inverse::extremes
