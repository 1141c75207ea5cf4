// SPDX-License-Identifier: LGPL-2.1-or-later
// Fits an edge prior of fewer hidden values to one that was fitted through the solve: regression of
// its ln a and ln b on cues alone, which needs no truth and takes a minute.
//
//   shrink_edge_prior --from weights-12.txt --out weights.txt [--hidden 4] [--steps 40000]
//                     [--scenes 400 --data DIR]
//
// Edges are drawn from procedural scenes (scenes.hpp) other than those of fit_edge_prior and, a
// quarter of each batch, from the rendered sequences that it saw too. MIT objects and the
// diverse-value sequences are not looked at. Only the net of edges shrinks; that of cells is
// copied.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "net.hpp"
#include "scenes.hpp"
#include "tests/bench/scenes/datasets.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"
#include "tests/reference/intrinsic/intrinsic_features.hpp"
#include "weights.hpp"

namespace inverse::training {
namespace {

constexpr int kCues = reference::kEdgeFeatures, kOutputs = 2, kBatch = 2048;
constexpr int kEdgesPerScene = 2500, kFirstSeed = 500000;
constexpr double kRenderedShare = 0.25, kRate = 1e-2;
constexpr float kLow = float(reference::kLogLow), kHigh = float(reference::kLogHigh);

struct Options {
  std::string from, out, data = "../shared/data";
  int hidden = 4, steps = 40000, scenes = 400;
};

/// Cues of many edges, one plane a cue, and what the large net says of them.
struct Edges {
  std::vector<Plane> cues{std::size_t(kCues)};
  std::vector<Plane> wanted;

  std::size_t count() const { return cues[0].size(); }
  void draw(const bench::Image& input, int edges, std::mt19937& engine) {
    const std::vector<double> rgb(input.data.begin(), input.data.end());
    const reference::Guide guide = reference::make_guide(rgb.data(), input.width, input.height);
    std::array<double, kCues> f{};
    for (int k = 0; k < edges; ++k) {
      const bool down = engine() & 1;
      const int x = int(engine() % unsigned(input.width - (down ? 0 : 1)));
      const int y = int(engine() % unsigned(input.height - (down ? 1 : 0)));
      reference::edge_features(guide, x, y, down, f.data());
      for (std::size_t i = 0; i < f.size(); ++i) cues[i].push_back(float(f[i]));
    }
  }
  void ask(const Net& net, const std::vector<float>& p) {
    std::vector<Plane> hidden;
    net.forward(p, cues, hidden, wanted);
    for (Plane& out : wanted)
      for (float& v : out) v = std::clamp(v, kLow, kHigh);
  }
};

std::vector<float> start(const Net& net, const Edges& edges) {
  std::vector<float> p(std::size_t(net.count()), 0.0F);
  std::mt19937 engine(1);
  std::normal_distribution<float> normal;
  for (int h = 0; h < net.hidden; ++h) {
    for (int i = 0; i < net.inputs; ++i)
      p[std::size_t(net.inner(h, i))] = 0.5F * normal(engine) / std::sqrt(float(net.inputs));
    for (int o = 0; o < net.outputs; ++o) p[std::size_t(net.outer(o, h))] = 0.3F * normal(engine);
  }
  for (int o = 0; o < net.outputs; ++o) {
    double sum = 0;
    for (float v : edges.wanted[std::size_t(o)]) sum += v;
    p[std::size_t(net.bias2(o))] = float(sum / double(edges.count()));
  }
  return p;
}

/// Error of one output; what is wanted at a limit is met beyond it, too.
float miss(float found, float wanted) {
  return std::clamp(found, kLow, kHigh) == wanted ? 0.0F : found - wanted;
}

std::array<double, kOutputs> rms(const Net& net, const std::vector<float>& p, const Edges& edges) {
  std::vector<Plane> hidden, out;
  net.forward(p, edges.cues, hidden, out);
  std::array<double, kOutputs> sum{};
  for (std::size_t o = 0; o < kOutputs; ++o) {
    for (std::size_t i = 0; i < edges.count(); ++i) {
      const double d = std::clamp(out[o][i], kLow, kHigh) - edges.wanted[o][i];
      sum[o] += d * d;
    }
    sum[o] = std::sqrt(sum[o] / double(std::max<std::size_t>(edges.count(), 1)));
  }
  return sum;
}

void shrink(const Options& options) {
  const Weights large = load_weights(options.from);
  Edges procedural, rendered, held_out;
  std::mt19937 engine(1);
  for (int k = 0; k < options.scenes; ++k) {
    const Scene scene = make_scene(std::uint32_t(kFirstSeed + k), 176, 132);
    (k % 10 == 9 ? held_out : procedural).draw(scene.input, kEdgesPerScene, engine);
  }
  for (const bench::LabeledFrame& f : bench::load_all(options.data, 3)) {
    if (f.regime == bench::Regime::kMit || f.regime == bench::Regime::kDiverseValue) continue;
    const bench::LabeledFrame half = bench::half_size(f);
    for (const bench::LabeledFrame* g : {&half, &f})
      rendered.draw(g->input, 4 * kEdgesPerScene, engine);
  }
  const Net teacher{kCues, large.edge_hidden, kOutputs, 0};
  for (Edges* edges : {&procedural, &rendered, &held_out}) edges->ask(teacher, large.values);

  const Net net{kCues, options.hidden, kOutputs, 0};
  std::vector<float> p = start(net, procedural);
  std::vector<double> first(p.size(), 0), second(p.size(), 0);
  std::vector<Plane> batch{std::size_t(kCues), Plane(kBatch)}, hidden, out;
  std::vector<Plane> d_out{std::size_t(kOutputs), Plane(kBatch)};
  for (int step = 1; step <= options.steps; ++step) {
    for (std::size_t k = 0; k < kBatch; ++k) {
      const bool from_rendered = rendered.count() > 0 && k < std::size_t(kRenderedShare * kBatch);
      const Edges& edges = from_rendered ? rendered : procedural;
      const std::size_t i = engine() % edges.count();
      for (std::size_t c = 0; c < batch.size(); ++c) batch[c][k] = edges.cues[c][i];
      for (std::size_t o = 0; o < kOutputs; ++o) d_out[o][k] = edges.wanted[o][i];
    }
    net.forward(p, batch, hidden, out);
    for (std::size_t o = 0; o < kOutputs; ++o)
      for (std::size_t k = 0; k < kBatch; ++k)
        d_out[o][k] = std::clamp(miss(out[o][k], d_out[o][k]), -1.0F, 1.0F) / kBatch;
    std::vector<double> gradient(p.size(), 0);
    net.backward(p, batch, hidden, d_out, gradient);
    const double rate = kRate * 0.5 * (1 + std::cos(3.14159 * step / options.steps)) + 1e-5;
    for (std::size_t i = 0; i < p.size(); ++i) {  // Adam
      first[i] = 0.9 * first[i] + 0.1 * gradient[i];
      second[i] = 0.99 * second[i] + 0.01 * gradient[i] * gradient[i];
      p[i] -= float(rate * first[i] / (1 - std::pow(0.9, step)) /
                    (std::sqrt(second[i] / (1 - std::pow(0.99, step))) + 1e-9));
    }
    if (step % 10000 == 0 || step == options.steps)
      for (const auto& [name, edges] :
           {std::pair{"held out", &held_out}, std::pair{"rendered", &rendered}}) {
        const auto error = rms(net, p, *edges);
        std::printf("step %d, %s: rms of ln a %.4f, ln b %.4f\n", step, name, error[0], error[1]);
        std::fflush(stdout);
      }
  }
  p.insert(p.end(), large.values.begin() + teacher.count(), large.values.end());
  save_weights({options.hidden, large.cell_hidden, p}, options.out);
}

}  // namespace
}  // namespace inverse::training

int main(int argc, char** argv) {
  inverse::training::Options o;
  namespace bench = inverse::bench;
  const bench::Options known{
      {"--from", bench::text(o.from)},      {"--out", bench::text(o.out)},
      {"--data", bench::text(o.data)},      {"--hidden", bench::integer(o.hidden)},
      {"--steps", bench::integer(o.steps)}, {"--scenes", bench::integer(o.scenes)}};
  if (!bench::read(known, argc, argv, "shrink_edge_prior.cpp")) return 2;
  try {
    if (o.from.empty() || o.out.empty() || o.hidden < 1 || o.scenes < 10)
      throw std::runtime_error("--from FILE, --out FILE, a hidden value and ten scenes are needed");
    inverse::training::shrink(o);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "shrink_edge_prior: %s\n", e.what());
    return 1;
  }
  return 0;
}
