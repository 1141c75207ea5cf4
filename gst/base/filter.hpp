// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gst/base/frames/picture.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/meta/view_meta.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/base/pads/side_pads.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "property_table.hpp"

namespace inverse {

struct FreeStructure {
  void operator()(GstStructure* structure) const { gst_structure_free(structure); }
};
using StructurePtr = std::unique_ptr<GstStructure, FreeStructure>;

/// One frame on its way through a filter.
struct FrameContext {
  gpu::Commands& commands;  ///< record here; submitted once by the base
  Layers layers;  ///< in: `input` alone if pixels came in, else what the meta carried; out: what to
                  ///< send on
  uint64_t number;          ///< frames since `configure`, from 0
  GstBuffer* in = nullptr;  ///< the buffer that came in, for its metas
  /// Its stream time; none if its segment is not in time.
  GstClockTime time = GST_CLOCK_TIME_NONE;

  /// Out: posted as element messages, also if `process` throws.
  std::vector<StructurePtr> messages = {};
  /// Out: read-only properties that changed (GObject::notify).
  std::vector<const char*> notify = {};
  /// Out: configuration warnings, posted on the bus; the filter adds each once.
  std::vector<std::string> warnings = {};
  Picture picture = {};  ///< out: what to draw
  /// Out: adds metas of the filter's own to the buffer that goes out.
  std::function<void(GstBuffer*)> decorate = {};

  bool fresh = false;  ///< the filter was reset before this frame: start, caps that differ in more
                       ///< than frame rate and pixel aspect ratio, flush, seek, gap
  bool new_stream = false;    ///< and it is the first of a stream
  bool draw = false;          ///< pixels go out: set `picture`
  bool alpha = false;         ///< these pixels have alpha, w of the picture
  bool gray = false;          ///< the buffer's pixels have no color
  bool repeated = false;      ///< the picture of the frame before came again, byte by byte
  bool keep_planes = false;   ///< repeats are frequent: keep the planes of this frame for the next
  bool same_picture = false;  ///< out: the picture is the one drawn last

  /// Waits until other commands of this frame are done; a flush or a stop ends the wait, and with
  /// it the frame: what is thrown then is not for the filter.
  std::function<void(gpu::Commands&)> wait = {};
};

/// The mouse over the picture (GstNavigation): its first button goes down, it moves, the button
/// goes up. Position in pixels of the frame; may be any number, NaN included.
struct MouseEvent {
  enum class Kind { press, move, release };
  Kind kind;
  double x, y;
};

/// What Filter::process throws if a flush ends a wait of its own.
struct Flushing {};

/// What an element does with frames. The base (filter.cpp) does the rest: caps, device, upload,
/// download, properties, events, QoS, latency, stats, errors. All calls but `parameters()`,
/// `start()` and `navigate()` come from the streaming thread; what they throw becomes an element
/// error.
class Filter {
 public:
  virtual ~Filter() = default;
  /// Where it logs: into the category of its element. The base sets it before all other calls.
  const Log& log() const { return log_; }
  void set_log(const Log& log) { log_ = log; }
  virtual PropertyStore& parameters() = 0;
  /// READY → PAUSED, before any frame, from the application's thread: reads files. What it throws
  /// becomes an element error, and the element does not start.
  virtual void start() {}
  /// Throws Error(unsupported) if plain frames `in` cannot become frames `out`; when caps are set.
  virtual void check_plain(const GstVideoInfo& /*in*/, const GstVideoInfo& /*out*/) const {}
  /// Makes pipelines and state for output frames of this size; called before the first frame and
  /// when size or device change.
  virtual void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) = 0;
  /// Drops everything on the device.
  virtual void release() = 0;
  /// Forgets earlier frames.
  virtual void reset() {}
  /// Its further sink pads (ElementInfo::side_sinks); null if it has none.
  virtual SidePads* side_pads() { return nullptr; }
  /// Whether frames are to be compared with the ones before them, for FrameContext::repeated.
  virtual bool compares_frames() const { return false; }
  /// If so, pixels that are not square cause a warning that says what to do.
  virtual bool needs_square_pixels() const { return false; }
  /// The values of `show` that draw a frame, as a camera would send it, not a layer; the first one
  /// is recommended to who takes a layer for a frame. Empty: all do.
  virtual std::span<const char* const> shows_frame() const { return {}; }
  /// Whether a picture that is marked as that of a layer (ViewMark) does as a frame.
  virtual bool takes_view(std::string_view layer) const { return layer == kDiffuseView; }
  /// Records the work for one frame.
  virtual void process(FrameContext& frame) = 0;
  /// A frame is completed: its time includes the wait for the device; `number` is FrameContext's.
  /// Called once for each, before `describe`.
  virtual void completed(uint64_t /*number*/, double /*milliseconds*/) {}
  /// Downstream reported by QoS how late a frame was; negative: early.
  virtual void late(double /*milliseconds*/) {}
  /// A value for a property (float), within its range.
  struct Setting {
    const char* property;
    double value;
  };
  /// The mouse (ElementInfo::navigation), from any thread. Returns properties that follow it: the
  /// base sets them as an application does, so that bindings and notify handlers see the change.
  virtual std::vector<Setting> navigate(const MouseEvent& /*event*/) { return {}; }
  /// A flush or a new stream: pending requests of users belong to another scene. Not after frames
  /// were dropped: who draws on a live stream goes on.
  /// From the streaming thread or while it is stopped; `reset` follows with the next frame.
  virtual void flushed() {}
  /// The stream ended, or the element stops; all frames are completed. From the streaming thread or
  /// while it is stopped; may come twice. What it throws becomes a warning.
  virtual void ended() {}
  /// Adds fields about a completed frame; `number` is FrameContext's, at most kFramesInFlight back.
  virtual void describe(GstStructure*, uint64_t /*number*/) const {}

 private:
  Log log_ = log_of(nullptr);
};

/// An action signal of an element, emitted by applications.
struct Action {
  const char* name;
  std::vector<GType> arguments;
  /// From the thread that emits. What it throws becomes a warning.
  void (*run)(Filter& filter, const GValue* arguments);
  bool returns_success = false;  ///< FALSE after a warning
};

/// All that makes an element out of a Filter.
struct ElementInfo {
  const char* factory;      ///< "intrinsicdecomp"
  const char* type_name;    ///< "GstIntrinsicDecomp"
  const char* long_name;    ///< a few words
  const char* klass;        ///< "Filter/Video"; with "Effect" if it needs no other element of ours
  const char* description;  ///< one sentence
  Flow sink, src;
  /// The kind of layers that it makes from pixels, or that it needs; kAnyLayers or kAllLayers.
  const char* layers;
  /// What to insert before this element if its input does not suit it.
  const char* needs = nullptr;
  std::unique_ptr<Filter> (*create)() = nullptr;
  std::vector<Action> actions = {};
  bool navigation = false;  ///< whether it takes navigation events (Filter::navigate)
  /// The kinds of layers in its sink's template. Layers that it cannot use are refused with an
  /// error that names `needs`.
  const char* accepts = kAnyLayers;
  /// Of an element that works on layers and also on plain frames: what caps of one pad mean for the
  /// other, as inverse::transform_caps does otherwise. Null: it refuses plain frames.
  GstCaps* (*plain_caps)(GstPadDirection, GstCaps* caps, GstCaps* templates,
                         GstCaps* filter) = nullptr;
  /// Sink pads for pictures that it has on request, by name (Filter::side_pads).
  std::vector<const char*> side_sinks = {};

  /// Caps of its pads. New references.
  GstCaps* sink_caps() const { return template_caps(sink, accepts); }
  GstCaps* src_caps() const {
    return template_caps(src, sink == Flow::pixels ? layers : kAnyLayers);
  }
  /// Whether it may work without layers before it, so that it has to find a device of its own.
  bool takes_pixels() const { return sink == Flow::pixels || plain_caps; }
  /// Whether pictures that come in have to be frames, not pictures of layers.
  bool takes_frames() const { return takes_pixels() && layers; }
};

/// The filter of an element that is one.
Filter& filter_of(GstElement* element);

/// Registers the element; one line of the plugin's list.
gboolean register_filter(GstPlugin* plugin, const ElementInfo& info);

}  // namespace inverse
