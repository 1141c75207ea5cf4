// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "gst/lightstage/sync/assemble/frame_assembler.hpp"
#include "gst/lightstage/sync/assemble/raw_frame.hpp"
#include "kernels/lightstage/labels/frame_labeler.hpp"

namespace inverse {

/// One camera of lightstagesync: its two pads, and the items between them. All of it is under the
/// element's mutex, except what belongs to the two streaming threads.
struct SyncCamera {
  using Clock = std::chrono::steady_clock;

  /// A buffer, an event or a query, in order of arrival.
  struct Item {
    enum class State : uint8_t { waiting, leaves, dropped } state = State::waiting;
    GstMiniObject* object = nullptr;  // owned, unless it is a query
    uint64_t token = 0;               // of a buffer
    std::optional<FrameLabel> label;
    GstClockTime time = GST_CLOCK_TIME_NONE;  // running time
  };

  SyncCamera(uint32_t number, GstPad* sink, GstPad* src)
      : number(number), sink(GST_PAD(gst_object_ref(sink))), src(GST_PAD(gst_object_ref(src))) {}
  SyncCamera(const SyncCamera&) = delete;
  SyncCamera& operator=(const SyncCamera&) = delete;
  ~SyncCamera() {
    clear();
    gst_object_unref(sink);
    gst_object_unref(src);
  }

  std::string name() const { return "sink_" + std::to_string(number); }

  /// Appends an event or a query, which leaves when all before it has.
  template <typename Object>
  void append(Object* object) {
    line.push_back(
        {Item::State::leaves, GST_MINI_OBJECT_CAST(object), 0, std::nullopt, GST_CLOCK_TIME_NONE});
  }
  /// Takes a query back; false if the source pad's thread is answering it.
  bool take_back(GstQuery* query) {
    const auto is_query = [&](const Item& item) {
      return item.object == GST_MINI_OBJECT_CAST(query);
    };
    return std::erase_if(line, is_query) + std::erase_if(out, is_query) > 0;
  }
  /// Moves decided items at the head of the line on to the source pad's thread.
  void advance() {
    while (!line.empty() && line.front().state != Item::State::waiting) {
      if (line.front().state == Item::State::leaves) {
        outgoing_buffers += GST_IS_BUFFER(line.front().object) ? 1 : 0;
        out.push_back(line.front());
      } else {
        gst_mini_object_unref(line.front().object);
      }
      line.pop_front();
    }
  }
  Item* find(uint64_t token) {
    for (Item& item : line)
      if (item.token == token) return &item;
    return nullptr;
  }
  /// Whether frames are here that have no label yet, and may get one.
  bool waits_for_labels() const {
    return !stalled && std::ranges::any_of(line, [](const Item& item) {
      return item.state == Item::State::waiting && !item.label;
    });
  }
  void clear() {
    for (auto* queue : {&line, &out}) {
      for (const Item& item : *queue)
        if (!GST_IS_QUERY(item.object)) gst_mini_object_unref(item.object);
      queue->clear();
    }
    in_sets = outgoing_buffers = 0;
  }

  const uint32_t number;
  GstPad *const sink, *const src;  // kept: one of them may be asked while the other is released

  // The sink pad's thread.
  std::optional<GstVideoInfo> info;
  std::optional<Linearizer> linear;
  GstSegment segment{};

  // The source pad's thread.
  std::unique_ptr<FrameAssembler> assembler;

  // Under the mutex.
  std::deque<Item> line, out;
  size_t in_sets = 0, outgoing_buffers = 0;  // buffers that wait for other cameras, or to be pushed
  size_t frame_bytes = 0;                    // of the caps
  std::unique_ptr<FrameLabeler> labeler;
  uint64_t run = 0;    // of the program: labels of different runs do not compare
  uint64_t start = 0;  // of the labeler's, by which the last frame was counted
  std::optional<uint64_t> last_trigger;
  GstClockTime last_time = GST_CLOCK_TIME_NONE;  // running time of that frame
  std::string stream_id;
  GstQuery* query = nullptr;  // behind the frames before it; null once it is answered
  bool live = false, upstream_known = false;
  GstClockTime sinks_wait = 0;  // latency of the sinks after it
  uint32_t id_bits = 0;         // as upstream says; 0: it does not
  bool flushing = true, ended = false, released = false;
  bool program_ended = false;  // and that is on its way to the assembler
  bool blocked = false;        // its thread waits because there is no room
  bool left_alone = false;     // sets do not wait for it any more
  bool stalled = false;        // and that was reported
  bool begun = false;          // caps or a frame have come
  bool answer = false;         // to it
  Clock::time_point last_arrival{};
  GstFlowReturn flow = GST_FLOW_OK;  // of the last push
  FrameLabeler::Counts triggered;    // in place of the labeler's if frames are triggered
  FrameLabeler::Counts reported;     // at the last warning
  Clock::time_point reported_at{};
  bool was_anchored = false;
  uint64_t incomplete = 0, sent = 0;  // frames
};

}  // namespace inverse
