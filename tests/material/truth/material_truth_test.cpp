// SPDX-License-Identifier: LGPL-2.1-or-later
// limematerial's own networks against truth: objects of the corpus' test split, of a seed that
// neither trainings nor choices nor reports have used.
#include "kernels/material/lime_material.hpp"
#include "tests/has_networks.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/srgb.hpp"
#include "training/lime/corpus/sample.hpp"

namespace inverse::testing {
namespace {

constexpr uint64_t kSeed = 2611;
constexpr uint32_t kSide = 128, kSamples = 12;
constexpr size_t kPixels = size_t{kSide} * kSide;

struct Sample {
  lime::Parameters of;
  std::vector<uint8_t> image = std::vector<uint8_t>(3 * kPixels),
                       coverage = std::vector<uint8_t>(kPixels);
  std::vector<float> diffuse = std::vector<float>(3 * kPixels),
                     specular = std::vector<float>(3 * kPixels),
                     mirror = std::vector<float>(3 * kPixels);
};

Sample sample(uint64_t index) {
  Sample s;
  lime::Request request;
  request.seed = kSeed;
  request.index = index;
  request.split = lime::Split::test;
  request.size = kSide;
  lime::render(
      request, {},
      {s.image.data(), s.coverage.data(), s.diffuse.data(), s.specular.data(), s.mirror.data()},
      s.of);
  return s;
}

class MaterialTruth : public GpuTest {};

TEST_F(MaterialTruth, TheNetworksAreAsGoodAsTheyWere) {
  if (!has_networks()) GTEST_SKIP() << "built without inverse-onnx-import";
  const LimeModels models = LimeModels::load(std::string(std::getenv("INVERSE_MODELS")) + "/lime");
  double diffuse = 0, alpha = 0, stops = 0, mask = 0, gloss = 0, mirror = 0;
  LimeMaterial lime(device, {kSide, kSide}, models);
  for (uint64_t n = 0; n < kSamples; ++n) {
    const Sample truth = sample(n);
    Pixels pixels(4 * kPixels, 1);
    for (size_t i = 0; i < kPixels; ++i)
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * i + c] = srgb_light(static_cast<float>(truth.image[c * kPixels + i]) / 255);
    const Plane frame = plane({kSide, kSide}, pixels);
    lime.reset();
    const LimeMaterial::Params params{.adaptive = false, .layers_asked = true};
    LimeMaterial::Layers layers;
    for (int k = 0; k < 2; ++k) {  // where the object is, then of what it is made
      run([&](gpu::Commands& commands) {
        lime.record(commands, frame, params, false);
        layers = lime.record_layers(commands, frame);
      });
      lime.done(lime.recorded() - 1);
    }
    ASSERT_TRUE(lime.object().known()) << "no object in sample " << n;
    const Material& got = lime.object().latest;
    for (size_t c = 0; c < 3; ++c)
      diffuse += std::abs(static_cast<double>(got.diffuse[c] - truth.of.diffuse[c])) / 3;
    alpha += std::abs(static_cast<double>(got.specular - truth.of.alpha));
    stops += std::abs(std::log2(static_cast<double>(got.shininess() / truth.of.shininess)));
    const Pixels body = download(layers.diffuse), shine = download(layers.gloss);
    double both = 0, either = 0, off = 0, reflected = 0, inside = 0;
    for (size_t i = 0; i < kPixels; ++i) {
      const double there = truth.coverage[i] / 255.0, found = static_cast<double>(body[4 * i + 3]);
      both += std::min(there, found);
      either += std::max(there, found);
      if (there < 0.99) continue;
      double layer = 0, picture = 0;
      for (size_t c = 0; c < 3; ++c) {
        layer += static_cast<double>(truth.of.specular * truth.specular[c * kPixels + i]) / 3;
        picture += static_cast<double>(truth.of.alpha * truth.mirror[c * kPixels + i]) / 3;
      }
      off += std::abs(std::min(layer, 1.0) - static_cast<double>(shine[4 * i]));
      reflected +=
          std::abs(std::min(picture, 1.0) - std::min(static_cast<double>(shine[4 * i + 3]), 1.0));
      ++inside;
    }
    mask += 1 - both / either;
    gloss += off / inside;
    mirror += reflected / inside;
  }
  const double share = 1.0 / kSamples;
  printf(
      "  diffuse albedo %.4f, alpha %.4f, shininess %.3f stops, mask %.4f, specular layer %.4f, "
      "mirror image %.4f\n",
      diffuse * share, alpha * share, stops * share, mask * share, gloss * share, mirror * share);
  EXPECT_LT(diffuse * share, 0.0864);  // 0.0823 when this was written
  EXPECT_LT(alpha * share, 0.1045);    // 0.0995
  // From both sides: the network predicts too high a shininess here, and weights that are off lower
  // that, so that an upper bound alone passes them.
  EXPECT_NEAR(stops * share, 1.332, 0.03);
  EXPECT_LT(mask * share, 0.0308);    // 0.0293
  EXPECT_LT(gloss * share, 0.0381);   // 0.0363
  EXPECT_LT(mirror * share, 0.0302);  // 0.0288
}

}  // namespace
}  // namespace inverse::testing
