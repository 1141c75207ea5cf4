// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

// Debian's library is built with these, but has no .pc file.
#define ONNX_ML 1
#define ONNX_NAMESPACE onnx
#include <onnx/onnx_pb.h>

namespace inverse::onnx_import {

/// A constant of a model.
struct Tensor {
  std::vector<int64_t> shape;
  std::vector<float> floats;      ///< of a float tensor
  std::vector<int64_t> integers;  ///< of an integer tensor
};

/// Reads a tensor; throws Error(unsupported) for types other than float32 and int64.
Tensor tensor_of(const onnx::TensorProto& proto, const std::string& name);

/// Constants by name: initializers, and results of Constant nodes.
std::unordered_map<std::string, Tensor> constants_of(const onnx::GraphProto& graph);

/// A node with access to its attributes.
class Operator {
 public:
  explicit Operator(const onnx::NodeProto& node) : node_(node) {}

  const std::string& type() const { return node_.op_type(); }
  /// Domain of the operator; empty or "ai.onnx": ONNX itself.
  const std::string& domain() const { return node_.domain(); }
  /// "Conv \"name\"", for messages.
  std::string text() const;
  int inputs() const { return node_.input_size(); }
  /// The name of an input; empty if absent.
  std::string input(int index) const;
  const std::string& output() const { return node_.output(0); }
  /// The name of an output; empty if absent.
  std::string output(int index) const;
  int outputs() const { return node_.output_size(); }

  int64_t integer(const char* attribute, int64_t otherwise) const;
  float number(const char* attribute, float otherwise) const;
  std::string word(const char* attribute, const std::string& otherwise) const;
  std::vector<int64_t> integers(const char* attribute, std::vector<int64_t> otherwise) const;

  /// Throws Error(unsupported) with this operator and the reason.
  [[noreturn]] void refuse(const std::string& why) const;
  /// Throws unless `holds`.
  void expect(bool holds, const std::string& why) const {
    if (!holds) refuse(why);
  }

 private:
  const onnx::AttributeProto* find(const char* attribute) const;

  const onnx::NodeProto& node_;
};

}  // namespace inverse::onnx_import
