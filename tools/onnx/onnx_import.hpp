#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "kernels/network/graph.hpp"

namespace inverse::onnx_import {

/// The graph of an ONNX model (float32, one image at a time, opset 11 to 21). `name` is for
/// messages.
///
/// Taken: Conv (3 x 3 or 1 x 1, stride 1 or 2, one group, zeros all around), BatchNormalization
/// (folded into the Conv before it), Relu, LeakyRelu, Sigmoid (made part of the Conv or Gemm before
/// them where nobody else reads that), MaxPool (2 x 2), Resize (linear, twice as large, half
/// pixels), Concat (of channels), Flatten and Reshape (to a vector), Gemm, GlobalAveragePool,
/// Softmax (of channels), Identity and Dropout.
///
/// Throws Error(unsupported) naming the operator, its node, and what about it is not taken.
network::Graph graph_of(std::span<const std::byte> model, const std::string& name);

}  // namespace inverse::onnx_import
