// SPDX-License-Identifier: LGPL-2.1-or-later
#include "network.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

using network::Activation;
using network::Graph;
using network::Node;
using network::Op;

double activated(const Node& node, double v) {
  switch (node.activation) {
    case Activation::relu:
      return std::max(v, 0.0);
    case Activation::leaky_relu:
      return v > 0 ? v : node.slope * v;
    case Activation::sigmoid:
      return 1 / (1 + std::exp(-v));
    case Activation::relu6:
      return std::clamp(v, 0.0, 6.0);
    case Activation::none:
      break;
  }
  return v;
}

void convolve(const Graph& graph, const Node& node, const Image& in, Image& out) {
  const float* weights = graph.weights.data() + node.weights;
  const int k = static_cast<int>(node.kernel), border = k / 2;
  const int height = static_cast<int>(in.shape.height), width = static_cast<int>(in.shape.width);
  for (uint32_t to = 0; to < out.shape.channels; ++to)
    for (uint32_t y = 0; y < out.shape.height; ++y)
      for (uint32_t x = 0; x < out.shape.width; ++x) {
        double sum = weights[node.weight_count() + to];
        for (uint32_t from = 0; from < node.fan_in; ++from)
          for (int dy = 0; dy < k; ++dy)
            for (int dx = 0; dx < k; ++dx) {
              const int sy = static_cast<int>(y * node.stride) + dy - border;
              const int sx = static_cast<int>(x * node.stride) + dx - border;
              if (sy < 0 || sy >= height || sx < 0 || sx >= width) continue;
              sum += in.at(from, static_cast<uint32_t>(sy), static_cast<uint32_t>(sx)) *
                     weights[((size_t{to} * node.fan_in + from) * k + dy) * k + dx];
            }
        out.at(to, y, x) = activated(node, sum);
      }
}

void depthwise(const Graph& graph, const Node& node, const Image& in, Image& out) {
  const float* weights = graph.weights.data() + node.weights;
  const int apart = static_cast<int>(node.dilation);
  const int height = static_cast<int>(in.shape.height), width = static_cast<int>(in.shape.width);
  for (uint32_t c = 0; c < out.shape.channels; ++c)
    for (uint32_t y = 0; y < out.shape.height; ++y)
      for (uint32_t x = 0; x < out.shape.width; ++x) {
        double sum = weights[node.weight_count() + c];
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const int sy = static_cast<int>(y * node.stride) + apart * dy;
            const int sx = static_cast<int>(x * node.stride) + apart * dx;
            if (sy < 0 || sy >= height || sx < 0 || sx >= width) continue;
            sum += in.at(c, static_cast<uint32_t>(sy), static_cast<uint32_t>(sx)) *
                   weights[9 * size_t{c} + size_t(3 * (dy + 1) + dx + 1)];
          }
        out.at(c, y, x) = activated(node, sum);
      }
}

void add(const Image& first, const Image& second, Image& out) {
  const bool vector = second.shape != first.shape;
  const size_t area = size_t{first.shape.height} * first.shape.width;
  for (size_t i = 0; i < out.data.size(); ++i)
    out.data[i] = first.data[i] + second.data[vector ? i / area : i];
}

void dense(const Graph& graph, const Node& node, const Image& in, Image& out) {
  const float* weights = graph.weights.data() + node.weights;
  for (uint32_t to = 0; to < node.channels; ++to) {
    double sum = weights[node.weight_count() + to];
    for (uint32_t from = 0; from < node.fan_in; ++from)
      sum += in.data[from] * weights[size_t{to} * node.fan_in + from];
    out.data[to] = activated(node, sum);
  }
}

void max_pool(const Image& in, Image& out) {
  for (uint32_t c = 0; c < out.shape.channels; ++c)
    for (uint32_t y = 0; y < out.shape.height; ++y)
      for (uint32_t x = 0; x < out.shape.width; ++x)
        out.at(c, y, x) = std::max({in.at(c, 2 * y, 2 * x), in.at(c, 2 * y, 2 * x + 1),
                                    in.at(c, 2 * y + 1, 2 * x), in.at(c, 2 * y + 1, 2 * x + 1)});
}

/// Between which two of `count` pixels the center of pixel `x` of twice as many lies.
struct Between {
  Between(uint32_t x, uint32_t count) {
    const double at = std::clamp((x + 0.5) / 2 - 0.5, 0.0, count - 1.0);
    low = static_cast<uint32_t>(at);
    high = std::min(low + 1, count - 1);
    share = at - low;
  }
  uint32_t low, high;
  double share;
};

void upsample(const Image& in, Image& out) {
  for (uint32_t c = 0; c < out.shape.channels; ++c)
    for (uint32_t y = 0; y < out.shape.height; ++y)
      for (uint32_t x = 0; x < out.shape.width; ++x) {
        const Between u(x, in.shape.width), v(y, in.shape.height);
        out.at(c, y, x) = std::lerp(
            std::lerp(in.at(c, v.low, u.low), in.at(c, v.low, u.high), u.share),
            std::lerp(in.at(c, v.high, u.low), in.at(c, v.high, u.high), u.share), v.share);
      }
}

void global_mean(const Image& in, Image& out) {
  const size_t area = size_t{in.shape.height} * in.shape.width;
  for (uint32_t c = 0; c < in.shape.channels; ++c) {
    double sum = 0;
    for (size_t i = 0; i < area; ++i) sum += in.data[c * area + i];
    out.data[c] = sum / static_cast<double>(area);
  }
}

void softmax(const Image& in, Image& out) {
  for (uint32_t y = 0; y < in.shape.height; ++y)
    for (uint32_t x = 0; x < in.shape.width; ++x) {
      double largest = in.at(0, y, x), sum = 0;
      for (uint32_t c = 1; c < in.shape.channels; ++c) largest = std::max(largest, in.at(c, y, x));
      for (uint32_t c = 0; c < in.shape.channels; ++c) sum += std::exp(in.at(c, y, x) - largest);
      for (uint32_t c = 0; c < in.shape.channels; ++c)
        out.at(c, y, x) = std::exp(in.at(c, y, x) - largest) / sum;
    }
}

}  // namespace

std::vector<Image> run_network(const Graph& graph, std::span<const Image> inputs) {
  std::vector<network::Shape> given;
  for (const Image& image : inputs) given.push_back(image.shape);
  const auto shapes = network::shapes_of(graph, given);
  std::vector<Image> values(inputs.begin(), inputs.end());
  for (const Node& node : graph.nodes) {
    const Image in = values[node.inputs[0]];
    Image out{shapes[values.size()], {}};
    out.data.resize(out.shape.size());
    switch (node.op) {
      case Op::convolution:
        convolve(graph, node, in, out);
        break;
      case Op::depthwise:
        depthwise(graph, node, in, out);
        break;
      case Op::add:
        add(in, values[node.inputs[1]], out);
        break;
      case Op::max_pool:
        max_pool(in, out);
        break;
      case Op::upsample:
        upsample(in, out);
        break;
      case Op::concat: {
        const Image& more = values[node.inputs[1]];
        out.data = in.data;
        out.data.insert(out.data.end(), more.data.begin(), more.data.end());
        break;
      }
      case Op::dense:
        dense(graph, node, in, out);
        break;
      case Op::global_mean:
        global_mean(in, out);
        break;
      case Op::softmax:
        softmax(in, out);
        break;
      case Op::activation:
        for (size_t i = 0; i < in.data.size(); ++i) out.data[i] = activated(node, in.data[i]);
        break;
    }
    values.push_back(std::move(out));
  }
  std::vector<Image> outputs;
  for (const network::Output& output : graph.outputs) outputs.push_back(values[output.value]);
  return outputs;
}

}  // namespace inverse::reference
