// SPDX-License-Identifier: LGPL-2.1-or-later
// metrics A B [--mask M] [--srgb] [--frame N]
//
// Compares an estimate A with the truth B and prints every measure as JSON. Files are PNG or flat
// dumps (flat_file.hpp; frame N of it, from 0). --srgb takes 8-bit PNG through the sRGB curve to
// linear light. Measures of one image; scale-invariant ones as metrics.hpp defines them.
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "flat_file.hpp"
#include "metrics.hpp"
#include "png_file.hpp"

namespace inverse::bench {
namespace {

Image load(const std::string& path, bool srgb, std::size_t frame) {
  if (path.ends_with(".png") || path.ends_with(".PNG")) return read_png(path, srgb);
  FlatFile file = read_flat(path);
  if (frame >= file.frames.size())
    throw std::runtime_error(path + " has " + std::to_string(file.frames.size()) + " frames");
  return std::move(file.frames[frame]);
}

void print(const std::vector<std::pair<const char*, double>>& values) {
  const char* before = "{";
  for (const auto& [name, value] : values) {
    std::printf("%s\"%s\": ", before, name);
    std::printf(std::isfinite(value) ? "%.12g" : "null", value);
    before = ", ";
  }
  std::printf("}\n");
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  using namespace inverse::bench;
  std::vector<std::string> files;
  std::string mask_path;
  bool srgb = false;
  std::size_t frame = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--srgb")
      srgb = true;
    else if (argument == "--mask" && i + 1 < argc)
      mask_path = argv[++i];
    else if (argument == "--frame" && i + 1 < argc)
      frame = std::stoul(argv[++i]);
    else
      files.push_back(argument);
  }
  if (files.size() != 2)
    throw std::runtime_error("usage: metrics ESTIMATE TRUTH [--mask M] [--srgb] [--frame N]");
  const Image a = load(files[0], srgb, frame), b = load(files[1], srgb, frame);
  Image mask;
  if (!mask_path.empty()) mask = channels(load(mask_path, false, frame), 0, 1);
  print({{"mse", mse(a, b, mask)},
         {"psnr", psnr(a, b, mask)},
         {"ssim", ssim(a, b, mask)},
         {"ms_ssim", ms_ssim(a, b, mask)},
         {"scale_invariant_mse", scale_invariant_mse(a, b, mask)},
         {"lmse20", lmse(a, b, mask, 20)},
         {"lmse10", lmse(a, b, mask, 10)},
         {"dssim", dssim(a, b, mask)},
         {"whdr", whdr(a, judge(b, mask, 2000, 1))},
         {"log_distance", log_distance(a, b, mask)}});
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "metrics: %s\n", error.what());
  return 1;
}
