// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kernels/network/network.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "common/error.hpp"
#include "network_builder.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/network/network.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {

using network::Activation;
using network::Graph;
using network::Network;
using network::Op;
using network::Shape;
using reference::Image;

/// On the device, and on the host.
class NetworkTest : public GpuTest, public ::testing::WithParamInterface<bool> {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    const char* given = std::getenv(kVariable);
    if (given) given_ = given;
    if (GetParam() && (!network::HostNetwork::available() || !device->is_cpu()))
      GTEST_SKIP() << "networks do not run on the host";
    setenv(kVariable, GetParam() ? "1" : "0", 1);
  }
  void TearDown() override {
    given_ ? setenv(kVariable, given_->c_str(), 1) : unsetenv(kVariable);
    GpuTest::TearDown();
  }
  Image random_image(Shape shape, unsigned seed, double low = -1, double high = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(low, high);
    Image image{shape, std::vector<double>(shape.size())};
    for (double& v : image.data) v = static_cast<float>(value(random));
    return image;
  }
  /// An image as a buffer of `Network` holds it.
  static Pixels blocks(const Image& image) {
    const auto [channels, height, width] = image.shape;
    Pixels pixels(4 * network::elements_of(image.shape), 0.0f);
    for (uint32_t c = 0; c < channels; ++c)
      for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
          pixels[4 * (1 + (size_t{c / 4} * height + y) * width + x) + c % 4] =
              static_cast<float>(image.at(c, y, x));
    return pixels;
  }
  void put(const Network& network, const std::vector<Image>& images) {
    for (size_t i = 0; i < images.size(); ++i) {
      const Pixels pixels = blocks(images[i]);
      const auto staged = upload(gpu::Element::vec4, pixels.data(), pixels.size() / 4);
      run([&](gpu::Commands& commands) {
        commands.copy(staged, network.input(i), staged->bytes());
      });
    }
  }
  /// Runs a network and compares all outputs; errors count against the largest value of an output.
  void expect_same(const Network& network, const std::vector<Image>& images, double bound = 1e-5) {
    put(network, images);
    run([&](gpu::Commands& commands) { network.record(commands); });
    const auto expected = reference::run_network(network.graph(), images);
    for (size_t o = 0; o < expected.size(); ++o) {
      const Image& want = expected[o];
      ASSERT_EQ(want.shape, network.output_shape(o));
      const Pixels got = download(network.output(o));
      ASSERT_GE(got.size(), 4 * network::elements_of(want.shape));
      double largest = 0;
      for (const double v : want.data) update_max(largest, std::fabs(v));
      for (uint32_t c = 0; c < want.shape.channels; ++c)
        for (uint32_t y = 0; y < want.shape.height; ++y)
          for (uint32_t x = 0; x < want.shape.width; ++x)
            ASSERT_NEAR(
                got[4 * (1 + (size_t{c / 4} * want.shape.height + y) * want.shape.width + x) +
                    c % 4],
                want.at(c, y, x), bound * largest)
                << "output " << o << ", channel " << c << " at " << x << ", " << y;
      for (int k = 0; k < 4; ++k) EXPECT_EQ(got[k], 0) << "the zero in front of an image";
    }
  }
  void expect_same(const Graph& graph, const std::vector<Image>& images, double bound = 1e-5) {
    std::vector<Shape> shapes;
    for (const Image& image : images) shapes.push_back(image.shape);
    const Network network(device, graph, shapes);
    EXPECT_EQ(network.on_host(), GetParam());
    expect_same(network, images, bound);
  }

 private:
  static constexpr const char* kVariable = "INVERSE_ONEDNN";
  std::optional<std::string> given_;
};

INSTANTIATE_TEST_SUITE_P(Where, NetworkTest, ::testing::Bool(), [](const auto& info) {
  return std::string(info.param ? "Host" : "Device");
});

TEST_P(NetworkTest, ConvolutionsOfEverySizeAgreeWithReference) {
  unsigned seed = 0;
  for (const auto& [channels, result, kernel, stride] : {std::array<uint32_t, 4>{1, 1, 3, 1},
                                                         {3, 5, 3, 1},
                                                         {8, 4, 3, 1},
                                                         {13, 7, 3, 2},
                                                         {4, 12, 3, 2},
                                                         {3, 9, 1, 1},
                                                         {16, 4, 1, 1},
                                                         {6, 6, 1, 2}})
    for (const auto& [width, height] : {std::array<uint32_t, 2>{1, 1},
                                        {1, 9},
                                        {17, 1},
                                        {2, 2},
                                        {8, 8},
                                        {15, 10},
                                        {33, 17},
                                        {64, 31}}) {
      NetworkBuilder b(++seed);
      b.output(b.convolution(b.input(channels), result, kernel, stride));
      SCOPED_TRACE(::testing::Message()
                   << channels << " to " << result << ", kernel " << kernel << ", stride " << stride
                   << ", " << width << " x " << height);
      expect_same(b.graph(), {random_image({channels, height, width}, seed)});
      if (HasFatalFailure()) return;
    }
}

TEST_P(NetworkTest, DepthwiseConvolutionsAgreeWithReference) {
  unsigned seed = 0;
  for (const auto& [channels, stride, dilation] :
       {std::array<uint32_t, 3>{1, 1, 1}, {5, 1, 2}, {8, 2, 1}, {13, 1, 4}, {6, 2, 3}, {4, 1, 16}})
    for (const auto& [width, height] :
         {std::array<uint32_t, 2>{1, 1}, {1, 9}, {17, 1}, {2, 2}, {15, 10}, {33, 17}}) {
      NetworkBuilder b(++seed);
      b.output(b.depthwise(b.input(channels), stride, dilation));
      SCOPED_TRACE(::testing::Message()
                   << channels << " channels, stride " << stride << ", dilation " << dilation
                   << ", " << width << " x " << height);
      expect_same(b.graph(), {random_image({channels, height, width}, seed)});
      if (HasFatalFailure()) return;
    }
}

TEST_P(NetworkTest, SumsAgreeWithReference) {
  for (const auto& [width, height] : {std::array<uint32_t, 2>{1, 1}, {5, 3}, {9, 16}}) {
    NetworkBuilder b(width);
    const uint32_t first = b.input(6), second = b.input(6);
    b.output(b.sum(first, second));
    b.output(b.sum(first, first));
    b.output(b.sum(first, b.simple(Op::global_mean, second)));
    expect_same(b.graph(),
                {random_image({6, height, width}, 1), random_image({6, height, width}, 2)});
  }
}

TEST_P(NetworkTest, ActivationsAgreeWithReferenceFusedAndAlone) {
  for (const Activation a : {Activation::none, Activation::relu, Activation::leaky_relu,
                             Activation::sigmoid, Activation::relu6}) {
    NetworkBuilder b(7);
    const uint32_t input = b.input(5);
    b.output(b.convolution(input, 6, 3, 1, a, .2f));
    b.output(b.convolution(input, 6, 3, 2, a, .2f));
    b.output(b.convolution(input, 6, 1, 1, a, .2f));
    b.output(b.depthwise(input, 1, 1, a));
    b.output(b.dense(input, 5 * 12 * 10, 6, a));
    b.output(b.activation(input, a, .2f));
    expect_same(b.graph(), {random_image({5, 12, 10}, 3, -4, 4)});
  }
}

TEST_P(NetworkTest, PoolingUpsamplingAndVectorsAgreeWithReference) {
  for (const auto& [width, height] : {std::array<uint32_t, 2>{2, 2}, {3, 5}, {16, 8}, {31, 30}}) {
    NetworkBuilder b(width);
    const uint32_t input = b.input(6);
    b.output(b.simple(Op::max_pool, input));
    b.output(b.simple(Op::upsample, input));
    const uint32_t mean = b.simple(Op::global_mean, input);
    b.output(mean);
    b.output(b.simple(Op::softmax, mean));
    b.output(b.simple(Op::softmax, input));
    b.output(b.dense(input, 6 * width * height, 9));
    b.output(b.dense(mean, 6, 3));
    expect_same(b.graph(), {random_image({6, height, width}, height)});
  }
}

TEST_P(NetworkTest, ConcatenationsAgreeWithReferenceFusedAndAlone) {
  for (const auto& [first, second] : {std::array<uint32_t, 2>{4, 4}, {3, 5}, {1, 1}, {6, 9}}) {
    NetworkBuilder b(first);
    const uint32_t small = b.input(first), large = b.input(second);
    const uint32_t up = b.simple(Op::upsample, small);
    const uint32_t both = b.concat(up, large),
                   turned = b.concat(large, b.simple(Op::upsample, small));
    b.output(both);  // which prevents fusion
    b.output(b.convolution(both, 5, 3));
    b.output(b.convolution(turned, 5, 3));
    b.output(b.convolution(b.concat(b.simple(Op::upsample, small), large), 7, 3));
    b.output(b.convolution(b.concat(b.simple(Op::upsample, small), b.simple(Op::upsample, small)),
                           7, 3));
    b.output(b.convolution(b.concat(large, large), 3, 3));
    b.output(b.convolution(b.concat(large, b.concat(large, large)), 3, 1));
    b.output(b.convolution(b.simple(Op::upsample, small), 4, 3));
    b.output(b.convolution(b.simple(Op::upsample, small), 4, 3, 2));
    for (const auto& [width, height] : {std::array<uint32_t, 2>{1, 1}, {5, 3}, {9, 16}})
      expect_same(b.graph(), {random_image({first, height, width}, width),
                              random_image({second, 2 * height, 2 * width}, height)});
  }
}

TEST_P(NetworkTest, WholeNetworksAgreeWithReference) {
  for (const auto& [width, height, channels, levels] :
       {std::array<uint32_t, 4>{64, 48, 6, 3}, {16, 16, 16, 4}, {8, 40, 5, 2}})
    expect_same(u_net(3, 2, channels, levels, width), {random_image({3, height, width}, 5)});

  NetworkBuilder b(3);  // a classifier
  uint32_t value = b.input(2), channels = 6;
  for (int block = 0; block < 3; ++block, channels *= 2)
    value = b.simple(Op::max_pool, b.convolution(value, channels, 3, 1, Activation::relu));
  value = b.dense(value, 24 * 4 * 4, 33, Activation::relu);
  b.output(b.simple(Op::softmax, b.dense(value, 33, 8)));
  expect_same(b.graph(), {random_image({2, 32, 32}, 6)});
}

TEST_P(NetworkTest, ExtremeValuesAgreeWithReference) {
  NetworkBuilder b(8);
  const uint32_t small = b.input(4), large = b.input(5);
  b.output(b.convolution(large, 4, 3, 1, Activation::sigmoid));
  b.output(b.convolution(large, 4, 3, 1, Activation::leaky_relu, .1f));
  b.output(b.convolution(large, 4, 3, 1));
  b.output(b.convolution(large, 4, 3, 2));
  b.output(b.convolution(large, 4, 1, 1, Activation::relu));
  b.output(b.convolution(b.concat(b.simple(Op::upsample, small), large), 4, 3));
  b.output(b.concat(large, b.simple(Op::upsample, small)));
  b.output(b.dense(large, 5 * 20 * 12, 3));
  b.output(b.depthwise(large, 2, 2, Activation::relu6));
  b.output(b.sum(large, b.simple(Op::global_mean, large)));
  for (const Op op : {Op::softmax, Op::global_mean, Op::max_pool, Op::upsample})
    b.output(b.simple(op, large));
  for (const Activation a : {Activation::relu, Activation::leaky_relu, Activation::sigmoid})
    b.output(b.activation(large, a, .1f));
  for (const double scale : {0.0, 1e-30, 1e-6, 1e3, 1e6, 1e30}) {
    SCOPED_TRACE(scale);
    expect_same(
        b.graph(),
        {random_image({4, 10, 6}, 6, -scale, scale), random_image({5, 20, 12}, 5, -scale, scale)},
        2e-5);
  }
}

// What only picks, or counts from the largest, takes every number that there is.
TEST_P(NetworkTest, TheLargestNumbersAgreeWithReference) {
  constexpr double kMaxFloat = std::numeric_limits<float>::max();
  NetworkBuilder b(8);
  const uint32_t input = b.input(6);
  for (const Op op : {Op::softmax, Op::max_pool}) b.output(b.simple(op, input));
  b.output(b.concat(input, input));
  b.output(b.activation(input, Activation::relu));
  b.output(b.activation(input, Activation::sigmoid));
  for (const auto& [low, high] :
       {std::pair{-kMaxFloat, -kMaxFloat}, {-kMaxFloat, kMaxFloat}, {kMaxFloat, kMaxFloat}})
    expect_same(b.graph(), {random_image({6, 6, 4}, 5, low, high)}, 2e-5);
}

TEST_P(NetworkTest, RunsAgainWithOtherInputs) {
  const Graph graph = u_net(3, 1, 6, 3, 1);
  const std::vector<Shape> shapes = {{3, 24, 32}};
  const Network network(device, graph, shapes);
  for (unsigned seed = 0; seed < 4; ++seed)
    expect_same(network, {random_image(shapes[0], seed, seed ? -1 : -1e3, 1)}, 1e-4);
}

TEST_P(NetworkTest, FusesValuesWithOneReader) {
  const Graph graph = u_net(3, 1, 8, 3, 1);  // 8, 16 and 32 channels
  const network::Plan plan = network::plan(graph, std::vector<Shape>{{3, 32, 32}});
  int upsamples = 0;
  for (const network::Step& step : plan.steps) {
    EXPECT_NE(graph.nodes[step.node].op, Op::concat);
    upsamples += graph.nodes[step.node].op == Op::upsample;
  }
  EXPECT_EQ(upsamples, 1) << "but for a convolution with many channels";
  EXPECT_EQ(plan.steps.size(), graph.nodes.size() - 5);
}

TEST_P(NetworkTest, ValuesThatAreStillNeededShareNoBuffer) {
  const Graph graph = u_net(3, 2, 8, 4, 2);
  const network::Plan plan = network::plan(graph, std::vector<Shape>{{3, 64, 64}});
  const auto inputs = static_cast<uint32_t>(graph.inputs.size());
  std::vector<uint32_t> holds(plan.elements.size(), ~0u);  // by buffer: the value written last
  holds[plan.buffer_of[0]] = 0;
  uint64_t alone = 0;
  for (const network::Step& step : plan.steps) {
    for (const network::Source& source : step.sources)
      EXPECT_EQ(holds[plan.buffer_of[source.value]], source.value) << graph.nodes[step.node].name;
    const uint32_t made = inputs + step.node, buffer = plan.buffer_of[made];
    for (const network::Source& source : step.sources)
      EXPECT_NE(buffer, plan.buffer_of[source.value]) << graph.nodes[step.node].name;
    EXPECT_GE(plan.elements[buffer], network::elements_of(plan.shapes[made]));
    holds[buffer] = made;
    alone += 16 * network::elements_of(plan.shapes[made]);
  }
  EXPECT_LT(plan.bytes(), alone * 85 / 100);
}

TEST_P(NetworkTest, RefusesSizesThatDoNotFitByName) {
  const Graph graph = u_net(3, 1, 4, 3, 1);
  const auto expect_refused = [&](const Graph& of, Shape shape, const std::string& text,
                                  ErrorKind kind = ErrorKind::unsupported) {
    expect_error(kind, text, [&] { Network(device, of, std::vector<Shape>{shape}); });
  };
  expect_refused(graph, {3, 20, 32}, "multiples of two");
  expect_refused(graph, {4, 32, 32}, "input 0");
  expect_refused(graph, {3, 0, 32}, "3 x 0 x 32");
  expect_refused(graph, {3, 1 << 15, 8}, "3 x 32768 x 8 is too large");
  expect_refused(graph, {3, 8, 1u << 31}, "too large");
  expect_refused(graph, {3, 1 << 14, 1 << 14}, "maxStorageBufferRange", ErrorKind::limit);
  NetworkBuilder b(1);
  b.output(b.dense(b.input(2), 2 * 9, 4));
  expect_refused(b.graph(), {2, 3, 4}, "it takes 18 numbers and gets 2 x 3 x 4");
  NetworkBuilder apart(1);
  const uint32_t image = apart.input(2);
  apart.output(apart.sum(image, apart.convolution(image, 2, 3, 2)));
  expect_refused(apart.graph(), {2, 4, 4}, "2 x 4 x 4 and 2 x 2 x 2 cannot be added");
}

}  // namespace inverse::testing
