// SPDX-License-Identifier: LGPL-2.1-or-later
#include "methods.hpp"

#include <cmath>

namespace inverse::extremes {

Method::Method(const Lab& lab, Solver solver, Extent extent) : lab_(lab), extent_(extent) {
  if (solver == Solver::multigrid) {
    intrinsic_ = std::make_unique<IntrinsicDecomposition>(lab.device(), extent);
    return;
  }
  thesis_ = std::make_unique<ThesisDecomposition>(lab.device(), extent);
  ThesisParams params;
  if (solver == Solver::schwarz) params.solver = ThesisParams::Solver::schwarz;
  thesis_->set_params(params);
}

void Method::set(const Case& one) {
  if (intrinsic_)
    set(intrinsic_params_of(one));
  else
    set(thesis_params_of(one));
}

Pixels Method::decompose(const Pixels& frame) {
  const PlanePtr input = lab_.plane(extent_, frame);
  Layers layers;
  uint64_t number = 0;
  lab_.run([&](gpu::Commands& commands) {
    if (intrinsic_)
      layers = intrinsic_->record(commands, input, intrinsic_params_, {});
    else
      number = thesis_->record(commands, *input, layers);
  });
  if (thesis_) stats_ = thesis_->stats(number);
  scale_ = intrinsic_ ? intrinsic_->findings().scale : stats_.scale;
  return lab_.download(layers[Role::intrinsic]->buffer);
}

Pixels Method::decompose_unscaled(const Pixels& frame) {
  Pixels pixels = decompose(frame);
  const float scale = std::exp(scale_);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] *= i % 4 == 3 ? scale : 1 / scale;
  return pixels;
}

float most_light(Solver solver) { return solver == Solver::multigrid ? 1e4F : 65504.0F; }

std::vector<double> rgb_of(const Pixels& pixels) {
  std::vector<double> rgb;
  for (size_t i = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < 3; ++c)
      rgb.push_back(static_cast<double>(finite_light(pixels[i + c], 3e38F)));
  return rgb;
}

}  // namespace inverse::extremes
