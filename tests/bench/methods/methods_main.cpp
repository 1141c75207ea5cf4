// SPDX-License-Identifier: LGPL-2.1-or-later
// bench-methods: the project's own methods on one Vulkan device. Needs only the kernels, libvulkan
// and the C++ runtime, and reads flat dumps, so that it can be copied to another machine:
//
//   bench-methods --data FOLDER --out FILE.json [--full] …     INVERSE_DEVICE names the device
#include <cstdio>
#include <exception>

#include "methods.hpp"

int main(int argc, char** argv) {
  using namespace inverse;
  using namespace inverse::bench;
  try {
    DeviceSession session("");
    return run_bench(argc, argv, session.device()->name(),
                     {intrinsicdecomp(session), globalintrinsic(session),
                      globalintrinsicthesis(session), thesis(session, ThesisParams::Solver::pcg),
                      thesis(session, ThesisParams::Solver::schwarz), indirect_guesses(session)});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench-methods: %s\n", error.what());
    return 1;
  }
}
