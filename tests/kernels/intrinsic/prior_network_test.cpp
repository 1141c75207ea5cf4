// SPDX-License-Identifier: LGPL-2.1-or-later
// A network that adds to the fitted prior, against tests/reference/intrinsic/prior_network.*: what
// it sees, what its output says, cells, and the whole decomposition.
#include "kernels/intrinsic/prior/network/prior_network.hpp"

#include "intrinsic_fixture.hpp"
#include "prior_graph.hpp"
#include "tests/expect_error.hpp"

namespace inverse::testing {
namespace {

constexpr auto kFields = static_cast<size_t>(reference::kPriorFields);

/// Sizes with network pixels of 1, 2, 4, 8 and 32 pixels along a side.
const std::vector<Extent> kSizes = {{1, 1},     {2, 3},     {17, 5},    {64, 48},   {256, 33},
                                    {257, 3},   {349, 287}, {512, 7},   {513, 61},  {1023, 18},
                                    {1025, 37}, {37, 2050}, {8192, 16}, {8191, 165}};

Pixels spoilt(Extent extent, unsigned seed) {
  Pixels pixels = scene(extent, seed);
  std::mt19937 random(seed);
  for (const float bad : {kNan, kInf, -kInf, 0.0F, -1.0F, 3e38F, 1e-40F})
    for (size_t k = 0; k < 1 + pixels.size() / 100; ++k) pixels[random() % pixels.size()] = bad;
  for (size_t i = 3; i < pixels.size(); i += 4) pixels[i] = 1;
  return pixels;
}

std::vector<reference::PriorFields> fields_of(const Pixels& device_fields) {
  std::vector<reference::PriorFields> fields(device_fields.size() / 4);
  for (size_t i = 0; i < fields.size(); ++i)
    for (size_t q = 0; q < kFields; ++q) fields[i][q] = double{device_fields[4 * i + q]};
  return fields;
}

}  // namespace

class PriorNetworkTest : public IntrinsicTest {
 protected:
  /// The device's guide of a frame, and what `model` says of it.
  struct Run {
    std::shared_ptr<Guide> guide;
    std::shared_ptr<PriorNetwork> network;
  };
  Run run_network(Extent extent, const Pixels& pixels, const PriorModelPtr& model,
                  const reference::LightColor& color = {}) {
    Run made{std::make_shared<Guide>(device, extent),
             std::make_shared<PriorNetwork>(device, extent, model)};
    const auto frame = plane(extent, pixels);
    const auto light = upload({float(color.slope), float(color.reference), 1, 1});
    run([&](gpu::Commands& commands) {
      made.guide->record(commands, frame.buffer, color.slope != 0 ? light : nullptr);
      made.network->record(commands, *made.guide);
    });
    return made;
  }
  /// The prior of a frame with `model` or, null, without.
  EdgePrior::Target prior_of(const Run& made, const PriorModelPtr& model) {
    EdgePrior prior(device, made.guide->extent());
    const EdgePrior::Target target = prior_target(made.guide->extent());
    run([&](gpu::Commands& commands) {
      for (const auto& part : {target.system, target.flux, target.value}) commands.fill(part);
      EdgePrior::Params params;
      params.network = model;
      prior.record(commands, *made.guide, target, params);
    });
    return target;
  }
};

TEST_F(PriorNetworkTest, PictureIsTheLargestOfAtMost256Pixels) {
  const auto expect = [](Extent frame, uint32_t level, Extent extent, Extent padded) {
    const PriorPicture picture(frame);
    EXPECT_EQ(picture.level, level) << name_of(frame);
    EXPECT_EQ(picture.extent, extent) << name_of(frame);
    EXPECT_EQ(picture.padded, padded) << name_of(frame);
  };
  expect({1, 1}, 0, {1, 1}, {16, 16});
  expect({256, 144}, 0, {256, 144}, {256, 144});
  expect({257, 144}, 1, {129, 72}, {144, 80});
  expect({640, 480}, 2, {160, 120}, {160, 128});
  expect({1080, 1920}, 3, {135, 240}, {144, 240});
  expect({3840, 2160}, 4, {240, 135}, {240, 144});
}

TEST_F(PriorNetworkTest, InputAgreesWithReference) {
  const PriorModelPtr models[] = {prior_model(1), reflectance_model(1)};
  const reference::LightColor lights[] = {{}, {0.8, -0.5}, {-1.3, -1}};
  for (size_t i = 0; const Extent extent : kSizes)
    for (const Pixels& pixels :
         {scene(extent, 2), spoilt(extent, 3), Pixels(4 * extent.pixels())}) {
      const reference::LightColor& color = lights[i++ % std::size(lights)];
      const PriorModelPtr& model = models[i % 5 < 2];
      const Run made = run_network(extent, pixels, model, color);
      const reference::PriorPicture picture(int(extent.width), int(extent.height));
      const reference::Guide guide = guide_of(extent, pixels, color);
      const reference::Image want = model->gives_reflectance()
                                        ? reference::image_input(guide, picture)
                                        : reference::prior_input(guide, picture);
      const auto [channels, height, width] = want.shape;
      const size_t blocks = model->gives_reflectance() ? 1 : 2;
      ASSERT_EQ(made.network->picture().padded, (Extent{width, height}));
      const Pixels got = download(made.network->network().input(0));
      ASSERT_EQ(got.size(), 4 * (1 + blocks * width * height));
      for (size_t c = 0; c < 4; ++c) ASSERT_EQ(got[c], 0) << "what is outside of the picture";
      for (uint32_t c = 0; c < 4 * blocks; ++c)
        for (uint32_t y = 0; y < height; ++y)
          for (uint32_t x = 0; x < width; ++x) {
            const size_t at = 4 * (1 + (size_t{c / 4} * height + y) * width + x) + c % 4;
            ASSERT_NEAR(got[at], c < channels ? want.at(c, y, x) : 0, 1e-3)
                << name_of(extent) << " channel " << c << " at " << x << "," << y;
          }
    }
}

TEST_F(PriorNetworkTest, FieldsAgreeWithReference) {
  const gpu::Program<shaders::intrinsic_prior_network_output> output(device);
  for (const Extent extent : {Extent{1, 1}, {2, 3}, {17, 5}, {255, 34}, {256, 256}}) {
    const PriorPicture picture(extent);
    const Extent half = half_of(picture.padded);
    reference::Image image{{PriorModel::kOutputs, half.height, half.width}, {}};
    image.data.resize(image.shape.size());
    std::mt19937 random(extent.width);
    std::uniform_real_distribution<float> value(-20, 20);
    const float odd[] = {0, kNan, -kNan, kInf, -kInf, 3e38F, -3e38F, 1e-40F};
    Pixels pixels(4 * network::elements_of(image.shape));
    for (uint32_t c = 0; c < image.shape.channels; ++c)
      for (uint32_t y = 0; y < half.height; ++y)
        for (uint32_t x = 0; x < half.width; ++x) {
          const float v = random() % 8 == 0 ? odd[random() % std::size(odd)] : value(random);
          image.at(c, y, x) = double{v};
          pixels[4 * (1 + (size_t{c / 4} * half.height + y) * half.width + x) + c % 4] = v;
        }
    const auto fields = buffer(extent.pixels());
    run([&](gpu::Commands& commands) {
      commands.dispatch(output, {.prior = upload(pixels), .fields = fields},
                        {.size = extent, .half_padded = half}, line_of(half_of(extent).pixels()));
    });
    const auto got = fields_of(download(fields));
    const auto want = reference::prior_fields(
        image, reference::PriorPicture(int(extent.width), int(extent.height)));
    ASSERT_EQ(got.size(), want.size());
    for (size_t i = 0; i < want.size(); ++i)
      for (size_t q = 0; q < kFields; ++q)
        ASSERT_NEAR(got[i][q], want[i][q], 1e-5)
            << name_of(extent) << " field " << q << " of pixel " << i;
  }
}

TEST_F(PriorNetworkTest, FieldsOfReflectanceAgreeWithReference) {
  const gpu::Program<shaders::intrinsic_prior_network_reflectance> program(device);
  const float odd[] = {0, kNan, -kNan, kInf, -kInf, 3e38F, -1, 1e-40F};
  for (const Extent extent : kSizes) {
    const Pixels pixels = scene(extent, 9);
    const Run made = run_network(extent, pixels, prior_model(1));
    const PriorPicture picture(extent);
    const Extent padded = picture.padded;
    reference::Image image{{PriorModel::kColors, padded.height, padded.width}, {}};
    image.data.resize(image.shape.size());
    std::mt19937 random(extent.width);
    std::uniform_real_distribution<float> value(0, 1.2F);
    Pixels reflectance(4 * network::elements_of(image.shape));
    for (uint32_t c = 0; c < image.shape.channels; ++c)
      for (uint32_t y = 0; y < padded.height; ++y)
        for (uint32_t x = 0; x < padded.width; ++x) {
          const float v = random() % 16 == 0 ? odd[random() % std::size(odd)] : value(random);
          image.at(c, y, x) = double{v};
          reflectance[4 * (1 + size_t{y} * padded.width + x) + c] = v;
        }
    const auto fields = buffer(picture.extent.pixels());
    run([&](gpu::Commands& commands) {
      commands.dispatch(program,
                        {.level0 = made.guide->level0(),
                         .level1 = made.guide->level1(),
                         .cells = made.guide->cells(),
                         .reflectance = upload(reflectance),
                         .fields = fields},
                        {.size = extent,
                         .network = picture.extent,
                         .padded_width = static_cast<int32_t>(padded.width),
                         .level = static_cast<int32_t>(picture.level)},
                        line_of(picture.extent.pixels()));
    });
    const auto got = fields_of(download(fields));
    const auto want = reference::reflectance_fields(
        image, guide_of(extent, pixels),
        reference::PriorPicture(int(extent.width), int(extent.height)));
    ASSERT_EQ(got.size(), want.size());
    for (size_t i = 0; i < want.size(); ++i)
      for (size_t q = 0; q < kFields; ++q)
        ASSERT_NEAR(got[i][q], want[i][q], 2e-3)
            << name_of(extent) << " field " << q << " of pixel " << i;
  }
}

TEST_F(PriorNetworkTest, EdgesAndCellsAgreeWithReference) {
  for (const Extent extent : kSizes)
    for (const float gain : {1.0F, 1e-3F, 1e3F, 1e30F}) {
      const PriorModelPtr model = prior_model(extent.height, gain);
      const Pixels pixels = gain == 1 ? spoilt(extent, 5) : scene(extent, 5);
      const Run made = run_network(extent, pixels, model);
      const reference::Guide guide = guide_of(extent, pixels);
      // With the device's own fields: where the output is near zero, a large gain makes much of
      // little.
      const reference::PriorNetwork said(
          reference::PriorPicture(int(extent.width), int(extent.height)),
          fields_of(download(made.network->fields())));
      expect_prior(prior_of(made, model), guide, reference::edge_prior(guide, {}, &said),
                   name_of(extent) + " gain " + std::to_string(gain));
    }
}

TEST_F(PriorNetworkTest, ANetworkOfZerosIsTheFittedPrior) {
  for (const Extent extent : kSizes) {
    const Run made = run_network(extent, scene(extent, 6), prior_model(7));
    const EdgePrior::Target fitted = prior_of(made, nullptr),
                            other = prior_of(made, prior_model(7, 1)),
                            zero = prior_of(made, prior_model(7, 0));
    EXPECT_EQ(download(zero.system), download(fitted.system)) << name_of(extent);
    EXPECT_EQ(download(zero.flux), download(fitted.flux)) << name_of(extent);
    EXPECT_EQ(download(zero.value), download(fitted.value)) << name_of(extent);
    EXPECT_NE(download(other.value), download(fitted.value)) << name_of(extent);
  }
}

TEST_F(PriorNetworkTest, WholeSolveAgreesWithReference) {
  std::vector<Extent> sizes = kOddSizes;
  sizes.push_back({600, 130});
  for (const PriorModelPtr& model : {prior_model(11), reflectance_model(11)})
    for (const Extent extent : sizes) {
      const Pixels pixels = scene(extent, 1);
      IntrinsicDecomposition::Params params;
      params.prior.network = model;
      if (model->gives_reflectance())
        params.tolerances.cycle = 0;  // all cycles, as the reference has
      const Pixels got = decompose(extent, pixels, params);
      const auto expected = expected_of(extent, pixels, {.network = &model->graph}).log_shading;
      EXPECT_LT(max_difference(log_shading_of(got), expected), 1e-3) << name_of(extent);
      if (extent.pixels() > 1000) {
        EXPECT_GT(rms_difference(log_shading_of(decompose(extent, pixels)), expected), 0.05)
            << "the network must change something";
      }
    }
}

TEST_F(PriorNetworkTest, SaturatedNetworksGiveLightOfBadFrames) {
  for (const Extent extent : {Extent{1, 1}, {17, 5}, {349, 287}, {515, 64}})
    for (const unsigned seed : {1U, 2U})
      for (const float gain : {1e3F, 1e35F}) {
        IntrinsicDecomposition::Params params;
        params.prior.network =
            seed == 1 || gain > 1e3F ? prior_model(seed, gain) : reflectance_model(seed);
        for (const float weight : {1.0F, 1e-3F, 1e3F}) {
          params.prior.reflectance_weight = weight;
          params.prior.value_weight = 1 / weight;
          EXPECT_TRUE(are_light(decompose(extent, spoilt(extent, seed), params)))
              << name_of(extent) << " gain " << gain << " weight " << weight;
        }
      }
}

TEST_F(PriorNetworkTest, AnotherNetworkTakesEffectAtOnce) {
  const Extent extent{349, 287};
  const PlanePtr frame = input(extent, scene(extent, 15));
  IntrinsicDecomposition method(device, extent);
  const uint32_t tiles = TileList::count(extent);
  IntrinsicDecomposition::Params params, other;
  params.cycles = params.warm_cycles = 32;
  params.anchor.anchor_weight = 0;
  params.tolerances.cycle = 0;
  const auto fresh = [&](const PriorModelPtr& model) {
    params.prior.network = model;
    return decompose(extent, scene(extent, 15), params);
  };
  for (const PriorModelPtr& model :
       {PriorModelPtr(), prior_model(1), prior_model(2), PriorModelPtr(), prior_model(1)}) {
    const Pixels want = fresh(model);
    Pixels got = decompose(method, frame, params, false);
    EXPECT_EQ(method.findings().tiles_evaluated, tiles);
    EXPECT_EQ(last_stats(method).network, model);
    EXPECT_LT(shading_distance(got, want), 2e-3);
    got = decompose(method, frame, params, false);
    EXPECT_EQ(method.findings().tiles_evaluated, 0U) << "edges of a picture at rest are reused";
    EXPECT_LT(shading_distance(got, want), 2e-3);
  }
}

TEST_F(PriorNetworkTest, APictureAtRestDoesNotRunIt) {
  if (!device->variant().conditional) GTEST_SKIP() << "the device skips nothing";
  const Extent extent{349, 287};
  // So large a gain makes much of noise.
  const PriorModelPtr model = prior_model(4, 1e3F);
  const Pixels first = scene(extent, 8);
  Pixels second = first;
  std::mt19937 random(9);
  std::uniform_real_distribution<float> noise(0.99F, 1.01F);
  for (float& v : second) v *= noise(random);
  const auto said_of = [&](const Pixels& pixels) {
    return reference::PriorNetwork(
        reference::PriorPicture(int(extent.width), int(extent.height)),
        fields_of(download(run_network(extent, pixels, model).network->fields())));
  };
  const reference::PriorNetwork said = said_of(first), fresh = said_of(second);
  const reference::Guide guide = guide_of(extent, first), noisy = guide_of(extent, second);
  reference::EdgePrior expected = reference::edge_prior(guide, {}, &said);
  const reference::EdgePrior cells = reference::edge_prior(noisy, {}, &said);
  EXPECT_GT(max_difference(cells.V, reference::edge_prior(noisy, {}, &fresh).V), 0.1)
      << "noise must matter to the network";
  expected.v = cells.v, expected.V = cells.V, expected.g = cells.g;

  Guide made(device, extent);
  EdgePrior prior(device, extent);
  const EdgePrior::Target target = prior_target(extent);
  EdgePrior::Params params;
  params.network = model;
  const auto play = [&](const Pixels& pixels) {
    const auto frame = plane(extent, pixels);
    run([&](gpu::Commands& commands) {
      made.record(commands, frame.buffer, nullptr);
      prior.record_changes(commands, made, target, params, 0.1F);
    });
  };
  run([&](gpu::Commands& commands) { commands.fill(target.system); });
  play(first);
  play(second);
  expect_prior(target, guide, expected, "edges of the first frame, cells of the second");
}

TEST_F(PriorNetworkTest, RefusesOtherNetworks) {
  const auto refused = [](const network::Graph& graph, const std::string& why) {
    expect_error(ErrorKind::file, why, [&] { PriorModel("a.net", graph); });
  };
  const auto convolved = [](uint32_t in, uint32_t out, uint32_t stride) {
    NetworkBuilder b(1);
    b.output(b.convolution(b.input(in), out, 3, stride));
    return b.graph();
  };
  EXPECT_NO_THROW(PriorModel("a.net", convolved(6, 12, 2)));
  EXPECT_NO_THROW(PriorModel("a.net", convolved(3, 3, 1)));
  refused(convolved(4, 12, 2), "4 channels in place of 6 of the guide or 3 of an image");
  refused(convolved(3, 12, 2), "in place of 3 x 16");
  refused(convolved(6, 11, 2), "in place of 12 x 8");
  refused(convolved(6, 12, 1), "in place of 12 x 8");
  NetworkBuilder deep(1);  // down to a 32th, and a sum with the half that is an odd one at times
  uint32_t value = deep.input(6);
  const uint32_t half = value = deep.convolution(value, 4, 3, 2);
  for (int k = 0; k < 4; ++k) value = deep.convolution(value, 4, 3, 2);
  for (int k = 0; k < 4; ++k) value = deep.simple(network::Op::upsample, value);
  deep.output(deep.convolution(deep.concat(value, half), 12, 1));
  refused(deep.graph(), "a.net");
  NetworkBuilder two(1);
  value = two.convolution(two.input(6), 12, 3, 2);
  two.output(value);
  two.output(value);
  refused(two.graph(), "one input and one output");
}

}  // namespace inverse::testing
