// SPDX-License-Identifier: LGPL-2.1-or-later
// Number and time of the clicks that the thesis' misclustering correction (5.5.2, Table 5.1) needs,
// and the accuracy of its automatic mode.
//
//   clicks-bench SCENE... [--least SHARE] [--frames N]
//
// SCENE are flat dumps of rendered sequences (import-scenes, own-scenes, edit-scenes). Their true
// reflectance shows which clusters are wrong (truth_clicks.hpp): a component of equal cluster of
// which more than half is nearer to another base color (by .1 in ln chromaticity). The simulated
// user clicks the largest such component of the first frame that is at least SHARE (default .005)
// of it, one after another, until none is left. Then the video plays for up to N frames (default
// 24), and new wrong components are clicked.
//
// Modes: no correction; clicks; clicks with the true color given; proposals. Reports wrong pixels
// and the error of reflectance for each. For proposals, on the first frame: precision and recall by
// region and by pixel, against the wrong regions.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "clicks_stage.hpp"
#include "tests/bench/metrics/metrics.hpp"

namespace {

using namespace inverse;
using namespace inverse::bench;

constexpr int kMaxFrames = 400;  // of the first image, until everything is decided
constexpr size_t kMeasured = 2;  // frames of a video with a full solve

struct Options {
  double min_share = kMinShare;
  size_t frames = 24;
};

enum class Way { none, clicks, named, proposals };
constexpr const char* kWays[] = {"none", "clicks", "named", "proposals"};

struct Outcome {
  int clicks = 0, later = 0, refused = 0;  ///< on the first frame; on those after it
  int right = 0;                      ///< marked regions on the first frame with the true color
  int marked = 0;                     ///< marked regions on the first frame
  double frames = 0;                  ///< mean number from a click to its decision
  double wrong_first = 0, wrong = 0;  ///< share of pixels, on the first frame and in all
  double lmse = 0, color_lmse = 0;
  double host_ms = 0;  ///< host time of proposals
};

/// Of proposals, on the first frame.
struct Quality {
  int proposed = 0, rightly = 0, wrong = 0, found = 0;
  double pixels = 0, rightly_pixels = 0, wrong_pixels = 0, found_pixels = 0;
};

class Run {
 public:
  Run(ClicksStage& stage, const Scene& scene, const Options& options, Way way)
      : stage_(stage), scene_(scene), options_(options), way_(way) {}

  Outcome play(Quality* quality) {
    using Mode = ClicksStage::Mode;
    stage_.begin(first().input, way_ == Way::proposals ? Mode::correct : Mode::off);
    int idle = 0;
    for (int frame = 0; frame < kMaxFrames && idle < 20; ++frame) {
      stage_.run(first().input, false);
      const size_t made = stage_.proposals().size();
      const bool acted = act(first(), outcome_.clicks) || made != proposed_;
      proposed_ = made;
      idle = acted || stage_.deciding() || undecided() ? 0 : idle + 1;
    }
    const Clusters clusters = stage_.clusters(first());
    look_at_regions(clusters);
    if (quality) *quality = judge(clusters);
    outcome_.wrong_first = share(clusters.wrong);
    const size_t count = scene_.video ? std::min(scene_.frames.size(), options_.frames) : 1;
    const size_t measured = std::min(count, kMeasured);
    for (size_t t = 0; t < count; ++t) {
      const TruthFrame& frame = scene_.frames[t];
      const bool whole = measured * t / count != measured * (t + 1) / count;
      stage_.run(frame.input, whole);
      if (t > 0) act(frame, outcome_.later);
      outcome_.wrong += share(stage_.clusters(frame).wrong) / static_cast<double>(count);
      if (!whole) continue;
      const Image r = stage_.reflectance();
      const auto part = 1 / static_cast<double>(measured);
      outcome_.lmse += part * lmse(r, frame.reflectance, frame.mask);
      outcome_.color_lmse += part * color_lmse(r, frame.reflectance, frame.mask);
    }
    outcome_.frames /= std::max(decided_, 1);
    outcome_.host_ms = stage_.proposal_ms();
    return outcome_;
  }

 private:
  const TruthFrame& first() const { return scene_.frames.front(); }

  static double share(const std::vector<uint8_t>& wrong) {
    size_t sum = 0;
    for (const uint8_t w : wrong) sum += w;
    return static_cast<double>(sum) / static_cast<double>(wrong.size());
  }

  bool undecided() {
    const auto& regions = stage_.regions().regions();
    return std::any_of(regions.begin(), regions.end(), [](const auto& r) { return r.color < 0; });
  }

  /// Simulates the user after a frame. True if something was clicked or is pending.
  bool act(const TruthFrame& frame, int& clicks) {
    if (way_ != Way::clicks && way_ != Way::named) return false;
    if (clicked_ > 0) {
      ++waited_;
      for (const auto& region : stage_.regions().regions()) {
        if (region.number != clicked_) continue;
        if (region.color < 0) return true;
        outcome_.frames += waited_;
        ++decided_;
      }
      clicked_ = 0;  // decided, or gone
    }
    if (outcome_.refused > 0) return false;
    const Clusters clusters = stage_.clusters(frame);
    const int w = frame.input.width, h = frame.input.height;
    for (const Component& c :
         wrong_components(clusters.raw, clusters.wrong, clusters.truth, w, h, options_.min_share)) {
      const int n = c.click();
      if (clusters.region[static_cast<size_t>(n)] > 0) continue;
      clicked_ = stage_.regions().click(n % w, n / w);
      if (clicked_ == 0) {
        ++outcome_.refused;
        return false;
      }
      if (way_ == Way::named) stage_.regions().set_color(clicked_, c.right);
      ++clicks;
      waited_ = 0;
      return true;
    }
    return false;
  }

  /// Whether marked regions have their true color.
  void look_at_regions(const Clusters& clusters) {
    for (const auto& region : stage_.regions().regions()) {
      if (region.color < 0) continue;
      size_t pixels = 0, wrong = 0;
      for (size_t n = 0; n < clusters.region.size(); ++n) {
        if (clusters.region[n] != region.number) continue;
        ++pixels;
        wrong += clusters.wrong[n];
      }
      ++outcome_.marked;
      outcome_.right += 2 * wrong < pixels;
    }
  }

  Quality judge(const Clusters& clusters) {
    Quality q;
    for (const auto& region : stage_.regions().regions()) {
      size_t pixels = 0, wrong = 0;
      for (size_t n = 0; n < clusters.region.size(); ++n) {
        if (clusters.region[n] != region.number) continue;
        ++pixels;
        wrong += clusters.raw_wrong[n];
      }
      const bool rightly = 2 * wrong > pixels;
      ++q.proposed;
      q.rightly += rightly;
      q.pixels += static_cast<double>(pixels);
      q.rightly_pixels += rightly ? static_cast<double>(pixels) : 0;
    }
    for (const Component& c :
         wrong_components(clusters.raw, clusters.raw_wrong, clusters.truth, first().input.width,
                          first().input.height, options_.min_share)) {
      size_t in = 0;
      for (const int n : c.pixels) in += clusters.region[static_cast<size_t>(n)] > 0;
      const bool found = 2 * in > c.pixels.size();
      ++q.wrong;
      q.found += found;
      q.wrong_pixels += static_cast<double>(c.pixels.size());
      q.found_pixels += found ? static_cast<double>(c.pixels.size()) : 0;
    }
    return q;
  }

  ClicksStage& stage_;
  const Scene& scene_;
  const Options& options_;
  Way way_;
  Outcome outcome_;
  size_t proposed_ = 0;
  int clicked_ = 0;  // the pending region
  int waited_ = 0;   // frames
  int decided_ = 0;
};

void measure(const std::shared_ptr<gpu::Device>& device, const Scene& scene,
             const Options& options) {
  const Image& first = scene.frames.front().input;
  ClicksStage stage(device,
                    {static_cast<uint32_t>(first.width), static_cast<uint32_t>(first.height)});
  printf("%s %s\n", scene.set.c_str(), scene.name.c_str());
  Quality quality;
  for (const Way way : {Way::none, Way::clicks, Way::named, Way::proposals}) {
    const char* name = kWays[static_cast<size_t>(way)];
    const Outcome o =
        Run(stage, scene, options, way).play(way == Way::proposals ? &quality : nullptr);
    printf(
        "  %-9s wrong %5.2f %% of the first frame, %5.2f %% of all; LMSE %.4f, of color %.4f; "
        "%d + %d clicks (%d refused), %.1f frames each; %d of %d regions right\n",
        name, 100 * o.wrong_first, 100 * o.wrong, o.lmse, o.color_lmse, o.clicks, o.later,
        o.refused, o.frames, o.right, o.marked);
  }
  printf(
      "  proposed %d regions, %d rightly (pixels %.0f, %.0f); wrong %d, found %d (pixels %.0f, "
      "%.0f); the host %.1f ms in all\n",
      quality.proposed, quality.rightly, quality.pixels, quality.rightly_pixels, quality.wrong,
      quality.found, quality.wrong_pixels, quality.found_pixels, stage.proposal_ms());
  fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  std::vector<std::string> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--least" && i + 1 < argc)
      options.min_share = std::atof(argv[++i]);
    else if (word == "--frames" && i + 1 < argc)
      options.frames = static_cast<size_t>(std::max(std::atoi(argv[++i]), 1));
    else
      scenes.push_back(word);
  }
  try {
    const auto device = gpu::Device::open();
    for (const std::string& path : scenes) measure(device, read_scene(path), options);
  } catch (const std::exception& failure) {
    fprintf(stderr, "clicks-bench: %s\n", failure.what());
    return 1;
  }
  return 0;
}
