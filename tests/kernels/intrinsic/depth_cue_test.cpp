// SPDX-License-Identifier: LGPL-2.1-or-later
// What remembered surfaces change of the edges of intrinsicdecomp.
#include "tests/reference/intrinsic/depth_cue.hpp"

#include "intrinsic_fixture.hpp"

namespace inverse::testing {
namespace {

class DepthCueTest : public IntrinsicTest {
 protected:
  struct Known {
    KnownReflectance given;
    reference::SeenSurface expected;
  };
  /// Faces of some pixels with normals of their own, steps of depth, holes, and things in front.
  Known known_of(Extent extent, unsigned seed, bool extreme) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(0, 1);
    Known known{{}, {int(extent.width), int(extent.height), {}, {}, {}, 200}};
    Pixels surface, depth, known_depth;
    struct Face {
      std::array<float, 3> normal;
      float z, front;
    };
    std::vector<Face> faces(40);
    for (Face& face : faces) {
      const float x = unit(random) - 0.5F, y = unit(random) - 0.5F, length = std::hypot(x, y, 1.0F);
      face = {{x / length, y / length, -1 / length},
              1 + (unit(random) < 0.7F ? 0.06F : 2.0F) * unit(random),
              unit(random) < 0.2F ? 0.5F : 0};
    }
    for (size_t i = 0; i < extent.pixels(); ++i) {
      const size_t x = i % extent.width, y = i / extent.width;
      const Face& face = faces[(x / 7 * 5 + y / 6 * 11) % faces.size()];
      const float hole = unit(random);
      std::array<float, 4> s{face.normal[0], face.normal[1], face.normal[2],
                             face.z * (1 + 0.002F * unit(random))};
      if (hole < 0.05F) s = {};
      float here = hole > 0.9F ? 0 : s[3] - face.front;
      if (extreme && i % 11 == 0) {
        const float nan = std::numeric_limits<float>::quiet_NaN(), huge = 1e30F;
        const std::array<float, 4> broken[] = {
            {nan, 0, -1, 1}, {0, 0, -1, nan}, {0, 0, -1, huge}, {huge, huge, 0, 1},
            {0, 0, 0, 1},    {0, 0, -1, 0},   {0, 0, -1, -1},   {0, 0, -1, 1e-30F}};
        s = broken[i / 11 % std::size(broken)];
        here = i % 2 ? huge : 65.534F;
      }
      surface.insert(surface.end(), s.begin(), s.end());
      depth.push_back(here);
      known_depth.push_back(s[3]);
      known.expected.normal.push_back({double{s[0]}, double{s[1]}, double{s[2]}});
      known.expected.known_depth.push_back(double{s[3]});
      known.expected.depth.push_back(double{here});
    }
    known.given.extent = extent;
    known.given.surface = upload(surface);
    known.given.depth = upload(gpu::Element::scalar, depth.data(), depth.size());
    known.given.known_depth = upload(gpu::Element::scalar, known_depth.data(), known_depth.size());
    known.given.valid = upload({1, 0, 0, 0});
    known.given.focal = 200;
    return known;
  }
};

TEST_F(DepthCueTest, AgreesWithReference) {
  for (unsigned seed = 0; const Extent extent : kOddSizes) {
    const Pixels pixels = scene(extent, ++seed);
    const auto guide = guide_of(extent, pixels);
    const auto frame = plane(extent, pixels);
    Guide made(device, extent);
    EdgePrior prior(device, extent);
    DepthCue cue(device, extent);
    EdgePrior::Target target = prior_target(extent);
    target.depth = &cue;
    // Of the frame's size, smaller, and larger.
    for (const Extent size : {extent, half_of(extent), Extent{2 * extent.width + 1, extent.height}})
      for (const bool extreme : {false, true})
        for (const auto& [valid, weight] : {std::pair{1.0F, 1.0F}, {1.0F, 3.0F}, {0.0F, 1.0F}}) {
          Known known = known_of(size, seed, extreme);
          known.given.valid = upload({valid, 0, 0, 0});
          const auto before = reference::edge_prior(guide, {});
          auto expected = before;
          if (valid > 0) reference::apply_depth(guide, known.expected, double{weight}, expected);
          if (valid > 0 && extent.pixels() > 1000) {
            EXPECT_NE(expected.b_right, before.b_right);
          }
          cue.set(&known.given, false);
          EdgePrior::Params params;
          params.depth_weight = weight;
          run([&](gpu::Commands& commands) {
            commands.fill(target.system);
            made.record(commands, frame.buffer, nullptr);
            prior.record(commands, made, target, params);
          });
          expect_prior(target, guide, expected, name_of(extent) + " by " + name_of(size));
        }
  }
}

// Edges follow a view that changes, and are reused while it is kept.
TEST_F(DepthCueTest, EdgesAreReusedWhileTheViewIsKept) {
  const Extent extent{64, 48};
  const Pixels pixels = scene(extent, 3);
  const auto frame = plane(extent, pixels);
  Guide made(device, extent);
  EdgePrior prior(device, extent);
  DepthCue cue(device, extent);
  EdgePrior::Target target = prior_target(extent);
  target.depth = &cue;
  const auto evaluated = [&](unsigned seed, uint32_t outdated, bool continues = true) {
    Known known = known_of(extent, seed, false);
    known.given.outdated = upload(gpu::Element::word, &outdated, 1);
    cue.set(&known.given, continues);
    if (!continues) prior.reset();
    run([&](gpu::Commands& commands) {
      made.record(commands, frame.buffer, nullptr);
      prior.record_changes(commands, made, target, {}, 0.05F);
    });
    const Pixels words = download(prior.evaluated());
    uint32_t count = 0;
    memcpy(&count, words.data(), sizeof count);
    return count;
  };
  EXPECT_EQ(evaluated(1, 1), prior.tiles());
  const Pixels first = download(target.system);
  EXPECT_EQ(evaluated(2, 0), 0U);
  EXPECT_EQ(download(target.system), first);
  EXPECT_EQ(evaluated(2, 1), prior.tiles());
  EXPECT_NE(download(target.system), first);
  EXPECT_EQ(evaluated(1, 0, false), prior.tiles()) << "of a view that was kept for others";
  EXPECT_EQ(download(target.system), first);
}

}  // namespace
}  // namespace inverse::testing
