// How a decomposition method enters the benchmark: one registration that lists its settings.
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
  /// Parts of RGB shading, which is their sum: by light straight from its source, and by light from
  /// other surfaces. 3 channels, linear; both empty of a method that does not tell them apart.
  Image direct, indirect;
  /// What else can be told of the frame, by name, several values each: an error of each base color.
  /// Goes to the row of results beside the scores.
  std::map<std::string, std::vector<double>> figures;
};

struct TruthFrame;

/// What a frame cost, milliseconds.
struct Cost {
  double wall = 0;
  double processor = 0;  ///< all threads of the process
  /// By the device's own clock; NaN where there is none.
  double device = std::numeric_limits<double>::quiet_NaN();
  std::map<std::string, double> stages;  ///< parts of `device`
};

/// A method at one setting for frames of one size. It may remember frames.
class Solver {
 public:
  virtual ~Solver() = default;
  /// Decomposes a frame; with `continues` it follows the one before, otherwise nothing does.
  virtual Decomposition run(const Image& frame, bool continues, Cost& cost) = 0;
  /// Before `run`, the frame with its truth: for a method that somebody helps who sees more than
  /// the method does, by clicks, and for figures of its own.
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
  std::map<std::string, std::string> parameters;  ///< what differs from the defaults
  std::function<std::unique_ptr<Solver>(Size)> make;
  std::string preset;  ///< quality that has these parameters: "medium"; empty: none
  bool base = false;   ///< the method's default for stills, a point of all of its curves
  bool stills = true;  ///< is measured on stills
  bool video = false;  ///< is measured on videos
  /// Is measured only where the truth tells direct from indirect light, and by the measures of
  /// layers alone.
  bool layers_only = false;
  /// Is scored by LMSE (k = 20) alone, and shown once: nobody asks for its time.
  bool lmse_only = false;
  std::set<std::string> sets = {};  ///< is measured on these sets of scenes only; empty: on all
  /// A video that is shorter is played to and fro until so many frames were shown, and its last
  /// ones are judged: what settles with time shows. 0: once.
  std::size_t frames = 0;
  /// With --full a video is shown again until so many of its frames were timed: for times that are
  /// compared closely. 0: once, or twice.
  std::size_t least_samples = 0;
  enum class Effort : std::uint8_t {
    brief,  ///< in every run, on all data
    usual,  ///< in every run, on the project's own data; with --full on all
    full,   ///< with --full only
  } effort = Effort::usual;
  /// The curve and name of the setting from which this one differs in leaving out what frames do
  /// not need; their times and errors are compared, scene by scene. Empty: none.
  std::string against;
};

struct Method {
  std::string name;
  std::string family;       ///< "method", "peer" (other people's) or "trivial"
  std::string description;  ///< one sentence
  std::vector<Setting> settings;
  /// The method's own converged solution, against which its settings are measured; null: none.
  std::function<std::unique_ptr<Solver>(Size)> converged;
  /// Another method that minimizes the same energy, whose converged solution is taken instead.
  std::string converges_to;
};

/// Wall-clock and processor time of `work`.
Cost measure(const std::function<void()>& work);

/// What a program measures: `bench-methods --help` tells the options.
int run_bench(int argc, char** argv, const std::string& device, const std::vector<Method>& methods);

/// Runs work(0) … work(count - 1) on all cores. The first exception is thrown again when all are
/// done.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& work);

/// A setting's parameters as text.
std::string text_of(double value);

}  // namespace inverse::bench
