// SPDX-License-Identifier: LGPL-2.1-or-later
#include "clicks_stage.hpp"

#include <chrono>

namespace inverse::bench {

ClicksStage::ClicksStage(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent),
      commands_(device),
      method_(device, extent),
      regions_(device, extent),
      correction_(device, extent),
      proposals_(device, extent) {
  const auto create = [&](gpu::Memory memory) {
    return gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), memory);
  };
  input_ = {extent, create(gpu::Memory::upload)};
  for (auto* buffer : {&features_, &marks_, &intrinsic_}) *buffer = create(gpu::Memory::readback);
  // Clusters do not depend on the solution, so a cheap solve suffices unless reflectance is needed.
  // The correction and refinement need full solves.
  cheap_.steps = cheap_.pcg_iterations = 1;
  cheap_.refine_rounds = whole_.refine_rounds = 0;
  cheap_.cut_fraction = whole_.cut_fraction = 0;
}

void ClicksStage::begin(const Image& frame, Mode mode) {
  mode_ = mode;
  method_.reset();
  regions_.reset();
  regions_.take_lost();
  correction_.reset();
  proposals_.reset();
  proposals_made_.clear();
  proposal_ms_ = 0;
  method_.set_params(cheap_);
  upload(frame);
  commands_.begin();
  method_.record_colors(commands_, input_);
  commands_.submit();
  commands_.wait();
  method_.collect_colors();
}

void ClicksStage::run(const Image& frame, bool whole) {
  upload(frame);
  commands_.begin();
  Layers layers;
  GlobalThesis::Hints hints;
  hints.regions = &regions_;
  method_.set_params(whole ? whole_ : cheap_);
  const uint64_t number = method_.record(commands_, input_, layers, hints);
  method_.set_params(whole_);
  const uint64_t corrected = correction_.record(commands_, method_, regions_);
  const uint64_t proposed = proposals_.record(commands_, method_, regions_, mode_);
  commands_.copy(method_.features(), features_, features_->bytes());
  commands_.copy(regions_.plane().buffer, marks_, marks_->bytes());
  commands_.copy(layers[Role::intrinsic]->buffer, intrinsic_, intrinsic_->bytes());
  commands_.submit();
  colors_ = method_.colors().colors();
  commands_.wait();
  method_.collect(number);
  regions_.collect(regions_.last());
  correction_.collect(corrected, regions_);
  for (const int hopeless : correction_.take_hopeless())
    regions_.remove(hopeless, MarkedRegions::Loss::no_candidates);
  const auto start = std::chrono::steady_clock::now();
  for (const auto& proposal : proposals_.collect(proposed, regions_))
    proposals_made_.push_back(proposal);
  proposal_ms_ +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Clusters ClicksStage::clusters(const TruthFrame& truth) const {
  const auto* features = features_->map_as<float>();
  const auto* marks = marks_->map_as<float>();
  Clusters result;
  for (size_t n = 0; n < extent_.pixels(); ++n) {
    const int raw = static_cast<int>(features[4 * n + 3]);
    const int demanded = static_cast<int>(marks[4 * n]);
    result.raw.push_back(raw);
    result.corrected.push_back(demanded >= 0 ? demanded : raw);
    result.region.push_back(static_cast<int>(marks[4 * n + 1]));
  }
  const TrueSlots slots(truth.reflectance, truth.mask, colors_);
  result.truth = slots.nearest();
  result.raw_wrong = slots.wrong(result.raw);
  result.wrong = slots.wrong(result.corrected);
  return result;
}

Image ClicksStage::reflectance() const {
  Image result(static_cast<int>(extent_.width), static_cast<int>(extent_.height), 3);
  const auto* pixel = intrinsic_->map_as<float>();
  for (size_t n = 0; n < extent_.pixels(); ++n)
    for (size_t c = 0; c < 3; ++c) result.data[3 * n + c] = pixel[4 * n + c];
  return result;
}

void ClicksStage::upload(const Image& frame) {
  auto* pixel = input_.buffer->map_as<float>();
  for (size_t n = 0; n < extent_.pixels(); ++n) {
    for (size_t c = 0; c < 3; ++c) pixel[4 * n + c] = frame.data[3 * n + c];
    pixel[4 * n + 3] = 1;
  }
}

}  // namespace inverse::bench
