// SPDX-License-Identifier: LGPL-2.1-or-later
// bench-peers: other methods on the processor, with Eigen and OpenCV. A program of its own, because
// OpenCV's ximgproc loads libraries that the project's programs must not link.
#include "peers.hpp"

int main(int argc, char** argv) {
  using namespace inverse::bench;
  return run_bench(argc, argv, "processor",
                   {constant_shading(), constant_reflectance(), max_channel(), gray_retinex(),
                    color_retinex(), fast_global_smoother(), domain_transform(), guided_filter(),
                    l0_smoothing(), energy_by_conjugate_gradients(), energy_by_cholesky()});
}
