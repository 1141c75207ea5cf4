// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tools/onnx/onnx_model.hpp"

namespace inverse::testing {

/// Attributes of a node.
inline onnx::AttributeProto attribute(const char* name, onnx::AttributeProto::AttributeType type) {
  onnx::AttributeProto a;
  a.set_name(name);
  a.set_type(type);
  return a;
}
inline onnx::AttributeProto attribute(const char* name, int value) {
  auto a = attribute(name, onnx::AttributeProto::INT);
  a.set_i(value);
  return a;
}
inline onnx::AttributeProto attribute(const char* name, float value) {
  auto a = attribute(name, onnx::AttributeProto::FLOAT);
  a.set_f(value);
  return a;
}
inline onnx::AttributeProto attribute(const char* name, const char* value) {
  auto a = attribute(name, onnx::AttributeProto::STRING);
  a.set_s(value);
  return a;
}
inline onnx::AttributeProto attribute(const char* name, const std::vector<int64_t>& values) {
  auto a = attribute(name, onnx::AttributeProto::INTS);
  for (const int64_t v : values) a.add_ints(v);
  return a;
}

/// Writes ONNX models as PyTorch exports them, with random weights.
class OnnxBuilder {
 public:
  explicit OnnxBuilder(unsigned seed, int64_t opset = 13) : random_(seed) {
    model_.set_ir_version(7);
    model_.add_opset_import()->set_version(opset);
    model_.mutable_graph()->set_name("test");
  }

  std::string input(const std::string& name, std::vector<int64_t> shape,
                    int32_t type = onnx::TensorProto::FLOAT) {
    describe(model_.mutable_graph()->add_input(), name, shape, type);
    return name;
  }
  void output(const std::string& name, std::vector<int64_t> shape) {
    describe(model_.mutable_graph()->add_output(), name, shape, onnx::TensorProto::FLOAT);
  }
  /// A float tensor of random numbers around `middle`.
  std::string tensor(std::vector<int64_t> shape, float spread, float middle = 0) {
    std::normal_distribution<float> number(middle, spread);
    int64_t count = 1;
    for (const int64_t side : shape) count *= side;
    std::vector<float> data(static_cast<size_t>(count));
    for (float& v : data) v = number(random_);
    return constant(shape, data);
  }
  std::string constant(const std::vector<int64_t>& shape, const std::vector<float>& data) {
    onnx::TensorProto* t = model_.mutable_graph()->add_initializer();
    t->set_name(fresh("w"));
    t->set_data_type(onnx::TensorProto::FLOAT);
    for (const int64_t side : shape) t->add_dims(side);
    t->set_raw_data(data.data(), data.size() * sizeof(float));
    return t->name();
  }
  /// Appends a node, whose output(0) is the result.
  onnx::NodeProto* node(const std::string& type, const std::vector<std::string>& inputs,
                        const std::vector<onnx::AttributeProto>& attributes = {}) {
    onnx::NodeProto* n = model_.mutable_graph()->add_node();
    n->set_op_type(type);
    n->set_name(fresh(type + "_"));
    for (const std::string& i : inputs) n->add_input(i);
    n->add_output(fresh("v"));
    for (const onnx::AttributeProto& a : attributes) *n->add_attribute() = a;
    return n;
  }
  std::string op(const std::string& type, const std::vector<std::string>& inputs,
                 const std::vector<onnx::AttributeProto>& attributes = {}) {
    return node(type, inputs, attributes)->output(0);
  }
  std::string convolution(const std::string& from, int64_t in, int64_t out, int64_t kernel,
                          int64_t stride = 1) {
    const float spread = std::sqrt(2.0f / static_cast<float>(in * kernel * kernel));
    return op("Conv", {from, tensor({out, in, kernel, kernel}, spread), tensor({out}, .1f)},
              {attribute("kernel_shape", {kernel, kernel}), attribute("strides", {stride, stride}),
               attribute("pads", std::vector<int64_t>(4, kernel / 2)),
               attribute("dilations", {1, 1}), attribute("group", 1)});
  }
  std::string max_pool(const std::string& from) {
    return op("MaxPool", {from}, {attribute("kernel_shape", {2, 2}), attribute("strides", {2, 2})});
  }
  std::string upsample(const std::string& from) {
    return op("Resize", {from, "", constant({4}, {1, 1, 2, 2})},
              {attribute("mode", "linear"),
               attribute("coordinate_transformation_mode", "pytorch_half_pixel")});
  }
  std::string concat(const std::vector<std::string>& parts) {
    return op("Concat", parts, {attribute("axis", 1)});
  }
  std::string bytes() const { return model_.SerializeAsString(); }

 private:
  std::string fresh(const std::string& stem) { return stem + std::to_string(count_++); }
  static void describe(onnx::ValueInfoProto* info, const std::string& name,
                       const std::vector<int64_t>& shape, int32_t of) {
    info->set_name(name);
    auto* type = info->mutable_type()->mutable_tensor_type();
    type->set_elem_type(of);
    for (const int64_t side : shape) type->mutable_shape()->add_dim()->set_dim_value(side);
  }

  onnx::ModelProto model_;
  std::mt19937 random_;
  int count_ = 0;
};

}  // namespace inverse::testing
