// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "global_thesis.hpp"
#include "kernels/thesis/chapter5/global_thesis_params.hpp"

namespace inverse::testing {

/// The kernels' parameters in the reference's words, every one that the reference has.
inline reference::GlobalThesisParams to_reference(const GlobalThesisParams& p) {
  reference::GlobalThesisParams r;
  r.lambda_data = p.lambda_data;
  r.lambda_clustering = p.lambda_clustering;
  r.lambda_r_sparsity = p.lambda_r_sparsity;
  r.lambda_r_consistency = p.lambda_r_consistency;
  r.lambda_monochrome = p.lambda_monochrome;
  r.lambda_i_sparsity = p.lambda_i_sparsity;
  r.lambda_smoothness = p.lambda_smoothness;
  r.lambda_non_negativity = p.lambda_non_negativity;
  r.lambda_ir = p.lambda_ir;
  r.lambda_cr = p.lambda_cr;
  r.p = p.p;
  r.alpha_sr = p.alpha_sr;
  r.w_intensity = p.w_intensity;
  r.tau_cc = p.tau_cc;
  r.epsilon = p.epsilon;
  r.epsilon_r = p.epsilon_r;
  r.log_floor = p.log_floor;
  r.chroma_floor = p.chroma_floor;
  r.indirect_start = p.indirect_start;
  r.consistent_irls = p.irls == GlobalThesisParams::Irls::consistent;
  r.line_search = p.line_search;
  r.steps = p.steps;
  r.pcg_iterations = p.pcg_iterations;
  r.samples = p.lambda_r_consistency > 0 ? p.samples : 0;
  r.keyframes = p.keyframes;
  r.keyframe_spacing = p.keyframe_spacing;
  r.resample = p.resample;
  r.seed = p.seed;
  return r;
}

}  // namespace inverse::testing
