// SPDX-License-Identifier: LGPL-2.1-or-later
// metrics A B
//
// Compares an estimate A with the truth B, the first frames of flat dumps (flat_file.hpp), and
// prints every measure as JSON. Measures of one image; scale-invariant ones as metrics.hpp defines
// them.
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "flat_file.hpp"
#include "metrics.hpp"

namespace inverse::bench {
namespace {

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
  if (argc != 3) throw std::runtime_error("usage: metrics ESTIMATE TRUTH");
  const Image a = read_flat(argv[1]).frames.at(0), b = read_flat(argv[2]).frames.at(0), mask;
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
