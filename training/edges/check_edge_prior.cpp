// SPDX-License-Identifier: LGPL-2.1-or-later
// Scores fitted weights on scenes that no fit sees: procedural ones of other seeds, or files.
//
//   check_edge_prior [--scenes 100] [--scenes-dir DIR] weights.txt …
//
// Prints for each file of weights the loss of the fit and the rms error of log shading (without its
// mean), with the slope of light given, and with gray light assumed.
#include <cmath>
#include <cstdio>
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
struct Score {
  double loss = 0, error = 0;
};

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
      }
    }
  }
  std::printf("%d scenes\nslope given: loss, rms | gray: loss, rms\n", count);
  for (std::size_t j = 0; j < sums.size(); ++j)
    std::printf("%.4f %.4f | %.4f %.4f  %s\n", sums[j].given.loss, sums[j].given.error,
                sums[j].gray.loss, sums[j].gray.error, weight_files[j].c_str());
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
