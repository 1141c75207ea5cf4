// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

#include "light_cells.hpp"

namespace inverse {

/// The part of an environment that the stage has already shown: A + B is the subject under all
/// lights; A − B, channel by channel, under lights weighted by a component of their direction. The
/// response to this part is measured, not predicted.
struct MeasuredLight {
  Rgb even{};                  ///< of Σ OLAT_i = A + B
  std::array<Rgb, 3> along{};  ///< of Σ ω_i,k OLAT_i, by component k of the directions
};

/// Weights of the lights in two parts, w_i = even + Σ_k along_k ω_i,k + rest_i.
struct SplitLight {
  MeasuredLight measured;
  std::vector<Rgb> rest;  ///< per light, of either sign

  /// The measured part that minimizes Σ |rest|^1.4 per channel (a square would follow a single
  /// bright light). Components that another channel measured have weight 0.7, because channels may
  /// reflect differently.
  static SplitLight of(std::span<const Direction> lights, std::span<const Rgb> weights);
};

}  // namespace inverse
