// Convergence of the thesis' solvers, like its figure 3.12: energy a pixel after every IRLS step on
// every pyramid level, for pcg and schwarz, beside the double-precision reference at the same
// iterations and the converged energy.
//
//   thesis-convergence [--dump FILE] [--size WxH] [--irls N] [--pcg N] [--levels N]
//   [--no-converged]
//
// Prints one line a step, separated by commas. The converged solve is the reference's, on the
// processor: seconds at 160×120, minutes from 640×480 on.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

#include "../reference/intrinsic_thesis.hpp"
#include "frames.hpp"
#include "intrinsic_thesis/thesis_decomposition.hpp"

namespace {

using namespace inverse;

/// The finest level's energy by solver, and the last value on every level: (level, step) → energy.
using Curve = std::map<std::pair<int, int>, double>;

struct Options {
  ThesisParams params;
  bool converged = true;
};

std::vector<float> download(gpu::Commands& commands, const gpu::BufferPtr& buffer) {
  const auto host = gpu::Buffer::create(commands.device(), buffer->element(), buffer->count(),
                                        gpu::Memory::readback);
  commands.begin();
  commands.copy(buffer, host, buffer->bytes());
  commands.submit();
  commands.wait();
  const auto* values = host->map_as<float>();
  return {values, values + buffer->bytes() / sizeof(float)};
}

reference::Plane to_reference(Extent extent, const std::vector<float>& pixels) {
  reference::Plane plane(static_cast<int>(extent.width), static_cast<int>(extent.height));
  for (size_t n = 0; n < plane.size(); ++n) {
    for (size_t c = 0; c < 4; ++c) plane.data[n][c] = static_cast<double>(pixels[4 * n + c]);
  }
  return plane;
}

reference::ThesisParams to_reference(const ThesisParams& params) {
  reference::ThesisParams result;  // every weight has the same default
  result.schwarz = params.solver == ThesisParams::Solver::schwarz;
  result.levels = params.levels;
  result.irls_iterations = params.irls_iterations;
  result.pcg_iterations = params.pcg_iterations;
  return result;
}

Curve reference_curve(const bench::Frame& frame, const ThesisParams& params,
                      const reference::Plane& clusters, bool converged) {
  reference::IntrinsicThesis method(to_reference(params));
  method.set_clusters(clusters);
  method.set_converged(converged);
  Curve curve;
  method.set_trace([&](int level, int step, const reference::ThesisEnergy& energy) {
    curve[{level, converged ? 0 : step}] = energy.total();
  });
  method.decompose(to_reference(frame.extent, frame.pixels));
  return curve;
}

void run(const std::shared_ptr<gpu::Device>& device, const bench::Frame& frame,
         const Options& options) {
  printf(
      "solver,iteration,level,width,height,irls step,energy/pixel,reference,converged,"
      "data+chromaticity,sparsity,smoothness,samples+clusters\n");
  for (const auto solver : {ThesisParams::Solver::pcg, ThesisParams::Solver::schwarz}) {
    ThesisParams params = options.params;
    params.solver = solver;
    params.trace = true;
    ThesisDecomposition method(device, frame.extent);
    method.set_params(params);
    const auto input =
        gpu::Buffer::create(device, gpu::Element::vec4, frame.extent.pixels(), gpu::Memory::upload);
    std::memcpy(input->map(), frame.pixels.data(), input->bytes());
    gpu::Commands commands(device);
    commands.begin();
    Layers layers;
    const uint64_t number = method.record(commands, {frame.extent, input}, layers);
    commands.submit();
    commands.wait();
    const auto stats = method.stats(number);

    reference::Plane clusters;
    if (stats.clustered) {
      clusters = to_reference(frame.extent, download(commands, method.clusters().buffer));
    }
    const Curve expected = reference_curve(frame, params, clusters, false);
    Curve best;
    if (options.converged) best = reference_curve(frame, params, clusters, true);
    int iteration = 0;
    for (const auto& energy : stats.energy) {
      const Plane level = method.sample_frame(energy.level);
      const auto pixels = static_cast<double>(level.extent.pixels());
      if (energy.step >= 0) iteration += params.pcg_iterations;
      printf("%s,%d,%d,%u,%u,%d,%.6f,%.6f,",
             solver == ThesisParams::Solver::pcg ? "pcg" : "schwarz", iteration, energy.level,
             level.extent.width, level.extent.height, energy.step + 1, energy.total() / pixels,
             expected.at({energy.level, energy.step}) / pixels);
      if (options.converged) printf("%.6f", best.at({energy.level, 0}) / pixels);
      printf(",%.6f,%.6f,%.6f,%.6f\n", energy.data_and_chromaticity / pixels,
             energy.sparsity / pixels, energy.smoothness / pixels,
             energy.samples_and_clusters / pixels);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.params.irls_iterations = 7;  // the figure's
  options.params.levels = 5;
  Extent extent{160, 120};
  std::string dump;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (name == "--no-converged") {
      options.converged = false;
      continue;
    }
    ++i;
    if (name == "--dump") {
      dump = value;
    } else if (name == "--irls") {
      options.params.irls_iterations = std::atoi(value);
    } else if (name == "--pcg") {
      options.params.pcg_iterations = std::atoi(value);
    } else if (name == "--levels") {
      options.params.levels = std::atoi(value);
    } else if (name != "--size" || sscanf(value, "%ux%u", &extent.width, &extent.height) != 2) {
      fprintf(stderr, "unknown option %s; the head of thesis_convergence.cpp lists them\n",
              argv[i - 1]);
      return 2;
    }
  }
  try {
    const bench::Frame frame =
        dump.empty() ? bench::synthetic_frame(extent, 0) : bench::read_frames(dump).front();
    run(gpu::Device::open(), frame, options);
  } catch (const std::exception& error) {
    fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
