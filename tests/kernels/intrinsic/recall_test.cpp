// SPDX-License-Identifier: LGPL-2.1-or-later
// What is known of reflectance, in the energy of intrinsicdecomp.
#include "intrinsic_fixture.hpp"
#include "tests/kernels/known_reflectance.hpp"

namespace inverse::testing {
namespace {

class RecallTest : public IntrinsicTest {
 protected:
  Known known_of(Extent extent, unsigned seed, float weight, bool extreme = false) {
    return testing::known_of(Lab(device), extent, seed, weight, extreme);
  }
};

TEST_F(RecallTest, AgreesWithReference) {
  for (unsigned seed = 0; const Extent extent : kOddSizes) {
    const Pixels pixels = scene(extent, ++seed);
    const auto guide = guide_of(extent, pixels);
    const auto frame = plane(extent, pixels);
    Guide made(device, extent);
    EdgePrior prior(device, extent);
    Recall recall(device, made.cell_extent());
    EdgePrior::Target target = prior_target(extent);
    // Of the frame's size, smaller, and larger.
    for (const Extent size : {extent, half_of(extent), Extent{2 * extent.width + 1, extent.height}})
      for (const bool extreme : {false, true})
        for (const float valid : {1.0F, 0.0F}) {
          Known known = known_of(size, seed, 2, extreme);
          known.given.valid = upload({valid, 0, 0, 0});
          auto expected = reference::edge_prior(guide, {});
          if (valid > 0) reference::recall(guide, known.expected, -1.25, expected);
          const auto scale = upload({-1.25, 1, 0, 0});
          EdgePrior::Target changed = target;
          run([&](gpu::Commands& commands) {
            commands.fill(target.system);
            made.record(commands, frame.buffer, nullptr);
            prior.record(commands, made, target, {});
            changed.value = recall.record(commands, made, target.value, scale, known.given);
          });
          expect_prior(changed, guide, expected, name_of(extent) + " by " + name_of(size));
        }
  }
}

// A reflectance that is known with a large weight is that of the layers.
TEST_F(RecallTest, LayersTakeWhatIsKnown) {
  const Extent extent{64, 48};
  const Pixels pixels = scene(extent, 4);
  IntrinsicDecomposition method(device, extent);
  const auto frame = input(extent, pixels);
  const auto layers_of = [&](const IntrinsicDecomposition::FrameInfo& info) {
    PlanePtr layers;
    run([&](gpu::Commands& commands) {
      layers = method.record(commands, frame, {}, info)[Role::intrinsic];
    });
    return download(layers->buffer);
  };
  // The first frame's own reflectance, half as bright on the left.
  const Pixels first = layers_of({});
  Pixels reflectance;
  const auto change = [&](size_t i) { return i % extent.width < extent.width / 2 ? -0.7F : 0.0F; };
  for (size_t i = 0; i < extent.pixels(); ++i) {
    for (size_t c = 0; c < 3; ++c)
      reflectance.push_back(std::log(std::max(first[4 * i + c], 1e-3F)) + change(i));
    reflectance.push_back(1);
  }
  const Pixels depth(extent.pixels(), 1.5F);
  const auto depths = upload(gpu::Element::scalar, depth.data(), depth.size());
  const KnownReflectance known{extent, upload(reflectance),  depths,
                               depths, upload({1, 0, 0, 0}), 100};
  Pixels held;
  for (int k = 0; k < 20; ++k) held = layers_of({.known = &known});  // temporal hold is slow
  double left = 0, right = 0;
  for (size_t i = 0; i < extent.pixels(); ++i) {
    const double step = std::log(double{held[4 * i]} / double{first[4 * i]});
    const uint32_t x = i % extent.width;
    if (x < extent.width / 2 - 8) left += step / double((extent.width / 2 - 8) * extent.height);
    if (x >= extent.width / 2 + 8) right += step / double((extent.width / 2 - 8) * extent.height);
  }
  EXPECT_NEAR(left - right, -0.7, 0.07);
}

}  // namespace
}  // namespace inverse::testing
