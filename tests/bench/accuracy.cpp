// Error per regime of every decomposition method.
//
//   accuracy [--device] [--data DIR] [--frames N] [--thesis] [--ablations] [--no-stills]
//            [--leave-one-out] [--temporal] [--pictures DIR]
//
// With --device our methods are the kernels (and are timed), otherwise the plain C++
// specifications. Scores are LMSE k=20 / scale-invariant MSE / DSSIM, mean of reflectance and
// shading, averaged over the frames of a scene and then over the scenes of a regime. Brackets: 95 %
// bootstrap interval of LMSE over scenes (frames where a regime has fewer than three scenes). No
// method sees a mask.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/bench/datasets.hpp"
#include "tests/bench/methods.hpp"
#include "tests/bench/metrics.hpp"

namespace inverse::bench {
namespace {

/// What to compare: baselines, the thesis' method and, last, ours.
struct Line {
  std::vector<Named> methods;
  DeviceMethods* device = nullptr;
};

/// The thesis' method with one of its terms left out.
std::vector<std::pair<std::string, ThesisParams>> ablations() {
  std::vector<std::pair<std::string, ThesisParams>> all;
  const auto without = [&](const char* term, float ThesisParams::*weight) {
    ThesisParams params;
    params.*weight = 0;
    all.emplace_back(std::string("  without ") + term, params);
  };
  without("data", &ThesisParams::w_data);
  without("intensity weight", &ThesisParams::w_intensity);
  without("sparsity", &ThesisParams::w_reflectance);
  without("shading", &ThesisParams::w_shading);
  without("chromaticity", &ThesisParams::w_chromaticity);
  without("samples", &ThesisParams::w_non_local);
  without("clusters", &ThesisParams::w_clustering);
  return all;
}

Line line_up(DeviceMethods* device, bool with_thesis, bool with_ablations) {
  Line line{baselines(), device};
  if (with_thesis) {
    line.methods.push_back(device ? device->thesis("thesis", {}) : reference_thesis());
  }
  if (with_ablations) {
    if (!device) throw std::runtime_error("--ablations needs --device");
    for (const auto& [name, params] : ablations())
      line.methods.push_back(device->thesis(name, params));
  }
  line.methods.push_back(device ? device->intrinsic("intrinsicdecomp", {})
                                : reference_intrinsic("intrinsicdecomp", {}, false));
  return line;
}

/// Runs `work(k)` for k = 0 … n-1 on two threads.
void parallel(std::size_t n, const std::function<void(std::size_t)>& work) {
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 2; ++t)
    threads.emplace_back([&, t] {
      for (std::size_t k = t; k < n; k += 2) work(k);
    });
  for (std::thread& t : threads) t.join();
}

std::vector<Scores> score_all(const std::vector<Frame>& frames, const Named& method) {
  std::vector<Scores> scores(frames.size());
  std::vector<Decomposition> found(frames.size());
  if (!method.parallel)
    for (std::size_t k = 0; k < frames.size(); ++k) found[k] = method.run(frames[k].input, false);
  parallel(frames.size(), [&](std::size_t k) {
    const Frame& f = frames[k];
    const Decomposition d =
        method.parallel ? method.run(f.input, false) : std::exchange(found[k], {});
    scores[k] = score(d.reflectance, d.shading, f.reflectance, f.shading, f.mask);
  });
  return scores;
}

double mean(const std::vector<double>& v) {
  double sum = 0;
  for (double x : v) sum += x;
  return v.empty() ? 0.0 : sum / double(v.size());
}

/// One value per scene of the regime (or per frame where there are fewer than three scenes).
std::vector<double> units(const std::vector<Frame>& frames, const std::vector<double>& values,
                          Regime regime) {
  std::map<std::string, std::vector<double>> scenes;
  std::vector<double> all;
  for (std::size_t k = 0; k < frames.size(); ++k)
    if (frames[k].regime == regime) {
      scenes[frames[k].scene].push_back(values[k]);
      all.push_back(values[k]);
    }
  if (scenes.size() < 3) return all;
  std::vector<double> out;
  for (const auto& [name, v] : scenes) out.push_back(mean(v));
  return out;
}

std::array<double, 2> bootstrap(const std::vector<double>& values) {
  std::mt19937 engine(1);
  std::vector<double> means(4000);
  for (double& m : means) {
    double sum = 0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += values[engine() % values.size()];
    m = sum / double(values.size());
  }
  std::sort(means.begin(), means.end());
  return {means[100], means[3899]};
}

std::vector<double> pick(const std::vector<Scores>& s, double Scores::*field) {
  std::vector<double> v;
  for (const Scores& x : s) v.push_back(x.*field);
  return v;
}

void print_row(const std::string& name, const std::vector<Frame>& frames,
               const std::vector<Scores>& s) {
  std::printf("%-22s", name.c_str());
  for (int r = 0; r < kRegimes; ++r) {
    const auto regime = Regime(r);
    const std::vector<double> l = units(frames, pick(s, &Scores::lmse20), regime);
    const std::array<double, 2> interval = bootstrap(l);
    std::printf("  %.4f [%.3f %.3f]/%.3f/%.3f", mean(l), interval[0], interval[1],
                mean(units(frames, pick(s, &Scores::mse), regime)),
                mean(units(frames, pick(s, &Scores::dssim), regime)));
  }
  std::printf("\n");
  std::fflush(stdout);
}

void print_difference(const char* title, const std::vector<Frame>& frames,
                      const std::vector<Scores>& mine, const std::vector<Scores>& other,
                      double Scores::*field) {
  std::vector<double> d = pick(mine, field);
  for (std::size_t i = 0; i < d.size(); ++i) d[i] -= other[i].*field;
  std::printf("%-22s", title);
  for (int r = 0; r < kRegimes; ++r) {
    const std::vector<double> u = units(frames, d, Regime(r));
    const std::array<double, 2> interval = bootstrap(u);
    std::printf("  %+.4f [%+.4f %+.4f]       ", mean(u), interval[0], interval[1]);
  }
  std::printf("\n");
}

void print_tables(const std::vector<Frame>& frames, const Line& line) {
  std::printf("%-22s", "");
  for (int r = 0; r < kRegimes; ++r) std::printf("  %-33s", regime_name(Regime(r)));
  std::printf("\n");
  std::vector<std::vector<Scores>> rows;
  std::vector<std::string> times;
  for (const Named& m : line.methods) {
    rows.push_back(score_all(frames, m));
    print_row(m.name, frames, rows.back());
    const DeviceMethods::Time time = line.device ? line.device->take_time() : DeviceMethods::Time{};
    char text[128];
    std::snprintf(text, sizeof text, "%-22s  %7.1f ms  processor %7.1f ms", m.name.c_str(),
                  time.wall, time.processor);
    if (time.wall > 0) times.emplace_back(text);
  }
  if (!times.empty())
    std::printf("\ntime for 640 x 480 pixels, %s\n", line.device->device_name().c_str());
  for (const std::string& text : times) std::printf("%s\n", text.c_str());
  for (const auto& [name, field] : {std::pair{"LMSE", &Scores::lmse20},
                                    {"scale-invariant MSE", &Scores::mse},
                                    {"DSSIM", &Scores::dssim}}) {
    std::printf("\nintrinsicdecomp minus method, paired %s and 95 %% interval (negative: better)\n",
                name);
    for (std::size_t k = 0; k + 1 < rows.size(); ++k)
      print_difference(line.methods[k].name.c_str(), frames, rows.back(), rows[k], field);
  }
  std::printf("\nLMSE k=20 (k=10) by scene: color Retinex, R = I / max_c I, intrinsicdecomp\n");
  std::map<std::string, std::array<std::vector<double>, 6>> scenes;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const std::string key = std::string(regime_name(frames[k].regime)) + " " + frames[k].scene;
    for (std::size_t j = 0; j < 3; ++j) {
      const Scores& s = rows[std::array<std::size_t, 3>{4, 2, rows.size() - 1}[j]][k];
      scenes[key][2 * j].push_back(s.lmse20);
      scenes[key][2 * j + 1].push_back(s.lmse10);
    }
  }
  for (const auto& [name, v] : scenes)
    std::printf("%-40s %.4f (%.4f)  %.4f (%.4f)  %.4f (%.4f)\n", name.c_str(), mean(v[0]),
                mean(v[1]), mean(v[2]), mean(v[3]), mean(v[4]), mean(v[5]));
}

/// Chooses the four weights of each scene on all other scenes, and scores it with them.
void print_leave_one_out(const std::vector<Frame>& frames) {
  constexpr std::array<double, 3> kFactors{0.5, 1, 2};
  std::vector<reference::IntrinsicParams> grid;
  for (double b : kFactors)
    for (double v : kFactors)
      for (double g : kFactors) {
        reference::IntrinsicParams p;
        p.shading_weight = b, p.value_weight = v, p.chroma_weight = g;
        grid.push_back(p);
      }
  std::vector<std::vector<Scores>> scores;
  for (const auto& p : grid) scores.push_back(score_all(frames, reference_intrinsic("", p, false)));
  // The criterion weighs the four regimes alike.
  const auto criterion = [&](std::size_t candidate, const std::string& left_out) {
    std::array<std::vector<double>, kRegimes> per;
    for (std::size_t k = 0; k < frames.size(); ++k)
      if (frames[k].scene != left_out)
        per[std::size_t(frames[k].regime)].push_back(scores[candidate][k].lmse20);
    double sum = 0;
    for (const auto& v : per) sum += mean(v) / kRegimes;
    return sum;
  };
  std::vector<Scores> chosen(frames.size());
  std::map<std::string, std::size_t> best;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const std::string& scene = frames[k].scene;
    if (!best.count(scene)) {
      best[scene] = 0;
      for (std::size_t c = 1; c < grid.size(); ++c)
        if (criterion(c, scene) < criterion(best[scene], scene)) best[scene] = c;
      const auto& p = grid[best[scene]];
      std::printf("without %-20s shading %.1f value %.1f chroma %.1f\n", scene.c_str(),
                  p.shading_weight, p.value_weight, p.chroma_weight);
    }
    chosen[k] = scores[best[scene]][k];
  }
  print_row("leave one scene out", frames, chosen);
}

/// A sequence and what is to be seen in it.
struct Motion {
  std::string scene, what;
  std::vector<Frame> frames;
  bool still = true;  ///< Reflectance stays where it is, so that flicker can be measured.
};

/// The first frame again and again, under shot and read noise.
std::vector<Frame> noisy(const std::vector<Frame>& sequence) {
  std::mt19937 engine(1);
  std::normal_distribution<float> normal;
  std::vector<Frame> frames(8, sequence[0]);
  for (Frame& f : frames)
    for (float& v : f.input.data)
      v = std::max(0.0F, v + 0.01F * std::sqrt(v + 0.002F) * normal(engine));
  return frames;
}

/// The same under light that changes in `parts` times smaller steps: light adds up.
std::vector<Frame> slower(const std::vector<Frame>& sequence, int parts) {
  std::vector<Frame> frames;
  for (std::size_t k = 0; k + 1 < sequence.size(); ++k)
    for (int j = 0; j < parts; ++j) {
      frames.push_back(sequence[k]);
      const float share = float(j) / float(parts);
      const auto mix = [&](Image& to, const Image& next) {
        for (std::size_t i = 0; i < to.data.size(); ++i)
          to.data[i] += share * (next.data[i] - to.data[i]);
      };
      mix(frames.back().input, sequence[k + 1].input);
      mix(frames.back().shading, sequence[k + 1].shading);
    }
  return frames;
}

std::vector<Named> temporal_methods(DeviceMethods* device) {
  std::vector<Named> methods;
  if (!device) {
    reference::IntrinsicParams loose;
    loose.anchor_weight = 0;
    methods.push_back(reference_intrinsic("anchor off", loose, true));
    methods.push_back(reference_intrinsic("anchor", {}, true));
    return methods;
  }
  IntrinsicDecomposition::Params loose;
  loose.anchor.anchor_weight = 0;
  ThesisParams alone;
  alone.keyframes = 0;
  methods.push_back(device->thesis("thesis, no keyframes", alone));
  methods.push_back(device->thesis("thesis", {}));
  methods.push_back(device->intrinsic("anchor off", loose));
  methods.push_back(device->intrinsic("anchor", {}));
  return methods;
}

/// Flicker of static reflectance under moving light and under sensor noise, and what the methods'
/// memories cost where something moves.
void print_temporal(const std::string& root, DeviceMethods* device) {
  std::printf("\n%-54s %8s %8s %8s %8s\n", "temporal", "LMSE", "flicker", "with gauge", "jitter");
  std::vector<Motion> motions;
  for (const char* scene : {"lightchange", "lightchange_values"}) {
    motions.push_back({scene, "moving light", load_sequence(root, scene)});
    motions.push_back({scene, "slow light", slower(motions.back().frames, 5)});
    motions.push_back({scene, "noise", noisy(motions.back().frames)});
  }
  for (const char* scene : {"cornell", "room", "desk_rgbd", "courtyard", "room_values"})
    motions.push_back({scene, "motion", load_sequence(root, scene), false});
  for (const Motion& motion : motions) {
    std::vector<Named> methods = temporal_methods(device);
    if (motion.still) methods.insert(methods.begin(), baselines()[0]);
    for (const Named& method : methods) {
      std::vector<Image> reflectance;
      double error = 0;
      for (const Frame& f : motion.frames) {
        const Decomposition d = method.run(f.input, !reflectance.empty());
        error += score(d.reflectance, d.shading, f.reflectance, f.shading, f.mask).lmse20 /
                 double(motion.frames.size());
        reflectance.push_back(d.reflectance);
      }
      std::printf("%-18s %-12s %-22s %8.4f", motion.scene.c_str(), motion.what.c_str(),
                  method.name.c_str(), error);
      if (motion.still)
        std::printf(" %8.4f %8.4f %8.4f", flicker(reflectance, true), flicker(reflectance, false),
                    jitter(reflectance));
      std::printf("\n");
      std::fflush(stdout);
    }
  }
}

/// Input, reflectance, shading and, below, the truth, gamma 2.2, one PNG a frame.
void write_pictures(const std::vector<Frame>& frames, const std::string& directory) {
  parallel(frames.size(), [&](std::size_t k) {
    const Frame& f = frames[k];
    const Decomposition d = reference_intrinsic("", {}, false).run(f.input, false);
    const int w = f.input.width, h = f.input.height;
    cv::Mat out(2 * h, 3 * w, CV_8UC3, cv::Scalar(0, 0, 0));
    const auto put = [&](const Image& image, int column, int row) {
      std::vector<float> peak(image.data);
      std::nth_element(peak.begin(), peak.begin() + std::ptrdiff_t(peak.size() * 99 / 100),
                       peak.end());
      const float scale = 1 / std::max(peak[peak.size() * 99 / 100], 1e-6F);
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
          for (int c = 0; c < 3; ++c) {
            const float v = image.at(x, y, image.channels == 3 ? c : 0) * scale;
            out.at<cv::Vec3b>(row * h + y, column * w + x)[2 - c] =
                std::uint8_t(255 * std::pow(std::clamp(v, 0.0F, 1.0F), 1 / 2.2F));
          }
    };
    put(f.input, 0, 0), put(d.reflectance, 1, 0), put(d.shading, 2, 0);
    put(f.reflectance, 1, 1), put(f.shading, 2, 1);
    char name[32];
    std::snprintf(name, sizeof name, "_%03d.png", f.index);
    cv::imwrite(directory + "/" + f.scene + name, out);
  });
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  using namespace inverse::bench;
  std::string root = "../shared/data", pictures;
  int frames_per_scene = 4;
  bool with_thesis = false, with_ablations = false, leave_one_out = false, temporal = false,
       stills = true;
  std::unique_ptr<DeviceMethods> device;
  try {
    for (int k = 1; k < argc; ++k) {
      const std::string a = argv[k];
      const auto value = [&] {
        if (k + 1 >= argc) throw std::runtime_error(a + " needs a value");
        return std::string(argv[++k]);
      };
      if (a == "--data")
        root = value();
      else if (a == "--frames")
        frames_per_scene = std::stoi(value());
      else if (a == "--thesis")
        with_thesis = true;
      else if (a == "--ablations")
        with_thesis = with_ablations = true;
      else if (a == "--device")
        device = std::make_unique<DeviceMethods>();
      else if (a == "--no-stills")
        stills = false;
      else if (a == "--leave-one-out")
        leave_one_out = true;
      else if (a == "--temporal")
        temporal = true;
      else if (a == "--pictures")
        pictures = value();
      else
        throw std::runtime_error("unknown option " + a);
    }
    const std::vector<Frame> frames = load_all(root, frames_per_scene);
    if (!pictures.empty()) {
      write_pictures(frames, pictures);
      return 0;
    }
    if (stills) print_tables(frames, line_up(device.get(), with_thesis, with_ablations));
    if (leave_one_out) print_leave_one_out(frames);
    if (temporal) print_temporal(root, device.get());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "accuracy: %s\n", e.what());
    return 1;
  }
  return 0;
}
