// How many clicks the thesis' misclustering correction (5.5.2, Table 5.1) wants of a user, how long
// they hold, and how many of them the automatic mode makes by itself.
//
//   clicks-bench SCENE... [--least SHARE] [--frames N] [--png FOLDER]
//
// SCENE are flat dumps of rendered sequences (import-scenes, own-scenes, edit-scenes). Their true
// reflectance tells which clusters are wrong: a component of equal cluster of which more than half
// has a reflectance that is nearer to another base color. The user clicks the largest such
// component of a frame that is no smaller than SHARE (default .005) of it, one after the other,
// until none is left; then the video goes on for up to N frames (default 24).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kernels/global_thesis/misclustering_correction.hpp"
#include "tests/bench/png_file.hpp"
#include "tests/bench/scene.hpp"

namespace {

using namespace inverse;
using bench::Image;
using bench::TruthFrame;

/// By how much nearer, in ln chromaticity, another base color must be for a pixel to be wrong.
constexpr float kMargin = 0.1F;

struct Options {
  double least = 0.005;
  size_t frames = 24;
  std::string png;
};

/// A frame as the method sees it and as it should.
struct Clusters {
  std::vector<int> seen;   ///< slot by pixel, −1: none
  std::vector<int> truth;  ///< slot that the pixel's reflectance is nearest to
  std::vector<uint8_t> wrong;
};

/// Pixels that hang together.
struct Component {
  int cluster = -1;
  std::vector<int> pixels;
  int right = -1;    ///< slot that most of its wrong pixels should have
  size_t wrong = 0;  ///< pixels that should have it
};

class Stage {
 public:
  Stage(const std::shared_ptr<gpu::Device>& device, Extent extent)
      : device_(device),
        extent_(extent),
        commands_(device),
        method_(device, extent),
        regions_(device, extent),
        correction_(device, extent) {
    const auto create = [&](gpu::Memory memory) {
      return gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), memory);
    };
    input_ = {extent, create(gpu::Memory::upload)};
    features_ = create(gpu::Memory::readback);
    marks_ = create(gpu::Memory::readback);
    // Clusters do not depend on the solution: it is cheap here, and whole in the correction.
    cheap_.steps = cheap_.pcg_iterations = 1;
    cheap_.refine_rounds = 0;
    cheap_.cut_fraction = 0;
  }

  /// The colors of the scene's first frame.
  void begin(const Image& frame) {
    method_.reset();
    regions_.reset();
    correction_.reset();
    method_.set_params(cheap_);
    upload(frame);
    commands_.begin();
    method_.record_colors(commands_, input_);
    commands_.submit();
    commands_.wait();
    method_.collect_colors();
  }

  /// One frame of the stream. Gives what the correction decided.
  std::optional<MisclusteringCorrection::Result> run(const Image& frame) {
    upload(frame);
    commands_.begin();
    Layers layers;
    GlobalThesis::Hints hints;
    hints.regions = &regions_;
    method_.set_params(cheap_);
    const uint64_t number = method_.record(commands_, input_, layers, hints);
    method_.set_params(whole_);
    const uint64_t corrected = correction_.record(commands_, method_, regions_);
    commands_.copy(method_.features(), features_, features_->bytes());
    commands_.copy(regions_.plane().buffer, marks_, marks_->bytes());
    commands_.submit();
    colors_ = method_.colors().colors();
    commands_.wait();
    method_.collect(number);
    regions_.collect(regions_.last());
    return correction_.collect(corrected, regions_);
  }

  Clusters clusters(const TruthFrame& truth) const {
    const auto* features = features_->map_as<float>();
    const auto* marks = marks_->map_as<float>();
    Clusters result;
    for (size_t n = 0; n < extent_.pixels(); ++n) {
      const int demanded = static_cast<int>(marks[4 * n]);
      const int seen = demanded >= 0 ? demanded : static_cast<int>(features[4 * n + 3]);
      const float* r = &truth.reflectance.data[3 * n];
      const float mean = (r[0] + r[1] + r[2]) / 3 + cheap_.chroma_floor;
      float own = 0, least = 3.4e38F;
      int nearest = -1;
      for (const auto& color : colors_) {
        float d2 = 0;
        for (size_t c = 0; c < 3; ++c) {
          const float d = std::log((r[c] + cheap_.chroma_floor) / mean) - color.center[c];
          d2 += d * d;
        }
        if (color.slot == seen) own = std::sqrt(d2);
        if (d2 >= least) continue;
        least = d2;
        nearest = color.slot;
      }
      result.seen.push_back(seen);
      result.truth.push_back(nearest);
      result.wrong.push_back(nearest != seen && own > std::sqrt(least) + kMargin);
    }
    return result;
  }

  std::vector<Component> components(const Clusters& clusters) const {
    const int w = static_cast<int>(extent_.width), h = static_cast<int>(extent_.height);
    std::vector<uint8_t> seen(clusters.seen.size());
    std::vector<Component> result;
    for (int first = 0; first < w * h; ++first) {
      if (seen[static_cast<size_t>(first)]) continue;
      Component component;
      component.cluster = clusters.seen[static_cast<size_t>(first)];
      component.pixels = {first};
      seen[static_cast<size_t>(first)] = 1;
      std::map<int, size_t> votes;
      for (size_t i = 0; i < component.pixels.size(); ++i) {
        const int n = component.pixels[i], x = n % w, y = n / w;
        const auto at = static_cast<size_t>(n);
        if (clusters.wrong[at]) ++votes[clusters.truth[at]];
        const std::array<std::pair<bool, int>, 4> neighbors{
            {{x > 0, n - 1}, {x + 1 < w, n + 1}, {y > 0, n - w}, {y + 1 < h, n + w}}};
        for (const auto& [inside, m] : neighbors) {
          if (!inside || seen[static_cast<size_t>(m)] ||
              clusters.seen[static_cast<size_t>(m)] != component.cluster)
            continue;
          seen[static_cast<size_t>(m)] = 1;
          component.pixels.push_back(m);
        }
      }
      for (const auto& [slot, count] : votes)
        if (count > component.wrong) {
          component.wrong = count;
          component.right = slot;
        }
      result.push_back(std::move(component));
    }
    return result;
  }

  /// Input, clusters, what they should be, and where they are wrong, side by side.
  void write(const std::string& path, const TruthFrame& truth, const Clusters& clusters) const {
    const int w = static_cast<int>(extent_.width), h = static_cast<int>(extent_.height);
    Image picture(4 * w, h, 3);
    const auto color = [&](int slot) {
      for (const auto& c : colors_)
        if (c.slot == slot) return c.color;
      return GlobalThesis::Rgb{};
    };
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const auto n = static_cast<size_t>(y * w + x);
        for (int c = 0; c < 3; ++c) {
          const auto channel = static_cast<size_t>(c);
          picture.at(x, y, c) = truth.input.data[3 * n + channel];
          picture.at(w + x, y, c) = color(clusters.seen[n])[channel];
          picture.at(2 * w + x, y, c) = color(clusters.truth[n])[channel];
          picture.at(3 * w + x, y, c) = clusters.wrong[n] ? 1 : 0.1F;
        }
      }
    bench::write_png(path, picture);
  }

  MarkedRegions& regions() { return regions_; }
  const std::vector<BaseColors::Color>& colors() const { return colors_; }

 private:
  void upload(const Image& frame) {
    auto* pixel = input_.buffer->map_as<float>();
    for (size_t n = 0; n < extent_.pixels(); ++n) {
      for (size_t c = 0; c < 3; ++c) pixel[4 * n + c] = frame.data[3 * n + c];
      pixel[4 * n + 3] = 1;
    }
  }

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  gpu::Commands commands_;
  GlobalThesis method_;
  MarkedRegions regions_;
  MisclusteringCorrection correction_;
  GlobalThesisParams cheap_, whole_;
  Plane input_;
  gpu::BufferPtr features_, marks_;
  std::vector<BaseColors::Color> colors_;
};

void measure(const std::shared_ptr<gpu::Device>& device, const bench::Scene& scene,
             const Options& options) {
  const TruthFrame& first = scene.frames.front();
  const Extent extent{static_cast<uint32_t>(first.input.width),
                      static_cast<uint32_t>(first.input.height)};
  Stage stage(device, extent);
  stage.begin(first.input);
  stage.run(first.input);
  const Clusters clusters = stage.clusters(first);
  const auto pixels = static_cast<double>(extent.pixels());
  size_t wrong = 0;
  for (const uint8_t w : clusters.wrong) wrong += w;
  printf("%s %s: %zu colors, %.2f %% of pixels wrong\n", scene.set.c_str(), scene.name.c_str(),
         stage.colors().size(), 100 * static_cast<double>(wrong) / pixels);
  for (const Component& c : stage.components(clusters)) {
    if (static_cast<double>(c.wrong) < options.least * pixels) continue;
    printf("   at %d, %d: %zu pixels of %d, %zu of which should be %d\n",
           c.pixels[0] % first.input.width, c.pixels[0] / first.input.width, c.pixels.size(),
           c.cluster, c.wrong, c.right);
  }
  if (!options.png.empty())
    stage.write(options.png + "/" + scene.set + "-" + scene.name + ".png", first, clusters);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  std::vector<std::string> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--least" && i + 1 < argc)
      options.least = std::atof(argv[++i]);
    else if (word == "--frames" && i + 1 < argc)
      options.frames = static_cast<size_t>(std::atoi(argv[++i]));
    else if (word == "--png" && i + 1 < argc)
      options.png = argv[++i];
    else
      scenes.push_back(word);
  }
  try {
    const auto device = gpu::Device::open();
    for (const std::string& path : scenes) measure(device, bench::read_scene(path), options);
  } catch (const std::exception& failure) {
    fprintf(stderr, "clicks-bench: %s\n", failure.what());
    return 1;
  }
  return 0;
}
