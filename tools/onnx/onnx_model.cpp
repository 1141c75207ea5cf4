// SPDX-License-Identifier: LGPL-2.1-or-later
#include "onnx_model.hpp"

#include <cstring>

#include "common/error.hpp"

namespace inverse::onnx_import {
namespace {

template <typename T, typename Field>
std::vector<T> values_of(const onnx::TensorProto& proto, const Field& field, size_t count,
                         const std::string& name) {
  std::vector<T> values(field.begin(), field.end());
  if (proto.has_raw_data()) {
    values.resize(proto.raw_data().size() / sizeof(T));
    if (!values.empty()) memcpy(values.data(), proto.raw_data().data(), values.size() * sizeof(T));
  }
  if (values.size() != count)
    throw Error(ErrorKind::unsupported, "tensor \"" + name + "\" has " +
                                            std::to_string(values.size()) +
                                            " numbers in place of " + std::to_string(count));
  return values;
}

}  // namespace

Tensor tensor_of(const onnx::TensorProto& proto, const std::string& name) {
  Tensor tensor;
  constexpr size_t kMaxElements = size_t{1} << 30;
  size_t count = 1;
  for (const int64_t side : proto.dims()) {
    if (side < 0 || static_cast<size_t>(side) > kMaxElements || count > kMaxElements)
      throw Error(ErrorKind::unsupported, "tensor \"" + name + "\" is of an impossible size");
    tensor.shape.push_back(side);
    count *= static_cast<size_t>(side);
  }
  if (proto.data_location() == onnx::TensorProto::EXTERNAL)
    throw Error(ErrorKind::unsupported,
                "tensor \"" + name + "\" lies in another file; export the model with its weights");
  if (proto.data_type() == onnx::TensorProto::FLOAT)
    tensor.floats = values_of<float>(proto, proto.float_data(), count, name);
  else if (proto.data_type() == onnx::TensorProto::INT64)
    tensor.integers = values_of<int64_t>(proto, proto.int64_data(), count, name);
  else
    throw Error(ErrorKind::unsupported,
                "tensor \"" + name + "\" is of type " +
                    onnx::TensorProto_DataType_Name(
                        static_cast<onnx::TensorProto_DataType>(proto.data_type())) +
                    ", not FLOAT or INT64");
  return tensor;
}

std::unordered_map<std::string, Tensor> constants_of(const onnx::GraphProto& graph) {
  std::unordered_map<std::string, Tensor> constants;
  for (const onnx::TensorProto& proto : graph.initializer())
    constants[proto.name()] = tensor_of(proto, proto.name());
  for (const onnx::NodeProto& node : graph.node()) {
    if (node.op_type() != "Constant" || node.output_size() != 1) continue;
    for (const onnx::AttributeProto& attribute : node.attribute())
      if (attribute.name() == "value")
        constants[node.output(0)] = tensor_of(attribute.t(), node.output(0));
  }
  return constants;
}

std::string Operator::text() const {
  return node_.op_type() + " \"" +
         (node_.name().empty() && node_.output_size() ? node_.output(0) : node_.name()) + "\"";
}

std::string Operator::input(int index) const {
  return index < node_.input_size() ? node_.input(index) : std::string();
}

std::string Operator::output(int index) const {
  return index < node_.output_size() ? node_.output(index) : std::string();
}

const onnx::AttributeProto* Operator::find(const char* attribute) const {
  for (const onnx::AttributeProto& a : node_.attribute())
    if (a.name() == attribute) return &a;
  return nullptr;
}

int64_t Operator::integer(const char* attribute, int64_t otherwise) const {
  const auto* a = find(attribute);
  return a ? a->i() : otherwise;
}

float Operator::number(const char* attribute, float otherwise) const {
  const auto* a = find(attribute);
  return a ? a->f() : otherwise;
}

std::string Operator::word(const char* attribute, const std::string& otherwise) const {
  const auto* a = find(attribute);
  return a ? a->s() : otherwise;
}

std::vector<int64_t> Operator::integers(const char* attribute,
                                        std::vector<int64_t> otherwise) const {
  const auto* a = find(attribute);
  return a ? std::vector<int64_t>(a->ints().begin(), a->ints().end()) : std::move(otherwise);
}

void Operator::refuse(const std::string& why) const {
  throw Error(ErrorKind::unsupported, text() + ": " + why);
}

}  // namespace inverse::onnx_import
