// SPDX-License-Identifier: LGPL-2.1-or-later
// Edits against the truth: a frame is decomposed, edited and composed, and compared with the same
// scene rendered again with other paint.
//
//   edit-bench EDITS [--png FOLDER]
//
// EDITS is the output of edit-scenes. Prints two tables; --png writes a strip of images for each
// pair: before, truth, then the edits in the order of the table. Strips of despill show the subject
// over the true background and end with the unedited frame.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>

#include "frame_layers.hpp"
#include "kernels/edit/light_edit.hpp"
#include "kernels/edit/recolor.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/metrics/png_file.hpp"
#include "tests/bench/peers/peer_despill.hpp"
#include "tests/bench/support/scene.hpp"

namespace inverse::bench {
namespace {

using Color = std::array<float, 3>;

/// A pair: input, expected result, and the edit.
struct Pair {
  std::string name;
  bool despill = false;
  Image before, after;
  Image matte;          ///< 0…1: repainted share of a pixel
  Color paint, target;  ///< reflectance of the repainted surface before and after
  Image perfect;        ///< R after times light before; empty if unknown
};

Color mean_where(const Image& image, const Image& matte) {
  std::array<double, 4> sum{};
  for (std::size_t i = 0; i < matte.data.size(); ++i) {
    if (matte.data[i] < 0.99F) continue;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += image.data[3 * i + c];
    sum[3] += 1;
  }
  if (sum[3] == 0) throw std::runtime_error("nothing is repainted");
  return {float(sum[0] / sum[3]), float(sum[1] / sum[3]), float(sum[2] / sum[3])};
}

float mean(const Color& color) { return (color[0] + color[1] + color[2]) / 3; }
Color operator*(float factor, Color color) {
  for (float& v : color) v *= factor;
  return color;
}

/// A pair of edit-scenes. The matte is the relative change of a pixel's reflectance.
Pair rendered_pair(const Scene& scene) {
  const TruthFrame &before = scene.frames.at(0), &after = scene.frames.at(1);
  const auto change = [&](std::size_t i) {
    float max = 0;
    for (std::size_t c = 0; c < 3; ++c)
      max = std::max(
          max, std::abs(after.reflectance.data[3 * i + c] - before.reflectance.data[3 * i + c]));
    return max;
  };
  Pair pair{scene.name, scene.regime == "despill", before.input, after.input, before.id, {}, {},
            {}};
  std::vector<float> changes;
  for (std::size_t i = 0; i < pair.matte.data.size(); ++i)
    if (pair.matte.data[i] > 0) changes.push_back(change(i));
  std::nth_element(changes.begin(), changes.begin() + long(changes.size() / 2), changes.end());
  for (std::size_t i = 0; i < pair.matte.data.size(); ++i)
    pair.matte.data[i] = std::min(1.0F, change(i) / changes[changes.size() / 2]);
  pair.paint = mean_where(before.reflectance, pair.matte);
  pair.target = mean_where(after.reflectance, pair.matte);
  pair.perfect = after.reflectance;
  for (std::size_t i = 0; i < pair.perfect.data.size(); ++i)
    pair.perfect.data[i] *= before.direct.data[i] + before.indirect.data[i];
  return pair;
}

/// Edits of the layers of a frame.
class Editor : public FrameLayers {
 public:
  explicit Editor(const std::shared_ptr<gpu::Device>& device, const Image& frame)
      : FrameLayers(device, frame), recolor_(device, extent()), light_(device, extent()) {}

  Image recolored(Layers layers, const RecolorParams& params, const PlanePtr& matte) {
    layers[Role::mask] = matte;
    return made(layers,
                [&](gpu::Commands& commands, Layers& l) { recolor_.record(commands, l, params); });
  }
  Image relit(Layers layers, const LightEdit::Key& key, const Color& target) {
    return made(layers, [&](gpu::Commands& commands, Layers& l) {
      light_.change(commands, l, key, target, 1, nullptr);
    });
  }

 private:
  Recolor recolor_;
  LightEdit light_;
};

/// 1 if paint is unchanged; with `spill` only where light changes by more than 2 %, too.
Image unchanged_paint(const Pair& pair, bool spill) {
  constexpr float kSeen = 0.02F;
  Image out = pair.matte;
  for (std::size_t i = 0; i < out.data.size(); ++i) {
    float difference = 0, level = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const float a = pair.before.data[3 * i + c], b = pair.after.data[3 * i + c];
      difference = std::max(difference, std::abs(a - b)), level = std::max({level, a, b});
    }
    out.data[i] = pair.matte.data[i] == 0 && (!spill || difference > kSeen * level) ? 1.0F : 0.0F;
  }
  return out;
}

struct Edit {
  std::string name;
  Image picture;
  float amount = 0;  ///< set by hand; 0: none
};

/// Colors as a user reads them off the layer, and the target in the scale of that layer.
RecolorParams from_layer(Editor& editor, const Pair& pair, const Layers& layers,
                         RecolorParams params) {
  params.key = mean_where(editor.reflectance(layers), pair.matte);
  params.target = mean(params.key) / mean(pair.paint) * pair.target;
  return params;
}

LightEdit::Key spill_key(Editor& editor, const Pair& pair, const Layers& layers) {
  const LightEdit::Key defaults{{}, 0.7F, 0.5F};  // of intrinsicdespill
  return {mean_where(editor.reflectance(layers), pair.matte), defaults.tolerance,
          defaults.softness};
}

/// Score of the edit with the best of several hand-set amounts of indirect light.
Edit best_amount(const Pair& pair, const std::function<Image(float)>& edit) {
  const Image truth = displayed(pair.after), spill = unchanged_paint(pair, true);
  Edit best;
  double best_score = -1;
  for (const float amount : {0.3F, 0.45F, 0.6F, 0.8F, 1.0F, 1.25F, 1.6F}) {
    Image picture = edit(amount);
    const double found = psnr(displayed(picture), truth, spill);
    if (found <= best_score) continue;
    best_score = found;
    best = {"globalintrinsic, best amount", std::move(picture), amount};
  }
  return best;
}

std::vector<Edit> recolored(Editor& editor, const Pair& pair) {
  RecolorParams by_key;  // defaults of the element
  by_key.use_mask = false;
  RecolorParams by_mask;
  constexpr float kAnyColor = 4.5F;
  by_mask.tolerance = kAnyColor;
  const PlanePtr matte = editor.upload(pair.matte);
  std::vector<Edit> edits{{"nothing", pair.before}};
  if (!pair.perfect.empty()) edits.push_back({"true R and S, light stays", pair.perfect});
  const std::pair<const char*, Layers> sources[] = {{"the picture itself", editor.no_layers()},
                                                    {"intrinsicdecomp", editor.two_layers()},
                                                    {"globalintrinsic", editor.all_layers()}};
  for (const auto& [name, layers] : sources) {
    const auto edit = [&, &from = layers](const RecolorParams& params) {
      return editor.recolored(from, from_layer(editor, pair, from, params), matte);
    };
    edits.push_back({std::string(name) + ", mask", edit(by_mask)});
    edits.push_back({std::string(name) + ", key", edit(by_key)});
  }
  edits.push_back(best_amount(pair, [&](float amount) {
    const Layers layers = editor.all_layers(amount);
    return editor.recolored(layers, from_layer(editor, pair, layers, by_mask), matte);
  }));
  edits.back().name += ", mask";
  return edits;
}

std::vector<Edit> despilled(Editor& editor, const Pair& pair) {
  const Layers layers = editor.all_layers();
  const LightEdit::Key key = spill_key(editor, pair, layers);
  const float ratio = mean(pair.target) / mean(pair.paint);
  const Color gray{ratio, ratio, ratio};
  std::vector<Edit> edits{{"nothing", pair.before},
                          {"ffmpeg despill", ffmpeg_despill(pair.before)},
                          {"green limit", green_limit(pair.before)},
                          {"GStreamer alpha method=green", gst_alpha_green(pair.before)},
                          {"globalintrinsic, keep=1", editor.relit(layers, key, {1, 1, 1})},
                          {"globalintrinsic, to gray", editor.relit(layers, key, gray)}};
  edits.push_back(best_amount(pair, [&](float amount) {
    const Layers found = editor.all_layers(amount);
    return editor.relit(found, spill_key(editor, pair, found), gray);
  }));
  edits.back().name += ", to gray";
  return edits;
}

void write_strip(const std::string& folder, const Pair& pair, const std::vector<Edit>& edits) {
  std::vector<const Image*> parts{&pair.before, &pair.after};
  for (const Edit& edit : edits)
    if (&edit != &edits.front()) parts.push_back(&edit.picture);
  if (pair.despill) parts.push_back(&pair.before);
  const int w = pair.before.width, h = pair.before.height;
  Image strip(w * int(parts.size()), h, 3);
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int c = 0; c < 3; ++c) {
          const float truth = pair.after.at(x, y, c), seen = parts[k]->at(x, y, c);
          strip.at(int(k) * w + x, y, c) =
              pair.despill && k > 0 ? seen + pair.matte.at(x, y) * (truth - seen) : seen;
        }
  std::string name = pair.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  std::filesystem::create_directories(folder);
  write_png(folder + "/" + name + ".png", strip);
}

/// Scores of edits and pairs, in order of occurrence. Frames of one sequence count as one pair:
/// means.
class Table {
 public:
  void add(const Pair& pair, const std::vector<Edit>& edits) {
    const std::string column = pair.name.substr(0, pair.name.find_last_not_of(" 0123456789") + 1);
    if (columns_.empty() || columns_.back() != column) columns_.push_back(column);
    const Image truth = displayed(pair.after), spill = unchanged_paint(pair, true);
    const Image whole = pair.despill ? unchanged_paint(pair, false) : Image{};
    for (const Edit& edit : edits) {
      if (std::find(rows_.begin(), rows_.end(), edit.name) == rows_.end())
        rows_.push_back(edit.name);
      const Image picture = displayed(edit.picture);
      Scores& scores = cells_[{edit.name, column}];
      scores.whole += psnr(picture, truth, whole), scores.ssim += ssim(picture, truth, whole);
      scores.spill += psnr(picture, truth, spill), scores.spill_ssim += ssim(picture, truth, spill);
      scores.amount += double(edit.amount), scores.count += 1;
    }
  }
  void print(const char* title) const {
    std::printf("| %s |", title);
    for (const std::string& column : columns_) std::printf(" %s |", column.c_str());
    std::printf("\n|%s\n",
                [&] {
                  std::string line = "---|";
                  for (std::size_t k = 0; k < columns_.size(); ++k) line += "---|";
                  return line;
                }()
                    .c_str());
    for (const std::string& row : rows_) {
      std::printf("| %s |", row.c_str());
      for (const std::string& column : columns_) {
        const auto found = cells_.find({row, column});
        if (found == cells_.end()) {
          std::printf(" – |");
          continue;
        }
        const Scores& s = found->second;
        std::printf(" %.1f / %.3f / %.1f / %.3f", s.whole / s.count, s.ssim / s.count,
                    s.spill / s.count, s.spill_ssim / s.count);
        if (s.amount > 0) std::printf(" (%.2g)", s.amount / s.count);
        std::printf(" |");
      }
      std::printf("\n");
    }
    std::printf("\n");
  }

 private:
  struct Scores {
    double whole = 0, ssim = 0, spill = 0, spill_ssim = 0, amount = 0, count = 0;
  };
  std::vector<std::string> rows_, columns_;
  std::map<std::pair<std::string, std::string>, Scores> cells_;
};

void run(const std::string& edits, const std::string& png) {
  std::vector<Pair> pairs;
  for (const Scene& scene : read_scenes(edits)) pairs.push_back(rendered_pair(scene));
  const std::shared_ptr<gpu::Device> device = gpu::Device::open("");
  Table tables[2];
  for (const Pair& pair : pairs) {
    Editor editor(device, pair.before);
    const std::vector<Edit> found =
        pair.despill ? despilled(editor, pair) : recolored(editor, pair);
    tables[pair.despill].add(pair, found);
    if (!png.empty()) write_strip(png, pair, found);
  }
  tables[0].print("recolor: PSNR / SSIM, then both of the spill");
  tables[1].print("despill: the same of what stays");
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  std::string edits, png;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--png" && i + 1 < argc)
      png = argv[++i];
    else
      edits = argument;
  }
  if (edits.empty()) throw std::runtime_error("usage: edit-bench EDITS [--png FOLDER]");
  inverse::bench::run(edits, png);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "edit-bench: %s\n", error.what());
  return 1;
}
