// Edits of light that has layers, in double precision: the specification of
// kernels/edit/light_edit.
#pragma once
#include <cstddef>
#include <vector>

#include "edit.hpp"

namespace inverse::reference {

struct Base {
  Rgb color{};
  bool exists = false;
};

/// For each base color, the share of the light of its own surfaces (those whose reflectance is
/// nearest in chromaticity) that the selection holds. `model` is (R, S), `selection` 0…1, both the
/// sample's pixels.
std::vector<double> selected_shares(const std::vector<Base>& bases, const std::vector<Rgba>& model,
                                    const std::vector<double>& selection);

/// What a change of light becomes by being sent on again and again, 1 + p + p² ...: p is the share
/// of the sample's light (L, direct share; on `model`'s S) that bounced, at most .75.
double sent_on(const std::vector<Rgba>& model, const std::vector<Rgba>& light);

/// How much a pixel (R, S) belongs to base color `index`, 0…1: by the distances in ln chromaticity
/// of its R S to that and to the nearest other, white among them.
double base_selection(const Rgba& model, const std::vector<Base>& bases, size_t index,
                      double softness);

/// Mean reflectance of what it selects of the sample, weighted with light.
Rgb base_key(const std::vector<Rgba>& model, const std::vector<Base>& bases, size_t index,
             double softness);

/// Which pixels of a frame are looked at for all that.
std::vector<size_t> light_sample(size_t width, size_t height);

/// How much a base color is chosen by a key's chromaticity.
double chosen(const Rgb& base, const Rgb& key, double tolerance, double softness);

/// b + w (scale · aim − b), where scale = b·key / key·key for what was repainted, and the mean of b
/// else.
Rgb repainted(const Rgb& base, const Rgb& key, const Rgb& aim, double w);
Rgb changed(const Rgb& base, const Rgb& aim, double w);

/// The light of a pixel (L, direct share) whose shares of base colors are `shares`.
Rgba retinted(const Rgba& light, const std::vector<double>& shares, const std::vector<Rgb>& change,
              double matte);

}  // namespace inverse::reference
