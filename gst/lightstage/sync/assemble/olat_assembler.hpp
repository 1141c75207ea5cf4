// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "frame_assembler.hpp"
#include "raw_frame.hpp"

namespace inverse {

/// Frames of a static capture, each aligned with the last tracking frame (thesis 7.3.2): flow from
/// that one to all others, linearly interpolated in time between them. Keeps all frames until the
/// pass is over.
class OlatAssembler final : public FrameAssembler {
 public:
  OlatAssembler(GstElement* element, GstPad* src, std::shared_ptr<const StageLabels> labels,
                const SyncParams& params, uint32_t camera);
  /// Throws Error(file) if `params` ask for OLATs and the program has none or no tracking frames,
  /// or if the folder cannot be made.
  static void check(const SyncParams& params, const LightProgram& program);
  /// Max number of steps of a pass for which its first frame is kept: until the frame after it.
  static uint64_t longest_pass(const LightProgram& program);

  bool set_caps(GstCaps* caps) override;
  GstFlowReturn take(GstBuffer* buffer, const FrameLabel* label) override;
  GstFlowReturn finish(bool program_over) override;
  void forget() override;
  void add_stats(GstStructure* stats) const override;

 private:
  struct Unref {
    void operator()(GstBuffer* buffer) const { gst_buffer_unref(buffer); }
  };
  using HeldBuffer = std::unique_ptr<GstBuffer, Unref>;
  struct Held {
    HeldBuffer buffer;
    FrameLabel label;
  };
  /// `ended`: the pass was complete, apart from lost frames.
  GstFlowReturn assemble(bool ended);
  GstFlowReturn send(const Held& held, const cv::Mat& displacement);
  void make_draft() const;
  void save(const Held& held, const cv::Mat& light);
  void save_list() const;
  void publish(bool ended);
  std::string folder() const;
  /// Folder of files until all are written, on the same disk.
  std::string draft() const { return folder() + ".new"; }

  const std::string location_;
  const uint32_t camera_;
  GstVideoInfo info_;
  std::optional<Linearizer> linear_;
  std::vector<Held> held_;
  std::map<std::string, std::string> files_;  // of the draft, by kind and light
  std::map<uint32_t, std::string> olat_files_;
  mutable std::mutex mutex_;  // the counts
  uint64_t passes_ = 0, moved_ = 0, still_ = 0, written_ = 0;
  double mean_motion_ = 0;  // pixels
};

}  // namespace inverse
