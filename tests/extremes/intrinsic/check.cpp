// SPDX-License-Identifier: LGPL-2.1-or-later
#include "check.hpp"

#include <cmath>

#include "methods.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"

namespace inverse::extremes {
namespace {

std::string at(const char* what, uint32_t frame, size_t index, double value) {
  return std::string(what) + " in frame " + std::to_string(frame) + " at " + std::to_string(index) +
         ": " + std::to_string(value);
}

/// The thesis' model explains its input at large, where nothing but the input is extreme.
std::optional<std::string> wrong_model(const Case& one, uint32_t frame, const Pixels& input,
                                       const Pixels& got) {
  double model = 0, light = 0;  // logarithms, floored as the method does: outliers count as pixels
  size_t count = 0;
  for (size_t i = 0; i < got.size(); ++i) {
    if (i % 4 == 3) continue;
    model += std::log(std::max(static_cast<double>(got[i] * got[i | 3]), 1e-6));
    light += std::log(std::max(static_cast<double>(finite_light(input[i], 65504)), 1e-3));
    ++count;
  }
  const double ratio = (model - light) / static_cast<double>(count);
  // Light of 1e4 beside black, which no format holds, pulls it up.
  const bool beyond = one.faults & kBeyondFormats;
  if (ratio > (beyond ? -0.45 : -0.2) && ratio < (beyond ? 1.8 : 0.75)) return {};
  return at("ln of model over input, mean", frame, 0, ratio);
}

/// The ε-smoothed energy, clusters fixed and nothing sampled, does not rise within a level: but for
/// what single precision makes of its value, and of a solution that it holds to 2^−24.
std::optional<std::string> rising_energy(const Lab& lab, const Case& one, const Pixels& input) {
  Method method(lab, one.solver, {one.width, one.height});
  ThesisParams params = thesis_params_of(one);
  params.irls = ThesisParams::Irls::consistent;
  params.samples = 0;
  params.trace = true;
  method.set(params);
  method.decompose(input);
  const auto& energies = method.thesis_stats().energy;
  for (size_t k = 1; k < energies.size(); ++k) {
    if (energies[k].level != energies[k - 1].level) continue;
    const double before = energies[k - 1].total(), after = energies[k].total();
    if (!(after <= before * (1 + 1e-5) + 1e-6))
      return "the energy of level " + std::to_string(energies[k].level) + " rises in step " +
             std::to_string(energies[k].step) + ": " + std::to_string(before) + " to " +
             std::to_string(after);
  }
  return {};
}

/// A frame without history is the reference's, as near as its bins in fixed point allow, when all
/// cycles are made.
std::optional<std::string> far_from_reference(const Lab& lab, const Case& one,
                                              const Pixels& input) {
  Method method(lab, one.solver, {one.width, one.height});
  IntrinsicDecomposition::Params params;
  params.tolerances.cycle = 0;
  method.set(params);
  const Pixels got = method.decompose_unscaled(input);
  const auto rgb = rgb_of(input);
  const auto expected = reference::decompose(rgb.data(), static_cast<int>(one.width),
                                             static_cast<int>(one.height), {}, nullptr);
  double sum = 0;
  for (size_t n = 0; n < expected.log_shading.size(); ++n)
    sum += std::pow(std::log(static_cast<double>(got[4 * n + 3])) - expected.log_shading[n], 2);
  const double rms = std::sqrt(sum / static_cast<double>(expected.log_shading.size()));
  if (rms < 2e-3) return {};
  return at("rms distance to the reference, log units", 0, 0, rms);
}

}  // namespace

std::optional<std::string> wrong_layers(const Case& one, uint32_t frame, const Pixels& input,
                                        const Pixels& got) {
  for (size_t i = 0; i < got.size(); ++i) {
    if (!std::isfinite(got[i])) return at("not finite", frame, i, static_cast<double>(got[i]));
    if (got[i] < 0) return at("negative", frame, i, static_cast<double>(got[i]));
    const bool tame = one.solver == Solver::multigrid || one.knobs == 0;
    if (i % 4 == 3 && tame && !(got[i] > 1e-13F && got[i] < 1e13F))
      return at("shading out of all proportion", frame, i, static_cast<double>(got[i]));
    if (i % 4 == 3 || one.solver != Solver::multigrid) continue;
    const float light = finite_light(input[i], most_light(one.solver));
    if (!(std::abs(got[i] * got[i | 3] - light) <= 1e-5F * (1 + light)))
      return at("R S is not I", frame, i, static_cast<double>(got[i] * got[i | 3]));
  }
  return {};
}

Check check_with(const Lab& lab) {
  return [&lab](const Case& one) -> std::optional<std::string> {
    Method method(lab, one.solver, {one.width, one.height});
    method.set(one);
    for (uint32_t frame = 0; frame < one.frames; ++frame) {
      const Pixels input = frame_of(one, frame);
      const Pixels got = method.decompose(input);
      if (auto wrong = wrong_layers(one, frame, input, got)) return wrong;
      if (one.solver != Solver::multigrid && one.knobs == 0)
        if (auto wrong = wrong_model(one, frame, input, got)) return wrong;
    }
    if (one.solver != Solver::multigrid) return rising_energy(lab, one, frame_of(one, 0));
    if (one.knobs == 0) return far_from_reference(lab, one, frame_of(one, 0));
    return {};
  };
}

}  // namespace inverse::extremes
