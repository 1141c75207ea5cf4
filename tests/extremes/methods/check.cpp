// SPDX-License-Identifier: LGPL-2.1-or-later
#include "check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/differences.hpp"
#include "tests/reference/global/global_intrinsic.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"
#include "tests/thesis/reference/intrinsic_thesis.hpp"
#include "tests/thesis/reference/thesis_params.hpp"

namespace inverse::extremes {
namespace {

std::string at(const std::string& what, uint32_t frame, size_t index, double value) {
  return what + " in frame " + std::to_string(frame) + " at " + std::to_string(index) + ": " +
         std::to_string(value);
}

/// ln of the model R S of intrinsicdecompthesis is the reference's, for the same chromaticities and
/// clusters: these are rounded, and single precision may round to the other side.
std::optional<std::string> far_from_model(const Lab& lab, Extent extent, uint32_t frame,
                                          const Pixels& input, Method& method,
                                          reference::IntrinsicThesis& expected) {
  ThesisDecomposition& thesis = method.thesis();
  std::vector<reference::Plane> chromaticities;
  for (int n = 0; n < method.thesis_stats().levels; ++n) {
    const Plane level = thesis.sample_frame(n);
    chromaticities.push_back(to_reference(level.extent, lab.download(level.buffer)));
  }
  expected.set_chromaticities(chromaticities);
  expected.set_clusters(method.thesis_stats().clustered
                            ? to_reference(extent, lab.download(thesis.clusters().buffer))
                            : reference::Plane());
  Pixels light = input;
  for (float& value : light) value = finite_light(value, 65504);
  const reference::Plane x = expected.decompose(to_reference(extent, light));
  const reference::Plane got = to_reference(extent, lab.download(thesis.solution().buffer));
  double sum = 0;
  for (size_t n = 0; n < x.size(); ++n)
    for (size_t c = 0; c < 3; ++c)
      sum += std::pow(got.data[n][c] + got.data[n][3] - x.data[n][c] - x.data[n][3], 2) / 3;
  const double rms = std::sqrt(sum / static_cast<double>(x.size()));
  if (rms < 1e-4) return {};
  return at("rms distance of ln of the model to the reference", frame, 0, rms);
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

/// Shading of a frame without history is the reference's, as near as its bins in fixed point allow,
/// when all cycles are made.
std::optional<std::string> far_from_shading(const Lab& lab, const Case& one, const Pixels& input) {
  Method method(lab, one.solver, {one.width, one.height});
  method.set(IntrinsicDecomposition::Params{.tolerances = {.cycle = 0}});
  const Output got = method.decompose_unscaled(input);
  const auto expected = reference::decompose(rgb_of(input).data(), static_cast<int>(one.width),
                                             static_cast<int>(one.height), {}, nullptr);
  const double rms = rms_difference(log_shading_of(got.intrinsic), expected.log_shading);
  if (rms < 2e-3) return {};
  return at("rms distance to the reference, log units", 0, 0, rms);
}

/// The thesis' model R (T_0 + Σ b_k T_k) explains its input at large, as its data term says: all
/// but 7 % of the input's squares. Dark noise it may leave.
std::optional<std::string> wrong_global_model(uint32_t frame, const Pixels& input,
                                              const Output& got) {
  double off = 0, light = 0;
  for (size_t i = 0; i < input.size(); ++i) {
    if (i % 4 == 3) continue;
    const auto wanted = static_cast<double>(finite_light(input[i], 65504));
    off += std::pow(
        static_cast<double>(got.intrinsic[i] * got.intrinsic[i | 3] * got.light[i]) - wanted, 2);
    light += wanted * wanted;
  }
  if (off <= 0.07 * light + 1e-4 * static_cast<double>(input.size())) return {};
  return at("part of the input that the model leaves", frame, 0, off / light);
}

/// Amount, base colors and light of a frame without history are the reference's.
std::optional<std::string> far_from_light(const Lab& lab, const Case& one, const Pixels& input) {
  Method method(lab, one.solver, {one.width, one.height});
  GlobalIntrinsic::Params params;
  params.adaptive = false;
  params.tolerances.cycle = 0;
  params.light.slope = 0;
  method.set(params);
  const Output got = method.decompose(input);
  const auto& found = method.found();
  const auto expected =
      reference::decompose_global(rgb_of(input).data(), static_cast<int>(one.width),
                                  static_cast<int>(one.height), reference::GlobalParams{}, nullptr);
  const auto amount = static_cast<double>(found.amount);
  if (!(std::abs(amount - expected.amount.value) <= 0.01 * expected.amount.value))
    return at("amount, and the reference's is " + std::to_string(expected.amount.value), 0, 0,
              amount);
  if (found.colors != static_cast<uint32_t>(expected.colors.used()))
    return at("base colors, and the reference's are " + std::to_string(expected.colors.used()), 0,
              0, found.colors);
  std::vector<double> apart;
  for (size_t n = 0; n < expected.direct.size(); ++n) {
    double mean = 0, off[3];
    for (size_t c = 0; c < 3; ++c) {
      off[c] = std::log(static_cast<double>(got.light[4 * n + c])) -
               std::log(std::max(expected.direct[n] + expected.indirect[3 * n + c], 1e-30));
      mean += off[c] / 3;
    }
    apart.push_back(0);
    for (const double d : off) apart.back() += (d - mean) * (d - mean) / 3;
  }
  // An empty bin between two base colors may go to either; the few pixels in it then differ. The
  // nearest nine tenths are compared.
  std::sort(apart.begin(), apart.end());
  apart.resize((9 * apart.size() + 9) / 10);
  double sum = 0;
  for (const double d : apart) sum += d;
  const double rms = std::sqrt(sum / static_cast<double>(apart.size()));
  if (rms < 1e-4) return {};
  return at("rms distance of the light's color to the reference, log units", 0, 0, rms);
}

/// What globalintrinsic reports of a frame that cannot be.
std::optional<std::string> wrong_findings(const Case& one, uint32_t frame, const Method& method,
                                          const Output& got) {
  const auto& found = method.found();
  const GlobalIntrinsic::Params params = global_params_of(one);
  if (!std::isfinite(found.tint)) return at("tint is not finite", frame, 0, 0);
  constexpr float kMinAmount = 0.06F;
  const float kMaxAmount = kMinAmount * std::pow(1.24F, 15.0F);
  const bool fades = found.chroma < 1.001F * GlobalIntrinsic::Params{}.full_color;
  if (params.amount > 0 ? found.amount != params.amount
                        : !(found.amount >= (fades ? 0 : 0.999F * kMinAmount) &&
                            found.amount <= 1.001F * kMaxAmount))
    return at("amount beside its candidates", frame, 0, static_cast<double>(found.amount));
  if (!(found.confidence >= 0 && found.confidence <= 1))
    return at("confidence", frame, 0, static_cast<double>(found.confidence));
  if ((found.colors == 0) != (found.amount == 0) ||
      found.colors > static_cast<uint32_t>(params.base_colors) || found.colors != got.colors())
    return at("base colors", frame, found.colors, static_cast<double>(got.colors()));
  return {};
}

/// Light that cannot be, of methods that find direct and indirect light.
std::optional<std::string> wrong_light(const Case& one, uint32_t frame, const Pixels& input,
                                       const Output& got) {
  const bool lamps = one.solver == Solver::global && global_params_of(one).white_balance > 0;
  for (size_t i = 0; i < got.light.size(); ++i) {
    const float direct = got.light[i | 3], light = got.light[i];
    if (direct > 1 + 1e-5F)
      return at("direct share above 1", frame, i, static_cast<double>(direct));
    if (!lamps && light < direct - 1e-5F)
      return at("less light than direct light", frame, i, static_cast<double>(light - direct));
    if (i % 4 == 3) continue;
    if (one.solver == Solver::global_thesis) {
      float sum = direct;
      for (size_t k = 0; k < 4 * got.shares.size(); ++k)
        sum += got.bases[4 * k + i % 4] * got.shares[k / 4][i / 4 * 4 + k % 4];
      if (std::abs(sum - light) > 1e-4F * (light + direct))
        return at("layers do not sum to the light", frame, i, static_cast<double>(sum - light));
      continue;
    }
    const float wanted = finite_light(input[i], max_light(one.solver));
    const float product = got.intrinsic[i] * got.intrinsic[i | 3] * light;
    if (!(std::abs(product - wanted) <= 2e-5F * (1e-2F + wanted)))
      return at("R S L is not the frame's " + std::to_string(wanted), frame, i,
                static_cast<double>(product));
  }
  return {};
}

}  // namespace

std::optional<std::string> wrong_layers(const Case& one, uint32_t frame, const Pixels& input,
                                        const Output& got) {
  std::vector<std::pair<std::string, const Pixels*>> planes{
      {"intrinsic", &got.intrinsic}, {"light", &got.light}, {"base color", &got.bases}};
  for (const Pixels& shares : got.shares) planes.emplace_back("share", &shares);
  for (const auto& [name, plane] : planes)
    for (size_t i = 0; i < plane->size(); ++i) {
      const float value = (*plane)[i];
      if (!std::isfinite(value)) return at(name + " is not finite", frame, i, 0);
      if (value < 0) return at(name + " is negative", frame, i, static_cast<double>(value));
    }
  if (is_global(one.solver)) return wrong_light(one, frame, input, got);
  for (size_t i = 0; i < got.intrinsic.size(); ++i) {
    const float value = got.intrinsic[i];
    const bool tame = one.solver == Solver::multigrid || one.knobs == 0;
    if (i % 4 == 3 && tame && !(value > 1e-15F && value < 1e15F))
      return at("shading out of all proportion", frame, i, static_cast<double>(value));
    if (i % 4 == 3 || one.solver != Solver::multigrid) continue;
    const float light = finite_light(input[i], max_light(one.solver));
    const float product = value * got.intrinsic[i | 3];
    if (!(std::abs(product - light) <= 1e-5F * std::max(light, 1.0F)))
      return at("R S is not I", frame, i, static_cast<double>(product));
  }
  return {};
}

Check check_with(const Lab& lab) {
  return [&lab](const Case& one) -> std::optional<std::string> {
    Method method(lab, one.solver, {one.width, one.height});
    method.set(one);
    reference::IntrinsicThesis thesis(testing::to_reference(thesis_params_of(one)));
    for (uint32_t frame = 0; frame < one.frames; ++frame) {
      Case scene = one;
      // Every second frame of the methods that remember base colors shows another scene.
      if (is_global(one.solver)) scene.seed += frame / 2;
      const Pixels input = frame_of(scene, frame);
      const Output got = method.decompose(input);
      auto wrong = wrong_layers(one, frame, input, got);
      if (wrong) return wrong;
      if (one.solver == Solver::global)
        wrong = wrong_findings(one, frame, method, got);
      else if (one.knobs != 0 || one.solver == Solver::multigrid)
        continue;
      else if (one.solver != Solver::global_thesis)
        wrong = far_from_model(lab, {one.width, one.height}, frame, input, method, thesis);
      else if (frame == 0 || frame % 2 == 1)  // a new scene's colors are known from its second one
        wrong = wrong_global_model(frame, input, got);
      if (wrong) return wrong;
    }
    const Pixels input = frame_of(one, 0);
    if (one.solver == Solver::pcg || one.solver == Solver::schwarz)
      return rising_energy(lab, one, input);
    if (one.knobs != 0 || one.solver == Solver::global_thesis) return {};
    return one.solver == Solver::global ? far_from_light(lab, one, input)
                                        : far_from_shading(lab, one, input);
  };
}

void check_each_fault(const Check& check, Solver solver, uint32_t frames,
                      std::initializer_list<Extent> extents) {
  for (uint32_t fault = 0; fault < kFaults; ++fault)
    for (const Extent extent : extents) {
      const Case one{solver, extent.width, extent.height, frames, fault + 1, 1U << fault, 0};
      const auto wrong = check(one);
      EXPECT_FALSE(wrong) << name_of(static_cast<Fault>(fault)) << ": " << one.text() << ": "
                          << *wrong;
    }
}

}  // namespace inverse::extremes
