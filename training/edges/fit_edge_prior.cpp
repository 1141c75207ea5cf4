// SPDX-License-Identifier: LGPL-2.1-or-later
// Fits the edge prior: stochastic gradient descent through the solve.
//
//   fit_edge_prior --out weights.txt [--from weights.txt | --hidden 4] [--seed 1] [--scenes 500]
//                  [--steps 4000] [--rate 0.005] [--scenes-dir DIR --share 0.5] [--pairs 0]
//                  [--couples-dir DIR --couples 0.4]
//
// Examples are procedural (scenes.hpp); a share of each batch comes from the files of a directory
// (scene_files.hpp), if one is given. Objects on black and palettes of diverse value are drawn more
// often than they occur. The slope of light is that of the scene with an error, as an estimate has.
// `--pairs` weighs steps of reflectance between pixels of one paint, in scenes from files. Of each
// batch a share `--couples` is couples (couples.hpp) of a directory, if one is given.
// training/edges/export_weights.py makes the C++ header.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>

#include "colored_light.hpp"
#include "couples.hpp"
#include "problem.hpp"
#include "scene_files.hpp"
#include "scenes.hpp"
#include "tests/bench/support/command_line.hpp"
#include "textures.hpp"
#include "weights.hpp"

namespace inverse::training {
namespace {

constexpr int kCellHidden = 8, kBatch = 8, kThreads = 2;
constexpr double kObjectShare = 0.35, kDiverseShare = 0.5, kDecay = 3e-5;

struct Options {
  std::string out, from, scenes_dir, couples_dir;
  int scenes = 500, hidden = 4, seed = 1, steps = 4000;
  double rate = 5e-3, share = 0.5, pairs = 0, couples = 0.4;
  double couple_weight = 1.0 / 3;  // of a couple's gradient
};

void parallel(int n, const std::function<void(int, int)>& work) {
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      for (int k = t; k < n; k += kThreads) work(k, t);
    });
  for (std::thread& t : threads) t.join();
}

std::vector<float> initial(const Model& model, int seed) {
  std::vector<float> p(std::size_t(model.count()), 0.0F);
  std::mt19937 engine{unsigned(seed)};
  std::normal_distribution<float> normal;
  for (const Net* net : {&model.edge, &model.cell})
    for (int h = 0; h < net->hidden; ++h)
      for (int i = 0; i < net->inputs; ++i)
        p[std::size_t(net->inner(h, i))] = 0.5F * normal(engine) / std::sqrt(float(net->inputs));
  for (int o = 0; o < model.edge.outputs; ++o)
    for (int h = 0; h < model.edge.hidden; ++h)
      p[std::size_t(model.edge.outer(o, h))] = 0.1F * normal(engine);
  // Starts as color Retinex does: chroma steps are reflectance, the rest is shading.
  p[std::size_t(model.edge.skip(0, 1))] = -1, p[std::size_t(model.edge.skip(0, 0))] = -0.5F;
  p[std::size_t(model.edge.skip(1, 1))] = 1;
  p[std::size_t(model.edge.bias2(0))] = 0.5F, p[std::size_t(model.edge.bias2(1))] = -2;
  p[std::size_t(model.cell.bias2(0))] = -3.5F, p[std::size_t(model.cell.bias2(2))] = -1.9F;
  return p;
}

/// Training examples, indices of them by kind, and couples, whose indices go on from theirs.
struct Corpus {
  std::vector<Example> examples;
  std::vector<int> objects, diverse, even, filed;
  std::vector<std::unique_ptr<Couple>> couples;

  bool is_couple(int k) const { return k >= int(examples.size()); }
  const Couple& couple(int k) const { return *couples[std::size_t(k) - examples.size()]; }
  int draw(std::mt19937& engine, double couple_share, double filed_share) const {
    const auto uniform = [&] { return double(engine() >> 8) / 16777216.0; };
    const auto any = [&](const std::vector<int>& v) { return v[engine() % v.size()]; };
    if (!couples.empty() && uniform() < couple_share)
      return int(examples.size() + engine() % couples.size());
    if (!filed.empty() && uniform() < filed_share) return any(filed);
    if (!objects.empty() && uniform() < kObjectShare) return any(objects);
    return (uniform() < kDiverseShare && !diverse.empty()) || even.empty() ? any(diverse)
                                                                           : any(even);
  }
};

bool is_diverse(const Example& e) {
  double sum = 0, squares = 0, count = 1e-9;
  for (std::size_t i = 0; i < e.m.size(); ++i) {
    if (e.mask.data[i] < 0.5F) continue;
    const float* r = &e.reflectance.data[3 * i];
    const double l = std::log(std::max({r[0], r[1], r[2]}) + 1e-3);
    sum += l, squares += l * l, count += 1;
  }
  return squares / count - sum * sum / (count * count) > 0.25;
}

Corpus make_corpus(const Options& options) {
  Corpus corpus;
  corpus.examples.resize(std::size_t(options.scenes));
  constexpr std::array<std::array<int, 2>, 5> kSizes{
      {{176, 132}, {176, 132}, {224, 168}, {128, 96}, {128, 96}}};
  const auto example = [&](const Scene& scene, int k) {
    Random r{std::mt19937(unsigned(k))};
    return make_example(scene, light_slope(scene) + kSlopeError * r.normal());
  };
  parallel(options.scenes, [&](int k, int) {
    const auto& size = kSizes[std::size_t(k) % kSizes.size()];
    const int seed = 100000 * (options.seed - 1) + 1000 + k;
    corpus.examples[std::size_t(k)] =
        example(make_scene(std::uint32_t(seed), size[0], size[1]), seed);
  });
  for (int k = 0; k < options.scenes; ++k) {
    const Example& e = corpus.examples[std::size_t(k)];
    if (std::find(e.mask.data.begin(), e.mask.data.end(), 0.0F) != e.mask.data.end())
      corpus.objects.push_back(k);
    (is_diverse(e) ? corpus.diverse : corpus.even).push_back(k);
  }
  if (!options.couples_dir.empty()) {
    const std::vector<std::string> files = scene_files(options.couples_dir);
    std::vector<std::unique_ptr<Couple>> couples(files.size());
    parallel(int(files.size()), [&](int k, int) {
      std::mt19937 engine{unsigned(k)};
      couples[std::size_t(k)] =
          std::make_unique<Couple>(load_couple(files[std::size_t(k)], engine));
    });
    corpus.couples = std::move(couples);
  }
  if (options.scenes_dir.empty()) return corpus;
  const std::vector<std::string> files = scene_files(options.scenes_dir);
  corpus.examples.resize(std::size_t(options.scenes) + files.size());
  parallel(int(files.size()), [&](int k, int) {
    Example& e = corpus.examples[std::size_t(options.scenes + k)];
    e = example(load_scene(files[std::size_t(k)]), k + 1);
    if (options.pairs > 0) draw_pairs(e);
  });
  for (int k = 0; k < int(files.size()); ++k) corpus.filed.push_back(options.scenes + k);
  return corpus;
}

void fit(const Options& options) {
  const Weights from =
      options.from.empty() ? Weights{options.hidden, kCellHidden, {}} : load_weights(options.from);
  const Model model(from.edge_hidden, from.cell_hidden);
  const std::size_t n = std::size_t(model.count());
  std::vector<float> p = options.from.empty() ? initial(model, options.seed) : from.values;
  if (p.size() != n) throw std::runtime_error(options.from + " holds no weights of this model");
  const auto save = [&](const std::vector<float>& values) {
    save_weights({from.edge_hidden, from.cell_hidden, values}, options.out);
  };
  const Corpus corpus = make_corpus(options);
  // Of an example in `before`, if it is no couple.
  std::vector<CoupleSolution> solutions(corpus.examples.size() + corpus.couples.size());
  std::vector<float> average = p;
  std::vector<double> first(n, 0), second(n, 0);
  std::mt19937 engine{unsigned(options.seed)};
  double sum = 0, sum_couples = 0;
  int count_couples = 0;
  for (int step = 1; step <= options.steps; ++step) {
    std::array<int, kBatch> batch{};
    for (int& b : batch) b = corpus.draw(engine, options.couples, options.share);
    std::array<std::vector<double>, kBatch> gradients;
    std::array<double, kBatch> losses{};
    std::array<CoupleSolution, kBatch> work;
    for (int k = 0; k < kBatch; ++k)
      work[std::size_t(k)] = solutions[std::size_t(batch[std::size_t(k)])];
    parallel(kBatch, [&](int k, int) {
      const std::size_t j = std::size_t(k);
      gradients[j].assign(n, 0);
      if (corpus.is_couple(batch[j])) {
        losses[j] = evaluate(model, p, corpus.couple(batch[j]), work[j], &gradients[j]);
        for (double& v : gradients[j]) v *= options.couple_weight;
      } else
        losses[j] = evaluate(model, p, corpus.examples[std::size_t(batch[j])], work[j].before,
                             &gradients[j], {.equal = options.pairs});
    });
    std::vector<double> g(n, 0);
    for (std::size_t j = 0; j < kBatch; ++j) {  // one example may not dominate a step
      double norm = 1e-12;
      for (double v : gradients[j]) norm += v * v;
      const double scale = std::min(1.0, 2 / std::sqrt(norm)) / kBatch;
      for (std::size_t i = 0; i < n; ++i) g[i] += scale * gradients[j][i];
      (corpus.is_couple(batch[j]) ? sum_couples : sum) += losses[j];
      count_couples += corpus.is_couple(batch[j]);
      solutions[std::size_t(batch[j])] = std::move(work[j]);
    }
    const double rate = options.rate * 0.5 * (1 + std::cos(3.14159 * step / options.steps)) + 1e-5;
    for (std::size_t i = 0; i < n; ++i) {  // Adam, and a running mean of the weights
      g[i] += kDecay * p[i];
      first[i] = 0.9 * first[i] + 0.1 * g[i];
      second[i] = 0.98 * second[i] + 0.02 * g[i] * g[i];
      const double mean = first[i] / (1 - std::pow(0.9, step)),
                   spread = second[i] / (1 - std::pow(0.98, step));
      p[i] -= float(rate * mean / (std::sqrt(spread) + 1e-8));
      average[i] += 0.02F * (p[i] - average[i]);
    }
    if (step % 100 == 0) {
      std::printf("step %d  loss %.4f  couples %.4f\n", step,
                  sum / std::max(1, 100 * kBatch - count_couples),
                  sum_couples / std::max(1, count_couples));
      std::fflush(stdout);
      sum = sum_couples = 0, count_couples = 0;
      save(average);
    }
  }
  save(average);
}

}  // namespace
}  // namespace inverse::training

int main(int argc, char** argv) {
  inverse::training::Options o;
  namespace bench = inverse::bench;
  const bench::Options known{{"--out", bench::text(o.out)},
                             {"--from", bench::text(o.from)},
                             {"--scenes-dir", bench::text(o.scenes_dir)},
                             {"--scenes", bench::integer(o.scenes)},
                             {"--hidden", bench::integer(o.hidden)},
                             {"--seed", bench::integer(o.seed)},
                             {"--steps", bench::integer(o.steps)},
                             {"--rate", bench::number(o.rate)},
                             {"--share", bench::number(o.share)},
                             {"--pairs", bench::number(o.pairs)},
                             {"--couples-dir", bench::text(o.couples_dir)},
                             {"--couples", bench::number(o.couples)},
                             {"--couple-weight", bench::number(o.couple_weight)}};
  if (!bench::read(known, argc, argv, "fit_edge_prior.cpp")) return 2;
  try {
    if (o.out.empty() || o.scenes < 1)
      throw std::runtime_error("--out FILE and at least one scene are needed");
    inverse::training::fit(o);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "fit_edge_prior: %s\n", e.what());
    return 1;
  }
  return 0;
}
