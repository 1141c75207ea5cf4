// SPDX-License-Identifier: LGPL-2.1-or-later
#include "split_element.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "gst/base/log/errors.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/meta/layers_meta.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/base/pads/missing_layers.hpp"
#include "gst/base/report.hpp"
#include "start_watch.hpp"

namespace inverse {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

const PropertyTable<SplitParams>& SplitElement::table() {
  using P = SplitParams;
  static const PropertyTable<P> table{
      choice<P>(
          "encoding", &P::encoding, "GstInverseSplitEncoding",
          {{static_cast<int>(P::Encoding::linear), "linear",
            "Linear light: values are proportional to reflectance and shading"},
           {static_cast<int>(P::Encoding::srgb), "srgb",
            "The sRGB curve for displays, or that of the colorimetry that downstream requires"}},
          "Transfer function of the pictures", Mutable::ready),
      number<P>("reflectance-scale", &P::reflectance_scale, 0, 100,
                "Factor on reflectance before it is clipped at 1"),
      number<P>("shading-scale", &P::shading_scale, 0, 100,
                "Factor on shading before it is clipped at 1"),
      number<P>("mirror-scale", &P::mirror_scale, 0, 100,
                "Factor on the mirror image before it is clipped at 1"),
  };
  return table;
}

SplitElement::SplitElement(GstElement* element, GstPad* sink)
    : element_(element), sink_(sink), combiner_(gst_flow_combiner_new()) {}

SplitElement::~SplitElement() {
  gst_flow_combiner_free(combiner_);
  gst_caps_replace(&caps_, nullptr);
  if (stats_) gst_structure_free(stats_);
}

std::vector<SplitElement::BranchPtr> SplitElement::branches() const {
  std::lock_guard lock(mutex_);
  return branches_;
}

bool SplitElement::add(GstPad* pad, SplitLayer layer, uint32_t base) {
  std::lock_guard lock(mutex_);
  auto made = std::make_shared<SplitBranch>(pad, layer, base);
  for (const BranchPtr& branch : branches_)
    if (branch->name() == made->name()) return false;
  branches_.push_back(std::move(made));
  gst_flow_combiner_add_pad(combiner_, pad);
  return true;
}

void SplitElement::remove(GstPad* pad) {
  BranchPtr branch;
  {
    std::lock_guard lock(mutex_);
    const auto at = std::find_if(branches_.begin(), branches_.end(),
                                 [&](const BranchPtr& b) { return b->pad() == pad; });
    if (at == branches_.end()) return;
    branch = *at;
    branch->released = true;
    branches_.erase(at);
    gst_flow_combiner_remove_pad(combiner_, pad);
  }
  gst_pad_set_active(pad, FALSE);
  gst_element_remove_pad(element_, pad);
}

void SplitElement::stop() {
  std::lock_guard lock(mutex_);
  gst_caps_replace(&caps_, nullptr);
  gst_flow_combiner_reset(combiner_);
  for (const BranchPtr& branch : branches_) {
    branch->forget();
    branch->stream_started = branch->refused = branch->fed = false;
    branch->flow = GST_FLOW_OK;
  }
  commands_.reset();
  pictures_ = {};
  frames_ = 0;
}

/// Brings a branch to where the stream is: pads may come late.
bool SplitElement::start(SplitBranch& branch) {
  if (branch.stream_started) return true;
  GstEvent* upstream = gst_pad_get_sticky_event(sink_, GST_EVENT_STREAM_START, 0);
  if (!upstream) return true;
  gchar* id = gst_pad_create_stream_id(branch.pad(), element_, branch.name().c_str());
  GstEvent* event = gst_event_new_stream_start(id);
  g_free(id);
  guint group = 0;
  GstStreamFlags flags = GST_STREAM_FLAG_NONE;
  if (gst_event_parse_group_id(upstream, &group)) gst_event_set_group_id(event, group);
  gst_event_parse_stream_flags(upstream, &flags);
  gst_event_set_stream_flags(event, flags);
  gst_event_unref(upstream);
  gst_pad_push_event(branch.pad(), event);
  branch.stream_started = true;
  branch.flow = GST_FLOW_OK;
  const bool good = !caps_ || !carries_layers(caps_) || negotiate(branch);
  gst_pad_sticky_events_foreach(
      sink_,
      [](GstPad*, GstEvent** event, gpointer to) -> gboolean {
        if (GST_EVENT_TYPE(*event) != GST_EVENT_STREAM_START &&
            GST_EVENT_TYPE(*event) != GST_EVENT_CAPS)
          gst_pad_push_event(static_cast<GstPad*>(to), gst_event_ref(*event));
        return TRUE;
      },
      branch.pad());
  return good;
}

bool SplitElement::negotiate(SplitBranch& branch) {
  // An error is reported once. An upstream that ignores it asks again with every buffer.
  if (branch.refused && !gst_pad_needs_reconfigure(branch.pad())) return false;
  branch.refused = !guarded(element_, [&] { branch.negotiate(caps_, parameters_.snapshot()); });
  return !branch.refused;
}

bool SplitElement::set_caps(GstCaps* caps) {
  const bool known = caps_ && gst_caps_is_equal(caps_, caps);
  {
    std::lock_guard lock(mutex_);
    gst_caps_replace(&caps_, caps);
  }
  if (!carries_layers(caps)) {
    if (known) return false;
    const std::string why = missing_layers(sink_, kAllLayers, "intrinsicdecomp");
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT, ("%s", why.c_str()),
                      ("got %" GST_PTR_FORMAT, caps));
    return false;
  }
  bool good = true;
  for (const BranchPtr& branch : branches()) {
    if (!known) branch->refused = false;
    good &= branch->stream_started ? negotiate(*branch) : start(*branch);
  }
  return good;
}

void SplitElement::send(const std::vector<BranchPtr>& to, GstEvent* event) {
  for (const BranchPtr& branch : to) gst_pad_push_event(branch->pad(), gst_event_ref(event));
  gst_event_unref(event);
}

gboolean SplitElement::sink_event(GstEvent* event) {
  const GstDebugLevel level =
      GST_EVENT_TYPE(event) == GST_EVENT_CAPS ? GST_LEVEL_INFO : GST_LEVEL_DEBUG;
  GST_CAT_LEVEL_LOG(log_of(element_).category, level, element_, "event: %" GST_PTR_FORMAT, event);
  const auto all = branches();
  switch (GST_EVENT_TYPE(event)) {
    case GST_EVENT_STREAM_START:
      // Every pad is a stream of its own; start() says so, with the event that is stored on
      // the sink pad when the next one comes.
      for (const BranchPtr& branch : all) branch->stream_started = false;
      gst_event_unref(event);
      return TRUE;
    case GST_EVENT_CAPS: {
      GstCaps* caps = nullptr;
      gst_event_parse_caps(event, &caps);
      const bool good = set_caps(caps);
      gst_event_unref(event);
      return good;
    }
    case GST_EVENT_FLUSH_START:
      send(all, event);
      return TRUE;
    case GST_EVENT_FLUSH_STOP: {
      send(all, event);
      for (const BranchPtr& branch : all) {
        branch->flow = GST_FLOW_OK;
        branch->fed = false;  // sinks wait for each other once more
      }
      std::lock_guard lock(mutex_);
      gst_flow_combiner_reset(combiner_);
      return TRUE;
    }
    default:
      break;
  }
  const bool in_order = gst_event_type_get_flags(GST_EVENT_TYPE(event)) & GST_EVENT_TYPE_SERIALIZED;
  bool good = true;
  if (in_order)
    for (const BranchPtr& branch : all) good &= start(*branch);
  send(all, event);
  return good;
}

gboolean SplitElement::src_event(GstPad* pad, GstEvent* event) {
  return gst_pad_event_default(pad, GST_OBJECT(element_), event);
}

GstCaps* SplitElement::sink_caps(GstCaps* filter) {
  GstCaps* result = template_caps(Flow::layers_or_pixels, kAllLayers);
  for (const BranchPtr& branch : branches()) {
    GstCaps* sends = SplitBranch::caps_for(branch->layer(), result);
    GstCaps* taken = gst_pad_peer_query_caps(branch->pad(), sends);
    GstCaps* back =
        transform_caps(taken, template_caps(Flow::layers_or_pixels, kAllLayers), nullptr);
    GstCaps* both = gst_caps_intersect_full(result, back, GST_CAPS_INTERSECT_FIRST);
    // Negotiation reports a pad without a suitable format by name.
    if (gst_caps_is_empty(both)) std::swap(both, result);
    for (GstCaps* caps : {sends, taken, back, result}) gst_caps_unref(caps);
    result = both;
  }
  if (filter) {
    GstCaps* filtered = gst_caps_intersect_full(filter, result, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(result);
    result = filtered;
  }
  GstCaps* ordered = prefer_layers(result);
  gst_caps_unref(result);
  return ordered;
}

GstCaps* SplitElement::src_caps(SplitLayer layer, GstCaps* filter) {
  GstCaps* layers = nullptr;
  {
    std::lock_guard lock(mutex_);
    if (caps_) layers = gst_caps_ref(caps_);
  }
  if (!layers) {
    // Pixels, too: pads must link, so that set_caps can say what is missing.
    GstCaps* ours = template_caps(Flow::layers_or_pixels, kAllLayers);
    layers = gst_pad_peer_query_caps(sink_, ours);
    gst_caps_unref(ours);
  }
  GstCaps* result = SplitBranch::caps_for(layer, layers);
  gst_caps_unref(layers);
  return filter_caps(result, filter);
}

gboolean SplitElement::sink_query(GstQuery* query) {
  if (GST_QUERY_TYPE(query) != GST_QUERY_CAPS)
    return gst_pad_query_default(sink_, GST_OBJECT(element_), query);
  GstCaps* filter = nullptr;
  gst_query_parse_caps(query, &filter);
  GstCaps* caps = sink_caps(filter);
  gst_query_set_caps_result(query, caps);
  gst_caps_unref(caps);
  return TRUE;
}

gboolean SplitElement::src_query(GstPad* pad, GstQuery* query) {
  if (GST_QUERY_TYPE(query) == GST_QUERY_CAPS) {
    for (const BranchPtr& branch : branches()) {
      if (branch->pad() != pad) continue;
      GstCaps* filter = nullptr;
      gst_query_parse_caps(query, &filter);
      GstCaps* caps = src_caps(branch->layer(), filter);
      gst_query_set_caps_result(query, caps);
      gst_caps_unref(caps);
      return TRUE;
    }
    return FALSE;
  }
  if (!gst_pad_query_default(pad, GST_OBJECT(element_), query)) return FALSE;
  if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY) {
    // A frame stays here for as long as it takes to draw it: one frame duration at most.
    GstVideoInfo info;
    std::lock_guard lock(mutex_);
    if (caps_ && gst_video_info_from_caps(&info, caps_)) add_latency(query, frame_latency(info));
  }
  return TRUE;
}

void SplitElement::draw(GstBuffer* buffer, const std::vector<BranchPtr>& all,
                        std::vector<GstBuffer*>& frames) {
  const Layers* found = layers_of(buffer);
  if (!found || !(*found)[Role::input])
    throw Error(ErrorKind::unsupported,
                "a buffer without layers reached intrinsicsplit; an element before it dropped the "
                "layers meta, or is of another build of gst-inverse");
  const Layers& layers = *found;
  const auto& device = layers[Role::input]->buffer->device();
  if (!commands_ || commands_->device() != device) {
    commands_ = std::make_unique<gpu::Commands>(device);
    pictures_ = {};
  }
  const SplitParams params = parameters_.snapshot();
  commands_->begin();
  std::vector<bool> drawn(all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    SplitBranch& branch = *all[i];
    if (branch.flow == GST_FLOW_EOS) continue;  // its downstream is finished
    branch.flow = gst_pad_is_linked(branch.pad()) ? GST_FLOW_OK : GST_FLOW_NOT_LINKED;
    if (branch.flow != GST_FLOW_OK) continue;
    branch.record(*commands_, layers, pictures_, params);
    drawn[i] = true;
  }
  commands_->stage("pack");
  commands_->submit();
  commands_->wait();
  for (size_t i = 0; i < all.size(); ++i) {
    if (!drawn[i]) continue;
    all[i]->announce(params, layers.edited());
    all[i]->flow = all[i]->take(buffer, &frames[i]);
  }
}

GstFlowReturn SplitElement::chain(GstBuffer* buffer) {
  const auto start_time = Clock::now();
  GST_CAT_LOG_OBJECT(log_of(element_).category, element_, "%" GST_PTR_FORMAT, buffer);
  const auto all = branches();
  std::vector<GstBuffer*> frames(all.size());
  // Only this thread changes caps_ while data flows.
  bool negotiated = caps_ && carries_layers(caps_);
  for (size_t i = 0; i < all.size() && negotiated; ++i) {
    SplitBranch& branch = *all[i];
    negotiated =
        start(branch) &&
        ((branch.negotiated() && !gst_pad_needs_reconfigure(branch.pad())) || negotiate(branch));
  }
  if (negotiated && is_gap(buffer)) {
    for (GstBuffer*& frame : frames) frame = gst_buffer_ref(buffer);
    gst_buffer_unref(buffer);
    return push(all, frames);
  }
  const bool good = negotiated && guarded(element_, [&] { draw(buffer, all, frames); });
  gst_buffer_unref(buffer);
  if (!good) {
    for (GstBuffer* frame : frames)
      if (frame) gst_buffer_unref(frame);
    return negotiated ? GST_FLOW_ERROR : GST_FLOW_NOT_NEGOTIATED;
  }
  ++frames_;
  publish(std::chrono::duration<double, std::milli>(Clock::now() - start_time).count());
  return push(all, frames);
}

namespace {

/// The names of the branches behind the `i`th that get their first frame in this round.
std::string waiting_after(size_t i, const std::vector<std::shared_ptr<SplitBranch>>& all,
                          const std::vector<GstBuffer*>& frames) {
  std::string names;
  for (size_t other = i + 1; other < all.size(); ++other)
    if (frames[other] && !all[other]->fed)
      names += (names.empty() ? "" : " and ") + all[other]->name();
  return names;
}

}  // namespace

GstFlowReturn SplitElement::push(const std::vector<BranchPtr>& all,
                                 const std::vector<GstBuffer*>& frames) {
  GstFlowReturn result = GST_FLOW_NOT_LINKED;  // without any pad, as in tee
  for (size_t i = 0; i < all.size(); ++i) {
    SplitBranch& branch = *all[i];
    if (frames[i]) {
      std::optional<StartWatch> watch;
      const std::string waiting = waiting_after(i, all, frames);
      if (!waiting.empty()) watch.emplace(element_, branch.pad(), waiting);
      branch.flow = gst_pad_push(branch.pad(), frames[i]);
      branch.fed = true;
    }
    std::lock_guard lock(mutex_);
    // The flow of a pad that was released meanwhile does not count for the others.
    result = branch.released
                 ? GST_FLOW_OK
                 : gst_flow_combiner_update_pad_flow(combiner_, branch.pad(), branch.flow);
    if (result == GST_FLOW_OK || result == GST_FLOW_EOS || result == GST_FLOW_NOT_LINKED) continue;
    for (size_t rest = i + 1; rest < frames.size(); ++rest)
      if (frames[rest]) gst_buffer_unref(frames[rest]);
    return result;
  }
  return result;
}

void SplitElement::publish(double wall_ms) {
  GstStructure* stats = frame_stats(*commands_, frames_, wall_ms);
  std::lock_guard lock(mutex_);
  std::swap(stats, stats_);
  if (stats) gst_structure_free(stats);
}

GstStructure* SplitElement::stats() const {
  std::lock_guard lock(mutex_);
  return stats_ ? gst_structure_copy(stats_) : gst_structure_new_empty("inverse-stats");
}

}  // namespace inverse
