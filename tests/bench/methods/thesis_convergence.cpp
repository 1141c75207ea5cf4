// SPDX-License-Identifier: LGPL-2.1-or-later
// Convergence of the thesis' solvers, as in its figure 3.12: energy per pixel after every IRLS step
// on every pyramid level, for pcg and schwarz, with the double-precision reference at the same
// iterations and the converged energy. Ends with the difference from the reference.
//
//   thesis-convergence --dump FILE [--irls N] [--pcg N] [--levels N] [--svg FILE]
//
// FILE is a frame (frames.hpp). Prints one comma-separated line per step; --svg also draws the
// curves. Each solver is compared at its own clusters, also for the converged energy: they differ
// slightly. The reference computes the converged solve on the processor: seconds at 80×60, minutes
// at 160×120.
//
// The last lines give the difference of r from the reference after removing the common scale (99 %
// of pixels, and maximum), and the change of the reference itself in single precision: sparsity
// with p < 1 is not convex, and rounding decides about edges near the threshold.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>

#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/frames.hpp"
#include "tests/lab.hpp"
#include "tests/reference/thesis/thesis_params.hpp"

namespace {

using namespace inverse;

struct Options {
  ThesisParams params;
  std::string svg;
};

/// One IRLS step of one solver; energies per pixel.
struct Point {
  int iteration;
  Extent extent;
  ThesisDecomposition::Energy energy;
  double total, reference, converged;
};

/// |Δr| without the common scale, largest channel: 99 % quantile and maximum over pixels.
struct Difference {
  double most, worst;
};

/// Device and reference results of one solve.
struct Curve {
  const char* name;
  std::vector<Point> points;
  Difference device, single;  ///< from the reference, and the reference's own in single precision
  double energy = 0, reference = 0;
};

/// (level, step) → energy; of a converged solve only step 0, with its last energy.
using Energies = std::map<std::pair<int, int>, double>;

/// The reference at the device's samples and clusters; all default weights are the same.
struct Reference {
  reference::IntrinsicThesis method;
  Energies energies;
  reference::Plane solution;

  Reference(const bench::RgbaFrame& frame, const ThesisParams& params,
            const std::vector<reference::Plane>& samples, const reference::Plane& clusters,
            bool converged, bool single = false)
      : method(testing::to_reference(params)) {
    method.set_chromaticities(samples);
    method.set_clusters(clusters);
    method.set_converged(converged);
    method.set_single_precision(single);
    method.set_trace([&](int level, int step, const reference::ThesisEnergy& energy) {
      energies[{level, converged ? 0 : step}] = energy.total();
    });
    solution = method.decompose(to_reference(frame.extent, frame.pixels));
  }
};

/// The mean difference is a difference of scale.
Difference difference(const reference::Plane& got, const reference::Plane& expected) {
  double scale = 0;
  for (size_t n = 0; n < expected.size(); ++n) {
    for (size_t c = 0; c < 3; ++c) scale += got.data[n][c] - expected.data[n][c];
  }
  scale /= 3.0 * static_cast<double>(expected.size());
  std::vector<double> differences(expected.size());
  for (size_t n = 0; n < expected.size(); ++n) {
    for (size_t c = 0; c < 3; ++c) {
      differences[n] =
          std::max(differences[n], std::abs(got.data[n][c] - expected.data[n][c] - scale));
    }
  }
  std::sort(differences.begin(), differences.end());
  return {differences[(differences.size() - 1) * 99 / 100], differences.back()};
}

Curve solve(const Lab& lab, const bench::RgbaFrame& frame, const Options& options,
            ThesisParams::Solver solver) {
  ThesisParams params = options.params;
  params.solver = solver;
  params.trace = true;
  ThesisDecomposition method(lab.device(), frame.extent);
  method.set_params(params);
  const PlanePtr input = lab.plane(frame.extent, frame.pixels);
  uint64_t number = 0;
  lab.run([&](gpu::Commands& commands) {
    Layers layers;
    number = method.record(commands, *input, layers);
  });
  const auto stats = method.stats(number);

  std::vector<reference::Plane> samples;
  for (int n = 0; n < stats.levels; ++n) {
    const Plane level = method.sample_frame(n);
    samples.push_back(to_reference(level.extent, lab.download(level.buffer)));
  }
  reference::Plane clusters;
  if (stats.clustered) {
    clusters = to_reference(frame.extent, lab.download(method.clusters().buffer));
  }
  const Reference expected(frame, params, samples, clusters, false);
  const Energies converged = Reference(frame, params, samples, clusters, true).energies;

  Curve curve;
  curve.name = solver == ThesisParams::Solver::pcg ? "pcg" : "schwarz";
  int iteration = 0;
  for (const auto& energy : stats.energy) {
    const Extent extent = method.sample_frame(energy.level).extent;
    const auto pixels = static_cast<double>(extent.pixels());
    if (energy.step >= 0) iteration += params.pcg_iterations;
    curve.points.push_back({iteration, extent, energy, energy.total() / pixels,
                            expected.energies.at({energy.level, energy.step}) / pixels,
                            converged.at({energy.level, 0}) / pixels});
  }
  const reference::Plane got = to_reference(frame.extent, lab.download(method.solution().buffer));
  curve.device = difference(got, expected.solution);
  curve.single = difference(Reference(frame, params, samples, clusters, false, true).solution,
                            expected.solution);
  curve.energy = expected.method.energy(got).total();
  curve.reference = expected.method.energy(expected.solution).total();
  return curve;
}

void print(const std::vector<Curve>& curves) {
  printf(
      "solver,iteration,level,width,height,irls step,energy/pixel,reference,converged,"
      "data+chromaticity,sparsity,smoothness,samples+clusters\n");
  for (const Curve& curve : curves) {
    for (const Point& point : curve.points) {
      const auto pixels = static_cast<double>(point.extent.pixels());
      const auto& energy = point.energy;
      printf("%s,%d,%d,%u,%u,%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f\n", curve.name, point.iteration,
             energy.level, point.extent.width, point.extent.height, energy.step + 1, point.total,
             point.reference, point.converged, energy.data_and_chromaticity / pixels,
             energy.sparsity / pixels, energy.smoothness / pixels,
             energy.samples_and_clusters / pixels);
    }
  }
  for (const Curve& curve : curves) {
    const Point& last = curve.points.back();
    printf("# %s: energy %.6g, reference %.6g (%+.4f %%), converged %.6g\n", curve.name,
           curve.energy, curve.reference, 100 * (curve.energy / curve.reference - 1),
           last.converged * static_cast<double>(last.extent.pixels()));
    printf("#   |dr| 99 %% %.1e, max %.1e; reference in single precision 99 %% %.1e, max %.1e\n",
           curve.device.most, curve.device.worst, curve.single.most, curve.single.worst);
  }
}

/// Energy over iterations, logarithmic; dashed: the converged energy of each level.
void draw(const std::vector<Curve>& curves, const std::string& path) {
  constexpr double kWidth = 720, kHeight = 360, kMargin = 48;
  double low = 1e300, high = 0;
  int last = 1;
  for (const Curve& curve : curves) {
    for (const Point& point : curve.points) {
      low = std::min({low, point.total, point.converged});
      high = std::max(high, point.total);
      last = std::max(last, point.iteration);
    }
  }
  const auto x = [&](double iteration) {
    return kMargin + iteration / last * (kWidth - 1.5 * kMargin);
  };
  const auto y = [&](double energy) {
    return kMargin / 2 + std::log(high / energy) / std::log(high / low) * (kHeight - 1.5 * kMargin);
  };
  std::ofstream svg(path);
  svg << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " << kWidth << ' ' << kHeight
      << "' font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' "
         "fill='white'/>\n";
  const char* colors[] = {"#1b6ca8", "#c8553d"};
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last_decade = static_cast<int>(std::floor(std::log10(high)));
  for (int exponent = first; exponent <= last_decade; ++exponent) {
    const double decade = std::pow(10, exponent);
    for (const double tick : {decade, 2 * decade, 5 * decade}) {
      if (tick < low || tick > high) continue;
      svg << "<path d='M" << kMargin << ' ' << y(tick) << 'H' << kWidth - kMargin / 2
          << "' stroke='#ddd'/><text x='4' y='" << y(tick) + 4 << "'>" << tick << "</text>\n";
    }
  }
  for (size_t k = 0; k < curves.size(); ++k) {
    svg << "<polyline fill='none' stroke-width='1.5' stroke='" << colors[k] << "' points='";
    for (const Point& point : curves[k].points)
      svg << x(point.iteration) << ',' << y(point.total) << ' ';
    svg << "'/>\n<text x='" << kWidth / 2 << "' y='" << 40 + 16 * k << "' fill='" << colors[k]
        << "'>" << curves[k].name << "</text>\n";
    for (size_t n = 1; n < curves[k].points.size(); ++n) {
      const Point &from = curves[k].points[n - 1], &to = curves[k].points[n];
      if (from.energy.level != to.energy.level) continue;
      svg << "<path stroke-dasharray='3 3' stroke='" << colors[k] << "' d='M" << x(from.iteration)
          << ' ' << y(to.converged) << 'H' << x(to.iteration) << "'/>\n";
    }
  }
  svg << "<text x='" << kWidth / 2 - 120 << "' y='" << kHeight - 8
      << "'>conjugate-gradient iterations, coarse to fine</text>\n<text x='4' y='14'>energy a "
         "pixel "
         "(dashed: converged)</text>\n</svg>\n";
  if (!svg) throw std::runtime_error("cannot write " + path);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.params.irls_iterations = 7;  // the figure's
  options.params.levels = 5;
  std::string dump;
  const bench::Options known{{"--dump", bench::text(dump)},
                             {"--irls", bench::integer(options.params.irls_iterations)},
                             {"--pcg", bench::integer(options.params.pcg_iterations)},
                             {"--levels", bench::integer(options.params.levels)},
                             {"--svg", bench::text(options.svg)}};
  if (!bench::read(known, argc, argv, "thesis_convergence.cpp")) return 2;
  try {
    const bench::RgbaFrame frame = bench::read_frame(dump);
    const Lab lab;
    const std::vector<Curve> curves = {solve(lab, frame, options, ThesisParams::Solver::pcg),
                                       solve(lab, frame, options, ThesisParams::Solver::schwarz)};
    print(curves);
    if (!options.svg.empty()) draw(curves, options.svg);
  } catch (const std::exception& error) {
    fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
