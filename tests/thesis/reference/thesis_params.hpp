// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "intrinsic_thesis.hpp"
#include "kernels/thesis/chapter3/thesis_params.hpp"

namespace inverse::testing {

/// The kernels' parameters in the reference's words, every one of them.
inline reference::ThesisParams to_reference(const ThesisParams& p) {
  reference::ThesisParams r;
  r.chapter4 = p.formulation == ThesisParams::Formulation::chapter4;
  r.w_data = p.w_data;
  r.w_intensity = p.w_intensity;
  r.w_reflectance = p.w_reflectance;
  r.w_shading = p.w_shading;
  r.w_chromaticity = p.w_chromaticity;
  r.w_non_local = p.w_non_local;
  r.w_clustering = p.w_clustering;
  r.w_cs = p.w_cs;
  r.p = p.p;
  r.alpha_cs = p.alpha_cs;
  r.alpha_clustering = p.alpha_clustering;
  r.tau_cc = p.tau_cc;
  r.epsilon = p.epsilon;
  r.log_floor = p.log_floor;
  r.chroma_floor = p.chroma_floor;
  r.consistent_irls = p.irls == ThesisParams::Irls::consistent;
  r.schwarz = p.solver == ThesisParams::Solver::schwarz;
  r.levels = p.levels;
  r.irls_iterations = p.irls_iterations;
  r.pcg_iterations = p.pcg_iterations;
  r.samples = p.samples;
  r.keyframes = p.keyframes;
  r.keyframe_spacing = p.keyframe_spacing;
  r.resample = p.resample;
  r.seed = p.seed;
  return r;
}

}  // namespace inverse::testing
