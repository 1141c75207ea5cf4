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

#include "tests/bench/flat_file.hpp"
#include "tests/bench/json.hpp"
#include "tests/bench/method.hpp"
#include "tests/bench/metrics.hpp"
#include "tests/bench/scene.hpp"

namespace inverse::bench {
namespace {

constexpr const char* kUsage =
    "options: --data FOLDER (scenes as flat dumps) --out FILE.json [--full] [--rounds N]\n"
    "  [--brief]                settings that every run has, and no scores: for more samples\n"
    "  [--only METHOD]…         some methods only\n"
    "  [--converged FOLDER]     keeps converged solutions there, and reads those of others\n"
    "  [--layers FOLDER]        writes the layers of scenes' first frames there, as flat dumps\n";

struct Options {
  std::string data, out, converged, layers;
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
  if (options.data.empty() || options.out.empty()) throw std::runtime_error(kUsage);
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
  std::vector<Scores> scores;
  std::vector<double> to_converged;
  std::vector<Image> reflectance;  // of a video
  bool warm = false;               // the solver has run
  bool slow = false;               // once a frame is enough

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

bool wanted(const Setting& setting, const Scene& scene, const Options& options) {
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
    out_ << "]}\n";
    if (!out_.flush()) throw std::runtime_error("cannot write " + options_.out);
  }

 private:
  std::string converged_path(const std::string& method, const Scene& scene) const {
    std::string name = method + "-" + scene.set + "-" + scene.name + ".f32";
    std::replace(name.begin(), name.end(), ' ', '_');
    return options_.converged + "/" + name;
  }

  /// Every method's converged reflectance of a scene of stills.
  Converged converge(const Scene& scene) const {
    Converged all;
    if (scene.video || options_.brief || (scene.set != "own" && !options_.full)) return all;
    for (const Method* m : methods_) {
      if (m->converged) {
        const auto solver = m->converged(size_of(scene));
        for (const TruthFrame& frame : scene.frames) {
          Cost cost;
          all[m->name].push_back(solver->run(frame.input, false, cost).reflectance);
        }
        if (!options_.converged.empty()) {
          std::filesystem::create_directories(options_.converged);
          write_flat(converged_path(m->name, scene), {"", all[m->name]});
        }
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
          if (!solver) solver = s.make(size_);
          rows.back().solver = solver;
        }
    // All settings take turns on every frame, so that what disturbs the machine disturbs all alike.
    for (int round = 0; round < options_.rounds; ++round)
      for (std::size_t k = 0; k < scene.frames.size(); ++k)
        for (Row& row : rows)
          if (round == 0 || again(row)) step(row, k, round == 0 && !options_.brief, converged);
    for (Row& row : rows) write(row);
  }

  /// Whether a row gets another round: slow ones have enough samples after one, and so have videos'
  /// many frames, but for those whose times are compared with each other.
  static bool again(const Row& row) {
    return !row.slow && (!row.scene->video || row.setting->effort == Setting::Effort::brief);
  }

  void step(Row& row, std::size_t k, bool judged, const Converged& converged) {
    constexpr double kSlow = 100;  // milliseconds
    const TruthFrame& frame = row.scene->frames[k];
    const bool continues = row.scene->video && k > 0;
    Cost cost;
    const Decomposition d = row.solver->run(frame.input, continues, cost);
    // The first frame of a solver compiles kernels and touches memory, which hardly matters to slow
    // ones (fast settings of the same kernels ran before); the first frame of a video has no
    // history, and the second finds things that it left.
    row.slow = row.slow || cost.wall > kSlow;
    if (row.scene->video ? k > 1 : row.warm || row.slow) row.sample(cost);
    row.warm = true;
    if (!judged) return;
    if (row.scene->video) row.reflectance.push_back(d.reflectance);
    if (row.scene->video && k % 3 != 2) return;  // frames are alike, and scores are dear
    row.scores.push_back(
        score(d.reflectance, d.shading, frame.reflectance, frame.shading, frame.mask));
    const auto limit = converged.find(row.method->name);
    if (limit != converged.end())
      row.to_converged.push_back(log_distance(d.reflectance, limit->second[k], frame.mask));
    if (k == 0 && !options_.layers.empty() && !row.scene->video &&
        row.setting->effort == Setting::Effort::brief)
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
        .add("device", json::text(row.method->family == "method" ? device_ : "processor"))
        .add("set", json::text(scene.set))
        .add("scene", json::text(scene.name))
        .add("regime", json::text(scene.regime))
        .add("video", scene.video ? "true" : "false")
        .add("width", json::number(size_of(scene).width))
        .add("height", json::number(size_of(scene).height))
        .add("frames", json::number(double(scene.frames.size())))
        .add("wall_ms", json::list(row.wall))
        .add("processor_ms", json::list(row.processor))
        .add("device_ms", json::list(row.device));
    for (const auto& [name, times] : row.stages) stages.add(name, json::list(times));
    object.add("stages_ms", stages.str());
    for (const auto& [name, field] : kScoreFields) {
      std::vector<double> values;
      for (const Scores& s : row.scores) values.push_back(s.*field);
      if (!values.empty()) object.add(name, json::list(values));
    }
    if (!row.to_converged.empty()) object.add("to_converged", json::list(row.to_converged));
    if (row.reflectance.size() > 1) add_temporal(row, object);
    out_ << (first_ ? "\n" : ",\n") << object.str();
    first_ = false;
  }

  static void add_temporal(const Row& row, json::Object& object) {
    std::vector<Image> truth;
    for (const TruthFrame& frame : row.scene->frames) truth.push_back(frame.reflectance);
    const Image still = static_pixels(truth);
    const double share =
        double(std::count(still.data.begin(), still.data.end(), 1.0F)) / double(still.data.size());
    constexpr double kLeastShare = 0.3;  // a camera that moves leaves hardly any
    if (share < kLeastShare) return;
    object.add("flicker", json::number(flicker(row.reflectance, true, still)))
        .add("jitter", json::number(jitter(row.reflectance, still)));
  }

  Options options_;
  std::string device_;
  std::vector<const Method*> methods_;
  std::vector<Scene> scenes_;
  std::map<const Setting*, std::shared_ptr<Solver>> solvers_;  // for frames of size_
  Size size_;
  std::ofstream out_;
  bool first_ = true;
};

}  // namespace

int run_bench(int argc, char** argv, const std::string& device,
              const std::vector<Method>& methods) {
  try {
    Bench(parse(argc, argv), device, methods).run();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace inverse::bench
