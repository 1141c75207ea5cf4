// The benchmark's own plumbing: layers of light through a device, scenes with them through a file,
// work on all cores.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "tests/bench/device_session.hpp"
#include "tests/bench/peer_despill.hpp"
#include "tests/bench/scene.hpp"

namespace inverse::bench {
namespace {

PlanePtr upload(const std::shared_ptr<gpu::Device>& device, Extent extent,
                const std::array<float, 4>& pixel) {
  auto buffer =
      gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), gpu::Memory::upload);
  for (std::size_t i = 0; i < extent.pixels(); ++i)
    std::memcpy(buffer->map_as<float>() + 4 * i, pixel.data(), sizeof pixel);
  return std::make_shared<Plane>(Plane{extent, buffer});
}

TEST(DeviceSession, SplitsShadingByItsLight) {
  DeviceSession session("");
  const Extent extent{5, 3};
  const Image frame(5, 3, 3, 0.5F);
  Cost cost;
  const Decomposition d = session.run(
      frame,
      [&](gpu::Commands&, const PlanePtr& input) {
        Layers layers =
            intrinsic_layers(input, upload(session.device(), extent, {0.2F, 0.3F, 0.4F, 2}));
        layers[Role::light] = layers[Role::model_light] =
            upload(session.device(), extent, {1.2F, 0.9F, 0.9F, 0.75F});
        return layers;
      },
      cost);
  EXPECT_FLOAT_EQ(d.reflectance.at(4, 2, 2), 0.4F);
  for (const int c : {0, 1, 2}) EXPECT_FLOAT_EQ(d.direct.at(4, 2, c), 1.5F);
  EXPECT_FLOAT_EQ(d.indirect.at(4, 2, 0), 0.9F);
  EXPECT_NEAR(d.indirect.at(4, 2, 1), 0.3F, 1e-6F);
  EXPECT_NEAR(d.shading.at(4, 2), 0.2126F * 2.4F + 0.7874F * 1.8F, 1e-5F);
  const Decomposition plain = session.run(
      frame,
      [&](gpu::Commands&, const PlanePtr& input) {
        return intrinsic_layers(input, upload(session.device(), extent, {0.2F, 0.3F, 0.4F, 2}));
      },
      cost);
  EXPECT_TRUE(plain.direct.empty());
  EXPECT_FLOAT_EQ(plain.shading.at(0, 0), 2);
}

TEST(Scenes, ComeBackWithTheirLight) {
  const std::string folder =
      (std::filesystem::temp_directory_path() / ("bench-scenes-" + std::to_string(getpid())))
          .string();
  TruthFrame frame{
      Image(4, 3, 3, 0.5F), Image(4, 3, 3, 0.6F), Image(4, 3, 1, 0.7F), {}, {}, {}, {}};
  Scene scene{"a", "with light", "some regime", false, {frame}};
  scene.frames[0].direct = Image(4, 3, 3, 0.1F);
  scene.frames[0].indirect = Image(4, 3, 3, 0.2F);
  scene.frames[0].id = Image(4, 3, 1, 7);
  write_scene(folder, scene);
  scene.frames[0].id = {};
  scene.name = "without id";
  write_scene(folder, scene);
  write_scene(folder, {"b", "plain", "some regime", true, {frame}});
  const std::vector<Scene> scenes = read_scenes(folder);
  std::filesystem::remove_all(folder);
  ASSERT_EQ(scenes.size(), 3U);
  EXPECT_EQ(scenes[0].name, "with light");
  EXPECT_FLOAT_EQ(scenes[0].frames[0].direct.at(3, 2, 2), 0.1F);
  EXPECT_FLOAT_EQ(scenes[0].frames[0].indirect.at(3, 2, 0), 0.2F);
  EXPECT_FLOAT_EQ(scenes[0].frames[0].id.at(3, 2), 7);
  EXPECT_TRUE(scenes[1].frames[0].id.empty());
  EXPECT_FALSE(scenes[1].frames[0].direct.empty());
  EXPECT_TRUE(scenes[2].frames[0].direct.empty());
  EXPECT_TRUE(scenes[2].video);
}

/// Codes as linear light and back are what they were.
float linear(float code) {
  return code <= 0.04045F ? code / 12.92F : std::pow((code + 0.055F) / 1.055F, 2.4F);
}
Image pixel(float r, float g, float b) {
  Image image(1, 1, 3);
  image.data = {linear(r), linear(g), linear(b)};
  return image;
}
void expect_codes(const Image& found, float r, float g, float b) {
  constexpr float kNear = 1e-4F;
  EXPECT_NEAR(found.data[0], linear(r), kNear);
  EXPECT_NEAR(found.data[1], linear(g), kNear);
  EXPECT_NEAR(found.data[2], linear(b), kNear);
}

TEST(Despill, OfOthersIsWhatTheirFormulasSay) {
  expect_codes(ffmpeg_despill(pixel(0.4F, 0.9F, 0.2F)), 0.4F, 0.3F, 0.2F);
  expect_codes(ffmpeg_despill(pixel(0.4F, 0.2F, 0.2F)), 0.4F, 0.2F, 0.2F);
  expect_codes(green_limit(pixel(0.4F, 0.9F, 0.2F)), 0.4F, 0.4F, 0.2F);
  // All of the key goes; of a gray with a green cast, all of the cast and of its luma.
  expect_codes(gst_alpha_green(pixel(0, 1, 0)), 0, 0, 0);
  expect_codes(gst_alpha_green(pixel(0.5F, 0.7F, 0.5F)), 0.5F, 0.5F, 0.5F);
  expect_codes(gst_alpha_green(pixel(0.8F, 0.5F, 0.4F)), 0.8F, 0.5F, 0.4F);
}

TEST(InParallel, DoesEverythingOnceAndPassesErrorsOn) {
  std::atomic<int> sum{0};
  in_parallel(100, [&](std::size_t k) { sum += int(k); });
  EXPECT_EQ(sum, 4950);
  in_parallel(0, [](std::size_t) { FAIL(); });
  EXPECT_THROW(in_parallel(3,
                           [](std::size_t k) {
                             if (k == 1) throw std::runtime_error("no");
                           }),
               std::runtime_error);
}

}  // namespace
}  // namespace inverse::bench
