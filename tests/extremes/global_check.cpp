// What has to hold of direct and indirect light, reflectance and shading, whatever the input.
#include <cmath>

#include "global_methods.hpp"
#include "methods.hpp"

namespace inverse::extremes {
namespace {

std::string at(const std::string& what, uint32_t frame, size_t index, double value) {
  return what + " in frame " + std::to_string(frame) + " at " + std::to_string(index) + ": " +
         std::to_string(value);
}

/// The thesis' model R (T_0 + Σ b_k T_k) explains its input at large, as its data term says: the
/// larger part of the input's squares. Dark noise it may leave.
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
  if (off <= 0.5 * light + 1e-4 * static_cast<double>(input.size())) return {};
  return at("part of the input that the model leaves", frame, 0, off / light);
}

}  // namespace

std::optional<std::string> wrong_global_layers(Solver solver, uint32_t frame, const Pixels& input,
                                               const GlobalLayers& layers) {
  std::vector<std::pair<std::string, const Pixels*>> planes{{"intrinsic", &layers.intrinsic},
                                                            {"light", &layers.light},
                                                            {"base color", &layers.bases}};
  for (const Pixels& shares : layers.shares) planes.emplace_back("share", &shares);
  for (const auto& [name, plane] : planes)
    for (size_t i = 0; i < plane->size(); ++i) {
      const float value = (*plane)[i];
      if (!std::isfinite(value)) return at(name + " is not finite", frame, i, 0);
      if (value < 0) return at(name + " is negative", frame, i, static_cast<double>(value));
    }
  for (size_t i = 0; i < layers.light.size(); ++i) {
    const float direct = layers.light[i | 3], light = layers.light[i];
    if (direct > 1 + 1e-5F) return at("direct share above 1", frame, i, static_cast<double>(direct));
    if (solver == Solver::global_thesis && light < direct - 1e-5F)
      return at("less light than direct light", frame, i, static_cast<double>(light - direct));
    if (solver != Solver::global || i % 4 == 3) continue;
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
      if (auto wrong = wrong_global_layers(one.solver, frame, input, got)) return wrong;
      if (one.solver == Solver::global_thesis) {
        if (one.knobs == 0)
          if (auto wrong = wrong_model(frame, input, got)) return wrong;
        continue;
      }
      const auto& found = method.found();
      if (!std::isfinite(found.tint)) return at("tint is not finite", frame, 0, 0);
      const float amount = global_params_of(one).amount;
      constexpr float kLeast = 0.06F;
      const float kMost = kLeast * std::pow(1.24F, 15.0F);
      if (amount > 0 ? found.amount != amount
                     : !(found.amount >= 0.999F * kLeast && found.amount <= 1.001F * kMost))
        return at("amount beside its candidates", frame, 0, static_cast<double>(found.amount));
      if (!(found.confidence >= 0 && found.confidence <= 1))
        return at("confidence", frame, 0, static_cast<double>(found.confidence));
      if (found.colors < 1 ||
          found.colors > static_cast<uint32_t>(global_params_of(one).base_colors) ||
          found.colors != got.colors())
        return at("base colors", frame, found.colors, static_cast<double>(got.colors()));
    }
    return {};
  };
}

}  // namespace inverse::extremes
