// SPDX-License-Identifier: LGPL-2.1-or-later
// What the figures of the thesis' chapter 3 depend on, for the accuracy page. First frames of
// scenes of ./dev bench, without history.
//
//   thesis-bench sizes [--times N] [--halve] FILE…     LMSE by variant of the method, in windows of
//       20 pixels and of 20 × width / 320 (at least 20); --times: frame and truth are enlarged
//       bilinearly, and so are the windows; --halve: they are halved before
//   thesis-bench background FILE…            LMSE with samples, without, and with those inside of
//   the
//       object; also with black outside of it; of scenes without a mask the object is a disc
//   thesis-bench convergence FILE…           Fig. 3.12: energy by reweighting and level
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/thesis/reference/thesis_params.hpp"

namespace inverse::bench {
namespace {

using Params = ThesisParams;

/// A frame by the thesis' method, and its statistics.
struct Result {
  Decomposition layers;
  ThesisDecomposition::Stats stats;
};

Result solve(DeviceSession& session, const Image& frame, const Params& params) {
  ThesisDecomposition method(session.device(), {uint32_t(frame.width), uint32_t(frame.height)});
  method.set_params(params);
  Cost cost;
  std::uint64_t number = 0;
  Result result;
  result.layers = session.run(
      frame,
      [&](gpu::Commands& commands, const PlanePtr& input) {
        Layers layers;
        number = method.record(commands, *input, layers);
        return layers;
      },
      cost);
  result.stats = method.stats(number);
  return result;
}

/// Mean LMSE of reflectance and shading.
double error(const Decomposition& d, const TruthFrame& truth, int window) {
  return (lmse(d.reflectance, truth.reflectance, truth.mask, window) +
          lmse(d.shading, truth.shading, truth.mask, window)) /
         2;
}

Image enlarged(const Image& in, int times) {
  if (in.empty()) return in;
  Image out(in.width * times, in.height * times, in.channels);
  const auto place = [times](int at, int size) {
    const float x = std::clamp((float(at) + .5F) / float(times) - .5F, 0.0F, float(size - 1));
    const int low = std::min(int(x), std::max(size - 2, 0));
    return std::pair{low, x - float(low)};
  };
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < in.channels; ++c) {
        const auto [x0, u] = place(x, in.width);
        const auto [y0, v] = place(y, in.height);
        const int x1 = std::min(x0 + 1, in.width - 1), y1 = std::min(y0 + 1, in.height - 1);
        out.at(x, y, c) = (1 - v) * ((1 - u) * in.at(x0, y0, c) + u * in.at(x1, y0, c)) +
                          v * ((1 - u) * in.at(x0, y1, c) + u * in.at(x1, y1, c));
      }
  return out;
}

/// Columns of numbers, printed as rows of a table with their means below.
class Columns {
 public:
  explicit Columns(const std::vector<std::string>& heads) {
    std::printf("| |");
    for (const std::string& head : heads) std::printf(" %s |", head.c_str());
    std::printf("\n|---|%s\n",
                [&] {
                  std::string rule;
                  for (std::size_t k = 0; k < heads.size(); ++k) rule += "---|";
                  return rule;
                }()
                    .c_str());
  }
  void add(const std::string& name, const std::vector<double>& row) {
    rows_.push_back(row);
    print(name, row);
  }
  void mean() const {
    std::vector<double> sums(rows_.front().size());
    for (const auto& row : rows_)
      for (std::size_t k = 0; k < row.size(); ++k) sums[k] += row[k] / double(rows_.size());
    print("mean of " + std::to_string(rows_.size()), sums);
  }

 private:
  static void print(const std::string& name, const std::vector<double>& row) {
    std::printf("| %s |", name.c_str());
    for (const double value : row) std::printf(" %.4f |", value);
    std::printf("\n");
    std::fflush(stdout);
  }
  std::vector<std::vector<double>> rows_;
};

struct Named {
  std::string name;
  TruthFrame frame;
};

Named first_frame(const std::string& path) {
  Scene scene = read_scene(path);
  TruthFrame frame = std::move(scene.frames.front());
  frame.input = through_8_bits(frame.input);
  return {scene.set + " " + scene.name, std::move(frame)};
}

void sizes(DeviceSession& session, const std::vector<std::string>& files, int times, bool halved) {
  const std::vector<std::pair<const char*, std::function<void(Params&)>>> variants{
      {"thesis", [](Params&) {}},
      {"printed", [](Params& p) { p.irls = Params::Irls::printed; }},
      {"without samples", [](Params& p) { p.w_non_local = 0; }},
      {"16x16", [](Params& p) { p.irls_iterations = p.pcg_iterations = 16; }}};
  std::vector<std::string> heads{"width", "height", "levels", "window"};
  for (const auto& [name, change] : variants)
    heads.insert(heads.end(), {std::string(name) + ", 20", std::string(name) + ", window"});
  Columns columns(heads);
  for (const std::string& file : files) {
    auto [name, frame] = first_frame(file);
    if (halved) {
      for (Image* image : {&frame.input, &frame.reflectance, &frame.shading})
        *image = halve(*image);
      if (!frame.mask.empty()) frame.mask = halve(frame.mask, true);
      frame.input = through_8_bits(frame.input);
    }
    const int window = std::max(20, 20 * frame.input.width / 320) * times;
    for (Image* image : {&frame.input, &frame.reflectance, &frame.shading, &frame.mask})
      *image = enlarged(*image, times);
    std::vector<double> row;
    for (const auto& [title, change] : variants) {
      Params params;
      change(params);
      const Result found = solve(session, frame.input, params);
      if (row.empty())
        row = {double(frame.input.width), double(frame.input.height), double(found.stats.levels),
               double(window)};
      row.push_back(error(found.layers, frame, 20));
      row.push_back(error(found.layers, frame, window));
    }
    columns.add(name, row);
  }
  columns.mean();
}

/// A disc that touches the longer sides, as a mask.
Image disc(int width, int height) {
  Image mask(width, height, 1);
  const float radius = .5F * float(std::min(width, height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      mask.at(x, y) =
          std::hypot(float(x) - .5F * float(width), float(y) - .5F * float(height)) < radius ? 1.0F
                                                                                             : 0.0F;
  return mask;
}

std::array<float, 3> chromaticity(const Image& image, std::size_t pixel) {
  const float floor = Params{}.chroma_floor;
  std::array<float, 3> c{};
  for (std::size_t k = 0; k < 3; ++k) c[k] = image.data[3 * pixel + k] + floor;
  const float mean = (c[0] + c[1] + c[2]) / 3;
  for (float& v : c) v /= mean;
  return c;
}

/// The share of the samples that bind the object's pixels (3.13) which lie outside of it.
double bound_outside(const Image& image, const Image& mask) {
  const float tau = Params{}.tau_cc;
  const std::size_t count = mask.data.size();
  std::vector<std::array<float, 3>> colors(count);
  for (std::size_t n = 0; n < count; ++n) colors[n] = chromaticity(image, n);
  double inside = 0, outside = 0;
  for (std::size_t x = 0; x < count; x += 17) {
    if (mask.data[x] < .5F) continue;
    for (std::size_t y = 0; y < count; y += 5) {
      float square = 0;
      for (std::size_t k = 0; k < 3; ++k) square += std::pow(colors[x][k] - colors[y][k], 2.0F);
      if (square < tau * tau) (mask.data[y] < .5F ? outside : inside) += 1;
    }
  }
  return outside / std::max(inside + outside, 1.0);
}

Image black_outside(const Image& image, const Image& mask) {
  Image out = image;
  for (std::size_t n = 0; n < out.data.size(); ++n)
    if (mask.data[n / 3] < .5F) out.data[n] = 0;
  return out;
}

/// Error with samples that are drawn inside of the mask alone: by the reference, where the
/// chromaticity by which they agree can be set.
double with_samples_inside(const Image& image, const TruthFrame& truth) {
  Params params;
  reference::Plane linear(image.width, image.height);
  for (std::size_t n = 0; n < linear.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c) linear.data[n][c] = double(image.data[3 * n + c]);
  params.irls_iterations = params.pcg_iterations = 1;  // for its levels alone
  reference::IntrinsicThesis levels(testing::to_reference(params));
  levels.decompose(linear);
  std::vector<reference::Plane> chromaticities;
  for (const reference::ThesisLevel& level : levels.levels()) {
    const int times = 1 << chromaticities.size();
    reference::Plane plane(level.image.width, level.image.height);
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) {
        const std::size_t n = plane.index(x, y);
        const bool inside = truth.mask.at(std::min(times * x, image.width - 1),
                                          std::min(times * y, image.height - 1)) > .5F;
        constexpr double kFar = 4095.0 * 4096 + 4095;  // no light has three times its mean twice
        plane.data[n][3] = inside ? level.packed[n] : kFar;
      }
    chromaticities.push_back(std::move(plane));
  }
  reference::IntrinsicThesis method(testing::to_reference(Params{}));
  method.set_chromaticities(std::move(chromaticities));
  const reference::Plane solution = method.decompose(linear);
  Decomposition d{
      Image(image.width, image.height, 3), Image(image.width, image.height, 1), {}, {}, {}};
  for (std::size_t n = 0; n < solution.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c)
      d.reflectance.data[3 * n + c] = float(std::exp(solution.data[n][c]));
    d.shading.data[n] = float(std::exp(solution.data[n][3]));
  }
  return error(d, truth, 20);
}

void background(DeviceSession& session, const std::vector<std::string>& files) {
  Columns columns({"outside, share", "samples that bind the object and lie outside, share",
                   "as it is", "no samples", "black outside", "black, no samples",
                   "black, samples inside"});
  for (const std::string& file : files) {
    auto [name, frame] = first_frame(file);
    if (frame.mask.empty()) frame.mask = disc(frame.input.width, frame.input.height);
    const Image black = black_outside(frame.input, frame.mask);
    const double outside = double(std::count_if(frame.mask.data.begin(), frame.mask.data.end(),
                                                [](float v) { return v < .5F; }));
    std::vector<double> row{outside / double(frame.mask.data.size()),
                            bound_outside(black, frame.mask)};
    for (const Image* input : {&std::as_const(frame.input), &black})
      for (const float weight : {Params{}.w_non_local, 0.0F}) {
        Params params;
        params.w_non_local = weight;
        row.push_back(error(solve(session, *input, params).layers, frame, 20));
      }
    row.push_back(with_samples_inside(black, frame));
    columns.add(name, row);
  }
  columns.mean();
}

/// Energies of a level, start first, over that of the start.
void convergence(DeviceSession& session, const std::vector<std::string>& files) {
  constexpr int kSteps = 7, kLevels = 5;
  for (const auto irls : {Params::Irls::consistent, Params::Irls::printed})
    for (const float samples : {Params{}.w_non_local, 0.0F}) {
      std::printf("\n%s, %s samples: energy a pixel\n\n",
                  irls == Params::Irls::printed ? "printed" : "consistent",
                  samples > 0 ? "with" : "without");
      std::vector<std::string> heads{"start"};
      for (int k = 1; k <= kSteps; ++k) heads.push_back(std::to_string(k));
      Columns columns(heads);
      std::map<int, std::vector<double>> sums;  // by level
      for (const std::string& file : files) {
        const auto [name, frame] = first_frame(file);
        Params params;
        params.irls = irls;
        params.w_non_local = samples;
        params.irls_iterations = kSteps;
        params.levels = kLevels;
        params.trace = true;
        const auto trace = solve(session, frame.input, params).stats.energy;
        for (const auto& at : trace) {
          auto& sum = sums[at.level];
          sum.resize(kSteps + 1);
          const double shrink = std::pow(4.0, at.level);
          const std::size_t place = at.step < 0 ? 0 : std::size_t(at.step) + 1;
          sum[place] +=
              at.total() * shrink / double(files.size()) / double(frame.shading.data.size());
        }
      }
      for (auto level = sums.rbegin(); level != sums.rend(); ++level)
        columns.add("level " + std::to_string(level->first), level->second);
    }
}

int run(int argc, char** argv) {
  int times = 1;
  bool halved = false;
  std::vector<std::string> words;
  const Options options{{"--times", integer(times)}, {"--halve", flag([&] { halved = true; })}};
  if (!read(options, argc, argv, "thesis_bench.cpp", &words)) return 2;
  if (words.size() < 2 || times < 1) {
    std::fprintf(stderr, "thesis-bench sizes|background|convergence [--times N] [--halve] FILE…\n");
    return 2;
  }
  const std::string mode = words.front();
  words.erase(words.begin());
  DeviceSession session("");
  if (mode == "sizes")
    sizes(session, words, times, halved);
  else if (mode == "background")
    background(session, words);
  else if (mode == "convergence")
    convergence(session, words);
  else
    throw std::runtime_error(mode + "?");
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("thesis-bench", inverse::bench::run, argc, argv);
}
