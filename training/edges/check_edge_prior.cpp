// SPDX-License-Identifier: LGPL-2.1-or-later
// Scores fitted weights on scenes that no fit sees: procedural ones of other seeds, or files.
//
//   check_edge_prior [--scenes 100] [--scenes-dir DIR] weights.txt …
//
// Prints for each file of weights the loss of the fit, the rms error of log shading (without its
// mean) and the share of wrong judgments of reflectance (WHDR, Bell et al. 2014, δ = .1) over pairs
// of points of which a third has the same paint, by kind of scene; with the slope of light given,
// given with an error, and with gray light assumed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>

#include "colored_light.hpp"
#include "problem.hpp"
#include "scene_files.hpp"
#include "tests/bench/support/command_line.hpp"
#include "weights.hpp"

namespace inverse::training {
namespace {

constexpr int kFirstSeed = 50000000;
constexpr int kPairs = 120;  // of a scene
struct Score {
  double loss = 0, error = 0, wrong = 0, judged = 0;
};

/// 1 if the first of two reflectances is darker, 2 if the second is, 0 if they are equal.
int judgment(double ratio) { return ratio > 1.1 ? 2 : 1 / ratio > 1.1 ? 1 : 0; }

/// Adds the judgments of pairs of points, the same ones for all weights and slopes.
void judge(const Example& e, const bench::Image& paint, const Plane& s, Score& out) {
  std::mt19937 engine{1};
  const auto brightness = [&](const bench::Image& image, std::size_t i) {
    return std::max(1e-5F, image.data[3 * i] + image.data[3 * i + 1] + image.data[3 * i + 2]);
  };
  int equal = 0, unequal = 0;
  for (int trial = 0; trial < 100 * kPairs && equal + unequal < kPairs; ++trial) {
    const std::size_t i = engine() % s.size(), j = engine() % s.size();
    if (e.mask.data[i] < 0.5F || e.mask.data[j] < 0.5F) continue;
    double chroma = 0;
    for (std::size_t c = 0; c < 3; ++c)
      chroma = std::max(chroma,
                        std::abs(std::log((paint.data[3 * i + c] + 1e-3) / brightness(paint, i)) -
                                 std::log((paint.data[3 * j + c] + 1e-3) / brightness(paint, j))));
    const double truth = brightness(paint, i) / double(brightness(paint, j));
    const bool same = std::abs(std::log(truth)) < 0.04 && chroma < 0.05;
    if (!same && std::abs(std::log(truth)) < 0.2) continue;
    int& kind = same ? equal : unequal;
    if (kind >= (same ? kPairs / 3 : 2 * kPairs / 3)) continue;
    ++kind;
    const double found = brightness(e.input, i) / double(brightness(e.input, j)) *
                         std::exp(double(s[j]) - double(s[i]));
    out.wrong += judgment(found) != (same ? 0 : judgment(truth));
    ++out.judged;
  }
}

Score score(const Model& model, const std::vector<float>& weights, const Example& e,
            const bench::Image& paint) {
  Solution solution;
  Score out;
  out.loss = evaluate(model, weights, e, solution, nullptr);
  double n = 1e-9, sum = 0, squares = 0;
  for (std::size_t i = 0; i < e.m.size(); ++i) {
    if (e.mask.data[i] < 0.5F || e.shading.data[i] < 1e-3F) continue;
    const double d = solution.s[i] - std::log(e.shading.data[i]);
    n += 1, sum += d, squares += d * d;
  }
  out.error = std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n)));
  judge(e, paint, solution.s, out);
  return out;
}

/// What a score is kept of: the kind of scene, and what is assumed of the slope of light.
constexpr std::array<const char*, 3> kKinds{"objects on black", "gray light", "colored light"};
constexpr std::array<const char*, 3> kSlopes{"given", "estimated", "gray"};

std::size_t kind_of(const Scene& scene, double slope) {
  const auto& mask = scene.mask.data;
  const auto black = std::count_if(mask.begin(), mask.end(), [](float v) { return v < 0.5F; });
  return double(black) > 0.1 * double(mask.size()) ? 0 : std::abs(slope) < 0.05 ? 1 : 2;
}

void check(const std::vector<std::string>& weight_files, int scenes, const std::string& directory) {
  const std::vector<std::string> files =
      directory.empty() ? std::vector<std::string>() : scene_files(directory);
  const int count = directory.empty() ? scenes : int(files.size());
  std::vector<Weights> weights;
  for (const std::string& file : weight_files) weights.push_back(load_weights(file));
  std::vector<std::array<std::array<Score, kSlopes.size()>, kKinds.size()>> sums(weights.size());
  std::array<int, kKinds.size()> counts{};
  std::mt19937 engine{1};
  std::normal_distribution<double> error(0, kSlopeError);
  for (int k = 0; k < count; ++k) {
    const Scene scene = directory.empty() ? make_scene(std::uint32_t(kFirstSeed + k), 176, 132)
                                          : load_scene(files[std::size_t(k)]);
    const double slope = light_slope(scene);
    const std::size_t kind = kind_of(scene, slope);
    ++counts[kind];
    const std::array<double, kSlopes.size()> assumed{slope, slope + error(engine), 0};
    for (std::size_t n = 0; n < assumed.size(); ++n) {
      const Example e = make_example(scene, assumed[n]);
      for (std::size_t j = 0; j < sums.size(); ++j) {
        const Model model(weights[j].edge_hidden, weights[j].cell_hidden);
        if (weights[j].values.size() != std::size_t(model.count()))
          throw std::runtime_error(weight_files[j] + " holds no weights of this model");
        const Score s = score(model, weights[j].values, e, scene.reflectance);
        Score& sum = sums[j][kind][n];
        sum.loss += s.loss, sum.error += s.error, sum.wrong += s.wrong, sum.judged += s.judged;
      }
    }
  }
  std::printf("loss, rms, WHDR by slope:");
  for (const char* name : kSlopes) std::printf(" %s |", name);
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    if (counts[kind] == 0) continue;
    std::printf("\n%s, %d scenes\n", kKinds[kind], counts[kind]);
    for (std::size_t j = 0; j < sums.size(); ++j) {
      for (const Score& s : sums[j][kind])
        std::printf("%.4f %.4f %.4f | ", s.loss / counts[kind], s.error / counts[kind],
                    s.wrong / std::max(1.0, s.judged));
      std::printf("%s\n", weight_files[j].c_str());
    }
  }
}

}  // namespace
}  // namespace inverse::training

int main(int argc, char** argv) {
  namespace bench = inverse::bench;
  int scenes = 100;
  std::string directory;
  std::vector<std::string> weights;
  const bench::Options known{{"--scenes", bench::integer(scenes)},
                             {"--scenes-dir", bench::text(directory)}};
  if (!bench::read(known, argc, argv, "check_edge_prior.cpp", &weights)) return 2;
  try {
    inverse::training::check(weights, scenes, directory);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "check_edge_prior: %s\n", e.what());
    return 1;
  }
  return 0;
}
