// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/video/video.h>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "caps.hpp"
#include "gst/base/frames/picture.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/image/tiles/tile_list.hpp"
#include "log.hpp"
#include "property_table.hpp"

namespace inverse {

struct FreeStructure {
  void operator()(GstStructure* structure) const { gst_structure_free(structure); }
};
using StructurePtr = std::unique_ptr<GstStructure, FreeStructure>;

/// One frame on its way through a filter.
struct FrameContext {
  gpu::Commands& commands;  ///< record here; submitted once by the base
  Layers layers;  ///< in: `input` alone where pixels came in, else what the meta carried; out: what
                  ///< to send on
  uint64_t number;          ///< frames since `configure`, from 0
  GstBuffer* in = nullptr;  ///< the buffer that came in, for its metas
  /// Its stream time; none where its segment is not in time.
  GstClockTime time = GST_CLOCK_TIME_NONE;
  /// Of every tile of 16 x 16 pixels, row by row, 0 where its bytes are those of the frame before;
  /// empty where that is not known.
  std::span<const uint8_t> changed = {};

  /// Out: what there is to tell the application, posted as element messages, also where
  /// `process` throws.
  std::vector<StructurePtr> messages = {};
  /// Out: read-only properties that changed (GObject::notify).
  std::vector<const char*> notify = {};
  /// Out: configuration warnings, posted on the bus; the filter adds each once.
  std::vector<std::string> warnings = {};
  Picture picture = {};  ///< out: what to draw
  /// Out: the only tiles where it differs from the one that was drawn last; null: all may.
  const TileList* drawn = nullptr;
  /// Out: adds metas of the filter's own to the buffer that goes out.
  std::function<void(GstBuffer*)> decorate = {};

  bool fresh = false;  ///< the filter was reset before this frame: start, other frames (caps that
                       ///< differ in more than rate and shape of pixels), flush, seek, gap
  bool draw = false;   ///< pixels go out: set `picture`
  bool gray = false;   ///< the buffer's pixels have no color
  bool repeated = false;  ///< the picture of the frame before came again, byte by byte
  bool hold = false;  ///< that happens often: planes of this frame are worth keeping for the next
  bool same_picture = false;  ///< out: it would come out as the one that was drawn last
};

/// What an element does with frames. The base (filter.cpp) does the rest: caps, device, upload,
/// download, properties, events, QoS, latency, stats, errors. All calls but `parameters()`
/// and `start()` come from the streaming thread; what they throw becomes an element error.
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
  /// Makes pipelines and state for frames of this size (as they go out: ElementInfo::side_by_side);
  /// called before the first frame and when size or device change.
  virtual void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) = 0;
  /// Drops everything on the device.
  virtual void release() = 0;
  /// Forgets earlier frames.
  virtual void reset() {}
  /// Whether frames are to be compared with the ones before them, for FrameContext::repeated and
  /// `changed`.
  virtual bool looks_for_repeats() const { return false; }
  /// Whether it takes pixels to be square; where they are not, a warning says what to do.
  virtual bool takes_pixels_for_square() const { return false; }
  /// Records the work for one frame.
  virtual void process(FrameContext& frame) = 0;
  /// What a completed frame took, its wait for the device included; `number` is FrameContext's.
  /// Called once for each, before `describe`.
  virtual void took(uint64_t /*number*/, double /*milliseconds*/) {}
  /// Who shows the frames said (QoS) that one came so much too late; negative: early.
  virtual void late(double /*milliseconds*/) {}
  /// Somebody marked a pixel of the frame, or clicked on one of the picture that is shown. From any
  /// thread, as the three after it.
  virtual void mark(int /*x*/, int /*y*/) {}
  virtual void click(int /*x*/, int /*y*/) {}
  /// The mouse over the picture (ElementInfo::points), in pixels of the frame: its first button
  /// goes down, it moves, the button goes up. From any thread. Gives the properties (floats) that
  /// follow it, within their ranges: the base sets them as an application does, so that whatever is
  /// bound to them hears of it.
  enum class Mouse { press, move, release };
  struct Setting {
    const char* property;
    double value;
  };
  virtual std::vector<Setting> point(Mouse, double /*x*/, double /*y*/) { return {}; }
  virtual void unmark(int /*region*/) {}
  virtual void refine() {}
  /// What was marked and not seen to yet was in another scene: a flush, a new stream, a
  /// discontinuity. From the streaming thread or while it rests; `reset` follows with the next
  /// frame.
  virtual void flushed() {}
  /// The stream ended, or the element stops: the last frame is done (ElementInfo::lights). From the
  /// streaming thread or while it rests; may come twice. What it throws becomes a warning.
  virtual void ended() {}
  /// Writes the light that it found to a file (ElementInfo::lights). From any thread; throws
  /// Error(output) where it cannot.
  virtual void save_environment(const std::string& /*path*/) {}
  /// Adds fields about a frame that is completed; `number` is FrameContext's, at most
  /// kFramesInFlight back.
  virtual void describe(GstStructure*, uint64_t /*number*/) const {}

 private:
  Log log_ = log_of(nullptr);
};

/// All that makes an element out of a Filter.
struct ElementInfo {
  const char* factory;      ///< "intrinsicdecomp"
  const char* type_name;    ///< "GstIntrinsicDecomp"
  const char* long_name;    ///< a few words
  const char* klass;        ///< "Filter/Effect/Video"
  const char* description;  ///< one sentence
  Flow sink, src;
  /// Of a decomposer: the kind of layers that it makes. Of an editor: the kind that it needs, or
  /// kAnyLayers or kAllLayers.
  const char* layers;
  /// What to insert before this element where an editor gets what it cannot work on.
  const char* needs;

  /// Caps of its pads. New references. An editor's sink takes all layers of reflectance and
  /// shading, to refuse what is not enough for it with a helpful error.
  GstCaps* sink_caps() const {
    const std::string_view kind = layers ? layers : "";
    const bool own = kind == kAllLayers || kind == kGradientLayers;
    return template_caps(sink, own ? layers : kAnyLayers);
  }
  GstCaps* src_caps() const {
    return template_caps(src, sink == Flow::pixels ? layers : kAnyLayers);
  }
  std::unique_ptr<Filter> (*create)();
  /// Whether it takes clicks: navigation events, and the action signals mark, unmark and
  /// refine.
  bool marks = false;
  /// Whether it finds light: Filter::ended, and the action signal save-environment.
  bool lights = false;
  bool points = false;  ///< whether it follows the mouse: navigation events
  /// Of an element that takes layers: so many pictures side by side in a plain frame do as well,
  /// and what it sends is as much narrower. 0: it refuses plain frames.
  uint32_t side_by_side = 0;

  /// Whether it may work without layers before it, so that it has to find a device of its own.
  bool takes_pixels() const { return sink == Flow::pixels || side_by_side > 0; }
};

/// Registers the element; one line of the plugin's list.
gboolean register_filter(GstPlugin* plugin, const ElementInfo& info);

}  // namespace inverse
