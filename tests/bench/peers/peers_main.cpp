// bench-peers: other people's methods on the processor, with Eigen and OpenCV. A program of its
// own, as OpenCV's ximgproc draws in libraries that nothing else here may link.
#include "peers.hpp"

int main(int argc, char** argv) {
  using namespace inverse::bench;
  return run_bench(argc, argv, "processor",
                   {constant_shading(), constant_reflectance(), max_channel(), gray_retinex(),
                    color_retinex(), fast_global_smoother(), domain_transform(), guided_filter(),
                    l0_smoothing(), energy_by_conjugate_gradients(), energy_by_cholesky()});
}
