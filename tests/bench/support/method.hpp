// SPDX-License-Identifier: LGPL-2.1-or-later
// Registration of a decomposition method in the benchmark, with its settings.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/metrics/image.hpp"

namespace inverse::bench {

struct Decomposition {
  Image reflectance;  ///< 3 channels, linear
  Image shading;  ///< 1 channel, linear; of a method with more layers the luminance of their sum
  /// Parts of RGB shading, which is their sum: direct light, and light from other surfaces. 3
  /// channels, linear; both empty if the method does not separate them.
  Image direct, indirect;
  /// Further values per frame, by name: an error of each base color. Stored in the results beside
  /// the scores.
  std::map<std::string, std::vector<double>> figures;
};

struct TruthFrame;

/// Cost of a frame, milliseconds.
struct Cost {
  double wall = 0;
  double processor = 0;  ///< all threads of the process
  /// By the device's clock; NaN if unavailable.
  double device = std::numeric_limits<double>::quiet_NaN();
  std::map<std::string, double> stages;  ///< parts of `device`
};

/// A method at one setting for frames of one size. It may keep state between frames.
class Solver {
 public:
  virtual ~Solver() = default;
  /// Decomposes a frame; with `continues` it follows the one before, else the history is discarded.
  virtual Decomposition run(const Image& frame, bool continues, Cost& cost) = 0;
  /// Called before `run` with the frame and its truth: for a simulated user's clicks, and for
  /// statistics.
  virtual void show(const TruthFrame& /*truth*/) {}
};

struct Size {
  int width = 0, height = 0;
  auto operator<=>(const Size&) const = default;
};

/// One point of a method's work-precision curve.
struct Setting {
  std::string curve;  ///< points of one curve are joined in the plots: "cycles", "levels", …
  std::string name;   ///< the point's label: "4"
  double order = 0;   ///< its place along the curve
  std::map<std::string, std::string> parameters;  ///< differences from the defaults
  std::function<std::unique_ptr<Solver>(Size)> make;
  std::string preset;  ///< quality with these parameters: "medium"; empty: none
  bool base = false;   ///< the method's default for stills, a point of all of its curves
  bool stills = true;  ///< measured on stills
  bool video = false;  ///< measured on videos
  /// Measured only if the truth separates direct and indirect light, and only by the measures of
  /// layers.
  bool layers_only = false;
  /// Scored by LMSE (k = 20) alone, on one pass, without times.
  bool lmse_only = false;
  bool photographs = false;         ///< with `stills`: measured on photographs, as brief ones are
  std::set<std::string> sets = {};  ///< measured on these sets of scenes only; empty: on all
  /// A shorter video plays forwards and backwards up to this number of frames, and its last frames
  /// are scored, to show temporal convergence. 0: once.
  std::size_t frames = 0;
  /// With --full a video repeats until this number of frames was timed, for accurate comparisons of
  /// time. 0: once, or twice.
  std::size_t min_samples = 0;
  enum class Effort : std::uint8_t {
    brief,  ///< in every run, on all data
    usual,  ///< in every run, on the project's own data; with --full on all
    full,   ///< with --full only
  } effort = Effort::usual;
  /// Curve and name of the setting that does the same without skipping; times and errors are
  /// compared with it, scene by scene. Empty: none.
  std::string against;
};

struct Method {
  std::string name;
  std::string family;       ///< "method", "peer" (other people's) or "trivial"
  std::string description;  ///< one sentence
  std::vector<Setting> settings;
  /// The method's own converged solution, as a reference for its settings; null: none.
  std::function<std::unique_ptr<Solver>(Size)> converged;
  /// Another method with the same energy, whose converged solution is used instead.
  std::string converges_to;
};

/// Wall-clock and processor time of `work`.
Cost measure(const std::function<void()>& work);

/// The main program of a benchmark: `bench-methods --help` lists the options.
int run_bench(int argc, char** argv, const std::string& device, const std::vector<Method>& methods);

/// Runs work(0) … work(count - 1) on all cores. Rethrows the first exception when all have
/// finished.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work);

/// A setting's parameters as text.
std::string text_of(double value);

}  // namespace inverse::bench
