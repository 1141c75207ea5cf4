#include "ladder.hpp"

namespace inverse {
namespace {

template <int kIrls, int kPcg>
void work(ThesisParams& params) {
  params.irls_iterations = kIrls;
  params.pcg_iterations = kPcg;
}

}  // namespace

const Ladder<ThesisParams>& thesis_ladder() {
  static const Ladder<ThesisParams> ladder{{{0.26, work<1, 4>},
                                            {0.32, work<1, 8>},
                                            {0.61, work<2, 8>},
                                            {0.77, work<3, 8>},
                                            {1.00, work<4, 8>},
                                            {1.66, work<7, 8>},
                                            {6.6, work<16, 16>}},
                                           {2, 4, 5, 6}};
  return ladder;
}

}  // namespace inverse
