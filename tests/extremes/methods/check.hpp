// SPDX-License-Identifier: LGPL-2.1-or-later
// Invariants for any input and any parameters.
#pragma once
#include <initializer_list>

#include "method.hpp"
#include "tests/extremes/support/shrink.hpp"

namespace inverse::extremes {

/// Decomposes a case's frames as a video and describes the first fault: wrong layers; layers that
/// differ from the reference; a rising energy; a model of globalintrinsicthesis that does not
/// explain most of the input. `lab` must outlive the check.
Check check_with(const Lab& lab);

/// What is wrong with one frame's layers: values that are not finite, negative light, reflectance
/// or shares, a direct share outside 0…1 or, unless the lamps have a color of their own, above the
/// light; R S or R S L of intrinsicdecomp and globalintrinsic that is not the input; direct and
/// indirect layers of globalintrinsicthesis that do not sum to the light.
std::optional<std::string> wrong_layers(const Case& one, uint32_t frame, const Pixels& input,
                                        const Output& got);

/// Expects no fault of a solver's frames of these sizes, each spoilt by one kind of bad input.
void check_each_fault(const Check& check, Solver solver, uint32_t frames,
                      std::initializer_list<Extent> extents);

}  // namespace inverse::extremes
