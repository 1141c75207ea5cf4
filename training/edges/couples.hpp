// SPDX-License-Identifier: LGPL-2.1-or-later
// Couples: two pictures of one scene that differ by light or by paint alone. Whatever its layers
// are, the difference of the two decompositions must be what was added.
#pragma once

#include <random>
#include <string>

#include "problem.hpp"

namespace inverse::training {

/// What was added to a picture.
struct Change {
  Plane light;        ///< Pixels: mean ln of the light that was added; 0 where paint was.
  Plane weight;       ///< Pixels: 0 outside of the mask, small where either picture is dark.
  double spread = 1;  ///< Mean distance from its mean of what was added to mean ln I.
  int width = 0;

  /// `ratio`: of light, as a picture. Throws std::runtime_error if the examples differ in size.
  Change(const Example& before, const Example& after, const bench::Image& ratio);
};

/// The distance of s - other, the change of ln S between two pictures, from sign x the light that
/// was added, and of its steps over 1, 2, 4 and 8 pixels, as shares of `spread`. `gradient`
/// receives its derivative by s.
double change_distance(const Change& change, double sign, const Plane& s, const Plane& other,
                       Plane& gradient);

struct Couple {
  Example before, after;
  Change change;
};

/// Warm starts of the next visit.
struct CoupleSolution {
  Solution before, after;
};

/// A file of training/couples: its picture is `after`, its reflectance is the picture before, its
/// shading the ratio of light. Throws std::runtime_error if the file is none.
Couple load_couple(const std::string& path, std::mt19937& engine);

/// Solves both pictures and returns the distance of their change. Adds the derivative by the
/// parameters, half of it through each picture, to `gradient` if one is given.
double evaluate(const Model& model, const std::vector<float>& parameters, const Couple& couple,
                CoupleSolution& solution, std::vector<double>* gradient);

}  // namespace inverse::training
