// SPDX-License-Identifier: LGPL-2.1-or-later
#include "network.hpp"

#include <cstring>
#include <utility>

#include "common/error.hpp"
#include "kernels/network_activate.spv.hpp"
#include "kernels/network_add.spv.hpp"
#include "kernels/network_concat.spv.hpp"
#include "kernels/network_convolve1.spv.hpp"
#include "kernels/network_convolve3.spv.hpp"
#include "kernels/network_convolve3_stride2.spv.hpp"
#include "kernels/network_dense.spv.hpp"
#include "kernels/network_depthwise3.spv.hpp"
#include "kernels/network_global_mean.spv.hpp"
#include "kernels/network_max_pool.spv.hpp"
#include "kernels/network_softmax.spv.hpp"
#include "kernels/network_upsample.spv.hpp"
#include "pack.hpp"

namespace inverse::network {
namespace {

int32_t area_of(const Shape& s) { return static_cast<int32_t>(s.height * s.width); }
int32_t block_count(const Shape& s) { return static_cast<int32_t>(blocks_of(s.channels)); }

/// Invocations, each of which is a pixel or more; what has so many also fits a buffer.
gpu::Items line_of(uint64_t items) { return {static_cast<uint32_t>(items)}; }

/// A workgroup for every four channels.
gpu::Items groups_of(const gpu::Kernel& kernel, const Shape& shape) {
  return {kernel.workgroup() * static_cast<uint32_t>(blocks_of(shape.channels)), 1};
}

}  // namespace

Network::Network(const std::shared_ptr<gpu::Device>& device, Graph graph,
                 std::span<const Shape> inputs)
    : device_(device), graph_(std::move(graph)) {
  validate(graph_);
  plan_ = network::plan(graph_, inputs);
  gpu::Commands commands(device);
  commands.begin();
  for (const uint64_t elements : plan_.elements) {
    buffers_.push_back(gpu::Buffer::create(device, gpu::Element::vec4, elements));
    commands.fill(buffers_.back());
  }
  if (device->is_cpu() && HostNetwork::available())
    host_.emplace(graph_, inputs);
  else
    for (const Step& step : plan_.steps) prepare(step);
  commands.submit();
  commands.wait();
}

gpu::BufferPtr Network::weights_of(const Step& step) {
  gpu::BufferPtr weights =
      gpu::make_table(device_, gpu::Element::vec4, packed_weights(graph_, plan_, step));
  weight_bytes_ += weights->bytes();
  return weights;
}

template <typename Shader>
void Network::add(const Step& step, const gpu::Program<Shader>& program,
                  const typename Shader::Buffers& buffers, const typename Shader::Push& push,
                  gpu::Items items) {
  const char* name = graph_.nodes[step.node].name.c_str();
  dispatches_.push_back(
      {name, [=](gpu::Commands& commands) { commands.dispatch(program, buffers, push, items); }});
}

void Network::prepare_convolve1(const Step& step) {
  using Shader = shaders::network_convolve1;
  const Node& node = graph_.nodes[step.node];
  const Shape &in = plan_.shapes[step.sources[0].value], &out = plan_.shapes[made_by(step)];
  const uint64_t lanes = (uint64_t{out.height} * out.width + Shader::PIXELS - 1) / Shader::PIXELS;
  add<Shader>(step, {device_, {.activation = static_cast<uint32_t>(node.activation)}},
              {.image = buffer_of(step.sources[0].value),
               .weights = weights_of(step),
               .result = buffer_of(made_by(step))},
              {.size = out,
               .source = in,
               .source_blocks = block_count(in),
               .blocks = block_count(out),
               .stride = static_cast<int32_t>(node.stride),
               .slope = node.slope},
              line_of(lanes * blocks_of(out.channels)));
}

void Network::prepare_convolve3(const Step& step) {
  using Shader = shaders::network_convolve3;
  using Strided = shaders::network_convolve3_stride2;
  const Node& node = graph_.nodes[step.node];
  const Source &first = step.sources[0], &second = step.sources.back();
  const bool two = step.sources.size() == 2;
  const Shape &source = plan_.shapes[node.inputs[0]], &out = plan_.shapes[made_by(step)];
  const auto activation = static_cast<uint32_t>(node.activation);
  const auto items = [&](uint32_t rows) {
    return uint64_t{(out.height + rows - 1) / rows} * out.width * blocks_of(out.channels);
  };
  const auto convolve = [&]<typename S>(const gpu::Program<S>& program, uint32_t rows) {
    add<S>(step, program,
           {.first = buffer_of(first.value),
            .second = buffer_of(second.value),
            .weights = weights_of(step),
            .result = buffer_of(made_by(step))},
           {.size = out,
            .source = source,
            .first_blocks = block_count(plan_.shapes[first.value]),
            .second_blocks = two ? block_count(plan_.shapes[second.value]) : 0,
            .blocks = block_count(out),
            .slope = node.slope},
           line_of(items(rows)));
  };
  if (node.stride == 2)
    convolve(gpu::Program<Strided>(device_, {.activation = activation}), Strided::ROWS);
  else
    convolve(gpu::Program<Shader>(
                 device_, {.activation = activation, .upsampled = first.upsampled, .second = two}),
             Shader::ROWS);
}

void Network::prepare(const Step& step) {
  const Node& node = graph_.nodes[step.node];
  const Shape &in = plan_.shapes[step.sources[0].value], &out = plan_.shapes[made_by(step)];
  const gpu::BufferPtr &first = buffer_of(step.sources[0].value),
                       &result = buffer_of(made_by(step));
  const gpu::BufferPtr& second = buffer_of(step.sources.back().value);
  const auto activation = static_cast<uint32_t>(node.activation);
  const uint64_t result_elements = elements_of(out) - 1;
  const auto channels = static_cast<int32_t>(out.channels);
  switch (node.op) {
    case Op::convolution:
      node.kernel == 1 ? prepare_convolve1(step) : prepare_convolve3(step);
      return;
    case Op::dense: {
      const gpu::Program<shaders::network_dense> dense(device_, {.activation = activation});
      add(step, dense, {.image = first, .weights = weights_of(step), .result = result},
          {.elements = static_cast<int32_t>(elements_of(in) - 1),
           .blocks = block_count(out),
           .slope = node.slope},
          groups_of(*dense.kernel(), out));
      return;
    }
    case Op::depthwise:
      add<shaders::network_depthwise3>(
          step, {device_, {.activation = activation}},
          {.image = first, .weights = weights_of(step), .result = result},
          {.size = out,
           .source = in,
           .blocks = block_count(out),
           .stride = static_cast<int32_t>(node.stride),
           .dilation = static_cast<int32_t>(node.dilation),
           .slope = node.slope},
          line_of(result_elements));
      return;
    case Op::add: {
      const bool vector = plan_.shapes[step.sources.back().value] != in;
      add<shaders::network_add>(
          step, {device_, {.vector = vector}}, {.first = first, .second = second, .result = result},
          {.area = area_of(out), .elements = static_cast<int32_t>(result_elements)},
          line_of(result_elements));
      return;
    }
    case Op::max_pool:
      add<shaders::network_max_pool>(step, {device_}, {.image = first, .result = result},
                                     {.size = out, .source = in, .blocks = block_count(out)},
                                     line_of(result_elements));
      return;
    case Op::upsample:
      add<shaders::network_upsample>(step, {device_}, {.image = first, .result = result},
                                     {.size = out, .source = in, .blocks = block_count(out)},
                                     line_of(result_elements));
      return;
    case Op::concat:
      add<shaders::network_concat>(step, {device_},
                                   {.first = first, .second = second, .result = result},
                                   {.area = area_of(out),
                                    .first_channels = static_cast<int32_t>(in.channels),
                                    .channels = channels},
                                   line_of(result_elements));
      return;
    case Op::global_mean: {
      const gpu::Program<shaders::network_global_mean> mean(device_);
      add(step, mean, {.image = first, .result = result}, {.area = area_of(in)},
          groups_of(*mean.kernel(), out));
      return;
    }
    case Op::softmax:
      add<shaders::network_softmax>(step, {device_}, {.image = first, .result = result},
                                    {.area = area_of(out), .channels = channels},
                                    line_of(uint64_t{out.height} * out.width));
      return;
    case Op::activation:
      add<shaders::network_activate>(
          step, {device_, {.activation = activation}}, {.image = first, .result = result},
          {.elements = static_cast<int32_t>(result_elements), .slope = node.slope},
          line_of(result_elements));
      return;
  }
}

void Network::run() const {
  std::vector<const float*> inputs;
  std::vector<float*> outputs;
  for (size_t i = 0; i < graph_.inputs.size(); ++i) inputs.push_back(input(i)->map_as<float>());
  for (size_t i = 0; i < graph_.outputs.size(); ++i) outputs.push_back(output(i)->map_as<float>());
  host_->run(inputs, outputs);
}

void Network::record(gpu::Commands& commands, bool stages) const {
  if (host_) return commands.on_host([this] { run(); });
  for (const Dispatch& d : dispatches_) {
    d.record(commands);
    if (stages) commands.stage(d.name);
  }
}

}  // namespace inverse::network
