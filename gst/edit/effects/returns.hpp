// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "gst/base/filter.hpp"
#include "return_pad.hpp"
#include "returned_reader.hpp"

namespace inverse {

/// How to take back pictures of layers.
struct ReturnParams {
  bool use_mask = true;
  float strength = 1;
};

/// The part of an element that takes back pictures of layers which left by intrinsicsplit: its
/// request pads, which frame their pictures belong to, how long to wait for them, and what they
/// change (kernels/edit/returned.hpp).
///
/// A frame whose picture is missing goes on unedited, and is counted. It waits for one
/// - in live pipelines until the latency that was agreed on is over, but always for a frame's
///   duration: elements that are slower than they said would otherwise never be waited for;
/// - in others until the branch has something later, or ends, or for kTimeout: then the branch
///   drops frames, or cannot go on before this one does.
class Returns final : public SidePads {
 public:
  static constexpr GstClockTime kTimeout = 10 * GST_SECOND;

  /// The names of the pads (ElementInfo::side_sinks).
  static std::vector<const char*> pad_names();

  GstPad* request(GstElement* element, GstPadTemplate* pad_template) override;
  void release(GstPad* pad) override;
  void set_flushing(bool flushing) override;
  void add_latency(GstQuery* query) override;

  /// A stream starts: counts begin anew.
  void start();
  /// The stream on `sink` is over, or goes on: what comes back meanwhile is dropped.
  void set_ended(bool ended);
  /// Drops everything on the device.
  void forget_device();
  /// Adds the counts to stats, if there are pads.
  void describe(GstStructure* stats) const;
  /// Called with true when a frame begins to wait for its pictures, with false when that is over;
  /// from the thread of `sink`. Set it before there are frames.
  void set_wait_handler(std::function<void(bool waits)> handler) { on_wait_ = std::move(handler); }

  /// Changes `frame.layers` by the pictures that came back for this frame; waits for them. Nothing
  /// is recorded without pads. Throws Flushing.
  void apply(GstElement* element, FrameContext& frame, const ReturnParams& params);

 private:
  using PadPtr = std::shared_ptr<ReturnPad>;
  /// A pad's picture for a frame.
  struct Arrival {
    PadPtr pad;
    ReturnPad::Found found = ReturnPad::Found::nothing_yet;
    ReturnPad::Picture picture;
    bool gave_up = false;     ///< it was waited for in vain, for the first time
    bool never_came = false;  ///< nor did any other, for the first time
  };
  using Deadline = std::chrono::steady_clock::time_point;

  /// The pads there are now. Each keeps its GstPad alive: another thread may release it.
  std::vector<PadPtr> pads() const;
  std::vector<Arrival> collect(GstElement* element, GstBuffer* in);
  /// Until when frames may wait, by the latency of the pipeline if it is live.
  struct Limits {
    bool live = false;
    Deadline deadline;
  };
  Limits limits(GstElement* element, ReturnPad::Time time, GstClockTime duration) const;

  std::shared_ptr<ReturnPad::Shared> shared_ = std::make_shared<ReturnPad::Shared>();
  std::vector<PadPtr> pads_;  // under Shared::mutex
  std::function<void(bool)> on_wait_ = [](bool) {};

  // Of the streaming thread of `sink`.
  std::map<SplitLayer, ReturnedReader> readers_;
  std::optional<ReturnedEdit> edit_;
  std::shared_ptr<gpu::Device> device_;  // of edit_
  Extent extent_;
};

/// A filter that takes back pictures.
class ReturningFilter : public Filter {
 public:
  SidePads* side_pads() override { return &returns_; }
  void start() override { returns_.start(); }
  void flushed() override { returns_.set_ended(false); }
  void ended() override { returns_.set_ended(true); }
  void release() override { returns_.forget_device(); }
  void describe(GstStructure* stats, uint64_t) const override { returns_.describe(stats); }
  Returns& returns() { return returns_; }

 protected:
  void apply_returned(FrameContext& frame, const ReturnParams& params) {
    returns_.apply(log().object, frame, params);
  }

 private:
  Returns returns_;
};

}  // namespace inverse
