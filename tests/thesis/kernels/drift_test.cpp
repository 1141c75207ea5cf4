// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "tests/kernels/solve/drift_fixture.hpp"

namespace inverse::testing::drift {

class ThesisDriftTest : public DriftTest {};

TEST_F(ThesisDriftTest, ReflectanceOfWhatStaysInView) {
  check("intrinsicdecompthesis",
        [&] {
          auto method = std::make_shared<ThesisDecomposition>(device, kView);
          return [this, method](const PlanePtr& frame, bool) {
            Layers layers;
            run([&](gpu::Commands& commands) { method->record(commands, *frame, layers); });
            return download(layers[Role::intrinsic]);
          };
        },
        0.05, {3});  // half of the cells that the points lie on contain a border of tiles
}

}  // namespace inverse::testing::drift
