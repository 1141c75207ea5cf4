// SPDX-License-Identifier: LGPL-2.1-or-later
// relight-bench [options] SET.f32 …: errors of olatrelight's methods.
// Sets come from import-olat.
//
//   --environment FILE.hdr   a light to relight with; may come again (the studio where there is
//   none)
//   --models FOLDER          a folder with features.net and light.net: the network, too
//   --pictures FOLDER        writes truth and predictions side by side
//
// Prints a table of the errors of single lights and of relit pictures.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "olat_set.hpp"
#include "relight_subject.hpp"
#include "tests/bench/metrics/png_file.hpp"
#include "tests/bench/support/command_line.hpp"

namespace inverse::bench {
namespace {

/// The gain for which the median over the subject of its brightest light is 0.7.
double display_gain(const OlatSet& set) {
  std::vector<double> brightest;
  for (size_t i = 0; i < set.mask.data.size(); ++i) {
    if (set.mask.data[i] < .5F) continue;
    float max = 0;
    for (const Image& light : set.lights)
      max = std::max(max,
                     std::max({light.data[3 * i], light.data[3 * i + 1], light.data[3 * i + 2]}));
    brightest.push_back(max);
  }
  return .7 / std::max(median(brightest), 1e-9);
}

/// Mean absolute difference over the subject of display codes, of 255.
double shown_difference(const Image& got, const Image& truth, const Image& mask, double gain) {
  double off = 0, count = 0;
  for (size_t n = 0; n < truth.data.size(); ++n) {
    if (mask.data[n / 3] < .5F) continue;
    off += std::fabs(std::min(1.0, gain * got.data[n]) - std::min(1.0, gain * truth.data[n]));
    ++count;
  }
  return 255 * off / count;
}

Image beside(const std::vector<Image>& images, double gain) {
  Image all(0, images[0].height, 3);
  for (const Image& image : images) all.width += image.width;
  all.data.resize(size_t(all.width) * all.height * 3);
  int left = 0;
  for (const Image& image : images) {
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c)
          all.at(left + x, y, c) = static_cast<float>(gain) * image.at(x, y, c);
    left += image.width;
  }
  return all;
}

struct Arguments {
  std::vector<std::string> environments, sets;
  std::string models, pictures;
};

struct Method {
  const char* name;
  const RelightModels* models;
  bool measured = false;  // including the measured part of the light

  SplitLight split(std::span<const Direction> lights, std::span<const Rgb> weights) const {
    return measured ? SplitLight::of(lights, weights)
                    : SplitLight{{}, {weights.begin(), weights.end()}};
  }
};

void errors(const std::shared_ptr<gpu::Device>& device, const std::vector<OlatSet>& sets,
            const std::vector<NamedEnvironment>& environments, const std::vector<Method>& methods,
            const std::string& pictures) {
  std::printf("\n| subject | method | one light, l1 of 255 |");
  for (const NamedEnvironment& e : environments) std::printf(" %s |", e.name.c_str());
  std::printf(" mean |\n|---|---|---|---|");
  for (size_t i = 0; i < environments.size(); ++i) std::printf("---|");
  std::printf("\n");
  for (const OlatSet& set : sets) {
    const Extent extent{static_cast<uint32_t>(set.a.width), static_cast<uint32_t>(set.a.height)};
    const double gain = display_gain(set);
    std::vector<std::vector<Image>> lit(5), relit(environments.size());
    for (size_t k = 0; k < lit.size(); ++k)
      lit[k].push_back(set.lights[(2 * k + 1) * set.lights.size() / (2 * lit.size())]);
    for (const Method& method : methods) {
      Subject subject(device, set, extent, method.models);
      double off = 0;
      for (size_t i = 0; i < set.lights.size(); ++i) {
        const WeightedLight light{set.directions[i], {1, 1, 1}};
        const Image got = subject.sum(std::span(&light, 1));
        off += shown_difference(got, set.lights[i], set.mask, gain) /
               static_cast<double>(set.lights.size());
        for (size_t k = 0; k < lit.size(); ++k)
          if (i == (2 * k + 1) * set.lights.size() / (2 * lit.size())) lit[k].push_back(got);
      }
      std::printf("| %s | %s | %.2f |", set.name.c_str(), method.name, off);
      double sum = 0;
      for (size_t e = 0; e < environments.size(); ++e) {
        const auto weights = subject.stage().cells.weights(environments[e].map);
        const Image truth = true_sum(set, weights);
        const SplitLight split = method.split(set.directions, weights);
        const Image got = subject.sum(weighted(subject.stage(), split.rest), split.measured);
        if (relit[e].empty()) relit[e].push_back(truth);
        relit[e].push_back(got);
        const double error = 100 * relative(got, truth, set.mask);
        sum += error;
        std::printf(" %.1f %% |", error);
      }
      std::printf(" %.2f %% |\n", sum / static_cast<double>(environments.size()));
      std::fflush(stdout);
    }
    if (pictures.empty()) continue;
    for (size_t k = 0; k < lit.size(); ++k)
      write_png(pictures + "/" + set.name + "-light-" + std::to_string(k) + ".png",
                beside(lit[k], gain));
    for (size_t e = 0; e < relit.size(); ++e)
      write_png(pictures + "/" + set.name + "-" + environments[e].name + ".png",
                beside(relit[e], 1));
  }
}

void run(const Arguments& arguments) {
  const auto sets = read_sets(arguments.sets);
  if (sets.empty()) return;
  const auto environments = read_environments(arguments.environments);
  std::optional<RelightModels> models;
  if (!arguments.models.empty()) models = RelightModels::load(arguments.models);
  std::vector<Method> methods{{"cosine-lobe", nullptr}};
  if (models) {
    methods.push_back({"network alone", &*models});
    methods.push_back({"network", &*models, true});
  }
  const auto device = gpu::Device::open();
  std::printf("%s\n", device->name().c_str());
  if (!arguments.pictures.empty()) std::filesystem::create_directories(arguments.pictures);
  errors(device, sets, environments, methods, arguments.pictures);
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  using namespace inverse::bench;
  Arguments arguments;
  const Options options{
      {"--environment",
       {true, [&](const char* v) { return arguments.environments.emplace_back(v), true; }}},
      {"--models", text(arguments.models)},
      {"--pictures", text(arguments.pictures)}};
  if (!read(options, argc, argv, "relight_bench.cpp", &arguments.sets)) return 2;
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "relight-bench: %s\n", error.what());
    return 1;
  }
}
