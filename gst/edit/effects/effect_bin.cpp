// SPDX-License-Identifier: LGPL-2.1-or-later
#include "effect_bin.hpp"

#include <utility>

#include "gst/base/log/errors.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/base/pads/pads.hpp"
#include "returns.hpp"

namespace inverse {
namespace {

/// Frames that the queue holds if none waits for its picture, and if one does: an effect may hold
/// back that many.
constexpr guint kQueued = 2, kQueuedWaiting = 64;
constexpr guint kMaxQueuedBytes = 1U << 30;

constexpr const char* kLayerNames[] = {"reflectance", "shading", "direct", "indirect", "mask"};

/// A bin of a piece of a launch line with one pad in and one out. Throws Error(unsupported);
/// `property` is where the text came from. New floating reference.
GstElement* parsed(const char* property, const std::string& text, const char* example) {
  const std::string what = std::string(property) + "=\"" + text + "\"";
  GError* error = nullptr;
  GstElement* bin = gst_parse_bin_from_description_full(text.c_str(), TRUE, nullptr,
                                                        GST_PARSE_FLAG_FATAL_ERRORS, &error);
  if (!bin) {
    const std::string why = error ? error->message : "no reason is known";
    g_clear_error(&error);
    throw Error(ErrorKind::unsupported, what + " cannot be built: " + why +
                                            "; it must be a piece of a gst-launch-1.0 line, as \"" +
                                            example + "\"");
  }
  g_clear_error(&error);
  for (const char* name : {"sink", "src"}) {
    const PadPtr pad(gst_element_get_static_pad(bin, name));
    if (pad) continue;
    gst_object_unref(gst_object_ref_sink(bin));
    throw Error(ErrorKind::unsupported, what + " has no free " +
                                            (name[1] == 'i' ? "sink" : "source") +
                                            " pad; it must take one stream of video and send one");
  }
  return bin;
}

/// Whether raw video in system memory can go through a ghost pad of a parsed bin, by the template
/// of its target: elements that do not run, as those of GL without a display, take nothing.
bool takes_video(GstPad* ghost) {
  const PadPtr target(gst_ghost_pad_get_target(GST_GHOST_PAD(ghost)));
  GstCaps* theirs = gst_pad_get_pad_template_caps(target.get());
  GstCaps* ours = pixel_caps();
  const bool fits = gst_caps_can_intersect(theirs, ours);
  gst_caps_unref(ours);
  gst_caps_unref(theirs);
  return fits;
}

/// Pushes frames through a pad of a tee whose branch may end before the others do: the tee would
/// end them all.
GstPadProbeReturn outlive(GstPad* pad, GstPadProbeInfo* info, gpointer) {
  const PadPtr next(gst_pad_get_peer(pad));
  if (!next) return GST_PAD_PROBE_OK;
  const GstFlowReturn flow = gst_pad_chain(next.get(), GST_PAD_PROBE_INFO_BUFFER(info));
  GST_PAD_PROBE_INFO_DATA(info) = nullptr;
  GST_PAD_PROBE_INFO_FLOW_RETURN(info) = flow == GST_FLOW_EOS ? GST_FLOW_OK : flow;
  return GST_PAD_PROBE_HANDLED;
}

}  // namespace

const PropertyTable<EffectParams>& EffectBin::table() {
  using P = EffectParams;
  using Layer = P::Layer;
  static const PropertyTable<P> table{
      choice<P>("layer", &P::layer, "GstInverseEditLayer",
                {{static_cast<int>(Layer::reflectance), "reflectance", "Color of surfaces"},
                 {static_cast<int>(Layer::shading), "shading", "Light on them"},
                 {static_cast<int>(Layer::direct), "direct",
                  "Light that comes straight from the lamps (globalintrinsic)"},
                 {static_cast<int>(Layer::indirect), "indirect",
                  "Light that bounced off surfaces (globalintrinsic)"},
                 {static_cast<int>(Layer::mask), "mask", "The mask layer of an editor before"}},
                "Layer that the effect changes", Mutable::ready),
      text<P>("effect", &P::effect,
              "Elements that change it, as in a gst-launch-1.0 line; empty = frames pass",
              Mutable::ready),
      text<P>("decomposer", &P::decomposer,
              "Elements that decompose frames if frames come in, not layers", Mutable::ready),
      number<P>("strength", &P::strength, 0, 1,
                "Share of the change; 0 = layers pass through unchanged"),
      flag<P>("use-mask", &P::use_mask,
              "Change the layer by the mask layer only, if the frame has one"),
  };
  return table;
}

EffectBin::EffectBin(GstBin* bin)
    : bin_(bin),
      tee_(gst_element_factory_make("tee", "tee")),
      split_(gst_element_factory_make("intrinsicsplit", "split")),
      queue_(gst_element_factory_make("queue", "queue")),
      merge_(gst_element_factory_make("intrinsicmerge", "merge")) {
  GstElementClass* klass = GST_ELEMENT_GET_CLASS(bin);
  sink_ = gst_ghost_pad_new_no_target_from_template(
      "sink", gst_element_class_get_pad_template(klass, "sink"));
  src_ = gst_ghost_pad_new_no_target_from_template(
      "src", gst_element_class_get_pad_template(klass, "src"));
  gst_pad_set_element_private(sink_, this);
  gst_pad_set_event_function(sink_, [](GstPad* pad, GstObject*, GstEvent* event) {
    return static_cast<EffectBin*>(gst_pad_get_element_private(pad))->event(event);
  });
  gst_pad_set_query_function(sink_, [](GstPad* pad, GstObject*, GstQuery* query) {
    return static_cast<EffectBin*>(gst_pad_get_element_private(pad))->query(query);
  });
  gst_pad_add_probe(
      sink_, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad* pad, GstPadProbeInfo* info, gpointer self) {
        sync_controlled(GST_PAD_PARENT(pad), pad, GST_PAD_PROBE_INFO_BUFFER(info));
        return static_cast<EffectBin*>(self)->frame(info);
      },
      this, nullptr);
  gst_element_add_pad(GST_ELEMENT(bin), sink_);
  gst_element_add_pad(GST_ELEMENT(bin), src_);
  if (!tee_ || !split_ || !queue_ || !merge_) return;  // assemble() says so
  gst_bin_add_many(bin, tee_, split_, queue_, merge_, nullptr);
  gst_element_link_pads(queue_, "src", merge_, "sink");
  g_object_set(queue_, "max-size-buffers", kQueued, "max-size-bytes", kMaxQueuedBytes,
               "max-size-time", guint64{0}, nullptr);
  // An effect may need later frames before it sends one.
  static_cast<ReturningFilter&>(filter_of(merge_)).returns().set_wait_handler([this](bool waits) {
    g_object_set(queue_, "max-size-buffers", waits ? kQueuedWaiting : kQueued, nullptr);
  });
}

GstStructure* EffectBin::stats() const {
  GstStructure* stats = nullptr;
  if (merge_) g_object_get(merge_, "stats", &stats, nullptr);
  return stats;
}

void EffectBin::install(GObjectClass* object_class, guint first_id, std::string_view child) const {
  parameters_.install(object_class, first_id, child);
}

void EffectBin::set(size_t index, const GValue* value) {
  const std::string name = table().rows()[index].name;
  const bool live = name == "strength" || name == "use-mask";
  parameters_.set(index, value);
  if (live) {
    if (merge_) g_object_set_property(G_OBJECT(merge_), name.c_str(), value);
  } else if (GST_STATE(bin_) > GST_STATE_READY) {
    // Kept: a video editor changes and saves properties of elements that play.
    post_warning(log_of(GST_ELEMENT(bin_)), GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS,
                 "%s cannot change while frames flow; stop the element (READY), and the next start "
                 "uses the new value",
                 name.c_str());
  } else if (name == "effect") {
    parse_effect();
  }
}

void EffectBin::remove(GstElement*& element) {
  if (!element) return;
  gst_element_set_state(element, GST_STATE_NULL);
  gst_bin_remove(bin_, element);
  element = nullptr;
}

void EffectBin::parse_effect() {
  remove(effect_);
  wrong_.clear();
  const std::string text = parsed_ = parameters_.snapshot().effect;
  if (text.find_first_not_of(' ') == std::string::npos) return;
  try {
    effect_ = parsed("effect", text, "gaussianblur sigma=4");
    gst_bin_add(bin_, effect_);
    gst_element_sync_state_with_parent(effect_);
  } catch (const Error& error) {
    wrong_ = error.what();
  }
}

bool EffectBin::assemble() {
  return guarded(GST_ELEMENT(bin_), [&] {
    if (!tee_ || !split_ || !queue_ || !merge_)
      throw Error(ErrorKind::unsupported,
                  "tee and queue are missing; install GStreamer's core elements");
    if (parameters_.snapshot().effect != parsed_) parse_effect();  // it changed while frames flowed
    if (!wrong_.empty()) throw Error(ErrorKind::unsupported, wrong_);
    const PadPtr sink(gst_element_get_static_pad(tee_, "sink"));
    gst_ghost_pad_set_target(GST_GHOST_PAD(sink_), sink.get());
    requested_.emplace_back(gst_element_request_pad_simple(tee_, "src_%u"));
    if (effect_)
      link_effect();
    else
      gst_ghost_pad_set_target(GST_GHOST_PAD(src_), requested_.back().get());
  });
}

void EffectBin::link_effect() {
  const EffectParams params = parameters_.snapshot();
  const char* layer = kLayerNames[static_cast<size_t>(params.layer)];
  const PadPtr in(gst_element_get_static_pad(effect_, "sink")),
      out(gst_element_get_static_pad(effect_, "src"));
  if (!takes_video(in.get()))
    throw Error(ErrorKind::unsupported,
                "effect=\"" + params.effect +
                    "\" takes no raw video in system memory; begin it with what converts, as "
                    "glupload");
  if (!takes_video(out.get()))
    throw Error(ErrorKind::unsupported,
                "effect=\"" + params.effect +
                    "\" sends no raw video in system memory; end it with what converts, as "
                    "gldownload or a decoder");
  const auto request = [&](GstElement* element, const char* name) {
    return requested_.emplace_back(gst_element_request_pad_simple(element, name)).get();
  };
  const auto link = [](GstPad* from, GstPad* to) {
    gst_pad_link_full(from, to, GST_PAD_LINK_CHECK_NOTHING);
  };
  const PadPtr splits(gst_element_get_static_pad(split_, "sink")),
      queued(gst_element_get_static_pad(queue_, "sink"));
  GstPad* first = requested_.front().get();
  link(first, splits.get());
  gst_pad_add_probe(first, GST_PAD_PROBE_TYPE_BUFFER, outlive, nullptr, nullptr);
  link(request(tee_, "src_%u"), queued.get());
  link(request(split_, layer), in.get());
  link(out.get(), request(merge_, layer));
}

void EffectBin::dismantle() {
  gst_ghost_pad_set_target(GST_GHOST_PAD(sink_), nullptr);
  gst_ghost_pad_set_target(GST_GHOST_PAD(src_), nullptr);
  remove(decomposer_);
  remove(compose_);
  for (const PadPtr& pad : requested_) {
    if (const PadPtr peer{gst_pad_get_peer(pad.get())})
      GST_PAD_IS_SRC(pad.get()) ? gst_pad_unlink(pad.get(), peer.get())
                                : gst_pad_unlink(peer.get(), pad.get());
    const ElementPtr element = element_of_pad(pad.get());
    gst_element_release_request_pad(element.get(), pad.get());
  }
  requested_.clear();
  kind_ = Kind::unknown;
  refused_ = false;
}

GstPadProbeReturn EffectBin::frame(GstPadProbeInfo* info) {
  if (!refused_) return GST_PAD_PROBE_OK;
  // The end, after which a source posts no error of its own.
  gst_buffer_unref(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_PAD_PROBE_INFO_DATA(info) = nullptr;
  GST_PAD_PROBE_INFO_FLOW_RETURN(info) = GST_FLOW_EOS;
  return GST_PAD_PROBE_HANDLED;
}

gboolean EffectBin::event(GstEvent* event) {
  if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS && effect_) {
    GstCaps* caps = nullptr;
    gst_event_parse_caps(event, &caps);
    // Once: an element that pushes on after an error sends the caps with every buffer.
    if (!refused_) refused_ = !guarded(GST_ELEMENT(bin_), [&] { arrange(caps); });
    if (refused_) {
      gst_event_unref(event);
      return TRUE;
    }
  }
  return gst_pad_event_default(sink_, GST_OBJECT(bin_), event);
}

void EffectBin::arrange(const GstCaps* caps) {
  const Kind kind = carries_layers(caps) ? Kind::layers : Kind::frames;
  if (kind == kind_) return;
  if (kind_ != Kind::unknown)
    throw Error(ErrorKind::unsupported,
                "intrinsicedit gets layers and frames in turn; let one kind of element come before "
                "it, or stop it (READY) in between");
  if (kind == Kind::frames) add_frame_elements();
  const PadPtr out(gst_element_get_static_pad(compose_ ? compose_ : merge_, "src"));
  gst_ghost_pad_set_target(GST_GHOST_PAD(src_), out.get());
  kind_ = kind;
}

void EffectBin::add_frame_elements() {
  const EffectParams params = parameters_.snapshot();
  decomposer_ = parsed("decomposer", params.decomposer, "intrinsicdecomp quality=fast");
  if (params.layer == EffectParams::Layer::mask && GST_BIN_NUMCHILDREN(decomposer_) < 2) {
    gst_object_unref(gst_object_ref_sink(std::exchange(decomposer_, nullptr)));
    throw Error(
        ErrorKind::unsupported,
        "layer=mask of intrinsicedit has no mask to change in plain frames; put a decomposer "
        "and an editor that writes one before it: intrinsicdecomp ! intrinsicselect ! "
        "intrinsicedit layer=mask ! intrinsiccompose");
  }
  compose_ = gst_element_factory_make("intrinsiccompose", "compose");
  gst_bin_add_many(bin_, decomposer_, compose_, nullptr);
  gst_ghost_pad_set_target(GST_GHOST_PAD(sink_), nullptr);
  if (!gst_element_link(merge_, compose_) || !gst_element_link(decomposer_, tee_))
    throw Error(ErrorKind::unsupported,
                "the decomposer of intrinsicedit sends no layers; use "
                "decomposer=intrinsicdecomp or globalintrinsic");
  gst_element_sync_state_with_parent(compose_);
  if (!gst_element_sync_state_with_parent(decomposer_))
    throw Error(ErrorKind::unsupported, "the decomposer of intrinsicedit does not start");
  const PadPtr in(gst_element_get_static_pad(decomposer_, "sink"));
  gst_ghost_pad_set_target(GST_GHOST_PAD(sink_), in.get());
}

GstCaps* EffectBin::caps(GstCaps* filter) const {
  GstCaps* ours = template_caps(kind_ == Kind::layers   ? Flow::layers
                                : kind_ == Kind::frames ? Flow::pixels
                                                        : Flow::layers_or_pixels,
                                kAnyLayers);
  GstCaps* taken = gst_pad_peer_query_caps(src_, nullptr);
  GstCaps* result =
      gst_caps_is_any(taken) ? filter_caps(ours, filter) : transform_caps(taken, ours, filter);
  gst_caps_unref(taken);
  return result;
}

gboolean EffectBin::query(GstQuery* query) {
  if (GST_QUERY_TYPE(query) == GST_QUERY_CAPS && effect_) {
    GstCaps* filter = nullptr;
    gst_query_parse_caps(query, &filter);
    GstCaps* result = caps(filter);
    gst_query_set_caps_result(query, result);
    gst_caps_unref(result);
    return TRUE;
  }
  if (GST_QUERY_TYPE(query) == GST_QUERY_ACCEPT_CAPS && effect_ && kind_ == Kind::unknown) {
    GstCaps* asked = nullptr;
    gst_query_parse_accept_caps(query, &asked);
    GstCaps* ours = gst_pad_get_pad_template_caps(sink_);
    gst_query_set_accept_caps_result(query, gst_caps_is_subset(asked, ours));
    gst_caps_unref(ours);
    return TRUE;
  }
  return gst_pad_query_default(sink_, GST_OBJECT(bin_), query);
}

}  // namespace inverse
