// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "kernels/network/graph.hpp"

namespace inverse::onnx_import {

/// The graph of an ONNX model (float32, one image at a time, opset 11 to 21). Messages call it
/// `name`.
///
/// Supported: Conv (3 x 3 or 1 x 1, stride 1 or 2, one group, zero padding), BatchNormalization
/// (folded into the Conv before it), Relu, LeakyRelu, Sigmoid (fused into the Conv or Gemm before
/// if that has no other reader), MaxPool (2 x 2), Resize (linear, factor 2, half pixels), Concat
/// (of channels), Flatten and Reshape (to a vector), Gemm, GlobalAveragePool, Softmax (of
/// channels), Identity and Dropout.
///
/// Throws Error(unsupported) naming the operator, its node, and the unsupported feature.
network::Graph graph_of(std::span<const std::byte> model, const std::string& name);

}  // namespace inverse::onnx_import
