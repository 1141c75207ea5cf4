// Accuracy of globalintrinsic's model (tests/reference/global_intrinsic.hpp) on scenes whose direct
// and indirect light is known.
//
//   global-accuracy DATA [--scenes a,b,…] [--frames N | --video] [--halve N] [--eight]
//   [--model NAME[:key=value,…]]… [--each] [--cast R,G,B]
//   [--png FOLDER]
//
// DATA holds a folder for every rendered sequence and `mit`. Models: `house` (intrinsicdecomp with
// 35 % of its shading as indirect light), `gray` (the same with a constant gray guess of as much
// light), `blur` (with a blurred image), `global`. --video runs frames in order with one state.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/datasets.hpp"
#include "tests/bench/layer_truth.hpp"
#include "tests/bench/metrics.hpp"
#include "tests/reference/global_intrinsic.hpp"

namespace inverse::bench {
namespace {

using reference::GlobalParams;
using reference::GlobalResult;
using reference::GlobalState;

struct Model {
  std::string name;
  GlobalParams params;
};

/// Parameters by name, for ablations.
const std::map<std::string, std::function<void(GlobalParams&, double)>>& keys() {
  static const std::map<std::string, std::function<void(GlobalParams&, double)>> all{
      {"grid", [](GlobalParams& p, double v) { p.grid = int(v); }},
      {"reach", [](GlobalParams& p, double v) { p.gather.reach = v; }},
      {"near", [](GlobalParams& p, double v) { p.gather.near = v; }},
      {"own", [](GlobalParams& p, double v) { p.gather.own = v; }},
      {"amount", [](GlobalParams& p, double v) { p.amount.manual = v; }},
      {"neutral", [](GlobalParams& p, double v) { p.amount.neutral = v; }},
      {"typical", [](GlobalParams& p, double v) { p.amount.typical = v; }},
      {"spread", [](GlobalParams& p, double v) { p.amount.spread = v; }},
      {"trust", [](GlobalParams& p, double v) { p.amount.trust = v; }},
      {"renew", [](GlobalParams& p, double v) { p.renew = v; }},
      {"white", [](GlobalParams& p, double v) { p.white_balance = v; }},
      {"bins", [](GlobalParams& p, double v) { p.palette.bins = int(v); }},
      {"bin-width", [](GlobalParams& p, double v) { p.palette.bin_width = v; }},
      {"residual", [](GlobalParams& p, double v) { p.tint.residual = v; }},
      {"gate", [](GlobalParams& p, double v) { p.tint.gate = v; }},
      {"cycles", [](GlobalParams& p, double v) { p.solve.cycles = int(v); }},
      {"warm-cycles", [](GlobalParams& p, double v) { p.warm_cycles = int(v); }},
      {"value", [](GlobalParams& p, double v) { p.solve.value_weight = v; }},
      {"chroma", [](GlobalParams& p, double v) { p.solve.chroma_weight = v; }},
      {"shading", [](GlobalParams& p, double v) { p.solve.shading_weight = v; }},
  };
  return all;
}

std::vector<std::string> parts(const std::string& text, char by) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, by);) out.push_back(part);
  return out;
}

Model model_of(const std::string& text) {
  Model model{text, {}};
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return model;
  for (const std::string& setting : parts(text.substr(colon + 1), ',')) {
    const auto pair = parts(setting, '=');
    const auto key = keys().find(pair[0]);
    if (pair.size() != 2 || key == keys().end())
      throw std::runtime_error("unknown setting " + setting);
    key->second(model.params, std::stod(pair[1]));
  }
  return model;
}

std::vector<double> doubles(const Image& image) { return {image.data.begin(), image.data.end()}; }

Image image_of(const std::vector<double>& data, int width, int height) {
  Image out(width, height, int(data.size() / (std::size_t(width) * std::size_t(height))));
  out.data.assign(data.begin(), data.end());
  return out;
}

struct Estimate {
  LightLayers layers;
  GlobalResult detail;
};

/// intrinsicdecomp with a guess at its indirect light: 35 % of the mean shading, shaped by `kind`.
Estimate baseline(const std::string& kind, const Image& input, GlobalState* state) {
  const int w = input.width, h = input.height;
  const auto rgb = doubles(input);
  reference::IntrinsicParams params;
  if (state && state->solve.width == w) params.cycles = 2;
  const auto result =
      reference::decompose(rgb.data(), w, h, params, state ? &state->solve : nullptr);
  const std::size_t n = result.log_shading.size();
  Estimate out;
  out.layers.reflectance = image_of(result.reflectance, w, h);
  out.layers.direct = Image(w, h, 1), out.layers.indirect = Image(w, h, 3);
  std::vector<reference::Vec3> light(n, {1, 1, 1});
  double level = 0, all = 0;
  if (kind == "blur") {
    std::vector<double> one(n, 1.0);
    const auto grid = reference::global::make_grid(rgb, one, w, h, 2);
    const reference::global::Gather gather(grid, std::vector<int>(grid.size(), 0), 1, {.near = 1});
    for (std::size_t i = 0; i < n; ++i)
      light[i] = gather.received(0, int(i % std::size_t(w)), int(i / std::size_t(w)), 4);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double s = std::exp(result.log_shading[i]);
    if (kind == "house") light[i] = {s, s, s};
    level += 0.35 * s;
    all += reference::global::mean(light[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double s = std::exp(result.log_shading[i]);
    for (double& v : light[i]) v *= level / all;
    const auto part = reference::global::split(s, light[i]);
    out.layers.direct.data[i] = float(part.direct);
    for (std::size_t c = 0; c < 3; ++c)
      out.layers.indirect.data[3 * i + c] = float(part.indirect[c]);
  }
  return out;
}

Estimate estimate(const Model& model, const Image& input, GlobalState* state) {
  if (model.name.rfind("global", 0) != 0) return baseline(model.name, input, state);
  const auto rgb = doubles(input);
  Estimate out;
  out.detail =
      reference::decompose_global(rgb.data(), input.width, input.height, model.params, state);
  out.layers = {image_of(out.detail.reflectance, input.width, input.height),
                image_of(out.detail.direct, input.width, input.height),
                image_of(out.detail.indirect, input.width, input.height)};
  return out;
}

/// Mean distance of every pixel's base color from its true log chroma.
double palette_error(const GlobalResult& result, const Image& truth) {
  if (result.label.empty() || result.colors.color.empty()) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < result.label.size(); ++i)
    sum += std::sqrt(reference::global::norm2(
        *result.colors.color[std::size_t(result.label[i])] -
        reference::global::chroma_of(
            {truth.data[3 * i], truth.data[3 * i + 1], truth.data[3 * i + 2]})));
  return sum / double(result.label.size());
}

/// The amount with which gathered light fits the truth best in the estimate's scale, by what is in
/// the layers: their ratio.
double true_amount(const Estimate& e, const LightLayers& truth) {
  const Image total = total_light(e.layers), true_total = total_light(truth);
  double a = 0, b = 0, ta = 0, tb = 0;
  for (std::size_t i = 0; i < total.data.size(); ++i) {
    a += e.layers.indirect.data[i], b += total.data[i];
    ta += truth.indirect.data[i], tb += true_total.data[i];
  }
  return (ta / tb) / (a / b) * e.detail.amount.value;
}

constexpr const char* kColumns[] = {"Rl",   "Rlc",  "Rm",  "Sl",     "Sm",   "dirl", "dirJ",  "ind",
                                    "indJ", "tint", "pal", "amount", "true", "sure", "colors"};
constexpr std::size_t kCount = std::size(kColumns);
using Row = std::array<double, kCount>;

Row measure(const Estimate& e, const LightLayers& truth) {
  const Image s = total_light(e.layers), st = total_light(truth);
  return {color_lmse(e.layers.reflectance, truth.reflectance),
          lmse(e.layers.reflectance, truth.reflectance, {}),
          color_mse(e.layers.reflectance, truth.reflectance),
          color_lmse(s, st),
          color_mse(s, st),
          color_lmse(e.layers.direct, truth.direct),
          direct_error_jointly(e.layers, truth),
          indirect_error(e.layers, truth),
          indirect_error_jointly(e.layers, truth),
          tint_error(e.layers, truth),
          palette_error(e.detail, truth.reflectance),
          e.detail.amount.value,
          true_amount(e, truth),
          e.detail.amount.confidence,
          double(e.detail.colors.used())};
}

struct Options {
  std::string data;
  std::vector<std::string> scenes{"cornell",     "room",        "courtyard",         "desk_rgbd",
                                  "lightchange", "room_values", "lightchange_values"};
  std::vector<Model> models;
  int frames = 2, halvings = 1;
  bool video = false, eight = false, each = false, mit = true;
  std::array<float, 3> cast{1, 1, 1};
  std::string png;
};

void print_row(const std::string& scene, const std::string& model, const Row& row) {
  std::printf("%-18s %-34s", scene.c_str(), model.c_str());
  for (std::size_t k = 0; k < kCount; ++k) std::printf(k < 10 ? " %6.4f" : " %6.3f", row[k]);
  std::printf("\n");
  std::fflush(stdout);
}

/// Runs task(0 … count - 1) on both processors.
void in_parallel(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr error;
  const auto work = [&] {
    try {
      for (std::size_t k; (k = next++) < count;) task(k);
    } catch (...) {
      error = std::current_exception();
    }
  };
  std::thread other(work);
  work();
  other.join();
  if (error) std::rethrow_exception(error);
}

/// Per model: geometric mean over scenes of every column, and of the amount the root mean square
/// of the logarithm of its ratio to the true one.
class Summary {
 public:
  explicit Summary(std::size_t models) : logs_(models, Row{}) {}
  void add(std::size_t model, const Row& row) {
    for (std::size_t c = 0; c < kCount; ++c) logs_[model][c] += std::log(std::max(row[c], 1e-9));
    const double off = std::log(std::max(row[kAmount], 1e-9) / std::max(row[kTrue], 1e-9));
    logs_[model][kAmount] += off * off - std::log(std::max(row[kAmount], 1e-9));
    if (model == 0) ++scenes_;
  }
  int scenes() const { return scenes_; }
  Row of(std::size_t model) const {
    Row row = logs_[model];
    for (std::size_t c = 0; c < kCount; ++c)
      row[c] = c == kAmount ? std::sqrt(row[c] / scenes_) : std::exp(row[c] / scenes_);
    return row;
  }

 private:
  static constexpr std::size_t kAmount = 11, kTrue = 12;
  std::vector<Row> logs_;
  int scenes_ = 0;
};

void run_scene(const Options& options, const std::string& scene, Summary& summary) {
  const std::string folder = options.data + "/" + scene;
  const int count = count_frames(folder);
  const int take = options.frames <= 0 ? count : std::min(options.frames, count);
  std::vector<LayerFrame> frames(static_cast<std::size_t>(take));
  std::vector<int> numbers;
  for (int k = 0; k < take; ++k)
    numbers.push_back(options.video || take == 1 ? k : k * (count - 1) / (take - 1));
  in_parallel(frames.size(), [&](std::size_t k) {
    frames[k] = load_layers(folder, numbers[k], options.halvings, options.eight);
    for (std::size_t i = 0; i < frames[k].input.data.size(); ++i)
      frames[k].input.data[i] *= options.cast[i % 3];
  });
  std::vector<std::vector<Row>> rows(options.models.size(), std::vector<Row>(frames.size()));
  const auto run_frame = [&](std::size_t m, std::size_t k, GlobalState* state) {
    const Estimate e = estimate(options.models[m], frames[k].input, state);
    rows[m][k] = measure(e, frames[k].truth);
    if (!options.png.empty())
      write_picture(options.png + "/" + scene + "-" + std::to_string(numbers[k]) + "-" +
                        options.models[m].name + ".png",
                    frames[k], e.layers);
  };
  if (options.video)
    in_parallel(options.models.size(), [&](std::size_t m) {
      GlobalState state;
      for (std::size_t k = 0; k < frames.size(); ++k) run_frame(m, k, &state);
    });
  else
    in_parallel(frames.size() * options.models.size(), [&](std::size_t t) {
      run_frame(t % options.models.size(), t / options.models.size(), nullptr);
    });
  for (std::size_t m = 0; m < options.models.size(); ++m) {
    Row mean{};
    for (std::size_t k = 0; k < frames.size(); ++k) {
      if (options.each)
        print_row(scene + "/" + std::to_string(numbers[k]), options.models[m].name, rows[m][k]);
      for (std::size_t c = 0; c < kCount; ++c) mean[c] += rows[m][k][c] / double(frames.size());
    }
    print_row(scene, options.models[m].name, mean);
    summary.add(m, mean);
  }
}

void run_mit(const Options& options) {
  std::vector<std::string> objects;
  for (const auto& entry : std::filesystem::directory_iterator(options.data + "/mit"))
    if (entry.is_directory()) objects.push_back(entry.path().string());
  std::vector<std::vector<double>> rl(options.models.size(), std::vector<double>(objects.size()));
  auto sl = rl, rm = rl;
  in_parallel(objects.size(), [&](std::size_t k) {
    LabeledFrame frame = load_mit(objects[k]);
    for (std::size_t m = 0; m < options.models.size(); ++m) {
      const Estimate e = estimate(options.models[m], frame.input, nullptr);
      const Image s = total_light(e.layers);
      Image gray(s.width, s.height, 1);
      for (std::size_t i = 0; i < gray.data.size(); ++i)
        gray.data[i] = (s.data[3 * i] + s.data[3 * i + 1] + s.data[3 * i + 2]) / 3;
      rl[m][k] = lmse(e.layers.reflectance, frame.reflectance, frame.mask);
      rm[m][k] = scale_invariant_mse(e.layers.reflectance, frame.reflectance, frame.mask);
      sl[m][k] = lmse(gray, frame.shading, frame.mask);
    }
  });
  for (std::size_t m = 0; m < options.models.size(); ++m) {
    const auto mean = [&](const std::vector<double>& v) {
      double sum = 0;
      for (const double x : v) sum += x / double(v.size());
      return sum;
    };
    std::printf("%-18s %-34s Rlc %.4f Rm %.4f Sl %.4f\n", "mit", options.models[m].name.c_str(),
                mean(rl[m]), mean(rm[m]), mean(sl[m]));
  }
}

void run(const Options& options) {
  std::printf("%-18s %-34s", "scene", "model");
  for (const char* column : kColumns) std::printf(" %6s", column);
  std::printf("\n");
  Summary summary(options.models.size());
  for (const std::string& scene : options.scenes)
    if (scene == "mit")
      run_mit(options);
    else
      run_scene(options, scene, summary);
  for (std::size_t m = 0; summary.scenes() > 0 && m < options.models.size(); ++m)
    print_row("(geometric mean)", options.models[m].name, summary.of(m));
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  inverse::bench::Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&] {
      if (++i >= argc) throw std::runtime_error(argument + " needs a value");
      return std::string(argv[i]);
    };
    if (argument == "--scenes")
      options.scenes = inverse::bench::parts(value(), ',');
    else if (argument == "--frames")
      options.frames = std::stoi(value());
    else if (argument == "--halve")
      options.halvings = std::stoi(value());
    else if (argument == "--model")
      options.models.push_back(inverse::bench::model_of(value()));
    else if (argument == "--cast") {
      const auto cast = inverse::bench::parts(value(), ',');
      for (std::size_t c = 0; c < 3; ++c) options.cast[c] = std::stof(cast.at(c));
    } else if (argument == "--video")
      options.video = true;
    else if (argument == "--eight")
      options.eight = true;
    else if (argument == "--png")
      options.png = value();
    else if (argument == "--each")
      options.each = true;
    else
      options.data = argument;
  }
  if (options.data.empty()) throw std::runtime_error("usage: global-accuracy DATA [options]");
  if (options.models.empty())
    for (const char* name : {"house", "gray", "blur", "global"})
      options.models.push_back(inverse::bench::model_of(name));
  inverse::bench::run(options);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "global-accuracy: %s\n", error.what());
  return 1;
}
