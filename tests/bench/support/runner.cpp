// SPDX-License-Identifier: LGPL-2.1-or-later
// Measures every method x setting on every scene and writes one row of JSON for each: raw samples
// of the times, scores against the truth, distance to the converged solution.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "json.hpp"
#include "method.hpp"
#include "photographs.hpp"
#include "scene.hpp"
#include "tests/bench/metrics/flat_file.hpp"
#include "tests/bench/metrics/metrics.hpp"

namespace inverse::bench {
namespace {

constexpr const char* kUsage =
    "options: --data FOLDER (scenes as flat dumps) --out FILE.json [--full] [--rounds N]\n"
    "  --photographs FOLDER     instead of --data: reflectance ratios of judged pairs of points\n"
    "  [--brief]                settings that every run has, and no scores: for more samples\n"
    "  [--only METHOD]…         some methods only\n"
    "  [--converged FOLDER]     keeps converged solutions there, and reads those of others\n"
    "  [--layers FOLDER]        writes the layers of scenes' first frames there, as flat dumps\n";

struct Options {
  std::string data, photographs, out, converged, layers;
  std::set<std::string> only;
  bool full = false, brief = false;
  int rounds = 2;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&] {
      if (++i >= argc) throw std::runtime_error(argument + " needs a value\n" + kUsage);
      return std::string(argv[i]);
    };
    if (argument == "--data")
      options.data = value();
    else if (argument == "--photographs")
      options.photographs = value();
    else if (argument == "--out")
      options.out = value();
    else if (argument == "--converged")
      options.converged = value();
    else if (argument == "--layers")
      options.layers = value();
    else if (argument == "--only")
      options.only.insert(value());
    else if (argument == "--rounds")
      options.rounds = std::max(1, std::stoi(value()));
    else if (argument == "--full")
      options.full = true;
    else if (argument == "--brief")
      options.brief = true;
    else
      throw std::runtime_error(argument + "?\n" + kUsage);
  }
  if (options.data.empty() == options.photographs.empty() || options.out.empty())
    throw std::runtime_error(kUsage);
  return options;
}

/// A setting on a scene.
struct Row {
  const Method* method = nullptr;
  const Setting* setting = nullptr;
  const Scene* scene = nullptr;
  std::shared_ptr<Solver> solver;
  std::vector<double> wall, processor, device;
  std::map<std::string, std::vector<double>> stages;
  std::map<std::string, std::vector<double>> errors;  // by measure, frame by frame
  std::optional<Decomposition> found;                 // of a frame, until it is scored
  std::optional<double> flicker, jitter;
  std::string failure;             // cause of an aborted measurement
  std::vector<Image> reflectance;  // of a video
  bool warm = false;               // the solver has run
  bool slow = false;               // one pass per frame suffices
  bool failed() const { return !failure.empty(); }
  /// Number of frames to play, and of last frames to score.
  std::size_t shown() const {
    const bool longer = scene->video && scene->frames.size() > 1;
    return longer ? std::max(setting->frames, judged()) : judged();
  }
  std::size_t judged() const { return scene->frames.size(); }
  /// Index of the k-th frame.
  std::size_t at(std::size_t k) const { return to_and_fro(k, scene->frames.size()); }

  void sample(const Cost& cost) {
    wall.push_back(cost.wall);
    processor.push_back(cost.processor);
    device.push_back(cost.device);
    for (const auto& [name, time] : cost.stages) stages[name].push_back(time);
  }
};

Size size_of(const Scene& scene) {
  return {scene.frames.front().input.width, scene.frames.front().input.height};
}

Image sum(Image a, const Image& b) {
  for (std::size_t i = 0; i < a.data.size(); ++i) a.data[i] += b.data[i];
  return a;
}

/// RGB shading: the sum of its layers, or gray.
Image colored_shading(const Decomposition& d) {
  if (!d.direct.empty()) return sum(d.direct, d.indirect);
  Image out(d.shading.width, d.shading.height, 3);
  for (std::size_t i = 0; i < out.data.size(); ++i) out.data[i] = d.shading.data[i / 3];
  return out;
}

bool has_layers(const Scene& scene) { return !scene.frames.front().direct.empty(); }

bool wanted(const Setting& setting, const Scene& scene, const Options& options) {
  if (setting.layers_only && (options.brief || !has_layers(scene))) return false;
  if (!setting.sets.empty() && !setting.sets.count(scene.set)) return false;
  if (!(scene.video ? setting.video : setting.stills)) return false;
  if (options.brief) return setting.effort == Setting::Effort::brief;
  if (options.full) return true;
  if (setting.effort == Setting::Effort::full) return false;
  return scene.set == "own" || setting.effort == Setting::Effort::brief;
}

/// Converged reflectances of a scene's frames, by method.
using Converged = std::map<std::string, std::vector<Image>>;

class Bench {
 public:
  Bench(Options options, std::string device, const std::vector<Method>& methods)
      : options_(std::move(options)), device_(std::move(device)) {
    for (const Method& m : methods)
      if (options_.only.empty() || options_.only.count(m.name)) methods_.push_back(&m);
    scenes_ = read_scenes(options_.data);
    if (scenes_.empty()) throw std::runtime_error("no scenes in " + options_.data);
    std::stable_sort(scenes_.begin(), scenes_.end(),
                     [](const Scene& a, const Scene& b) { return size_of(a) < size_of(b); });
    out_.open(options_.out);
    if (!out_) throw std::runtime_error("cannot write " + options_.out);
  }

  void run() {
    out_ << "{\"device\": " << json::text(device_) << ",\n\"methods\": [";
    const char* before = "\n";
    for (const Method* m : methods_) {
      out_ << before
           << json::Object()
                  .add("name", json::text(m->name))
                  .add("family", json::text(m->family))
                  .add("description", json::text(m->description))
                  .str();
      before = ",\n";
    }
    out_ << "],\n\"rows\": [";
    for (std::size_t k = 0; k < scenes_.size(); ++k) {
      std::fprintf(stderr, "@progress %.3f %s %s\n", double(k) / double(scenes_.size()),
                   scenes_[k].set.c_str(), scenes_[k].name.c_str());
      measure_scene(scenes_[k]);
    }
    out_ << "],\n\"failures\": [";
    for (std::size_t k = 0; k < failures_.size(); ++k) out_ << (k ? ",\n" : "\n") << failures_[k];
    out_ << "]}\n";
    if (!out_.flush()) throw std::runtime_error("cannot write " + options_.out);
  }

 private:
  static constexpr std::size_t kUntimed = 2;  // first frames of a video

  std::string converged_path(const std::string& method, const Scene& scene) const {
    std::string name = method + "-" + scene.set + "-" + scene.name + ".f32";
    std::replace(name.begin(), name.end(), ' ', '_');
    return options_.converged + "/" + name;
  }

  /// Every method's converged reflectance of the project's own stills; of all with --full, else of
  /// the first, because some methods take seconds to converge.
  Converged converge(const Scene& scene) {
    Converged all;
    if (scene.video || scene.set != "own" || options_.brief) return all;
    const bool first = !std::exchange(first_still_seen_, true);
    if (!first && !options_.full) return all;
    for (const Method* m : methods_) {
      if (m->converged) try {
          const auto solver = m->converged(size_of(scene));
          for (const TruthFrame& frame : scene.frames) {
            Cost cost;
            all[m->name].push_back(solver->run(frame.input, false, cost).reflectance);
          }
          if (!options_.converged.empty()) {
            std::filesystem::create_directories(options_.converged);
            write_flat(converged_path(m->name, scene), {"", all[m->name]});
          }
        } catch (const std::exception& error) {
          all.erase(m->name);
          fail(*m, "converged", "", scene, error.what());
        }
      const std::string path = converged_path(m->converges_to, scene);
      if (!m->converges_to.empty() && std::filesystem::exists(path)) {
        const FlatFile file = read_flat(path);
        if (file.frames.size() == scene.frames.size()) all[m->name] = file.frames;
      }
    }
    return all;
  }

  void measure_scene(const Scene& scene) {
    if (size_of(scene) != size_) solvers_.clear();
    size_ = size_of(scene);
    const Converged converged = converge(scene);
    std::vector<Row> rows;
    for (const Method* m : methods_)
      for (const Setting& s : m->settings)
        if (wanted(s, scene, options_)) {
          std::shared_ptr<Solver>& solver = solvers_[&s];
          rows.emplace_back();
          rows.back().method = m, rows.back().setting = &s, rows.back().scene = &scene;
          rows.back().warm = solver != nullptr;
          attempt(rows.back(), [&] {
            if (!solver) solver = s.make(size_);
            rows.back().solver = solver;
          });
        }
    // All settings take turns on every frame, so that other load affects all alike.
    for (int round = 0;; ++round) {
      std::vector<Row*> turns;
      std::size_t count = 0;
      for (Row& row : rows)
        if (!row.failed() && (round == 0 || again(row, round))) {
          turns.push_back(&row);
          count = std::max(count, row.shown());
        }
      if (turns.empty()) break;
      for (std::size_t k = 0; k < count; ++k) {
        for (Row* row : turns)
          if (k < row->shown() && !row->failed())
            attempt(*row, [&] { step(*row, k, round == 0 && !options_.brief); });
        std::reverse(turns.begin(), turns.end());  // so that none always follows the same one
        if (round == 0)
          in_parallel(rows.size(),
                      [&](std::size_t n) { judge(rows[n], rows[n].at(k), converged); });
      }
    }
    if (scene.video) add_temporal(scene, rows);
    for (Row& row : rows) write(row);
  }

  /// An error of a setting does not affect others.
  void attempt(Row& row, const std::function<void()>& work) {
    try {
      work();
    } catch (const std::exception& error) {
      row.failure = error.what();
      row.found.reset();
      solvers_.erase(row.setting);
      fail(*row.method, row.setting->curve, row.setting->name, *row.scene, error.what());
    }
  }

  void fail(const Method& method, const std::string& curve, const std::string& setting,
            const Scene& scene, const std::string& why) {
    std::fprintf(stderr, "%s %s %s, %s %s: %s\n", method.name.c_str(), curve.c_str(),
                 setting.c_str(), scene.set.c_str(), scene.name.c_str(), why.c_str());
    failures_.push_back(json::Object()
                            .add("method", json::text(method.name))
                            .add("curve", json::text(curve))
                            .add("setting", json::text(setting))
                            .add("set", json::text(scene.set))
                            .add("scene", json::text(scene.name))
                            .add("why", json::text(why))
                            .str());
  }

  /// Whether a row is measured again: slow ones and videos have enough samples after one round,
  /// except, with --full, videos whose times are compared.
  bool again(const Row& row, int round) const {
    const Setting& setting = *row.setting;
    if (setting.lmse_only) return false;
    if (options_.full && !options_.brief && row.scene->video && row.shown() > kUntimed &&
        row.wall.size() < setting.min_samples)
      return true;
    if (row.slow || round >= options_.rounds) return false;
    if (!row.scene->video) return true;
    return options_.full && row.shown() == row.judged() && setting.effort == Setting::Effort::brief;
  }

  void step(Row& row, std::size_t k, bool judged) {
    constexpr double kSlow = 40;  // milliseconds
    const bool video = row.scene->video;
    Cost cost;
    const TruthFrame& frame = row.scene->frames[row.at(k)];
    row.solver->show(frame);
    Decomposition d = row.solver->run(frame.input, video && k > 0, cost);
    // A solver's first frame compiles kernels and touches memory, which hardly matters for slow
    // ones (fast settings of the same kernels ran before). A video's first frame has no history,
    // and its second uses incomplete history.
    row.slow = row.slow || cost.wall > kSlow;
    if (video ? k >= kUntimed : row.warm || row.slow) row.sample(cost);
    row.warm = true;
    if (!judged || k + row.judged() < row.shown()) return;
    if (video) row.reflectance.push_back(d.reflectance);
    if (video && k % 3 != 2) return;  // frames are similar, and scores are slow
    row.found = std::move(d);
  }

  /// Scores the result of a row in frame `k`. Runs in parallel with other scoring, while nothing is
  /// timed.
  void judge(Row& row, std::size_t k, const Converged& converged) const {
    if (!row.found) return;
    const Decomposition d = *std::exchange(row.found, std::nullopt);
    const TruthFrame& truth = row.scene->frames[k];
    const auto add_lmse = [&] {
      row.errors["lmse20"].push_back(
          score_lmse(d.reflectance, d.shading, truth.reflectance, truth.shading, truth.mask));
    };
    if (row.setting->lmse_only) return add_lmse();
    const auto note = [&](const char* name, double value) { row.errors[name].push_back(value); };
    if (!d.direct.empty() && !truth.direct.empty()) {
      const LayerScores scores =
          score_layers(d.direct, d.indirect, truth.direct, truth.indirect, truth.mask);
      for (const auto& [name, field] : kLayerScoreFields) note(name, scores.*field);
    }
    for (const auto& [name, values] : d.figures)
      row.errors[name].insert(row.errors[name].end(), values.begin(), values.end());
    // By layer; if the truth has the color of light, wrong colors count.
    const bool colored = !truth.direct.empty();
    const Image shading = colored ? colored_shading(d) : d.shading;
    const Image true_shading = colored ? sum(truth.direct, truth.indirect) : truth.shading;
    const auto error = colored ? color_lmse : lmse;
    note("lmse20_R", error(d.reflectance, truth.reflectance, truth.mask, 20));
    note("lmse20_S", error(shading, true_shading, truth.mask, 20));
    if (row.setting->layers_only) return;
    if (row.scene->video) return add_lmse();
    const Scores scores =
        score(d.reflectance, d.shading, truth.reflectance, truth.shading, truth.mask);
    for (const auto& [name, field] : kScoreFields) note(name, scores.*field);
    const auto limit = converged.find(row.method->name);
    if (limit != converged.end())
      note("to_converged", log_distance(d.reflectance, limit->second[k], truth.mask));
    if (k == 0 && !options_.layers.empty() && row.setting->effort == Setting::Effort::brief)
      write_layers(row, d);
  }

  void write_layers(const Row& row, const Decomposition& d) const {
    std::filesystem::create_directories(options_.layers);
    std::string name = row.scene->set + "-" + row.scene->name + "-" + row.method->name + "-" +
                       row.setting->curve + "-" + row.setting->name;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == '/'; }, '_');
    write_flat(options_.layers + "/" + name + ".f32",
               {"", {stacked({&d.reflectance, &d.shading})}});
  }

  void write(const Row& row) {
    if (row.failed()) return;
    const Scene& scene = *row.scene;
    json::Object parameters, object, stages;
    for (const auto& [name, value] : row.setting->parameters)
      parameters.add(name, json::text(value));
    object.add("method", json::text(row.method->name))
        .add("curve", json::text(row.setting->curve))
        .add("setting", json::text(row.setting->name))
        .add("order", json::number(row.setting->order))
        .add("preset", json::text(row.setting->preset))
        .add("base", row.setting->base ? "true" : "false")
        .add("against", json::text(row.setting->against))
        .add("parameters", parameters.str())
        .add("device", json::text(device_))
        .add("set", json::text(scene.set))
        .add("scene", json::text(scene.name))
        .add("regime", json::text(scene.regime))
        .add("video", scene.video ? "true" : "false")
        .add("width", json::number(size_of(scene).width))
        .add("height", json::number(size_of(scene).height))
        .add("frames", json::number(double(row.shown())))
        .add("wall_ms", json::list(row.wall))
        .add("processor_ms", json::list(row.processor))
        .add("device_ms", json::list(row.device));
    for (const auto& [name, times] : row.stages) stages.add(name, json::list(times));
    object.add("stages_ms", stages.str());
    for (const auto& [name, values] : row.errors) object.add(name, json::list(values));
    if (row.flicker) object.add("flicker", json::number(*row.flicker));
    if (row.jitter) object.add("jitter", json::number(*row.jitter));
    out_ << (first_ ? "\n" : ",\n") << object.str();
    first_ = false;
  }

  static void add_temporal(const Scene& scene, std::vector<Row>& rows) {
    std::vector<Image> truth;
    for (const TruthFrame& frame : scene.frames) truth.push_back(frame.reflectance);
    const Image still = static_pixels(truth);
    const double share =
        double(std::count(still.data.begin(), still.data.end(), 1.0F)) / double(still.data.size());
    constexpr double kMinShare = 0.3;  // a moving camera leaves hardly any
    if (share < kMinShare) return;
    in_parallel(rows.size(), [&](std::size_t n) {
      Row& row = rows[n];
      if (row.reflectance.size() < scene.frames.size() || row.failed()) return;
      row.flicker = flicker(row.reflectance, true, still);
      row.jitter = jitter(row.reflectance, still);
    });
  }

  Options options_;
  std::string device_;
  std::vector<const Method*> methods_;
  std::vector<Scene> scenes_;
  std::map<const Setting*, std::shared_ptr<Solver>> solvers_;  // for frames of size_
  Size size_;
  std::ofstream out_;
  std::vector<std::string> failures_;
  bool first_ = true;
  bool first_still_seen_ = false;
};

}  // namespace

int run_bench(int argc, char** argv, const std::string& device,
              const std::vector<Method>& methods) {
  try {
    const Options options = parse(argc, argv);
    if (options.photographs.empty()) {
      Bench(options, device, methods).run();
      return 0;
    }
    std::ofstream out(options.out);
    out << measure_photographs(options.photographs, methods, options.only);
    if (!out.flush()) throw std::runtime_error("cannot write " + options.out);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace inverse::bench
