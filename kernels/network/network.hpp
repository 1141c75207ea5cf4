// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host_network.hpp"
#include "kernels/gpu/commands.hpp"
#include "plan.hpp"

namespace inverse::network {

/// A network on a device, for inputs of one size. On a software device it runs by HostNetwork where
/// there is one.
///
/// Images are vec4 buffers as in `Plan`: element 0 is always zero; then channels in blocks of four,
/// element 1 + (block * height + y) * width + x. The caller writes finite inputs (NaN spreads), and
/// zeros in the unused channels of the last block. Unused channels of outputs are undefined.
class Network {
 public:
  /// Throws Error(unsupported) for graphs that are invalid or do not match these sizes,
  /// Error(limit) and Error(out_of_memory).
  Network(const std::shared_ptr<gpu::Device>& device, Graph graph, std::span<const Shape> inputs);

  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  const gpu::BufferPtr& input(size_t index) const {
    return buffer_of(static_cast<uint32_t>(index));
  }
  const gpu::BufferPtr& output(size_t index) const {
    return buffer_of(graph_.outputs[index].value);
  }
  const Shape& output_shape(size_t index) const {
    return plan_.shapes[graph_.outputs[index].value];
  }

  /// Records one run. With `stages`, every step is a stage named as its node, for benchmarks.
  void record(gpu::Commands& commands, bool stages = false) const;
  /// Whether it runs on the host, so that `record` splits the submit (Commands::on_host).
  bool on_host() const { return host_.has_value(); }
  /// Runs it now, on the host, while no submitted work uses its inputs and outputs.
  void run() const;

  const Graph& graph() const { return graph_; }
  const Plan& plan() const { return plan_; }
  /// Bytes of device memory of the weights; images take plan().bytes().
  uint64_t weight_bytes() const { return weight_bytes_; }

 private:
  struct Dispatch {
    const char* name;
    std::function<void(gpu::Commands&)> record;
  };

  const gpu::BufferPtr& buffer_of(uint32_t value) const { return buffers_[plan_.buffer_of[value]]; }
  gpu::BufferPtr weights_of(const Step& step);
  /// The value that the step computes.
  uint32_t made_by(const Step& step) const {
    return static_cast<uint32_t>(graph_.inputs.size()) + step.node;
  }
  void prepare(const Step& step);
  void prepare_convolve1(const Step& step);
  void prepare_convolve3(const Step& step);
  /// One dispatch of `name`, `items` invocations.
  template <typename Shader>
  void add(const Step& step, const gpu::Program<Shader>& program,
           const typename Shader::Buffers& buffers, const typename Shader::Push& push,
           gpu::Items items);

  std::shared_ptr<gpu::Device> device_;
  Graph graph_;
  Plan plan_;
  std::vector<gpu::BufferPtr> buffers_;
  std::vector<Dispatch> dispatches_;
  uint64_t weight_bytes_ = 0;
  mutable std::optional<HostNetwork> host_;
};

}  // namespace inverse::network
