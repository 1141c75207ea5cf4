// SPDX-License-Identifier: LGPL-2.1-or-later
// ONNX models through the importer and the device, against OpenCV's dnn with the same model; and
// the importer's errors.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <opencv2/dnn.hpp>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"
#include "kernels/network/network.hpp"
#include "onnx_builder.hpp"
#include "tests/expect_error.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tools/onnx/onnx_import.hpp"

namespace inverse::testing {
namespace {

network::Graph import(const OnnxBuilder& builder) {
  const std::string bytes = builder.bytes();
  return onnx_import::graph_of(std::as_bytes(std::span(bytes)), "model.onnx");
}

std::string import_error(const OnnxBuilder& builder) {
  return error_of([&] { import(builder); }, ErrorKind::unsupported);
}

/// Convolutions of all kinds with batch-norm, skips and upsampling, as in SegmentationNet.
OnnxBuilder image_model(int64_t height, int64_t width) {
  OnnxBuilder b(5);
  const std::string image = b.input("image", {1, 3, height, width});
  const auto block = [&b](const std::string& from, int64_t in, int64_t out, int64_t stride) {
    const std::string c = b.convolution(from, in, out, 3, stride);
    return b.op("LeakyRelu",
                {b.op("BatchNormalization", {c, b.tensor({out}, .1f, 1), b.tensor({out}, .1f),
                                             b.tensor({out}, .1f), b.tensor({out}, .05f, 1)})});
  };
  const std::string top = block(image, 3, 10, 1);
  const std::string middle = block(top, 10, 14, 2);
  const std::string low = b.op("Relu", {b.convolution(b.max_pool(middle), 14, 20, 3)});
  const std::string up = block(b.concat({b.upsample(low), middle}), 34, 12, 1);
  const std::string all = block(b.concat({top, b.upsample(up)}), 22, 8, 1);
  b.output(b.op("Sigmoid", {b.convolution(all, 8, 2, 1)}), {1, 2, height, width});
  return b;
}

/// Pooling blocks and dense nodes, as in ExponentNet.
OnnxBuilder vector_model(int64_t side) {
  OnnxBuilder b(6);
  std::string value = b.input("image", {1, 2, side, side});
  int64_t channels = 2;
  for (const int64_t next : {8, 12, 18}) {
    value = b.max_pool(b.op("Relu", {b.convolution(value, channels, next, 3)}));
    channels = next;
  }
  const std::string flat = b.op("Flatten", {value}, {attribute("axis", 1)});
  const int64_t count = channels * (side / 8) * (side / 8);
  const std::string first = b.op("Gemm", {flat, b.tensor({30, count}, .06f), b.tensor({30}, .1f)},
                                 {attribute("transB", 1)});
  const std::string last =
      b.op("Gemm", {b.op("Relu", {first}), b.tensor({8, 30}, .3f), b.tensor({8}, .1f)},
           {attribute("transB", 1)});
  b.output(b.op("Softmax", {last}, {attribute("axis", 1)}), {1, 8});
  return b;
}

class OnnxTest : public GpuTest {
 protected:
  void expect_as_opencv(const OnnxBuilder& builder, network::Shape shape) {
    const std::string bytes = builder.bytes();
    expect_as_opencv(import(builder), cv::dnn::readNetFromONNX(bytes.data(), bytes.size()), shape,
                     -1);
  }
  /// On numbers from `low` to 1.
  void expect_as_opencv(const network::Graph& graph, cv::dnn::Net peer, network::Shape shape,
                        float low) {
    const network::Network network(device, graph, std::vector{shape});
    std::mt19937 random(9);
    std::uniform_real_distribution<float> value(low, 1);
    cv::Mat blob({1, static_cast<int>(shape.channels), static_cast<int>(shape.height),
                  static_cast<int>(shape.width)},
                 CV_32F);
    Pixels image(4 * network::elements_of(shape), 0.0f);
    const size_t area = size_t{shape.height} * shape.width;
    for (uint32_t c = 0; c < shape.channels; ++c)
      for (size_t i = 0; i < area; ++i)
        image[4 * (1 + c / 4 * area + i) + c % 4] = blob.ptr<float>()[c * area + i] = value(random);
    const auto staged = upload(image);
    run([&](gpu::Commands& commands) {
      commands.copy(staged, network.input(0), staged->bytes());
      network.record(commands);
    });
    const Pixels got = download(network.output(0));

    peer.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    peer.setInput(blob);
    const cv::Mat want = peer.forward();
    const network::Shape result = network.output_shape(0);
    ASSERT_EQ(want.total(), result.size());
    const double largest = cv::norm(want.reshape(1, 1), cv::NORM_INF);
    ASSERT_GT(largest, 0.01) << "nothing to compare";
    const size_t result_area = size_t{result.height} * result.width;
    for (uint32_t c = 0; c < result.channels; ++c)
      for (size_t i = 0; i < result_area; ++i)
        ASSERT_NEAR(got[4 * (1 + c / 4 * result_area + i) + c % 4],
                    want.ptr<float>()[c * result_area + i], 1e-3 * std::max(1.0, largest))
            << "channel " << c << ", pixel " << i;
  }
};

}  // namespace

TEST_F(OnnxTest, ImagesMatchOpenCv) {
  expect_as_opencv(image_model(32, 48), {3, 32, 48});
  expect_as_opencv(image_model(128, 128), {3, 128, 128});
}

TEST_F(OnnxTest, VectorsMatchOpenCv) { expect_as_opencv(vector_model(32), {2, 32, 32}); }

// As the plugin loads them: what the build made of models/lime and models/olat.
TEST_F(OnnxTest, BundledNetworksMatchOpenCv) {
  int networks = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MODELS "/lime")) {
    if (entry.path().extension() != ".onnx") continue;
    const std::string name = entry.path().stem().string();
    SCOPED_TRACE(name);
    const network::Graph graph = network::load(BUILT_MODELS "/lime/" + name + ".net");
    ASSERT_EQ(graph.inputs.size(), 1u);
    const network::Input& input = graph.inputs[0];
    ASSERT_NO_FATAL_FAILURE(expect_as_opencv(graph, cv::dnn::readNetFromONNX(entry.path().string()),
                                             {input.channels, input.height, input.width}, 0));
    ++networks;
  }
  EXPECT_EQ(networks, 5);
  // These two take pictures of any size.
  for (const auto& [name, shape] : {std::pair{"features", network::Shape{6, 64, 96}},
                                    std::pair{"light", network::Shape{24, 16, 16}}}) {
    SCOPED_TRACE(name);
    expect_as_opencv(network::load(BUILT_MODELS "/olat/" + std::string(name) + ".net"),
                     cv::dnn::readNetFromONNX(MODELS "/olat/" + std::string(name) + ".onnx"), shape,
                     0);
  }
}

TEST_F(OnnxTest, SoftmaxOfWhatIsOnePixelIsTheSameInEveryOpset) {
  for (const int64_t opset : {11, 12, 13, 17}) {
    OnnxBuilder b(3, opset);
    const std::string image = b.input("image", {1, 3, 8, 8});
    const std::string mean = b.op("GlobalAveragePool", {b.convolution(image, 3, 6, 3)});
    b.output(b.op("Softmax", {mean}, {attribute("axis", 1)}), {1, 6, 1, 1});
    expect_as_opencv(b, {3, 8, 8});
  }
}

TEST_F(OnnxTest, FoldsWhatCanBeFolded) {
  const network::Graph graph = import(image_model(32, 32));
  for (const network::Node& node : graph.nodes)
    EXPECT_NE(node.op, network::Op::activation) << node.name;
  EXPECT_EQ(graph.nodes.size(), 11u);
}

TEST_F(OnnxTest, MatricesMayBeTransposed) {
  const auto matrix = [](bool transposed) {
    OnnxBuilder b(1);
    const std::string image = b.input("image", {1, 2, 1, 1});
    const std::string weights = transposed ? b.constant({3, 2}, {1, 2, 3, 4, 5, 6})
                                           : b.constant({2, 3}, {1, 3, 5, 2, 4, 6});
    std::vector<onnx::AttributeProto> attributes;
    if (transposed) attributes.push_back(attribute("transB", 1));
    b.output(b.op("Gemm", {b.op("Flatten", {image}), weights}, attributes), {1, 3});
    return import(b).weights;
  };
  EXPECT_EQ(matrix(true), (std::vector<float>{1, 2, 3, 4, 5, 6, 0, 0, 0}));
  EXPECT_EQ(matrix(false), matrix(true));
}

TEST_F(OnnxTest, ValuesWithSeveralReadersAreNotFolded) {
  for (const bool concat : {false, true}) {  // of one, which is the same
    OnnxBuilder b(1);
    const std::string image = b.input("image", {1, 3, 8, 8});
    const std::string plain = b.convolution(image, 3, 4, 1);
    const std::string same = concat ? b.concat({plain}) : b.op("Identity", {plain});
    b.output(b.op("Relu", {same}), {1, 4, 8, 8});
    b.output(plain, {1, 4, 8, 8});
    const network::Graph graph = import(b);
    ASSERT_EQ(graph.nodes.size(), 2u) << concat;
    EXPECT_EQ(graph.nodes[0].activation, network::Activation::none);
    EXPECT_EQ(graph.nodes[1].op, network::Op::activation);
  }
}

TEST_F(OnnxTest, RefusesUnsupportedOperatorsByName) {
  const auto refused = [](const std::string& part,
                          const std::function<std::string(OnnxBuilder&, const std::string&)>& add) {
    OnnxBuilder b(1);
    b.output(add(b, b.input("image", {1, 4, 8, 8})), {1, 4, 8, 8});
    const std::string text = import_error(b);
    expect_contains(text, part);
    EXPECT_EQ(text.rfind("model.onnx: ", 0), 0u) << text;
  };
  const auto with = [](const char* type, const char* name, std::vector<int64_t> values) {
    return [=](OnnxBuilder& b, const std::string& image) {
      return b.op(type, {image, b.tensor({4, 4, 3, 3}, .1f)}, {attribute(name, values)});
    };
  };
  refused("Einsum \"Einsum_0\": this operator is not supported",
          [](auto& b, auto& i) { return b.op("Einsum", {i}); });
  refused("its padding", with("Conv", "pads", {0, 0, 0, 0}));
  refused("dilated", with("Conv", "dilations", {2, 2}));
  refused("stride", [](auto& b, auto& i) {
    return b.op("Conv", {i, b.tensor({4, 4, 1, 1}, 1)}, {attribute("strides", {3, 3})});
  });
  refused("2 x 2", with("MaxPool", "kernel_shape", {3, 3}));
  refused("MaxPool \"MaxPool_0\": it is dilated", [](auto& b, auto& i) {
    return b.op("MaxPool", {i},
                {attribute("kernel_shape", {2, 2}), attribute("strides", {2, 2}),
                 attribute("dilations", {2, 2})});
  });
  refused("training", [](auto& b, auto& i) {
    const auto numbers = [&b] { return b.tensor({4}, .1F, 1); };
    return b.op("BatchNormalization",
                {b.convolution(i, 4, 4, 1), numbers(), numbers(), numbers(), numbers()},
                {attribute("training_mode", 1)});
  });
  refused("5 x 5", [](auto& b, auto& i) { return b.op("Conv", {i, b.tensor({4, 4, 5, 5}, 1)}); });
  refused("not a constant", [](auto& b, auto& i) { return b.op("Conv", {i, i}); });
  refused("bias", [](auto& b, auto& i) {
    return b.op("Conv", {i, b.tensor({4, 4, 1, 1}, 1), b.tensor({3}, 1)});
  });
  refused("linear", [](auto& b, auto& i) {
    return b.op("Resize", {i, "", b.constant({4}, {1, 1, 2, 2})});
  });
  refused("\"nothing\"", [](auto& b, auto&) { return b.op("Relu", {"nothing"}); });
  refused("axis 1", [](auto& b, auto& i) { return b.op("Concat", {i, i}); });
  refused("axis -1", [](auto& b, auto& i) { return b.op("Softmax", {i}); });
  refused("0 nodes", [](auto&, auto& i) { return i; });
  refused("Conv_1\"\": a weight is not a finite number", [](auto& b, auto& i) {
    return b.op("Conv", {i, b.constant({1, 4, 1, 1}, {1, 2, NAN, 4})});
  });
}

// Unsupported attributes: if one is ignored, the network runs, but with other results than ONNX
// defines.
TEST_F(OnnxTest, RefusesEveryAttributeThatMeansSomethingElse) {
  using Proto = onnx::NodeProto;
  using Spoil = std::function<void(Proto*)>;
  const auto with = [](const char* name, const auto& value) -> Spoil {
    return [a = attribute(name, value)](Proto* n) { *n->add_attribute() = a; };
  };
  const auto list = [&](const char* name, const std::vector<int64_t>& values) {
    return with(name, values);
  };
  const auto another = [](const char* name) -> Spoil {
    return [=](Proto* n) { n->add_output(name); };
  };
  const Spoil foreign = [](Proto* n) { n->set_domain("com.example"); };

  const auto node_of = [](OnnxBuilder& b, const std::string& type) -> Proto* {
    const std::string image = b.input("image", {1, 4, 8, 8});
    const auto numbers = [&b] { return b.tensor({4}, .1F, 1); };
    if (type == "Conv") return b.node(type, {image, b.tensor({4, 4, 1, 1}, 1)});
    if (type == "Gemm")
      return b.node(type,
                    {b.op("Flatten", {image}), b.tensor({4 * 8 * 8, 3}, 1), b.tensor({3}, 1)});
    if (type == "MaxPool")
      return b.node(type, {image},
                    {attribute("kernel_shape", {2, 2}), attribute("strides", {2, 2})});
    if (type == "Resize")
      return b.node(type, {image, "", b.constant({4}, {1, 1, 2, 2})},
                    {attribute("mode", "linear")});
    if (type == "BatchNormalization")
      return b.node(type,
                    {b.convolution(image, 4, 4, 1), numbers(), numbers(), numbers(), numbers()});
    return b.node(type, {b.convolution(image, 4, 4, 1)});
  };
  const auto import_error_of = [&](const std::string& type, const Spoil& spoil) {
    OnnxBuilder b(1);
    Proto* n = node_of(b, type);
    if (spoil) spoil(n);
    for (const std::string& made : n->output()) b.output(made, {});
    return import_error(b);
  };
  struct Row {
    const char* type;
    Spoil spoil;
    const char* says;
  };
  for (const Row& row : std::vector<Row>{
           {"Conv", with("group", 2), "groups"},
           {"Conv", with("auto_pad", "SAME_UPPER"), "auto_pad"},
           {"Conv", list("strides", {1, 2}), "stride"},
           {"Conv", list("pads", {0, 0, 1, 1}), "padding"},
           {"Conv", list("dilations", {2, 1}), "dilated"},
           {"Gemm", with("alpha", .5F), "alpha"},
           {"Gemm", with("beta", .5F), "beta"},
           {"Gemm", with("transA", 1), "transA"},
           {"MaxPool", with("ceil_mode", 1), "ceil_mode"},
           {"MaxPool", list("pads", {0, 0, 1, 1}), "padding"},
           {"MaxPool", with("auto_pad", "SAME_LOWER"), "auto_pad"},
           {"MaxPool", list("dilations", {2, 2}), "dilated"},
           {"MaxPool", another("indices"), "indices"},
           {"Resize", with("coordinate_transformation_mode", "align_corners"), "align_corners"},
           {"Resize", with("coordinate_transformation_mode", "asymmetric"), "asymmetric"},
           {"Resize", [](Proto* n) { n->mutable_input()->RemoveLast(); }, "scales, not sizes"},
           {"BatchNormalization", another("mean"), "training"},
           {"Dropout", another("mask"), "mask"},
           {"Dropout",
            [](Proto* n) {
              for (int i = 0; i < 2; ++i) n->add_input("image");
            },
            "training"},
           {"Flatten", with("axis", 2), "axis 1"},
           {"Relu", foreign, "com.example"},
           {"Conv", foreign, "com.example"}}) {
    EXPECT_EQ(import_error_of(row.type, nullptr), "") << row.type;
    const std::string text = import_error_of(row.type, row.spoil);
    expect_contains(text, row.type);
    expect_contains(text, row.says);
  }
  // The same, as constants.
  for (const std::vector<float>& scales :
       {std::vector<float>{1, 1, 3, 3}, {1, 1, 2, 1}, {1, 2, 2, 2}}) {
    OnnxBuilder b(1);
    const std::string image = b.input("image", {1, 4, 8, 8});
    b.output(b.op("Resize", {image, "", b.constant({4}, scales)}, {attribute("mode", "linear")}),
             {});
    expect_contains(import_error(b), "twice as large");
  }
}

TEST_F(OnnxTest, RefusesInputsOfOtherKinds) {
  OnnxBuilder of_bytes(1);
  const std::string image = of_bytes.input("image", {1, 4, 8, 8}, onnx::TensorProto::UINT8);
  of_bytes.output(of_bytes.convolution(image, 4, 4, 1), {});
  expect_contains(import_error(of_bytes), "input \"image\": it is not of float32");
  for (const std::vector<int64_t>& shape :
       {std::vector<int64_t>{1, (int64_t{1} << 32) + 4, 8, 8}, {1, 4, int64_t{1} << 32, 8}}) {
    OnnxBuilder huge(1);
    huge.output(huge.convolution(huge.input("image", shape), 4, 4, 1), {});
    expect_contains(import_error(huge), "too large");
  }
}

TEST_F(OnnxTest, RefusesUnsupportedBatchesAndOperatorSets) {
  const auto refused = [](int64_t opset, int64_t batch) {
    OnnxBuilder b(1, opset);
    const std::string image = b.input("image", {batch, 4, 8, 8});
    b.output(b.op("Relu", {b.convolution(image, 4, 4, 3)}), {batch, 4, 8, 8});
    return import_error(b);
  };
  for (const int64_t opset : {11, 13, 17, 21}) EXPECT_EQ(refused(opset, 1), "");
  EXPECT_EQ(refused(13, 0), "") << "open";
  expect_contains(refused(13, 4), "input \"image\": one image is wanted");
  for (const int64_t opset : {0, 9, 10, 22})
    expect_contains(refused(opset, 1), "(opset) " + std::to_string(opset) + "; 11 to 21");
}

// Up to opset 12 axis 1 meant that axis and all following ones.
TEST_F(OnnxTest, RefusesSoftmaxOverAllOfAnImage) {
  const auto import_error_of = [](int64_t opset, bool with_axis) {
    OnnxBuilder b(1, opset);
    const std::string image = b.convolution(b.input("image", {1, 4, 8, 8}), 4, 4, 1);
    b.output(
        with_axis ? b.op("Softmax", {image}, {attribute("axis", 1)}) : b.op("Softmax", {image}),
        {1, 4, 8, 8});
    return import_error(b);
  };
  EXPECT_EQ(import_error_of(13, true), "");
  for (const bool with_axis : {false, true})
    for (const int64_t opset : {11, 12})
      expect_contains(import_error_of(opset, with_axis), "all of its pixels together");
}

TEST_F(OnnxTest, RefusesFilesThatAreCutShort) {
  const std::string bytes = vector_model(16).bytes();
  for (size_t size = 0; size < bytes.size(); size += 97)
    expect_error(ErrorKind::unsupported, "it is no ONNX model, or cut short",
                 [&] { onnx_import::graph_of(std::as_bytes(std::span(bytes.data(), size)), ""); });
}

}  // namespace inverse::testing
