// SPDX-License-Identifier: LGPL-2.1-or-later
// relight-curves [options] SET.f32 …: error of relit pictures against run time, over the number of
// lights, the width of the network and the size of the frame. Sets come from import-olat.
//
//   --network NAME=FOLDER    features.net and light.net of a network; may come again
//   --environment FILE.hdr   a light to relight with; may come again (the studio where there is
//   none)
//   --runs N                 of each time (default 5)
//
// Frames are scaled, relit and scaled back; errors are against the sum of true pictures at the
// set's own size, over the subject, in per cent of its mean.
#include <cstdio>

#include "relight_subject.hpp"
#include "tests/bench/support/command_line.hpp"

namespace inverse::bench {
namespace {

struct Arguments {
  std::vector<std::string> environments, networks, sets;
  int runs = 5;
};

struct Network {
  std::string name;
  RelightModels models;
};

struct Mean {
  double sum = 0;
  int count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return sum / count; }
};

OlatSet scaled(const OlatSet& set, double by) {
  OlatSet result{set.name, set.directions, {}, {}, {}, {}};
  const int width = static_cast<int>(std::lround(set.a.width * by)),
            height = static_cast<int>(std::lround(set.a.height * by));
  result.a = resized(set.a, width, height);
  result.b = resized(set.b, width, height);
  result.mask = resized(set.mask, width, height);
  return result;
}

void print(const std::string& method, Extent extent, const std::string& limit, const Mean& lights,
           double frame_ms, double light_ms, const Mean& error) {
  std::printf("| %s | %u x %u | %s | %.0f | %.1f | %.1f | %.2f %% |\n", method.c_str(),
              extent.width, extent.height, limit.c_str(), lights.value(), frame_ms, light_ms,
              100 * error.value());
  std::fflush(stdout);
}

/// The error of a picture of another size.
double error_of(const Image& got, const Image& truth, const OlatSet& set) {
  return relative(resized(got, truth.width, truth.height), truth, set.mask);
}

void lobes(const std::shared_ptr<gpu::Device>& device, const std::vector<OlatSet>& sets,
           const std::vector<NamedEnvironment>& environments, double scale, int runs) {
  Mean lights, error;
  double frame_ms = 0, light_ms = 0;
  Extent extent;
  for (const OlatSet& set : sets) {
    const OlatSet small = scaled(set, scale);
    extent = {static_cast<uint32_t>(small.a.width), static_cast<uint32_t>(small.a.height)};
    Subject subject(device, small, extent, nullptr);
    for (const NamedEnvironment& e : environments) {
      const auto weights = subject.stage().cells.weights(e.map);
      const auto all = weighted(subject.stage(), weights);
      lights.add(static_cast<double>(all.size()));
      error.add(error_of(subject.relit_by_table(all), true_sum(set, weights), set));
      if (frame_ms > 0) continue;
      light_ms = subject.time(runs, [&] {
        subject.make_table(all);
        subject.look_up();
      });
      frame_ms = subject.time(runs, [&] {
        subject.find_lobes();
        subject.look_up();
      });
    }
  }
  print("cosine-lobe", extent, "–", lights, frame_ms, light_ms, error);
}

void network(const std::shared_ptr<gpu::Device>& device, const std::vector<OlatSet>& sets,
             const std::vector<NamedEnvironment>& environments, double scale,
             const Network& network, int runs) {
  for (const double max_error : {.2, .05, .02, 0.0}) {
    Mean lights, error, light_ms;
    double features_ms = 0;
    Extent extent;
    for (const OlatSet& set : sets) {
      const OlatSet small = scaled(set, scale);
      extent = {static_cast<uint32_t>(small.a.width), static_cast<uint32_t>(small.a.height)};
      Subject subject(device, small, extent, &network.models);
      std::vector<uint32_t> samples;
      for (uint32_t i = 0; i < extent.pixels(); i += std::max<uint32_t>(1, extent.pixels() / 1600))
        samples.push_back(i);
      LightReduction reduction(set.directions);
      reduction.set_responses(subject.responses(samples));
      if (features_ms == 0) features_ms = subject.time(runs, [&] { subject.find_features(); });
      for (const NamedEnvironment& e : environments) {
        const auto weights = subject.stage().cells.weights(e.map);
        const SplitLight split = SplitLight::of(set.directions, weights);
        const auto choice = reduction.choose(split.rest, weights, max_error);
        lights.add(static_cast<double>(choice.lights.size()));
        error.add(
            error_of(subject.sum(choice.lights, split.measured), true_sum(set, weights), set));
        if (&set == &sets[0])
          light_ms.add(
              subject.time(runs, [&] { subject.record_sum(choice.lights, split.measured); }));
      }
    }
    char limit[16];
    std::snprintf(limit, sizeof limit, "%.0f %%", 100 * max_error);
    print(network.name, extent, limit, lights, features_ms + light_ms.value(), light_ms.value(),
          error);
  }
}

void run(const Arguments& arguments) {
  const auto sets = read_sets(arguments.sets);
  if (sets.empty()) return;
  const auto environments = read_environments(arguments.environments);
  std::vector<Network> networks;
  for (const std::string& one : arguments.networks) {
    const size_t at = one.find('=');
    if (at == std::string::npos) throw std::runtime_error("--network is NAME=FOLDER, not " + one);
    networks.push_back({one.substr(0, at), RelightModels::load(one.substr(at + 1))});
  }
  const auto device = gpu::Device::open();
  std::printf("%s; %zu subjects, %zu environments\n\n", device->name().c_str(), sets.size(),
              environments.size());
  std::printf(
      "| method | size | max-error | lights | ms a frame | ms of its light | error |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const double scale : {.5, 1.0, 2.0}) {
    lobes(device, sets, environments, scale, arguments.runs);
    for (const Network& one : networks)
      network(device, sets, environments, scale, one, arguments.runs);
  }
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  using namespace inverse::bench;
  Arguments arguments;
  const Options options{
      {"--environment",
       {true, [&](const char* v) { return arguments.environments.emplace_back(v), true; }}},
      {"--network",
       {true, [&](const char* v) { return arguments.networks.emplace_back(v), true; }}},
      {"--runs", integer(arguments.runs)}};
  if (!read(options, argc, argv, "relight_curves.cpp", &arguments.sets)) return 2;
  try {
    run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "relight-curves: %s\n", error.what());
    return 1;
  }
}
