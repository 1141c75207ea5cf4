// SPDX-License-Identifier: LGPL-2.1-or-later
// What strokes select, against tests/reference/image/strokes.*.
#include "kernels/edit/strokes/stroke_select.hpp"

#include "strokes_fixture.hpp"

namespace inverse::testing {
namespace {

using Kind = Stroke::Kind;

class StrokeSelectTest : public GpuTest {
 protected:
  /// The mask layer; empty: there is none.
  Pixels select(StrokeSelect& selects, const StrokesPtr& strokes, Extent extent,
                bool wanted = true) {
    const Pixels gray(4 * extent.pixels(), 0.5F);
    Layers layers{extent, {}};
    layers[Role::model] = std::make_shared<Plane>(Plane{extent, upload(gray)});
    run([&](gpu::Commands& commands) { selects.record(commands, layers, wanted, strokes, {}); });
    return layers[Role::mask] ? download(layers[Role::mask]->buffer) : Pixels();
  }
};

TEST_F(StrokeSelectTest, AgreesWithReference) {
  for (const Extent extent : {Extent{1, 1}, {5, 3}, {17, 40}, {101, 67}}) {
    const auto w = float(extent.width), h = float(extent.height);
    const StrokeList list{{{Kind::select, {{.1F * w, .2F * h}, {.8F * w, .3F * h}}, .1F * h},
                           {Kind::select, {{.5F * w, -h}, {.9F * w, 2 * h}}, .06F * h},
                           {Kind::select, {{-9 * w, 0}}, 20}},
                          extent};
    const auto lines = reference_lines(list, extent);
    const auto expected =
        reference::draw_strokes(lines, std::vector<reference::StrokeMove>(lines.size()),
                                int(extent.width), int(extent.height));
    StrokeSelect selects(device, extent);
    const Pixels mask = select(selects, std::make_shared<StrokeList>(list), extent);
    ASSERT_EQ(mask.size(), 4 * extent.pixels());
    for (size_t i = 0; i < extent.pixels(); ++i) {
      ASSERT_NEAR(mask[4 * i], expected.weight[i], 1e-3) << name_of(extent) << " " << i;
      for (size_t c = 1; c < 4; ++c) ASSERT_EQ(mask[4 * i + c], 0);
    }
  }
}

TEST_F(StrokeSelectTest, SelectsNothingWithoutStrokes) {
  const Extent extent{13, 7};
  StrokeSelect selects(device, extent);
  EXPECT_TRUE(select(selects, nullptr, extent, false).empty()) << "no mask, if none is wanted";
  const auto dot = std::make_shared<StrokeList>(StrokeList{{{Kind::select, {{6, 3}}, 3}}, extent});
  EXPECT_GT(select(selects, dot, extent)[4 * (3 * 13 + 6)], 0.9F);
  for (const float value : select(selects, nullptr, extent)) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace inverse::testing
