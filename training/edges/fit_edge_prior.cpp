// SPDX-License-Identifier: LGPL-2.1-or-later
// Fits the edge prior: stochastic gradient descent through the solve.
//
//   fit_edge_prior --out weights.txt [--from weights.txt | --hidden 12] [--scenes 200] [--seconds
//   600] [--rate 0.005]
//                  [--rendered 0.25 --data DIR --leave scene,scene]
//
// Examples are procedural (scenes.hpp); a share of `--rendered` of each batch comes from the
// rendered sequences of regimes near_constant_value and hard_shadow, without the scenes left out.
// MIT objects and the diverse-value sequences are never trained on. Objects on black and palettes
// of diverse value are drawn more often than they occur. shrink_edge_prior fits a smaller net to
// the result, training/edges/export_weights.py makes the C++ header.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>

#include "problem.hpp"
#include "scenes.hpp"
#include "tests/bench/scenes/datasets.hpp"
#include "tests/bench/support/command_line.hpp"
#include "weights.hpp"

namespace inverse::training {
namespace {

constexpr int kCellHidden = 8, kBatch = 8, kThreads = 2;
constexpr double kObjectShare = 0.35, kDiverseShare = 0.5, kDecay = 3e-5;

struct Options {
  std::string out, from, data = "../shared/data", leave;
  int scenes = 200, hidden = 12;
  double seconds = 600, rate = 5e-3, rendered = 0;
};

void parallel(int n, const std::function<void(int, int)>& work) {
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      for (int k = t; k < n; k += kThreads) work(k, t);
    });
  for (std::thread& t : threads) t.join();
}

std::vector<float> initial(const Model& model) {
  std::vector<float> p(std::size_t(model.count()), 0.0F);
  std::mt19937 engine(1);
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

/// Indices of the training examples by kind.
struct Corpus {
  std::vector<Example> examples;
  std::vector<int> objects, diverse, even, rendered;

  int draw(std::mt19937& engine, double rendered_share) const {
    const auto uniform = [&] { return double(engine() >> 8) / 16777216.0; };
    const auto any = [&](const std::vector<int>& v) { return v[engine() % v.size()]; };
    if (!rendered.empty() && uniform() < rendered_share) return any(rendered);
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
  parallel(options.scenes, [&](int k, int) {
    const auto& size = kSizes[std::size_t(k) % kSizes.size()];
    Scene s = make_scene(std::uint32_t(1000 + k), size[0], size[1]);
    corpus.examples[std::size_t(k)] = make_example(std::move(s.input), std::move(s.reflectance),
                                                   std::move(s.shading), std::move(s.mask));
  });
  for (int k = 0; k < options.scenes; ++k) {
    const Example& e = corpus.examples[std::size_t(k)];
    if (std::find(e.mask.data.begin(), e.mask.data.end(), 0.0F) != e.mask.data.end())
      corpus.objects.push_back(k);
    (is_diverse(e) ? corpus.diverse : corpus.even).push_back(k);
  }
  if (options.rendered <= 0) return corpus;
  for (const bench::LabeledFrame& f : bench::load_all(options.data, 3)) {
    if (f.regime == bench::Regime::kMit || f.regime == bench::Regime::kDiverseValue) continue;
    if (("," + options.leave + ",").find("," + f.scene + ",") != std::string::npos) continue;
    const bench::LabeledFrame half = bench::half_size(f);
    for (const bench::LabeledFrame* g : {&half, &f}) {
      if (g == &f && f.index % 2 == 1) continue;
      corpus.rendered.push_back(int(corpus.examples.size()));
      corpus.examples.push_back(
          make_example(g->input, g->reflectance, g->shading,
                       bench::Image(g->input.width, g->input.height, 1, 1.0F)));
    }
  }
  return corpus;
}

void fit(const Options& options) {
  const Weights from =
      options.from.empty() ? Weights{options.hidden, kCellHidden, {}} : load_weights(options.from);
  const Model model(from.edge_hidden, from.cell_hidden);
  const std::size_t n = std::size_t(model.count());
  std::vector<float> p = options.from.empty() ? initial(model) : from.values;
  if (p.size() != n) throw std::runtime_error(options.from + " holds no weights of this model");
  const auto save = [&](const std::vector<float>& values) {
    save_weights({from.edge_hidden, from.cell_hidden, values}, options.out);
  };
  const Corpus corpus = make_corpus(options);
  std::vector<Solution> solutions(corpus.examples.size());
  std::vector<float> average = p;
  std::vector<double> first(n, 0), second(n, 0);
  std::mt19937 engine(1);
  const auto start = std::chrono::steady_clock::now();
  double sum = 0, reported = 0;
  for (int step = 1, count = 0;; ++step) {
    const double elapsed =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (elapsed > options.seconds) break;
    std::array<int, kBatch> batch{};
    for (int& b : batch) b = corpus.draw(engine, options.rendered);
    std::array<std::vector<double>, kBatch> gradients;
    std::array<double, kBatch> losses{};
    std::array<Solution, kBatch> work;
    for (int k = 0; k < kBatch; ++k)
      work[std::size_t(k)] = solutions[std::size_t(batch[std::size_t(k)])];
    parallel(kBatch, [&](int k, int) {
      const std::size_t j = std::size_t(k);
      gradients[j].assign(n, 0);
      losses[j] =
          evaluate(model, p, corpus.examples[std::size_t(batch[j])], work[j], &gradients[j]);
    });
    std::vector<double> g(n, 0);
    for (std::size_t j = 0; j < kBatch; ++j) {  // one example may not dominate a step
      double norm = 1e-12;
      for (double v : gradients[j]) norm += v * v;
      const double scale = std::min(1.0, 2 / std::sqrt(norm)) / kBatch;
      for (std::size_t i = 0; i < n; ++i) g[i] += scale * gradients[j][i];
      sum += losses[j] / kBatch;
      solutions[std::size_t(batch[j])] = std::move(work[j]);
    }
    const double rate =
        options.rate * 0.5 * (1 + std::cos(3.14159 * elapsed / options.seconds)) + 1e-5;
    for (std::size_t i = 0; i < n; ++i) {  // Adam, and a running mean of the weights
      g[i] += kDecay * p[i];
      first[i] = 0.9 * first[i] + 0.1 * g[i];
      second[i] = 0.98 * second[i] + 0.02 * g[i] * g[i];
      const double mean = first[i] / (1 - std::pow(0.9, step)),
                   spread = second[i] / (1 - std::pow(0.98, step));
      p[i] -= float(rate * mean / (std::sqrt(spread) + 1e-8));
      average[i] += 0.02F * (p[i] - average[i]);
    }
    if (++count; elapsed > reported + 30) {
      std::printf("%5.0f s  step %d  loss %.4f\n", elapsed, step, sum / count);
      std::fflush(stdout);
      reported = elapsed, sum = 0, count = 0;
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
                             {"--data", bench::text(o.data)},
                             {"--leave", bench::text(o.leave)},
                             {"--scenes", bench::integer(o.scenes)},
                             {"--hidden", bench::integer(o.hidden)},
                             {"--seconds", bench::number(o.seconds)},
                             {"--rate", bench::number(o.rate)},
                             {"--rendered", bench::number(o.rendered)}};
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
