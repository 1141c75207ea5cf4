// SPDX-License-Identifier: LGPL-2.1-or-later
// Methods to compare with, measured in the same run: trivial ones, Retinex, edge-aware filters, and
// a plain solver of intrinsicdecomp's own energy on the processor. None of them uses a mask.
#pragma once

#include "tests/bench/support/method.hpp"

namespace inverse::bench {

/// Trivial decompositions: R = I; S = mean of I; R = I / max_c I, which is exact if every albedo
/// has the same value.
Method constant_shading();
Method constant_reflectance();
Method max_channel();

/// Retinex (Land and McCann; Horn; Grosse et al. 2009) as a Poisson problem over ln I: an edge
/// keeps its step in shading unless it is classified as a reflectance edge. Sparse Cholesky.
Method gray_retinex();
Method color_retinex();

/// OpenCV's edge-aware filters as decomposers (peer_filters.cpp).
Method fast_global_smoother();
Method domain_transform();
Method guided_filter();
Method l0_smoothing();

/// intrinsicdecomp's energy, minimized on the processor in double precision (peer_energy.cpp).
Method energy_by_conjugate_gradients();
Method energy_by_cholesky();

/// R = I / S with S at least 1e-6.
Decomposition divide(const Image& input, Image shading);

/// A method without state as a setting.
std::function<std::unique_ptr<Solver>(Size)> without_memory(
    std::function<Decomposition(const Image&)> run);

}  // namespace inverse::bench
