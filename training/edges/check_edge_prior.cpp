// SPDX-License-Identifier: LGPL-2.1-or-later
// Scores fitted weights on scenes that no fit sees: procedural ones of other seeds, or files.
//
//   check_edge_prior [--scenes 100] [--scenes-dir DIR] weights.txt …
//
// Prints for each file of weights the loss of the fit, the rms error of log shading (without its
// mean) and the share of wrong judgments of reflectance (WHDR, Bell et al. 2014, δ = .1) over pairs
// of points of which a third has the same paint; with the slope of light given, and with gray
// light.
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

/// Adds the judgments of pairs of points, the same ones for all weights.
void judge(const Example& e, const Plane& s, Score& out) {
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
      chroma = std::max(
          chroma,
          std::abs(
              std::log((e.reflectance.data[3 * i + c] + 1e-3) / brightness(e.reflectance, i)) -
              std::log((e.reflectance.data[3 * j + c] + 1e-3) / brightness(e.reflectance, j))));
    const double truth = brightness(e.reflectance, i) / double(brightness(e.reflectance, j));
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

Score score(const Model& model, const std::vector<float>& weights, const Example& e) {
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
  judge(e, solution.s, out);
  return out;
}

void check(const std::vector<std::string>& weight_files, int scenes, const std::string& directory) {
  const std::vector<std::string> files =
      directory.empty() ? std::vector<std::string>() : scene_files(directory);
  const int count = directory.empty() ? scenes : int(files.size());
  struct Sum {
    Score given, gray;
  };
  std::vector<Sum> sums(weight_files.size());
  for (int k = 0; k < count; ++k) {
    const Scene scene = directory.empty() ? make_scene(std::uint32_t(kFirstSeed + k), 176, 132)
                                          : load_scene(files[std::size_t(k)]);
    for (const bool given : {true, false}) {
      const Example e = make_example(scene, given ? light_slope(scene) : 0);
      for (std::size_t j = 0; j < sums.size(); ++j) {
        const Weights w = load_weights(weight_files[j]);
        const Model model(w.edge_hidden, w.cell_hidden);
        if (w.values.size() != std::size_t(model.count()))
          throw std::runtime_error(weight_files[j] + " holds no weights of this model");
        const Score s = score(model, w.values, e);
        Score& sum = given ? sums[j].given : sums[j].gray;
        sum.loss += s.loss / count, sum.error += s.error / count;
        sum.wrong += s.wrong, sum.judged += s.judged;
      }
    }
  }
  std::printf("%d scenes\nslope given: loss, rms, WHDR | gray: loss, rms, WHDR\n", count);
  for (std::size_t j = 0; j < sums.size(); ++j) {
    for (const Score& s : {sums[j].given, sums[j].gray})
      std::printf("%.4f %.4f %.4f | ", s.loss, s.error, s.wrong / std::max(1.0, s.judged));
    std::printf("%s\n", weight_files[j].c_str());
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
