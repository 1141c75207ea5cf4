// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>

#include "frame_assembler.hpp"
#include "gradient_layers.hpp"
#include "raw_frame.hpp"

namespace inverse {

/// Gradients A and B of a performance in one buffer, as layers or side by side.
class PairAssembler final : public FrameAssembler {
 public:
  PairAssembler(GstElement* element, GstPad* src, std::shared_ptr<const StageLabels> labels,
                const SyncParams& params, DeviceContext& context);
  ~PairAssembler() override;
  /// Throws Error(file) if `params` ask for pairs and no B follows an A in the program.
  static void check(const SyncParams& params, const LightProgram& program);

  bool set_caps(GstCaps* caps) override;
  GstFlowReturn take(GstBuffer* buffer, const FrameLabel* label) override;
  GstFlowReturn finish(bool program_over) override;
  void return_buffers() override;
  void forget() override;
  void add_stats(GstStructure* stats) const override;

 private:
  GstFlowReturn pair(GstBuffer* b, const FrameLabel& label);
  GstBuffer* aligned(GstBuffer* b, const FrameLabel& label);
  GstBuffer* side_by_side(GstBuffer* a, GstBuffer* b);
  bool choose_caps(GstCaps* caps);
  void drop_first();

  const bool align_;
  const std::string device_;
  DeviceContext& context_;
  GstVideoInfo info_, out_info_;
  bool negotiated_ = false;
  std::unique_ptr<GradientLayers> layers_;  // if layers go out
  std::optional<Linearizer> linear_;
  GstBuffer* a_ = nullptr;  // waits for its B
  FrameLabel a_label_;
  struct Before;  // the B before this one
  std::unique_ptr<Before> before_;
  mutable std::mutex mutex_;  // the counts
  uint64_t pairs_ = 0, unpaired_ = 0, unaligned_ = 0, other_ = 0;
};

}  // namespace inverse
