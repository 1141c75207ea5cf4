#pragma once
#include <array>
#include <span>
#include <vector>

#include "light_cells.hpp"

namespace inverse {

/// The part of an environment that a stage has shown already: A + B is the subject under all its
/// lights, and A − B, channel by channel, under lights as bright as a component of their direction.
/// Under such light nothing has to be predicted.
struct MeasuredLight {
  Rgb even{};                  ///< of Σ OLAT_i = A + B
  std::array<Rgb, 3> along{};  ///< of Σ ω_i,k OLAT_i, by component k of the directions
};

/// Lights' weights in two parts, w_i = even + Σ_k along_k ω_i,k + rest_i.
struct SplitLight {
  MeasuredLight measured;
  std::vector<Rgb> rest;  ///< of every light, of either sign

  /// The measured part that leaves little to the rest: by channel, Σ |rest|^1.4 is the least (sums
  /// of squares would follow a single bright light). Components that another channel has measured
  /// count by seven tenths, since they are known only as far as channels reflect alike.
  static SplitLight of(std::span<const Direction> lights, std::span<const Rgb> weights);
};

}  // namespace inverse
