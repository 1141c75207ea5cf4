// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plan.hpp"

#include <algorithm>
#include <optional>

namespace inverse::network {
namespace {

/// A convolution repeats the upsampling for every four channels of its result, so with more blocks
/// a separate upsampling is cheaper.
constexpr uint32_t kMaxFusedBlocks = 4;

class Planner {
 public:
  Planner(const Graph& graph, std::span<const Shape> inputs) : graph_(graph) {
    plan_.shapes = shapes_of(graph, inputs);
    readers_.resize(graph.values());
    for (const Node& node : graph.nodes)
      for (const uint32_t input : node.inputs) ++readers_[input];
    for (const Output& output : graph.outputs) ++readers_[output.value];
  }

  Plan run() {
    choose_steps();
    choose_buffers();
    return std::move(plan_);
  }

 private:
  const Node* node_of(uint32_t value) const {
    return value < graph_.inputs.size() ? nullptr : &graph_.nodes[value - graph_.inputs.size()];
  }
  /// The node of operation `op` that makes `value`, if only one reader uses it.
  const Node* only_for_one(uint32_t value, Op op) const {
    const Node* node = node_of(value);
    return node && node->op == op && readers_[value] == 1 ? node : nullptr;
  }
  Source source_of(uint32_t value, const Node& reader) const {
    const Node* up = only_for_one(value, Op::upsample);
    const bool fuse = up && blocks_of(reader.channels) <= kMaxFusedBlocks;
    return fuse ? Source{up->inputs[0], true} : Source{value};
  }

  /// Sources of a 3 x 3 convolution. One may be upsampled; it comes first.
  void fuse(Step& step) {
    const Node& node = graph_.nodes[step.node];
    if (node.op != Op::convolution || node.kernel != 3 || node.stride != 1) return;
    const uint32_t input = node.inputs[0];
    const Node* both = only_for_one(input, Op::concat);
    if (!both) {
      step.sources = {source_of(input, node)};
      return;
    }
    const uint32_t before = plan_.shapes[both->inputs[0]].channels;
    Source first = source_of(both->inputs[0], node), second = source_of(both->inputs[1], node);
    if (first.upsampled && second.upsampled) second = Source{both->inputs[1]};
    step.sources = {first, second};
    step.first_channel = {0, before};
    if (second.upsampled) {
      std::swap(step.sources[0], step.sources[1]);
      std::swap(step.first_channel[0], step.first_channel[1]);
    }
  }

  /// From the last node to the first: only values that a later step reads are needed.
  void choose_steps() {
    std::vector<bool> wanted(graph_.values());
    for (const Output& output : graph_.outputs) wanted[output.value] = true;
    for (uint32_t i = static_cast<uint32_t>(graph_.nodes.size()); i-- > 0;) {
      if (!wanted[graph_.inputs.size() + i]) continue;
      Step step{i, {}, {}};
      for (const uint32_t input : graph_.nodes[i].inputs) step.sources.push_back({input});
      fuse(step);
      if (step.first_channel.empty()) step.first_channel.assign(step.sources.size(), 0);
      for (const Source& source : step.sources) wanted[source.value] = true;
      plan_.steps.push_back(std::move(step));
    }
    std::reverse(plan_.steps.begin(), plan_.steps.end());
  }

  uint32_t new_buffer(uint64_t elements) {
    plan_.elements.push_back(elements);
    return static_cast<uint32_t>(plan_.elements.size() - 1);
  }

  /// The best free buffer: the smallest that is large enough, else the largest, which grows.
  uint32_t take_buffer(uint64_t elements) {
    std::optional<size_t> best;
    for (size_t i = 0; i < free_.size(); ++i) {
      const uint64_t size = plan_.elements[free_[i]];
      if (!best) {
        best = i;
        continue;
      }
      const uint64_t so_far = plan_.elements[free_[*best]];
      if (so_far < elements ? size > so_far : size >= elements && size < so_far) best = i;
    }
    if (!best) return new_buffer(elements);
    const uint32_t taken = free_[*best];
    free_.erase(free_.begin() + static_cast<ptrdiff_t>(*best));
    plan_.elements[taken] = std::max(plan_.elements[taken], elements);
    return taken;
  }

  void choose_buffers() {
    constexpr uint32_t kForever = ~0u;
    std::vector<uint32_t> last(graph_.values(), 0);
    for (uint32_t s = 0; s < plan_.steps.size(); ++s)
      for (const Source& source : plan_.steps[s].sources) last[source.value] = s;
    for (uint32_t v = 0; v < graph_.inputs.size(); ++v) last[v] = kForever;
    for (const Output& output : graph_.outputs) last[output.value] = kForever;

    plan_.buffer_of.assign(graph_.values(), Plan::kNowhere);
    for (uint32_t v = 0; v < graph_.inputs.size(); ++v)
      plan_.buffer_of[v] = new_buffer(elements_of(plan_.shapes[v]));
    for (uint32_t s = 0; s < plan_.steps.size(); ++s) {
      const auto made = static_cast<uint32_t>(graph_.inputs.size() + plan_.steps[s].node);
      const uint64_t elements = elements_of(plan_.shapes[made]);
      plan_.buffer_of[made] = last[made] == kForever ? new_buffer(elements) : take_buffer(elements);
      std::vector<uint32_t> done;
      for (const Source& source : plan_.steps[s].sources)
        if (last[source.value] == s) done.push_back(plan_.buffer_of[source.value]);
      std::sort(done.begin(), done.end());
      done.erase(std::unique(done.begin(), done.end()), done.end());
      free_.insert(free_.end(), done.begin(), done.end());
    }
  }

  const Graph& graph_;
  Plan plan_;
  std::vector<uint32_t> readers_;  // by value; outputs count as readers
  std::vector<uint32_t> free_;
};

}  // namespace

uint64_t Plan::bytes() const {
  uint64_t sum = 0;
  for (const uint64_t count : elements) sum += 16 * count;
  return sum;
}

Plan plan(const Graph& graph, std::span<const Shape> inputs) {
  return Planner(graph, inputs).run();
}

}  // namespace inverse::network
