// SPDX-License-Identifier: LGPL-2.1-or-later
// Invariants of direct and indirect light, reflectance and shading for any input.
#include <algorithm>
#include <cmath>

#include "global_methods.hpp"
#include "tests/extremes/intrinsic/methods.hpp"
#include "tests/reference/global/global_intrinsic.hpp"

namespace inverse::extremes {
namespace {

std::string at(const std::string& what, uint32_t frame, size_t index, double value) {
  return what + " in frame " + std::to_string(frame) + " at " + std::to_string(index) + ": " +
         std::to_string(value);
}

/// The thesis' model R (T_0 + Σ b_k T_k) explains its input at large, as its data term says: all
/// but 7 % of the input's squares. Dark noise it may leave.
std::optional<std::string> wrong_model(uint32_t frame, const Pixels& input,
                                       const GlobalLayers& got) {
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
std::optional<std::string> far_from_reference(const Lab& lab, const Case& one,
                                              const Pixels& input) {
  GlobalMethod method(lab, one.solver, {one.width, one.height});
  GlobalIntrinsic::Params params;
  params.adaptive = false;
  params.tolerances.cycle = 0;
  method.set(params);
  const GlobalLayers got = method.decompose(input);
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

}  // namespace

std::optional<std::string> wrong_global_layers(Solver solver, uint32_t frame, const Pixels& input,
                                               const GlobalLayers& layers, bool colored_lamps) {
  std::vector<std::pair<std::string, const Pixels*>> planes{
      {"intrinsic", &layers.intrinsic}, {"light", &layers.light}, {"base color", &layers.bases}};
  for (const Pixels& shares : layers.shares) planes.emplace_back("share", &shares);
  for (const auto& [name, plane] : planes)
    for (size_t i = 0; i < plane->size(); ++i) {
      const float value = (*plane)[i];
      if (!std::isfinite(value)) return at(name + " is not finite", frame, i, 0);
      if (value < 0) return at(name + " is negative", frame, i, static_cast<double>(value));
    }
  for (size_t i = 0; i < layers.light.size(); ++i) {
    const float direct = layers.light[i | 3], light = layers.light[i];
    if (direct > 1 + 1e-5F)
      return at("direct share above 1", frame, i, static_cast<double>(direct));
    if (!colored_lamps && light < direct - 1e-5F)
      return at("less light than direct light", frame, i, static_cast<double>(light - direct));
    if (i % 4 == 3) continue;
    if (solver == Solver::global_thesis) {
      float sum = direct;
      for (size_t k = 0; k < 4 * layers.shares.size(); ++k)
        sum += layers.bases[4 * k + i % 4] * layers.shares[k / 4][i / 4 * 4 + k % 4];
      if (std::abs(sum - light) > 1e-4F * (light + direct))
        return at("layers do not sum to the light", frame, i, static_cast<double>(sum - light));
      continue;
    }
    const float wanted = finite_light(input[i], most_light(Solver::multigrid));
    const float product = layers.intrinsic[i] * layers.intrinsic[i | 3] * light;
    if (!(std::abs(product - wanted) <= 2e-5F * (1e-2F + wanted)))
      return at("R S L is not the frame's " + std::to_string(wanted), frame, i,
                static_cast<double>(product));
  }
  return {};
}

Check check_global_with(const Lab& lab) {
  return [&lab](const Case& one) -> std::optional<std::string> {
    GlobalMethod method(lab, one.solver, {one.width, one.height});
    method.set(one);
    for (uint32_t frame = 0; frame < one.frames; ++frame) {
      // Every second frame shows another scene.
      Case scene = one;
      scene.seed += frame / 2;
      const Pixels input = frame_of(scene, frame);
      const GlobalLayers got = method.decompose(input);
      const bool lamps = one.solver == Solver::global && global_params_of(one).white_balance > 0;
      if (auto wrong = wrong_global_layers(one.solver, frame, input, got, lamps)) return wrong;
      if (one.solver == Solver::global_thesis) {
        // A new scene's colors are known from its second frame on.
        if (one.knobs == 0 && (frame == 0 || frame % 2 == 1))
          if (auto wrong = wrong_model(frame, input, got)) return wrong;
        continue;
      }
      const auto& found = method.found();
      if (!std::isfinite(found.tint)) return at("tint is not finite", frame, 0, 0);
      const float amount = global_params_of(one).amount;
      constexpr float kMinAmount = 0.06F;
      const float kMaxAmount = kMinAmount * std::pow(1.24F, 15.0F);
      const bool fades = found.chroma < 1.001F * GlobalIntrinsic::Params{}.full_color;
      if (amount > 0 ? found.amount != amount
                     : !(found.amount >= (fades ? 0 : 0.999F * kMinAmount) &&
                         found.amount <= 1.001F * kMaxAmount))
        return at("amount beside its candidates", frame, 0, static_cast<double>(found.amount));
      if (!(found.confidence >= 0 && found.confidence <= 1))
        return at("confidence", frame, 0, static_cast<double>(found.confidence));
      if ((found.colors == 0) != (found.amount == 0) ||
          found.colors > static_cast<uint32_t>(global_params_of(one).base_colors) ||
          found.colors != got.colors())
        return at("base colors", frame, found.colors, static_cast<double>(got.colors()));
    }
    if (one.solver == Solver::global && one.knobs == 0)
      return far_from_reference(lab, one, frame_of(one, 0));
    return {};
  };
}

}  // namespace inverse::extremes
