#include "network.hpp"

#include <cstring>
#include <utility>

#include "common/error.hpp"
#include "kernels/gpu/shaders.hpp"
#include "pack.hpp"

INVERSE_SHADER(network_activate);
INVERSE_SHADER(network_concat);
INVERSE_SHADER(network_convolve1);
INVERSE_SHADER(network_convolve3);
INVERSE_SHADER(network_convolve3_stride2);
INVERSE_SHADER(network_dense);
INVERSE_SHADER(network_global_mean);
INVERSE_SHADER(network_max_pool);
INVERSE_SHADER(network_softmax);
INVERSE_SHADER(network_upsample);

namespace inverse::network {
namespace {

constexpr uint32_t kRows = 8;         // convolve3.comp
constexpr uint32_t kStridedRows = 4;  // convolve3_stride2.comp
constexpr uint32_t kPixels = 8;       // convolve1.comp

struct Size {
  explicit Size(const Shape& s)
      : width(static_cast<int32_t>(s.width)), height(static_cast<int32_t>(s.height)) {}
  int32_t width, height;
};

int32_t area_of(const Shape& s) { return static_cast<int32_t>(s.height * s.width); }
int32_t block_count(const Shape& s) { return static_cast<int32_t>(blocks_of(s.channels)); }

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
  for (const Step& step : plan_.steps) prepare(step, commands);
  commands.submit();
  commands.wait();
}

gpu::BufferPtr Network::weights_of(const Step& step, gpu::Commands& commands) {
  const std::vector<float> packed = packed_weights(graph_, plan_, step);
  const auto staged =
      gpu::Buffer::create(device_, gpu::Element::vec4, packed.size() / 4, gpu::Memory::upload);
  memcpy(staged->map(), packed.data(), packed.size() * sizeof(float));
  gpu::BufferPtr weights = commands.resident(staged);
  weight_bytes_ += weights->bytes();
  return weights;
}

template <typename Push>
void Network::add(const Step& step, gpu::KernelPtr kernel, std::vector<gpu::BufferPtr> buffers,
                  const Push& push, uint64_t items) {
  static_assert(sizeof(Push) <= sizeof(Dispatch::push));
  const uint64_t max_items = uint64_t{device_->limits().workgroups[0]} * kernel->workgroup();
  if (items > max_items)
    throw Error(ErrorKind::limit, "network: node \"" + graph_.nodes[step.node].name + "\" needs " +
                                      std::to_string(items) + " invocations and the device has " +
                                      std::to_string(max_items) + "; use a smaller input");
  Dispatch dispatch{graph_.nodes[step.node].name.c_str(),
                    std::move(kernel),
                    std::move(buffers),
                    {},
                    {static_cast<uint32_t>(items)}};
  memcpy(dispatch.push.data(), &push, sizeof push);
  dispatches_.push_back(std::move(dispatch));
}

void Network::prepare_convolve1(const Step& step, gpu::Commands& commands) {
  const Node& node = graph_.nodes[step.node];
  const Shape &in = plan_.shapes[step.sources[0].value], &out = plan_.shapes[made_by(step)];
  const struct {
    Size size, source;
    int32_t source_blocks, blocks, stride;
    float slope;
  } push{Size(out), Size(in), block_count(in), block_count(out), static_cast<int32_t>(node.stride),
         node.slope};
  const uint64_t lanes = (uint64_t{out.height} * out.width + kPixels - 1) / kPixels;
  const auto activation = static_cast<uint32_t>(node.activation);
  add(step, device_->kernel(shaders::network_convolve1, {activation}),
      {buffer_of(step.sources[0].value), weights_of(step, commands), buffer_of(made_by(step))},
      push, lanes * blocks_of(out.channels));
}

void Network::prepare_convolve3(const Step& step, gpu::Commands& commands) {
  const Node& node = graph_.nodes[step.node];
  const Source &first = step.sources[0], &second = step.sources.back();
  const bool two = step.sources.size() == 2, strided = node.stride == 2;
  const Shape &source = plan_.shapes[node.inputs[0]], &out = plan_.shapes[made_by(step)];
  const struct {
    Size size, source;
    int32_t first_blocks, second_blocks, blocks;
    float slope;
  } push{Size(out),
         Size(source),
         block_count(plan_.shapes[first.value]),
         two ? block_count(plan_.shapes[second.value]) : 0,
         block_count(out),
         node.slope};
  const uint32_t rows = strided ? kStridedRows : kRows;
  const uint64_t strips = (out.height + rows - 1) / rows;
  const auto activation = static_cast<uint32_t>(node.activation);
  add(step,
      strided ? device_->kernel(shaders::network_convolve3_stride2, {activation})
              : device_->kernel(shaders::network_convolve3, {activation, first.upsampled, two}),
      {buffer_of(first.value), buffer_of(second.value), weights_of(step, commands),
       buffer_of(made_by(step))},
      push, strips * out.width * blocks_of(out.channels));
}

void Network::prepare(const Step& step, gpu::Commands& commands) {
  const Node& node = graph_.nodes[step.node];
  const Shape &in = plan_.shapes[step.sources[0].value], &out = plan_.shapes[made_by(step)];
  const gpu::BufferPtr &first = buffer_of(step.sources[0].value),
                       &result = buffer_of(made_by(step));
  const gpu::BufferPtr& second = buffer_of(step.sources.back().value);
  const auto activation = static_cast<uint32_t>(node.activation);
  const uint64_t result_elements = elements_of(out) - 1;
  struct Resize {
    Size size, source;
    int32_t blocks;
  };
  switch (node.op) {
    case Op::convolution:
      node.kernel == 1 ? prepare_convolve1(step, commands) : prepare_convolve3(step, commands);
      return;
    case Op::dense: {
      const struct {
        int32_t elements, blocks;
        float slope;
      } push{static_cast<int32_t>(elements_of(in) - 1), block_count(out), node.slope};
      const gpu::KernelPtr kernel = device_->kernel(shaders::network_dense, {activation});
      add(step, kernel, {first, weights_of(step, commands), result}, push,
          uint64_t{kernel->workgroup()} * blocks_of(out.channels));
      return;
    }
    case Op::max_pool:
      add(step, device_->kernel(shaders::network_max_pool), {first, result},
          Resize{Size(out), Size(in), block_count(out)}, result_elements);
      return;
    case Op::upsample:
      add(step, device_->kernel(shaders::network_upsample), {first, result},
          Resize{Size(out), Size(in), block_count(out)}, result_elements);
      return;
    case Op::concat: {
      const int32_t push[3] = {area_of(out), static_cast<int32_t>(in.channels),
                               static_cast<int32_t>(out.channels)};
      add(step, device_->kernel(shaders::network_concat), {first, second, result}, push,
          result_elements);
      return;
    }
    case Op::global_mean: {
      const gpu::KernelPtr kernel = device_->kernel(shaders::network_global_mean);
      add(step, kernel, {first, result}, area_of(in),
          uint64_t{kernel->workgroup()} * blocks_of(out.channels));
      return;
    }
    case Op::softmax: {
      const int32_t push[2] = {area_of(out), static_cast<int32_t>(out.channels)};
      add(step, device_->kernel(shaders::network_softmax), {first, result}, push,
          uint64_t{out.height} * out.width);
      return;
    }
    case Op::activation: {
      const struct {
        int32_t elements;
        float slope;
      } push{static_cast<int32_t>(result_elements), node.slope};
      add(step, device_->kernel(shaders::network_activate, {activation}), {first, result}, push,
          result_elements);
      return;
    }
  }
}

void Network::record(gpu::Commands& commands, bool stages) const {
  for (const Dispatch& d : dispatches_) {
    commands.dispatch(d.kernel, d.buffers, d.push, d.items);
    if (stages) commands.stage(d.name);
  }
}

}  // namespace inverse::network
