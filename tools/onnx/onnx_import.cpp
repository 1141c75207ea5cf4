// SPDX-License-Identifier: LGPL-2.1-or-later
#include "onnx_import.hpp"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "common/error.hpp"
#include "onnx_model.hpp"

namespace inverse::onnx_import {
namespace {

using network::Activation;
using network::Graph;
using network::Node;
using network::Op;

// Supported versions of ONNX' operators. Before 11, Resize and others had other inputs.
constexpr int64_t kFirstOpset = 11, kLastOpset = 21;
constexpr int64_t kMaxDimension = 1 << 16;  // of an input; graph.cpp takes no more

/// The version of ONNX' own operators in a model.
int64_t opset_of(const onnx::ModelProto& model) {
  int64_t version = 0;
  for (const onnx::OperatorSetIdProto& set : model.opset_import())
    if (set.domain().empty() || set.domain() == "ai.onnx") version = set.version();
  if (version < kFirstOpset || version > kLastOpset)
    throw Error(ErrorKind::unsupported, "it is of operator set (opset) " + std::to_string(version) +
                                            "; " + std::to_string(kFirstOpset) + " to " +
                                            std::to_string(kLastOpset) +
                                            " are taken: export it with one of these");
  return version;
}

class Importer {
 public:
  Importer(const onnx::GraphProto& proto, int64_t opset)
      : proto_(proto), opset_(opset), constants_(constants_of(proto)) {
    for (const onnx::NodeProto& node : proto.node())
      for (const std::string& input : node.input()) ++readers_[input];
    for (const onnx::ValueInfoProto& output : proto.output()) ++readers_[output.name()];
  }

  Graph run() {
    for (const onnx::ValueInfoProto& input : proto_.input())
      if (!constants_.count(input.name())) add_input(input);
    for (const onnx::NodeProto& node : proto_.node()) add(Operator(node));
    for (const onnx::ValueInfoProto& output : proto_.output()) {
      const auto found = values_.find(output.name());
      if (found == values_.end())
        throw Error(ErrorKind::unsupported, "output \"" + output.name() + "\" is made by no node");
      graph_.outputs.push_back({output.name(), found->second});
    }
    return std::move(graph_);
  }

 private:
  void add_input(const onnx::ValueInfoProto& input) {
    const onnx::TypeProto_Tensor& type = input.type().tensor_type();
    if (type.elem_type() != onnx::TensorProto::FLOAT)
      throw Error(ErrorKind::unsupported,
                  "input \"" + input.name() + "\": it is not of float32 (FLOAT)");
    const onnx::TensorShapeProto& shape = type.shape();
    for (const onnx::TensorShapeProto_Dimension& side : shape.dim())
      if (side.dim_value() > kMaxDimension)
        throw Error(ErrorKind::unsupported, "input \"" + input.name() + "\": a side of " +
                                                std::to_string(side.dim_value()) + " is too large");
    if (shape.dim_size() != 4 || shape.dim(1).dim_value() < 1 || shape.dim(0).dim_value() > 1)
      throw Error(
          ErrorKind::unsupported,
          "input \"" + input.name() +
              "\": one image is wanted, of [1, channels, height, width] with known channels");
    values_[input.name()] = static_cast<uint32_t>(graph_.inputs.size());
    const auto side = [&shape](int index) {  // 0 if it is open, as dim_value is then
      return static_cast<uint32_t>(std::max<int64_t>(0, shape.dim(index).dim_value()));
    };
    graph_.inputs.push_back({input.name(), side(1), side(2), side(3)});
  }

  uint32_t value(const Operator& op, int index) const {
    const auto found = values_.find(op.input(index));
    if (found == values_.end())
      op.refuse("its input \"" + op.input(index) + "\" is no image that was made before");
    return found->second;
  }
  const Tensor& constant(const Operator& op, int index) const {
    const auto found = constants_.find(op.input(index));
    if (found == constants_.end())
      op.refuse("its input \"" + op.input(index) + "\" is not a constant");
    return found->second;
  }
  /// The node that makes `value` for this reader only; null if it is an input or others read it.
  Node* only_mine(const Operator& op, int index) {
    const uint32_t from = value(op, index);
    if (from < graph_.inputs.size() || readers_[op.input(index)] != 1) return nullptr;
    return &graph_.nodes[from - graph_.inputs.size()];
  }
  /// Whether somebody reads a result behind the first.
  bool wanted(const Operator& op, int index) const {
    const std::string name = op.output(index);
    return !name.empty() && readers_.count(name) > 0;
  }
  Node make(const Operator& op, Op kind, std::vector<uint32_t> inputs) const {
    Node node;
    node.name = op.text();
    node.op = kind;
    node.inputs = std::move(inputs);
    return node;
  }
  void put(const std::string& result, Node node) {
    graph_.nodes.push_back(std::move(node));
    values_[result] = graph_.values() - 1;
  }
  void put_weights(Node& node, const std::vector<float>& weights, const std::vector<float>& bias) {
    node.weights = graph_.weights.size();
    graph_.weights.insert(graph_.weights.end(), weights.begin(), weights.end());
    graph_.weights.insert(graph_.weights.end(), bias.begin(), bias.end());
  }
  std::vector<float> bias(const Operator& op, uint32_t channels) const {
    if (op.input(2).empty()) return std::vector<float>(channels, 0.0f);
    const Tensor& bias = constant(op, 2);
    op.expect(bias.floats.size() == channels, "its bias has " + std::to_string(bias.floats.size()) +
                                                  " numbers in place of " +
                                                  std::to_string(channels));
    return bias.floats;
  }

  void convolution(const Operator& op) {
    const Tensor& weights = constant(op, 1);
    op.expect(weights.shape.size() == 4 && !weights.floats.empty(), "it is not of two dimensions");
    const int64_t k = weights.shape[2];
    op.expect((k == 1 || k == 3) && weights.shape[3] == k,
              "a kernel of " + std::to_string(k) + " x " + std::to_string(weights.shape[3]));
    const int64_t groups = op.integer("group", 1);
    const bool depthwise =
        groups > 1 && k == 3 && weights.shape[1] == 1 && weights.shape[0] == groups;
    op.expect(groups == 1 || depthwise, "it has groups that are not its channels");
    const auto dilations = op.integers("dilations", {1, 1});
    const int64_t most = depthwise ? int64_t{network::kMaxDilation} : 1;
    op.expect(dilations.size() == 2 && dilations[0] == dilations[1] && dilations[0] >= 1 &&
                  dilations[0] <= most,
              "it is dilated");
    const int64_t dilation = dilations[0];
    op.expect(op.word("auto_pad", "NOTSET") == "NOTSET", "auto_pad; give its padding");
    const int64_t padding = k / 2 * dilation;
    op.expect(op.integers("pads", {0, 0, 0, 0}) == std::vector<int64_t>(4, padding),
              "its padding is not " + std::to_string(padding) + " all around");
    const auto strides = op.integers("strides", {1, 1});
    op.expect(
        strides.size() == 2 && strides[0] == strides[1] && (strides[0] == 1 || strides[0] == 2),
        "its stride is neither 1 nor 2");
    Node node = make(op, depthwise ? Op::depthwise : Op::convolution, {value(op, 0)});
    node.kernel = static_cast<uint32_t>(k);
    node.stride = static_cast<uint32_t>(strides[0]);
    node.dilation = static_cast<uint32_t>(dilation);
    node.channels = static_cast<uint32_t>(weights.shape[0]);
    node.fan_in = static_cast<uint32_t>(weights.shape[1]);
    put_weights(node, weights.floats, bias(op, node.channels));
    put(op.output(), std::move(node));
  }

  void dense(const Operator& op) {
    op.expect(op.number("alpha", 1) == 1 && op.number("beta", 1) == 1, "alpha or beta is not 1");
    op.expect(op.integer("transA", 0) == 0, "transA");
    const Tensor& given = constant(op, 1);
    op.expect(given.shape.size() == 2 && !given.floats.empty(), "its matrix has no two dimensions");
    const bool rows_first = op.integer("transB", 0) != 0;
    const auto channels = static_cast<uint32_t>(given.shape[rows_first ? 0 : 1]);
    const auto fan_in = static_cast<uint32_t>(given.shape[rows_first ? 1 : 0]);
    std::vector<float> weights = given.floats;
    if (!rows_first)
      for (uint32_t to = 0; to < channels; ++to)
        for (uint32_t from = 0; from < fan_in; ++from)
          weights[size_t{to} * fan_in + from] = given.floats[size_t{from} * channels + to];
    Node node = make(op, Op::dense, {value(op, 0)});
    node.channels = channels;
    node.fan_in = fan_in;
    put_weights(node, weights, bias(op, channels));
    put(op.output(), std::move(node));
  }

  /// w' = w g / sqrt(v + e), b' = (b - m) g / sqrt(v + e) + c.
  void batch_norm(const Operator& op) {
    Node* node = only_mine(op, 0);
    op.expect(node && (node->op == Op::convolution || node->op == Op::depthwise) &&
                  node->activation == Activation::none,
              "it does not follow a Conv that nothing else reads");
    // Before opset 14, results beyond the first indicated training mode if used.
    op.expect(op.integer("training_mode", 0) == 0 && !wanted(op, 1), "it is in training");
    std::array<const float*, 4> parts{};
    for (int i = 0; i < 4; ++i) {
      const std::vector<float>& part = constant(op, i + 1).floats;
      op.expect(part.size() == node->channels, "its constants do not fit the Conv before it");
      parts[static_cast<size_t>(i)] = part.data();
    }
    const auto& [scale, shift, mean, variance] = parts;
    float* weights = graph_.weights.data() + node->weights;
    float* bias = weights + node->weight_count();
    const uint64_t each = node->weight_count() / node->channels;
    for (uint32_t c = 0; c < node->channels; ++c) {
      const double factor =
          scale[c] / std::sqrt(static_cast<double>(variance[c]) + op.number("epsilon", 1e-5f));
      for (uint64_t i = c * each; i < (c + 1) * each; ++i)
        weights[i] = static_cast<float>(weights[i] * factor);
      bias[c] = static_cast<float>((bias[c] - mean[c]) * factor + shift[c]);
    }
    values_[op.output()] = value(op, 0);
  }

  /// Clip from 0 to 6 alone: ReLU6.
  void clip(const Operator& op) {
    const auto bound = [&](int index, const char* name) {
      if (op.input(index).empty()) return op.number(name, NAN);
      const std::vector<float>& given = constant(op, index).floats;
      return given.size() == 1 ? given[0] : NAN;
    };
    op.expect(bound(1, "min") == 0 && bound(2, "max") == 6, "only 0 to 6 is taken");
    activate(op, Activation::relu6, 0);
  }
  void sum(const Operator& op) {
    op.expect(op.inputs() == 2, "it has not two inputs");
    put(op.output(), make(op, Op::add, {value(op, 0), value(op, 1)}));
  }
  void activation(const Operator& op) {
    const Activation kind = op.type() == "Relu"        ? Activation::relu
                            : op.type() == "LeakyRelu" ? Activation::leaky_relu
                                                       : Activation::sigmoid;
    const float slope = kind == Activation::leaky_relu ? op.number("alpha", 0.01f) : 0;
    activate(op, kind, slope);
  }
  void activate(const Operator& op, Activation kind, float slope) {
    Node* before = only_mine(op, 0);
    if (before && before->has_weights() && before->activation == Activation::none) {
      before->activation = kind;
      before->slope = slope;
      values_[op.output()] = value(op, 0);
      return;
    }
    Node node = make(op, Op::activation, {value(op, 0)});
    node.activation = kind;
    node.slope = slope;
    put(op.output(), std::move(node));
  }

  void max_pool(const Operator& op) {
    const std::vector<int64_t> two = {2, 2};
    op.expect(!wanted(op, 1), "its indices are wanted");
    op.expect(op.integers("kernel_shape", {}) == two && op.integers("strides", {1, 1}) == two,
              "only 2 x 2 with stride 2 is taken");
    op.expect(op.integers("pads", {0, 0, 0, 0}) == std::vector<int64_t>(4, 0), "it has padding");
    op.expect(op.integers("dilations", {1, 1}) == std::vector<int64_t>({1, 1}), "it is dilated");
    op.expect(op.integer("ceil_mode", 0) == 0, "ceil_mode");
    op.expect(op.word("auto_pad", "NOTSET") == "NOTSET", "auto_pad");
    put(op.output(), make(op, Op::max_pool, {value(op, 0)}));
  }

  void resize(const Operator& op) {
    op.expect(op.word("mode", "nearest") == "linear", "its mode is not linear");
    const std::string how = op.word("coordinate_transformation_mode", "half_pixel");
    op.expect(how == "half_pixel" || how == "pytorch_half_pixel",
              "coordinates \"" + how + "\"; only half_pixel is taken (align_corners=False)");
    op.expect(!op.input(2).empty(), "it needs constant scales, not sizes");
    op.expect(constant(op, 2).floats == std::vector<float>({1, 1, 2, 2}),
              "only twice as large is taken");
    put(op.output(), make(op, Op::upsample, {value(op, 0)}));
  }

  void concat(const Operator& op) {
    op.expect(op.integer("axis", 0) == 1, "only channels (axis 1) are taken");
    op.expect(op.inputs() >= 1, "it has no inputs");
    if (op.inputs() == 1) return pass(op);
    uint32_t all = value(op, 0);
    for (int i = 1; i < op.inputs(); ++i) {
      graph_.nodes.push_back(make(op, Op::concat, {all, value(op, i)}));
      all = graph_.values() - 1;
    }
    values_[op.output()] = all;
  }

  void softmax(const Operator& op) {
    // Before opset 13, softmax ran over the axis and all following ones.
    const bool over_all = opset_ < 13;
    const int64_t axis = op.integer("axis", over_all ? 1 : -1);
    op.expect(axis == 1 || axis == -1, "only channels (axis 1) are taken");
    op.expect(axis == 1 || comes_of(op, Op::dense), "axis -1 of an image");
    op.expect(!over_all || comes_of(op, Op::dense) || comes_of(op, Op::global_mean),
              "axis 1 of an image, which before opset 13 is all of its pixels together");
    put(op.output(), make(op, Op::softmax, {value(op, 0)}));
  }
  /// Whether the input of an operator is the result of a node of this kind.
  bool comes_of(const Operator& op, Op kind) const {
    const uint32_t from = value(op, 0);
    return from >= graph_.inputs.size() && graph_.nodes[from - graph_.inputs.size()].op == kind;
  }

  void dropout(const Operator& op) {
    op.expect(op.input(2).empty(), "it may be in training");
    op.expect(!wanted(op, 1), "its mask is wanted");
    pass(op);
  }
  void pass(const Operator& op) {
    if (const auto found = constants_.find(op.input(0)); found != constants_.end()) {
      const Tensor same = found->second;
      constants_[op.output()] = same;
      return;
    }
    values_[op.output()] = value(op, 0);
    readers_[op.output()] += readers_[op.input(0)] - 1;  // whoever reads one name reads the other
    readers_[op.input(0)] = readers_[op.output()];
  }
  /// Gemm treats images as vectors, channel by channel, as ONNX does.
  void flatten(const Operator& op) {
    if (op.type() == "Flatten") {
      op.expect(op.integer("axis", 1) == 1, "only axis 1 is taken");
    } else {
      const auto& to = constant(op, 1).integers;
      op.expect(to.size() == 2 && (to[0] == 1 || to[0] == 0 || to[0] == -1),
                "only [1, n] is taken");
    }
    for (const onnx::NodeProto& node : proto_.node())
      for (const std::string& input : node.input())
        op.expect(input != op.output() || node.op_type() == "Gemm",
                  "its result must go to Gemm, and goes to " + Operator(node).text());
    pass(op);
  }

  void add(const Operator& op) {
    static const std::unordered_map<std::string, void (Importer::*)(const Operator&)> known = {
        {"Conv", &Importer::convolution},
        {"BatchNormalization", &Importer::batch_norm},
        {"Relu", &Importer::activation},
        {"LeakyRelu", &Importer::activation},
        {"Sigmoid", &Importer::activation},
        {"MaxPool", &Importer::max_pool},
        {"Resize", &Importer::resize},
        {"Concat", &Importer::concat},
        {"Flatten", &Importer::flatten},
        {"Reshape", &Importer::flatten},
        {"Gemm", &Importer::dense},
        {"GlobalAveragePool", &Importer::global_mean},
        {"Softmax", &Importer::softmax},
        {"Identity", &Importer::pass},
        {"Dropout", &Importer::dropout},
        {"Clip", &Importer::clip},
        {"Add", &Importer::sum}};
    op.expect(op.domain().empty() || op.domain() == "ai.onnx",
              "an operator of \"" + op.domain() + "\", not of ONNX itself");
    if (op.type() == "Constant") return;
    const auto found = known.find(op.type());
    if (found == known.end())
      op.refuse(
          "this operator is not supported (supported are Conv, BatchNormalization, Relu, "
          "LeakyRelu, Sigmoid, MaxPool, Resize, Concat, Flatten, Reshape, Gemm, "
          "GlobalAveragePool, Softmax, Identity, Dropout, Clip, Add)");
    op.expect(op.outputs() >= 1 && (op.inputs() >= 1), "it has no input or no result");
    (this->*found->second)(op);
  }
  void global_mean(const Operator& op) {
    put(op.output(), make(op, Op::global_mean, {value(op, 0)}));
  }

  const onnx::GraphProto& proto_;
  const int64_t opset_;
  std::unordered_map<std::string, Tensor> constants_;
  std::unordered_map<std::string, uint32_t> values_;  // by the name that ONNX has for them
  std::unordered_map<std::string, int> readers_;
  Graph graph_;
};

}  // namespace

Graph graph_of(std::span<const std::byte> model, const std::string& name) {
  if (model.size() > INT_MAX)
    throw Error(ErrorKind::unsupported, name + ": larger than 2 GiB, which no ONNX file may be");
  onnx::ModelProto proto;
  if (!proto.ParseFromArray(model.data(), static_cast<int>(model.size())) || !proto.has_graph())
    throw Error(ErrorKind::unsupported, name + ": it is no ONNX model, or cut short");
  try {
    Graph graph = Importer(proto.graph(), opset_of(proto)).run();
    network::validate(graph);
    // If input sizes are given, check the shapes of all layers.
    std::vector<network::Shape> given;
    for (const network::Input& input : graph.inputs)
      if (input.height && input.width) given.push_back({input.channels, input.height, input.width});
    if (given.size() == graph.inputs.size()) network::shapes_of(graph, given);
    return graph;
  } catch (const Error& error) {
    throw Error(ErrorKind::unsupported, name + ": " + error.what());
  }
}

}  // namespace inverse::onnx_import
