// SPDX-License-Identifier: LGPL-2.1-or-later
#include "host_network.hpp"

#ifdef INVERSE_GOMP
#include <omp.h>
#endif

#include <dnnl.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "kernels/gpu/variables.hpp"

namespace inverse::network {
namespace {

using dnnl::algorithm;
using dnnl::memory;
using dnnl::prop_kind;
using Dims = memory::dims;
using Tag = memory::format_tag;

constexpr auto kFloat = memory::data_type::f32;
constexpr Dims::value_type kPadding = 4;  // floats before an image: a vec4 of zeros

Dims dims_of(const Shape& s) { return {1, s.channels, s.height, s.width}; }
memory::desc desc_of(const Shape& s, Tag tag) { return {dims_of(s), kFloat, tag}; }

/// A primitive's description; oneDNN 2 has one more step than oneDNN 3.
template <typename Primitive, typename... Parts>
typename Primitive::primitive_desc describe(const dnnl::engine& engine,
                                            const dnnl::primitive_attr& attributes,
                                            const Parts&... parts) {
#if DNNL_VERSION_MAJOR >= 3
  return {engine, parts..., attributes};
#else
  return {typename Primitive::desc(parts...), attributes, engine};
#endif
}

void append(dnnl::post_ops& ops, algorithm kind, float alpha, float beta) {
#if DNNL_VERSION_MAJOR >= 3
  ops.append_eltwise(kind, alpha, beta);
#else
  ops.append_eltwise(1, kind, alpha, beta);
#endif
}

/// How oneDNN names an activation, and its two parameters.
struct Eltwise {
  algorithm kind;
  float alpha = 0, beta = 0;
};
Eltwise eltwise_of(const Node& node) {
  switch (node.activation) {
    case Activation::leaky_relu:
      return {algorithm::eltwise_relu, node.slope};
    case Activation::sigmoid:
      return {algorithm::eltwise_logistic};
    case Activation::relu6:
      return {algorithm::eltwise_clip, 0, 6};
    case Activation::relu:
    case Activation::none:
      break;
  }
  return {algorithm::eltwise_relu};
}

}  // namespace

struct HostNetwork::Impl {
  using Arguments = std::unordered_map<int, memory>;
  struct Step {
    dnnl::primitive primitive;
    Arguments arguments;
  };

  dnnl::engine engine{dnnl::engine::kind::cpu, 0};
  dnnl::stream stream{engine};
  std::vector<Shape> shapes;
  std::vector<memory> values;           // of the graph
  std::vector<memory> inputs, outputs;  // on the caller's images
  std::vector<Step> steps;

  Impl(const Graph& graph, std::span<const Shape> given) : shapes(shapes_of(graph, given)) {
    for (const Shape& shape : given) {
      inputs.emplace_back(desc_of(shape, Tag::nChw4c), engine, nullptr);
      values.push_back(inputs.back());
    }
    for (const Node& node : graph.nodes) try {
        add(graph, node);
      } catch (const dnnl::error& error) {
        throw Error(ErrorKind::unsupported,
                    "network: node \"" + node.name + "\": oneDNN: " + error.what());
      }
    for (const Output& output : graph.outputs) {
      outputs.emplace_back(desc_of(shapes[output.value], Tag::nChw4c), engine, nullptr);
      reorder(values[output.value], outputs.back());
    }
  }

  void reorder(const memory& from, const memory& to) {
    steps.push_back({dnnl::reorder(from, to), {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, to}}});
  }
  /// A value in the layout that a primitive wants.
  memory in_layout(const memory& value, const memory::desc& wanted) {
    if (value.get_desc() == wanted) return value;
    memory made(wanted, engine);
    reorder(value, made);
    return made;
  }
  /// Adds a primitive that makes the next value.
  template <typename Primitive>
  void put(const typename Primitive::primitive_desc& description, Arguments arguments) {
    const memory result(description.dst_desc(), engine);
    arguments[DNNL_ARG_DST] = result;
    steps.push_back({Primitive(description), std::move(arguments)});
    values.push_back(result);
  }

  void add(const Graph& graph, const Node& node) {
    const memory first = values[node.inputs[0]];
    const Shape &in = shapes[node.inputs[0]], &out = shapes[values.size()];
    const memory::desc source = first.get_desc(), result = desc_of(out, Tag::any);
    const auto inference = prop_kind::forward_inference;
    switch (node.op) {
      case Op::convolution:
      case Op::depthwise:
        convolve(graph, node, node.kernel, node.kernel, node.kernel / 2);
        return;
      case Op::dense:
        convolve(graph, node, in.height, in.width, 0);
        return;
      case Op::max_pool: {
        const Dims two{2, 2}, none{0, 0};
        // An odd last row or column is dropped: less than nothing is padded there.
        const Dims cut{-int64_t{in.height % 2}, -int64_t{in.width % 2}};
#if DNNL_VERSION_MAJOR >= 3
        put<dnnl::pooling_forward>(
            describe<dnnl::pooling_forward>(engine, {}, inference, algorithm::pooling_max, source,
                                            result, two, two, none, none, cut),
            {{DNNL_ARG_SRC, first}});
#else
        put<dnnl::pooling_forward>(
            describe<dnnl::pooling_forward>(engine, {}, inference, algorithm::pooling_max, source,
                                            result, two, two, none, cut),
            {{DNNL_ARG_SRC, first}});
#endif
        return;
      }
      case Op::global_mean: {
        const Dims all{in.height, in.width}, none{0, 0};
#if DNNL_VERSION_MAJOR >= 3
        put<dnnl::pooling_forward>(
            describe<dnnl::pooling_forward>(engine, {}, inference,
                                            algorithm::pooling_avg_exclude_padding, source, result,
                                            all, all, none, none, none),
            {{DNNL_ARG_SRC, first}});
#else
        put<dnnl::pooling_forward>(
            describe<dnnl::pooling_forward>(engine, {}, inference,
                                            algorithm::pooling_avg_exclude_padding, source, result,
                                            all, all, none, none),
            {{DNNL_ARG_SRC, first}});
#endif
        return;
      }
      case Op::upsample:
        put<dnnl::resampling_forward>(
            describe<dnnl::resampling_forward>(engine, {}, inference, algorithm::resampling_linear,
                                               std::vector<float>{2, 2}, source, result),
            {{DNNL_ARG_SRC, first}});
        return;
      case Op::concat: {
        const memory second =
            in_layout(values[node.inputs[1]], like(node.inputs[0], node.inputs[1]));
        const std::vector<memory::desc> both{source, second.get_desc()};
#if DNNL_VERSION_MAJOR >= 3
        const dnnl::concat::primitive_desc description(engine, 1, both);
#else
        const dnnl::concat::primitive_desc description(1, both, engine);
#endif
        put<dnnl::concat>(description,
                          {{DNNL_ARG_MULTIPLE_SRC, first}, {DNNL_ARG_MULTIPLE_SRC + 1, second}});
        return;
      }
      case Op::add: {
        const memory second = values[node.inputs[1]];
        put<dnnl::binary>(describe<dnnl::binary>(engine, {}, algorithm::binary_add, source,
                                                 second.get_desc(), result),
                          {{DNNL_ARG_SRC_0, first}, {DNNL_ARG_SRC_1, second}});
        return;
      }
      case Op::softmax:
#if DNNL_VERSION_MAJOR >= 3
        put<dnnl::softmax_forward>(
            describe<dnnl::softmax_forward>(engine, {}, inference, algorithm::softmax_accurate,
                                            source, source, 1),
            {{DNNL_ARG_SRC, first}});
#else
        put<dnnl::softmax_forward>(
            describe<dnnl::softmax_forward>(engine, {}, inference, source, 1),
            {{DNNL_ARG_SRC, first}});
#endif
        return;
      case Op::activation: {
        if (node.activation == Activation::none) {
          values.push_back(first);
          return;
        }
        const Eltwise eltwise = eltwise_of(node);
#if DNNL_VERSION_MAJOR >= 3
        put<dnnl::eltwise_forward>(
            describe<dnnl::eltwise_forward>(engine, {}, inference, eltwise.kind, source, source,
                                            eltwise.alpha, eltwise.beta),
            {{DNNL_ARG_SRC, first}});
#else
        put<dnnl::eltwise_forward>(
            describe<dnnl::eltwise_forward>(engine, {}, inference, eltwise.kind, source,
                                            eltwise.alpha, eltwise.beta),
            {{DNNL_ARG_SRC, first}});
#endif
        return;
      }
    }
  }

  /// The layout of one value for another.
  memory::desc like(uint32_t of, uint32_t value) const {
    const memory::desc layout = values[of].get_desc();
    for (const Tag tag : {Tag::nChw16c, Tag::nChw8c, Tag::nChw4c, Tag::nhwc})
      if (layout == desc_of(shapes[of], tag)) return desc_of(shapes[value], tag);
    return values[value].get_desc();
  }

  void convolve(const Graph& graph, const Node& node, uint32_t height, uint32_t width,
                int64_t padding) {
    const Shape &in = shapes[node.inputs[0]], &out = shapes[values.size()];
    const bool depthwise = node.op == Op::depthwise;
    const Dims stride{node.stride, node.stride}, apart{node.dilation - 1, node.dilation - 1};
    const int64_t border = padding * node.dilation;
    const Dims weight_dims = depthwise ? Dims{node.channels, 1, 1, height, width}
                                       : Dims{node.channels, in.channels, height, width};
    const memory::desc any_weights(weight_dims, kFloat, Tag::any),
        bias_desc({node.channels}, kFloat, Tag::x);
    // So that a strided convolution has the size that shapes_of gives, the far padding is what is
    // left over.
    const auto behind = [&](uint32_t from, uint32_t to, uint32_t kernel) {
      const int64_t reach = int64_t{kernel - 1} * node.dilation + 1;
      return int64_t{to - 1} * node.stride + reach - from - border;
    };
    const Dims before{border, border},
        after{behind(in.height, out.height, height), behind(in.width, out.width, width)};
    dnnl::primitive_attr attributes;
    if (node.activation != Activation::none) {
      dnnl::post_ops ops;
      const Eltwise eltwise = eltwise_of(node);
      append(ops, eltwise.kind, eltwise.alpha, eltwise.beta);
      attributes.set_post_ops(ops);
    }
    const auto description = describe<dnnl::convolution_forward>(
        engine, attributes, prop_kind::forward_inference, algorithm::convolution_direct,
        desc_of(in, Tag::any), any_weights, bias_desc, desc_of(out, Tag::any), stride, apart,
        before, after);
    const float* numbers = graph.weights.data() + node.weights;
    memory plain({weight_dims, kFloat, depthwise ? Tag::goihw : Tag::oihw}, engine);
    std::copy_n(numbers, node.weight_count(), static_cast<float*>(plain.get_data_handle()));
    memory bias(bias_desc, engine), weights(description.weights_desc(), engine);
    std::copy_n(numbers + node.weight_count(), node.channels,
                static_cast<float*>(bias.get_data_handle()));
    dnnl::reorder(plain, weights).execute(stream, plain, weights);
    stream.wait();
    const memory source = in_layout(values[node.inputs[0]], description.src_desc());
    put<dnnl::convolution_forward>(
        description, {{DNNL_ARG_SRC, source}, {DNNL_ARG_WEIGHTS, weights}, {DNNL_ARG_BIAS, bias}});
  }

  void run(std::span<const float* const> from, std::span<float* const> to) {
    for (size_t i = 0; i < inputs.size(); ++i)
      inputs[i].set_data_handle(const_cast<float*>(from[i]) + kPadding);
    for (size_t i = 0; i < outputs.size(); ++i) outputs[i].set_data_handle(to[i] + kPadding);
    for (const Step& step : steps) step.primitive.execute(stream, step.arguments);
    stream.wait();
#ifdef INVERSE_GOMP
    omp_pause_resource_all(omp_pause_soft);  // its threads would wait for work on processors that
                                             // the next kernels need
#endif
  }
};

bool HostNetwork::available() { return gpu::environment_number("INVERSE_ONEDNN", 1) != 0; }

HostNetwork::HostNetwork(const Graph& graph, std::span<const Shape> inputs)
    : impl_(std::make_unique<Impl>(graph, inputs)) {}
HostNetwork::HostNetwork(HostNetwork&&) noexcept = default;
HostNetwork::~HostNetwork() = default;

void HostNetwork::run(std::span<const float* const> inputs, std::span<float* const> outputs) {
  impl_->run(inputs, outputs);
}

}  // namespace inverse::network
