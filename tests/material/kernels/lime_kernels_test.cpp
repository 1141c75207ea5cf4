// SPDX-License-Identifier: LGPL-2.1-or-later
// What lies between the networks of limematerial against its reference.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include "kernels/material/layers/guided_layers.hpp"
#include "kernels/material/layers/under_highlights.hpp"
#include "kernels/material_layers_layers.spv.hpp"
#include "kernels/material_networks_crop.spv.hpp"
#include "kernels/material_networks_drop_foreign.spv.hpp"
#include "kernels/material_networks_to_exponent.spv.hpp"
#include "kernels/material_networks_to_mirror_and_albedo.spv.hpp"
#include "kernels/material_networks_to_specular.spv.hpp"
#include "kernels/material_preview_preview.spv.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/material/reference/lime.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

using Push = shaders::material_networks_crop::Push;  // and of layers.comp

/// Frames and squares of them: inside, reaching over the border, of less than a pixel a point, and
/// of so many that not each is read.
struct Case {
  Extent extent;
  Push place;
};
Push push(Extent extent, float x, float y, float pixels) {
  return {.size = extent, .corner = {x, y}, .pixels = pixels, .side = 32};
}
const std::vector<Case> kCases = {
    {{64, 48}, push({64, 48}, 8, 4, 1)},        {{64, 48}, push({64, 48}, -20.25F, -9.5F, 3.7F)},
    {{17, 5}, push({17, 5}, 2.5F, -6, .4F)},    {{349, 287}, push({349, 287}, 11.3F, 7.7F, 8.9F)},
    {{1, 1}, push({1, 1}, 0, 0, 1.F / 32)},     {{700, 700}, push({700, 700}, 0, 0, 21.875F)},
    {{40, 30}, push({40, 30}, 500, 500, 1.5F)},  // nothing of it is in the frame
};

class LimeKernels : public GpuTest {
 protected:
  reference::LimeSquare square(const Push& push) {
    return {double{push.corner[0]}, double{push.corner[1]}, double{push.pixels}, push.side};
  }
  /// Points behind one zero, as networks have them.
  gpu::BufferPtr points(const Pixels& pixels) {
    Pixels padded(4, 0.F);
    padded.insert(padded.end(), pixels.begin(), pixels.end());
    return upload(padded);
  }
  Pixels download_points(const gpu::BufferPtr& buffer) {
    Pixels all = download(buffer);
    return {all.begin() + 4, all.end()};
  }
};

/// What a frame must not bring down.
Pixels with_extremes(Pixels pixels, unsigned seed) {
  std::mt19937 random(seed);
  const float bad[] = {kNan, -kInf, kInf, -3, 1e30F, 0, 1e-30F};
  for (size_t i = 0; i < pixels.size(); i += 1 + random() % 23) pixels[i] = bad[random() % 7];
  return pixels;
}

TEST_F(LimeKernels, SquareOfTheFrame) {
  unsigned seed = 1;
  for (const auto& [extent, place] : kCases)
    for (const bool extreme : {false, true}) {
      const Pixels plain = random_pixels(extent, ++seed);
      const Pixels frame = extreme ? with_extremes(plain, seed) : plain;
      const gpu::BufferPtr out = buffer(1 + 32 * 32);
      run([&](gpu::Commands& commands) {
        commands.dispatch(gpu::Program<shaders::material_networks_crop>(device),
                          {.frame = plane(extent, frame).buffer, .image = out}, place, {32 * 32});
      });
      expect_near(download_points(out),
                  reference::lime_crop(to_reference(extent, frame), square(place)), 2e-4,
                  "frame of " + std::to_string(extent.width));
    }
}

TEST_F(LimeKernels, ForeignPointsAreOfNoObject) {
  const Extent side{33, 31};
  const Pixels probability = with_extremes(random_pixels(side, 9), 9);
  std::vector<uint32_t> foreign(side.pixels());
  std::mt19937 random(9);
  for (uint32_t& word : foreign) word = random() % 3 ? 0 : random();
  const gpu::BufferPtr given = points(probability);
  run([&](gpu::Commands& commands) {
    commands.dispatch(gpu::Program<shaders::material_networks_drop_foreign>(device),
                      {.probability = given,
                       .foreign = upload(gpu::Element::word, foreign.data(), foreign.size())},
                      {.count = static_cast<int32_t>(side.pixels())},
                      {static_cast<uint32_t>(side.pixels())});
  });
  const Pixels got = download_points(given);
  const auto expected = reference::lime_drop_foreign(to_reference(side, probability), foreign);
  for (size_t i = 0; i < got.size(); ++i) {
    const auto wanted = static_cast<float>(expected.data[i / 4][i % 4]);
    ASSERT_TRUE(got[i] == wanted || std::isnan(wanted)) << i;
  }
}

TEST_F(LimeKernels, PictureOfTheObject) {
  const Extent side{32, 32};
  const Pixels image = random_pixels(side, 3), probability = random_pixels(side, 4);
  const gpu::BufferPtr out = buffer(1 + side.pixels());
  run([&](gpu::Commands& commands) {
    commands.dispatch(gpu::Program<shaders::material_networks_to_specular>(device),
                      {.image = points(image), .probability = points(probability), .result = out},
                      {.count = static_cast<int32_t>(side.pixels())},
                      {static_cast<uint32_t>(side.pixels())});
  });
  expect_near(
      download_points(out),
      reference::lime_to_specular(to_reference(side, image), to_reference(side, probability)), 1e-6,
      "masked");
}

/// Codes as no network should give them, but may.
Pixels extreme_codes(Extent side, unsigned seed) {
  Pixels codes = random_pixels(side, seed, -2, 9);
  const float far[] = {1e30F, -1e30F, 0, 1e-30F};
  std::mt19937 random(seed);
  for (size_t i = 0; i < codes.size(); i += 1 + random() % 17) codes[i] = far[random() % 4];
  return codes;
}

TEST_F(LimeKernels, OutputsOfTheSecondAndThirdNetwork) {
  const Extent side{32, 32};
  const auto count = static_cast<uint32_t>(side.pixels());
  Pixels masked = random_pixels(side, 5);
  for (size_t i = 3; i < masked.size(); i += 4) masked[i] = masked[i] < .6F ? 1 : 0;
  const Pixels specular = with_extremes(extreme_codes(side, 6), 6),
               mirror = with_extremes(extreme_codes(side, 7), 7);
  const gpu::BufferPtr mirror_in = buffer(1 + count), albedo_in = buffer(1 + count),
                       exponent_in = buffer(1 + count);
  run([&](gpu::Commands& commands) {
    commands.dispatch(gpu::Program<shaders::material_networks_to_mirror_and_albedo>(device),
                      {.masked = points(masked),
                       .specular = points(specular),
                       .mirror_in = mirror_in,
                       .albedo_in = albedo_in},
                      {.count = static_cast<int32_t>(count)}, {count});
    commands.dispatch(gpu::Program<shaders::material_networks_to_exponent>(device),
                      {.masked = points(masked),
                       .specular = mirror_in,
                       .mirror = points(mirror),
                       .result = exponent_in},
                      {.count = static_cast<int32_t>(count)}, {count});
  });
  const auto expected = reference::lime_to_mirror_and_albedo(to_reference(side, masked),
                                                             to_reference(side, specular));
  expect_near(download_points(mirror_in), expected.mirror_in, 1e-6, "to MirrorNet");
  expect_near(download_points(albedo_in), expected.albedo_in, 1e-6, "to AlbedoNet");
  expect_near(download_points(exponent_in),
              reference::lime_to_exponent(to_reference(side, masked), expected.mirror_in,
                                          to_reference(side, mirror)),
              1e-6, "to ExponentNet");
}

TEST_F(LimeKernels, SphereBeforeTheFrame) {
  constexpr uint32_t kTable = 160;
  unsigned seed = 60;
  for (const Extent extent : {Extent{64, 48}, Extent{17, 5}, Extent{1, 1}, Extent{349, 287}})
    for (const bool extreme : {false, true}) {
      Pixels frame = random_pixels(extent, ++seed), table = random_pixels({kTable, kTable}, ++seed);
      if (extreme) {
        frame = with_extremes(frame, seed);
        for (size_t i = 3; i < frame.size(); i += 4) frame[i] = .5F;  // alpha passes as it is
        for (size_t i = 0; i < table.size(); i += 101) table[i] = i % 2 ? 1e30F : -5;
      }
      const float shorter = static_cast<float>(std::min(extent.width, extent.height));
      // Within the frame, and of which the frame shows a part.
      for (const auto& [x, y, radius] :
           {std::tuple{.5F, .5F, .45F}, {.95F, .8F, .3F}, {-.1F, .3F, 2.5F}, {.4F, .4F, .02F}}) {
        const shaders::material_preview_preview::Push push{
            .size = extent,
            .middle = {x * static_cast<float>(extent.width), y * static_cast<float>(extent.height)},
            .radius = radius * shorter,
            .side = kTable,
            .first_row = 0};
        const gpu::BufferPtr out = buffer(extent.pixels());
        run([&](gpu::Commands& commands) {
          commands.dispatch(gpu::Program<shaders::material_preview_preview>(device),
                            {.frame = plane(extent, frame).buffer,
                             .LIT_TABLE = plane({kTable, kTable}, table).buffer,
                             .picture = out},
                            push, {extent.width, (extent.height + 3) / 4});
        });
        const auto expected = reference::lime_preview(
            to_reference(extent, frame), to_reference({kTable, kTable}, table),
            double{push.middle[0]}, double{push.middle[1]}, double{push.radius});
        expect_near(download(out), expected, 2e-3, "frame of " + std::to_string(extent.width));
      }
    }
}

/// A picture of a square, the mask with it, and codes: of its specular layer some clipped
/// highlights.
struct Square {
  Pixels masked, codes;
};
Square random_square(Extent side, unsigned seed, double known) {
  Square s{random_pixels(side, seed), random_pixels(side, seed + 1, -.1F, .4F)};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  for (size_t i = 0; i < s.masked.size(); i += 4) {
    if (share(random) > known) s.masked[i] = s.masked[i + 1] = s.masked[i + 2] = 1;
    s.masked[i + 3] = share(random) < .7 ? 1 : 0;
    if (s.masked[i + 3] == 0) s.masked[i] = s.masked[i + 1] = s.masked[i + 2] = 0;
  }
  return s;
}

TEST_F(LimeKernels, LightUnderHighlightsIsFilledIn) {
  for (const uint32_t size : {1U, 2U, 5U, 32U, 128U})
    for (const double known : {1., .5, .01, 0.}) {
      const Extent side{size, size};
      const Square s = random_square(side, size + static_cast<unsigned>(100 * known), known);
      UnderHighlights under(device, size);
      run([&](gpu::Commands& commands) {
        under.record(commands, points(s.masked), points(s.codes));
      });
      const auto expected = reference::lime_under_highlights(to_reference(side, s.masked),
                                                             to_reference(side, s.codes));
      Pixels got = download(under.diffuse());
      for (size_t i = 3; i < got.size(); i += 4)
        got[i] = static_cast<float>(expected.data[i / 4][3]);  // of no meaning
      expect_near(got, expected, 1e-4,
                  std::to_string(size) + " points, known " + std::to_string(known));
    }
}

TEST_F(LimeKernels, AnEvenObjectIsEvenUnderItsHighlight) {
  const Extent side{64, 64};
  Pixels masked(side.pixels() * 4, .5F), codes(side.pixels() * 4, 0.F);
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      float* p = &masked[4 * (64 * y + x)];
      p[3] = 1;
      if (std::hypot(static_cast<float>(x) - 30, static_cast<float>(y) - 25) < 12)
        p[0] = p[1] = p[2] = 1;
    }
  UnderHighlights under(device, 64);
  run([&](gpu::Commands& commands) { under.record(commands, points(masked), points(codes)); });
  const Pixels got = download(under.diffuse());
  const float expected = srgb_light(.5F);
  for (size_t i = 0; i < got.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) ASSERT_NEAR(got[i + c], expected, 1e-4) << i;
}

TEST_F(LimeKernels, LinesOfTheSpecularLayer) {
  for (const uint32_t size : {1U, 2U, 5U, 32U, 128U})
    for (const bool extreme : {false, true}) {
      const Extent side{size, size};
      Square s = random_square(side, 70 + size, .8);
      if (extreme) s.codes = extreme_codes(side, size);
      GuidedLayers guided(device, size);
      run([&](gpu::Commands& commands) {
        guided.record_specular(commands, points(s.masked), points(s.codes));
      });
      expect_near(download(guided.specular()),
                  reference::lime_guided_specular(to_reference(side, s.masked),
                                                  to_reference(side, s.codes)),
                  1e-3, std::to_string(size) + (extreme ? " extreme points" : " points"));
    }
}

TEST_F(LimeKernels, PlanesOfTheMask) {
  enum { plain, gray, even, foreign };
  for (const uint32_t size : {1U, 2U, 5U, 32U, 128U})
    for (const int kind : {plain, gray, even, foreign}) {
      const Extent side{size, size};
      Pixels image = random_pixels(side, 80 + size), probability = random_pixels(side, 81 + size);
      for (size_t i = 0; i < image.size(); i += 4) {
        if (kind == gray)
          image[i + 1] = image[i + 2] = image[i];  // channels that depend on each other
        if (kind == even) image[i] = image[i + 1] = image[i + 2] = 1;
        if (kind == foreign && i % 3 == 0) probability[i] = 0;
      }
      GuidedLayers guided(device, size);
      run([&](gpu::Commands& commands) {
        guided.record_mask(commands, points(image), points(probability));
      });
      expect_near(
          download(guided.mask()),
          reference::lime_guided_mask(to_reference(side, image), to_reference(side, probability)),
          2e-3, std::to_string(size) + " points");
    }
}

/// A disk in a frame, found at points of eight pixels each: as a highlight on an even object, and
/// as an object before something of another color. Layers have the edge that the frame shows.
TEST_F(LimeKernels, LayersHaveTheEdgesOfTheFrame) {
  constexpr size_t kSide = 16, kPixels = 8, kFrame = kSide * kPixels;
  constexpr std::array<double, 3> kAround = {.2, .3, .4}, kHighlight = {.7, .8, .9},
                                  kObject = {.5, .3, .1};
  const Extent frame{kFrame, kFrame};
  std::vector<double> disk(kFrame * kFrame), shares(kSide * kSide);
  for (size_t y = 0; y < kFrame; ++y)
    for (size_t x = 0; x < kFrame; ++x) {
      double& covered = disk[y * kFrame + x];
      covered = std::hypot(static_cast<double>(x) - 60, static_cast<double>(y) - 66) < 35 ? 1 : 0;
      shares[y / kPixels * kSide + x / kPixels] += covered / (kPixels * kPixels);
    }
  for (const auto& [color, is_object, exposure] :
       {std::tuple{kHighlight, false, 1.}, {kHighlight, false, .1}, {kObject, true, 1.}}) {
    const auto mixed = [&, color = color, exposure = exposure](double share, size_t c) {
      return exposure * std::lerp(kAround[c], color[c], share);
    };
    Pixels light(4 * disk.size(), 1), means(4 * shares.size(), 1), mask(means.size(), 1),
        codes(means.size(), 0);
    for (size_t i = 0; i < disk.size(); ++i)
      for (size_t c = 0; c < 3; ++c) light[4 * i + c] = static_cast<float>(mixed(disk[i], c));
    for (size_t i = 0; i < shares.size(); ++i) {
      for (size_t c = 0; c < 3; ++c)
        means[4 * i + c] = static_cast<float>(srgb_code(mixed(shares[i], c)));
      if (is_object)
        mask[4 * i] = static_cast<float>(std::max(shares[i], .01));
      else
        codes[4 * i] = static_cast<float>(std::log1p(4 * exposure * shares[i] / 2) / 2);
    }
    GuidedLayers guided(device, kSide);
    const gpu::BufferPtr diffuse = buffer(frame.pixels()), gloss = buffer(frame.pixels());
    run([&](gpu::Commands& commands) {
      guided.record_mask(commands, points(means), points(mask));
      guided.record_specular(commands, points(means), points(codes));
      commands.dispatch(
          gpu::Program<shaders::material_layers_layers>(device),
          {.frame = plane(frame, light).buffer,
           .planes = guided.mask(),
           .codes = points(codes),
           .lines = guided.specular(),
           .under = plane({kSide, kSide}, Pixels(means.size(), 0)).buffer,
           .diffuse = diffuse,
           .gloss = gloss},
          {.size = frame, .corner = {0, 0}, .pixels = kPixels, .side = kSide, .first_row = 0},
          {kFrame, kFrame});
    });
    const Pixels found = download(is_object ? diffuse : gloss);
    // A sixth of the step at most, as slopes are a little small; between points it would be a
    // half.
    const size_t channel = is_object ? 3 : 0;
    const double step = is_object ? 1 : exposure / 2;
    for (size_t i = 0; i < disk.size(); ++i)
      ASSERT_NEAR(double{found[4 * i + channel]}, step * disk[i], step / 6)
          << (is_object ? "object" : "highlight") << " at " << exposure << ", pixel " << i;
  }
}

TEST_F(LimeKernels, LayersOfTheFrame) {
  unsigned seed = 40;
  const Extent side{32, 32};
  for (const auto& [extent, place] : kCases)
    for (const bool extreme : {false, true}) {
      const Pixels plain = random_pixels(extent, ++seed, 0, 1.2F);
      const Pixels frame = extreme ? with_extremes(plain, seed) : plain;
      const Pixels planes = random_pixels(side, ++seed, -.5F, .8F),
                   codes = random_pixels(side, ++seed, -.2F, 1.2F),
                   lines = random_pixels(side, ++seed, -.1F, 1.1F);
      const Pixels under = random_pixels(side, ++seed, 0, .6F);
      const gpu::BufferPtr diffuse = buffer(extent.pixels()), gloss = buffer(extent.pixels());
      // Without an object there is light alone, whatever the rest holds.
      for (const bool found : {true, false}) {
        run([&](gpu::Commands& commands) {
          commands.dispatch_rows(
              gpu::Program<shaders::material_layers_layers>(device, {.found = found}),
              {.frame = plane(extent, frame).buffer,
               .planes = plane(side, planes).buffer,
               .codes = points(codes),
               .lines = plane(side, lines).buffer,
               .under = plane(side, under).buffer,
               .diffuse = gpu::by_rows(diffuse),
               .gloss = gpu::by_rows(gloss)},
              {.size = place.size,
               .corner = place.corner,
               .pixels = place.pixels,
               .side = place.side,
               .first_row = 0},
              {extent.width, extent.height});
        });
        const auto expected = reference::lime_layers(
            to_reference(extent, frame), found ? square(place) : reference::LimeSquare{},
            to_reference(side, planes), to_reference(side, codes), to_reference(side, lines),
            to_reference(side, under));
        const std::string what =
            (found ? " of " : " without an object of ") + std::to_string(extent.width);
        expect_near(download(diffuse), expected.diffuse, 1e-3, "diffuse" + what);
        expect_near(download(gloss), expected.gloss, 1e-3, "gloss" + what);
      }
    }
}

}  // namespace
}  // namespace inverse::testing
