#include "ladder.hpp"

namespace inverse {
namespace {

/// Resolution, cycles of the first frame and of those after it, change from which on edges are
/// decided anew, and change by a cycle that needs no further one.
template <bool kHalf, uint32_t kCycles, uint32_t kWarm, float kTolerance, float kSettled>
void work(ScaledIntrinsic::Params& params) {
  params.half_resolution = kHalf;
  params.cycles = kCycles;
  params.warm_cycles = kWarm;
  params.still_tolerance = kTolerance;
  params.settled = kSettled;
}

}  // namespace

const Ladder<ScaledIntrinsic::Params>& intrinsic_ladder() {
  static const Ladder<ScaledIntrinsic::Params> ladder{{{0.40, work<true, 3, 1, 0.1F, 0.01F>},
                                                       {0.46, work<true, 4, 2, 0.1F, 0.01F>},
                                                       {0.54, work<true, 4, 2, 0.05F, 0.01F>},
                                                       {0.65, work<true, 8, 4, 0.05F, 0.003F>},
                                                       {0.83, work<false, 4, 2, 0.1F, 0.01F>},
                                                       {1.00, work<false, 4, 2, 0.05F, 0.01F>},
                                                       {1.18, work<false, 6, 3, 0.05F, 0.005F>},
                                                       {1.36, work<false, 8, 4, 0.05F, 0.003F>},
                                                       {2.1, work<false, 12, 8, 0.05F, 0.001F>},
                                                       {4.8, work<false, 24, 24, 0.05F, 2e-4F>}},
                                                      {2, 5, 7, 9}};
  return ladder;
}

}  // namespace inverse
