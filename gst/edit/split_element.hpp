// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/base/gstflowcombiner.h>

#include <memory>
#include <mutex>
#include <vector>

#include "gst/base/property_table.hpp"
#include "split_branch.hpp"

namespace inverse {

/// The work behind intrinsicsplit: its branches, what flows to them, stats. intrinsicsplit.cpp
/// binds it to GObject.
class SplitElement {
 public:
  SplitElement(GstElement* element, GstPad* sink);
  SplitElement(const SplitElement&) = delete;
  SplitElement& operator=(const SplitElement&) = delete;
  ~SplitElement();

  /// Takes a pad into the flow, from any thread; it must be active. False if there is one for
  /// this layer (and base color) already.
  bool add(GstPad* pad, SplitLayer layer, uint32_t base);
  /// Takes it out again and off the element.
  void remove(GstPad* pad);
  /// PAUSED → READY.
  void stop();

  GstFlowReturn chain(GstBuffer* buffer);
  /// Both take the event.
  gboolean sink_event(GstEvent* event);
  gboolean src_event(GstPad* pad, GstEvent* event);
  gboolean sink_query(GstQuery* query);
  gboolean src_query(GstPad* pad, GstQuery* query);

  PropertyStore& parameters() { return parameters_; }
  static const PropertyTable<SplitParams>& table();
  /// A copy of the stats of the last completed frame.
  GstStructure* stats() const;

 private:
  using BranchPtr = std::shared_ptr<SplitBranch>;
  std::vector<BranchPtr> branches() const;
  bool set_caps(GstCaps* caps);
  /// Both say on the bus, once, what went wrong.
  bool start(SplitBranch& branch);
  bool negotiate(SplitBranch& branch);
  void send(const std::vector<BranchPtr>& to, GstEvent* event);
  void draw(GstBuffer* buffer, const std::vector<BranchPtr>& branches,
            std::vector<GstBuffer*>& frames);
  /// Sends each branch its frame, if it has one; takes the frames.
  GstFlowReturn push(const std::vector<BranchPtr>& branches, const std::vector<GstBuffer*>& frames);
  void publish(double wall_ms);
  GstCaps* sink_caps(GstCaps* filter);
  GstCaps* src_caps(SplitLayer layer, GstCaps* filter);

  GstElement* element_;
  GstPad* sink_;  // the element's
  Parameters<SplitParams> parameters_{table()};

  GstCaps* caps_ = nullptr;  // of the layers that come in; under mutex_
  std::unique_ptr<gpu::Commands> commands_;
  LayerPictures pictures_;
  uint64_t frames_ = 0;

  mutable std::mutex mutex_;  // branches_, combiner_, caps_, stats_
  std::vector<BranchPtr> branches_;
  GstFlowCombiner* combiner_;
  GstStructure* stats_ = nullptr;
};

}  // namespace inverse
