// SPDX-License-Identifier: LGPL-2.1-or-later
// A picture on a plane against the truth: frames are decomposed, the picture is put on the plane
// and composed, and compared with the same scene rendered again with the picture as its paint.
//
//   texture-bench BEFORE EDIT [--png FOLDER]
//
// BEFORE and EDIT have I8/NNN.png; EDIT has edit.json with the corners in each frame, the albedo
// before and the gain of bitmap.png. Prints means over frames: PSNR and SSIM of display codes, over
// pixels within the corners. The scale of the layer is read off the layer, as a user does: white is
// the gain, times mean reflectance over mean albedo there. --png writes a strip for each frame:
// before, truth, then the rows of the table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "kernels/texture/texture_edit.hpp"
#include "tests/bench/methods/frame_layers.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/metrics/png_file.hpp"

namespace inverse::bench {
namespace {

/// One frame of the pair.
struct Pair {
  std::string name;
  Image before, after;
  Corners corners;
};

/// 1 within the corners, away from their border by a pixel.
Image inside(const Pair& pair) {
  const Homography back = to_square(pair.corners);
  Image mask(pair.before.width, pair.before.height, 1);
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      bool all = true;
      for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        const Point p = mapped(back, {x + 0.5 + u, y + 0.5 + v});
        all = all && p[0] >= 0 && p[1] >= 0 && p[0] <= 1 && p[1] <= 1;
      }
      mask.at(x, y) = all ? 1.0F : 0.0F;
    }
  return mask;
}

float mean_where(const Image& image, const Image& mask) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < mask.data.size(); ++i)
    if (mask.data[i] > 0) {
      for (std::size_t c = 0; c < 3; ++c) sum += image.data[3 * i + c] / 3;
      ++count;
    }
  return float(sum / count);
}

struct Scores {
  double psnr = 0, ssim = 0;
  int count = 0;
};

void run(const std::string& before, const std::string& edit, const std::string& png) {
  std::ifstream file(edit + "/edit.json");
  const auto json = nlohmann::json::parse(file);
  const auto& parameters = json.at("parameters");
  const auto albedo = parameters.at("old_albedo").get<std::array<float, 3>>();
  const float gain = parameters.at("bitmap_gain").get<float>();
  const Image bitmap = read_png(edit + "/" + parameters.at("bitmap").get<std::string>(), true);
  const auto device = gpu::Device::open("");
  std::vector<std::string> rows;
  std::map<std::string, Scores> scores;
  for (const auto& frame : json.at("frames")) {
    char name[16];
    std::snprintf(name, sizeof name, "%03d", frame.at("frame").get<int>());
    Pair pair{name,
              read_png(before + "/I8/" + name + ".png", true),
              read_png(edit + "/I8/" + name + ".png", true),
              {}};
    pair.corners = frame.at("corners_px_TL_TR_BR_BL").get<Corners>();
    for (Point& p : pair.corners)
      for (double& v : p) v += 0.5;  // pixel centers have whole coordinates there
    const Image mask = inside(pair), truth = displayed(pair.after);
    FrameLayers frames(device, pair.before);
    const Extent size{uint32_t(bitmap.width), uint32_t(bitmap.height)};
    TexturePyramid pyramid(device, size);
    const auto texels =
        gpu::Buffer::create(device, gpu::Element::vec4, size.pixels(), gpu::Memory::upload);
    for (std::size_t i = 0; i < size.pixels(); ++i)
      for (std::size_t c = 0; c < 4; ++c)
        texels->map_as<float>()[4 * i + c] = c == 3 ? 1 : bitmap.data[3 * i + c];
    std::vector<Image> strip{pair.before, pair.after};
    const auto add = [&](const std::string& row, const Image& picture) {
      if (std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
      Scores& s = scores[row];
      s.psnr += psnr(displayed(picture), truth, mask);
      s.ssim += ssim(displayed(picture), truth, mask);
      ++s.count;
      strip.push_back(picture);
    };
    add("nothing", pair.before);
    const std::pair<const char*, Layers> sources[] = {
        {"the picture itself (naive)", frames.no_layers()},
        {"intrinsicdecomp", frames.two_layers()},
        {"globalintrinsic", frames.all_layers()}};
    for (const auto& [row, layers] : sources) {
      Layers edited = layers;
      TextureEdit texture(device, frames.extent());
      const float mean_albedo = (albedo[0] + albedo[1] + albedo[2]) / 3;
      const float white = gain * mean_where(frames.reflectance(layers), mask) / mean_albedo;
      add(row, frames.made(edited, [&](gpu::Commands& commands, Layers& l) {
        pyramid.record(commands, {size, texels});
        texture.record(commands, l, pyramid, pair.corners, {.white = white, .occlusion = false});
      }));
    }
    if (png.empty()) continue;
    std::filesystem::create_directories(png);
    strip.erase(strip.begin() + 2);  // nothing
    Image wide(pair.before.width * int(strip.size()), pair.before.height, 3);
    for (std::size_t k = 0; k < strip.size(); ++k)
      for (int y = 0; y < wide.height; ++y)
        for (int x = 0; x < pair.before.width; ++x)
          for (int c = 0; c < 3; ++c)
            wide.at(int(k) * pair.before.width + x, y, c) = strip[k].at(x, y, c);
    write_png(png + "/texture_" + pair.name + ".png", wide);
  }
  std::printf("| | PSNR, dB | SSIM |\n|---|---|---|\n");
  for (const std::string& row : rows) {
    const Scores& s = scores[row];
    std::printf("| %s | %.1f | %.3f |\n", row.c_str(), s.psnr / s.count, s.ssim / s.count);
  }
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  std::vector<std::string> folders;
  std::string png;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--png" && i + 1 < argc)
      png = argv[++i];
    else
      folders.push_back(argument);
  }
  if (folders.size() != 2)
    throw std::runtime_error("usage: texture-bench BEFORE EDIT [--png FOLDER]");
  inverse::bench::run(folders[0], folders[1], png);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "texture-bench: %s\n", error.what());
  return 1;
}
