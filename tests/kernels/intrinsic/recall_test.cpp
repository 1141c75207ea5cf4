// SPDX-License-Identifier: LGPL-2.1-or-later
// What is known of reflectance, in the energy of intrinsicdecomp.
#include "tests/reference/intrinsic/recall.hpp"

#include "intrinsic_fixture.hpp"

namespace inverse::testing {
namespace {

class RecallTest : public IntrinsicTest {
 protected:
  struct Known {
    reference::KnownReflectance expected;
    KnownReflectance given;
  };
  /// Something known, part of it nearer or farther than the frame, or unknown, or of another color.
  /// `extreme`: with numbers as broken data have them.
  Known known_of(Extent extent, unsigned seed, float weight, bool extreme = false) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    Known known{{int(extent.width), int(extent.height), {}, {}, {}, {}, double{weight}}, {}};
    Pixels reflectance, depth, known_depth;
    for (size_t i = 0; i < extent.pixels(); ++i) {
      const float z = 0.5F + 3 * unit(random), kind = unit(random);
      depth.push_back(kind < 0.1F ? 0 : z);
      known_depth.push_back(kind > 0.9F ? 0 : kind > 0.8F ? z + 0.5F : z + 0.004F * unit(random));
      for (int c = 0; c < 3; ++c) reflectance.push_back(-3 * unit(random));
      reflectance.push_back(kind > 0.5F && kind < 0.6F ? 0 : unit(random));
      if (extreme && i % 7 == 0) {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        for (size_t c = 0; c < 3; ++c) reflectance[4 * i + c] = i % 2 ? nan : 1e30F;
        reflectance[4 * i + 3] = 0;
        depth[i] = i % 3 ? 1e30F : 65.534F;
      }
      for (size_t c = 0; c < 3; ++c)
        known.expected.log_reflectance.push_back(double{reflectance[4 * i + c]});
      known.expected.confidence.push_back(double{reflectance[4 * i + 3]});
    }
    known.expected.depth.assign(depth.begin(), depth.end());
    known.expected.known_depth.assign(known_depth.begin(), known_depth.end());
    const auto scalars = [&](const Pixels& values) {
      return upload(gpu::Element::scalar, values.data(), values.size());
    };
    known.given = {extent,         upload(reflectance),  scalars(known_depth),
                   scalars(depth), upload({1, 0, 0, 0}), weight};
    return known;
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
