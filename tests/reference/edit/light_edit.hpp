// SPDX-License-Identifier: LGPL-2.1-or-later
// Edits of layered light in double precision: the specification of kernels/edit/light_edit.
#pragma once
#include <cstddef>
#include <vector>

#include "edit.hpp"

namespace inverse::reference {

struct Base {
  Rgb color{};
  bool exists = false;
};

/// Per base color, the selected share of the light of its own surfaces (those nearest to it in
/// chromaticity). `model` is (R, S), `selection` 0…1, both at the sampled pixels.
std::vector<double> selected_shares(const std::vector<Base>& bases, const std::vector<Rgba>& model,
                                    const std::vector<double>& selection);

/// Amplification of a change of light by repeated reflection, 1 + p + p² ...: p is the indirect
/// share of the samples' light (L, direct share; with `model`'s S), at most .75.
double sent_on(const std::vector<Rgba>& model, const std::vector<Rgba>& light);

/// Membership of a pixel (R, S) in base color `index`, 0…1: by the distances in ln chromaticity of
/// R S to that color and to the nearest other one, including white.
double base_selection(const Rgba& model, const std::vector<Base>& bases, size_t index,
                      double softness);

/// Mean reflectance of the selected samples, weighted with light.
Rgb base_key(const std::vector<Rgba>& model, const std::vector<Base>& bases, size_t index,
             double softness);

/// The sampled pixels of a frame.
std::vector<size_t> light_sample(size_t width, size_t height);

/// Selection of a base color by a key's chromaticity.
double chosen(const Rgb& base, const Rgb& key, double tolerance, double softness);

/// b + w (scale · target − b); scale = b·key / key·key for repainted surfaces, else the mean of b.
Rgb repainted(const Rgb& base, const Rgb& key, const Rgb& target, double w);
Rgb changed(const Rgb& base, const Rgb& target, double w);

/// The light of a pixel (L, direct share) whose shares of base colors are `shares`.
Rgba retinted(const Rgba& light, const std::vector<double>& shares, const std::vector<Rgb>& change,
              double matte);

}  // namespace inverse::reference
