// SPDX-License-Identifier: LGPL-2.1-or-later
// Renders frames of the bundled clip with their ground truth. Usage:
//
//   render --size=WxH --frames=0,10,20 | --frames=0-124 --out=DIR [--samples=25] [--soft=8]
//          [--length=125] [--threads=2] --write=video|truth|flat|sheet
//
// video: DIR/NNN.rgb, 8-bit RGB with the BT.601 transfer curve; frames that exist are kept.
// truth: DIR/NNN_{input,reflectance,shading}.png; input and reflectance 8-bit sRGB, shading
//        16-bit linear with code = S / 2 · 65535.
// flat:  DIR/clip.f32, all frames in one file: the text line "F32 width height 9 frames", then
//        little-endian float32, frame by frame, row by row, nine values a pixel: input,
//        reflectance, shading as linear RGB with input = reflectance · shading.
// sheet: DIR/NNN_sheet.png, input, reflectance and shading (halved) side by side, 8-bit sRGB.

#include <bit>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "denoise.hpp"
#include "image_files.hpp"
#include "still_life.hpp"
#include "transport.hpp"

namespace inverse::clip {
namespace {

constexpr float kShadingScale = 0.5f;
constexpr int kDenoisePasses = 4;

struct Options {
  int width = 640, height = 480, length = 125, threads = 2;
  Quality quality;
  std::vector<int> frames;
  std::filesystem::path out = ".";
  std::string write = "video";
};

std::vector<int> parse_frames(const std::string& text) {
  std::vector<int> frames;
  for (size_t start = 0; start < text.size();) {
    size_t end = std::min(text.find(',', start), text.size());
    int first = 0, last = 0;
    std::string item = text.substr(start, end - start);
    int read = std::sscanf(item.c_str(), "%d-%d", &first, &last);
    if (read < 1) throw std::runtime_error("--frames: cannot read '" + item + "'");
    for (int frame = first; frame <= (read == 2 ? last : first); ++frame) frames.push_back(frame);
    start = end + 1;
  }
  return frames;
}

Options parse(int argc, char** argv) {
  std::map<std::string, std::string> given;
  for (int i = 1; i < argc; ++i) {
    std::string argument = argv[i];
    size_t equals = argument.find('=');
    if (!argument.starts_with("--") || equals == std::string::npos) {
      throw std::runtime_error("expected --name=value, got '" + argument + "'");
    }
    given[argument.substr(2, equals - 2)] = argument.substr(equals + 1);
  }
  Options options;
  for (const auto& [name, value] : given) {
    if (name == "size") {
      if (std::sscanf(value.c_str(), "%dx%d", &options.width, &options.height) != 2) {
        throw std::runtime_error("--size takes WIDTHxHEIGHT, got '" + value + "'");
      }
    } else if (name == "frames") {
      options.frames = parse_frames(value);
    } else if (name == "out") {
      options.out = value;
    } else if (name == "write") {
      options.write = value;
    } else if (name == "samples") {
      options.quality.samples = std::stoi(value);
    } else if (name == "soft") {
      options.quality.soft_samples = std::stoi(value);
    } else if (name == "length") {
      options.length = std::stoi(value);
    } else if (name == "threads") {
      options.threads = std::stoi(value);
    } else {
      throw std::runtime_error("unknown option --" + name);
    }
  }
  if (options.width < 1 || options.height < 1 || options.length < 2 || options.threads < 1 ||
      options.quality.samples < 1 || options.quality.soft_samples < 1) {
    throw std::runtime_error("sizes, counts and threads must be positive");
  }
  static const std::set<std::string> kinds{"video", "truth", "flat", "sheet"};
  if (!kinds.contains(options.write)) {
    throw std::runtime_error("--write takes video, truth, flat or sheet");
  }
  if (options.frames.empty()) throw std::runtime_error("--frames is missing");
  return options;
}

struct Decomposed {
  std::vector<Vec3> input, reflectance, shading;
};

Decomposed decompose(const Options& options, int frame) {
  float time = static_cast<float>(frame) / static_cast<float>(options.length - 1);
  Layers layers =
      render(still_life(time), options.width, options.height, options.quality, options.threads);
  denoise(layers, kDenoisePasses, options.threads);
  Decomposed result;
  for (size_t i = 0; i < layers.reflectance.size(); ++i) {
    float window = layers.window[i];
    Vec3 shading = layers.lamp[i] + Vec3{window, window, window} + layers.indirect[i];
    result.shading.push_back(shading);
    result.input.push_back(layers.reflectance[i] * shading);
  }
  result.reflectance = std::move(layers.reflectance);
  return result;
}

std::string numbered(int frame, const char* suffix) {
  char name[64];
  std::snprintf(name, sizeof name, "%03d%s", frame, suffix);
  return name;
}

void write_video(const Options& options, int frame, const Decomposed& layers) {
  auto bytes = to_bytes(layers.input, encode_video);
  auto partial = options.out / numbered(frame, ".part");  // so that a frame is there or is not
  write_bytes(partial, bytes.data(), bytes.size());
  std::filesystem::rename(partial, options.out / numbered(frame, ".rgb"));
}

void write_truth(const Options& options, int frame, const Decomposed& layers) {
  int w = options.width, h = options.height;
  write_png8(options.out / numbered(frame, "_input.png"), layers.input, w, h);
  write_png8(options.out / numbered(frame, "_reflectance.png"), layers.reflectance, w, h);
  write_png16(options.out / numbered(frame, "_shading.png"), layers.shading, w, h, kShadingScale);
}

void write_sheet(const Options& options, int frame, const Decomposed& layers) {
  std::vector<Vec3> sheet;
  for (int y = 0; y < options.height; ++y) {
    size_t row = static_cast<size_t>(y) * options.width;
    for (const auto* plane : {&layers.input, &layers.reflectance, &layers.shading}) {
      float scale = plane == &layers.shading ? kShadingScale : 1;
      for (int x = 0; x < options.width; ++x) sheet.push_back((*plane)[row + x] * scale);
    }
  }
  write_png8(options.out / numbered(frame, "_sheet.png"), sheet, 3 * options.width, options.height);
}

void append_flat(std::vector<char>& flat, const Decomposed& layers) {
  static_assert(std::endian::native == std::endian::little && sizeof(Vec3) == 12);
  for (size_t i = 0; i < layers.input.size(); ++i) {
    for (const auto* plane : {&layers.input, &layers.reflectance, &layers.shading}) {
      const char* bytes = reinterpret_cast<const char*>(&(*plane)[i]);
      flat.insert(flat.end(), bytes, bytes + sizeof(Vec3));
    }
  }
}

void run(const Options& options) {
  std::filesystem::create_directories(options.out);
  std::string header = "F32 " + std::to_string(options.width) + " " +
                       std::to_string(options.height) + " 9 " +
                       std::to_string(options.frames.size()) + "\n";
  std::vector<char> flat(header.begin(), header.end());
  for (int frame : options.frames) {
    bool video = options.write == "video";
    if (video && std::filesystem::exists(options.out / numbered(frame, ".rgb"))) continue;
    auto start = std::chrono::steady_clock::now();
    Decomposed layers = decompose(options, frame);
    if (video) write_video(options, frame, layers);
    if (options.write == "truth") write_truth(options, frame, layers);
    if (options.write == "sheet") write_sheet(options, frame, layers);
    if (options.write == "flat") append_flat(flat, layers);
    std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::fprintf(stderr, "frame %d: %.1f s\n", frame, seconds.count());
  }
  if (options.write == "flat") {
    write_bytes(options.out / "clip.f32", flat.data(), flat.size());
  }
}

}  // namespace
}  // namespace inverse::clip

int main(int argc, char** argv) {
  try {
    inverse::clip::run(inverse::clip::parse(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "render: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
