// SPDX-License-Identifier: LGPL-2.1-or-later
#include "returns.hpp"

#include <gst/base/gstbasetransform.h>

#include <algorithm>
#include <array>
#include <string>

#include "gst/base/pads/pads.hpp"
#include "gst/base/report.hpp"

namespace inverse {
namespace {

using Clock = std::chrono::steady_clock;

/// In the order in which they are applied.
constexpr std::array kLayers{SplitLayer::mask, SplitLayer::reflectance, SplitLayer::shading,
                             SplitLayer::direct, SplitLayer::indirect};
constexpr std::array kNames{"mask", "reflectance", "shading", "direct", "indirect"};

const char* name_of(SplitLayer layer) {
  const auto at = std::ranges::find(kLayers, layer);
  return at == kLayers.end() ? "another layer" : kNames[static_cast<size_t>(at - kLayers.begin())];
}

/// How long frames wait for a branch that did not deliver within kTimeout.
constexpr unsigned kEnoughAbsent = 100;  // frames without any picture
constexpr auto kStalledPatience = std::chrono::milliseconds(100);

struct Latency {
  bool live = false;
  GstClockTime min = 0, max = GST_CLOCK_TIME_NONE;
};

/// Of what is upstream of a sink pad.
Latency latency_of(GstPad* sink) {
  Latency latency;
  GstQuery* query = gst_query_new_latency();
  gboolean live = FALSE;
  GstClockTime min = 0, max = 0;
  if (gst_pad_peer_query(sink, query)) {
    gst_query_parse_latency(query, &live, &min, &max);
    if (live) latency = {true, min, max};
  }
  gst_query_unref(query);
  return latency;
}

GstClockTime duration_of(GstBuffer* in, GstPad* sink) {
  if (GST_BUFFER_DURATION_IS_VALID(in) && GST_BUFFER_DURATION(in) > 0)
    return GST_BUFFER_DURATION(in);
  GstVideoInfo info;
  gst_video_info_init(&info);
  if (GstCaps* caps = gst_pad_get_current_caps(sink)) {
    gst_video_info_from_caps(&info, caps);
    gst_caps_unref(caps);
  }
  return frame_latency(info);
}

ReturnPad::Time running_time(GstElement* element, GstBuffer* in) {
  const GstSegment& segment = GST_BASE_TRANSFORM(element)->segment;
  if (segment.format != GST_FORMAT_TIME || !GST_BUFFER_PTS_IS_VALID(in)) return {};
  guint64 running = 0;
  const int sign =
      gst_segment_to_running_time_full(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(in), &running);
  if (sign == 0) return {};
  return sign * static_cast<GstClockTimeDiff>(running);
}

/// The warning of a branch that was waited for in vain; `element` is how messages name it.
std::string no_picture(SplitLayer layer, const std::string& element) {
  return std::string("no picture came to pad ") + name_of(layer) + " of " + element + " in " +
         std::to_string(Returns::kTimeout / GST_SECOND) +
         " s; frames go on without: if the effect holds frames back, put a queue of as many before "
         "pad sink of " +
         element;
}

std::string only_absent(SplitLayer layer, const std::string& element) {
  return std::string("none of ") + std::to_string(kEnoughAbsent) + " pictures came back to pad " +
         name_of(layer) + " of " + element +
         "; frames go on without: take out what drops or keeps pictures in the branch";
}

Error wrong_layer(SplitLayer layer, const std::string& element, SplitLayer shown) {
  return {ErrorKind::unsupported,
          std::string("pad ") + name_of(layer) + " of " + element + " gets pictures of " +
              name_of(shown) + "; link the pads of intrinsicsplit to those of the same names"};
}

}  // namespace

std::vector<const char*> Returns::pad_names() { return {kNames.begin(), kNames.end()}; }

GstPad* Returns::request(GstElement*, GstPadTemplate* pad_template) {
  const std::string name = GST_PAD_TEMPLATE_NAME_TEMPLATE(pad_template);
  const auto at = std::ranges::find(kNames, name);
  if (at == kNames.end()) return nullptr;
  const SplitLayer layer = kLayers[static_cast<size_t>(at - kNames.begin())];
  {
    const std::lock_guard lock(shared_->mutex);
    for (const PadPtr& pad : pads_)
      if (pad->layer() == layer) return nullptr;
  }
  const PadPtr made = ReturnPad::create(pad_template, layer, shared_);
  gst_pad_set_active(made->pad(), TRUE);
  const std::lock_guard lock(shared_->mutex);
  pads_.push_back(made);
  std::ranges::sort(pads_, {},
                    [](const PadPtr& pad) { return std::ranges::find(kLayers, pad->layer()); });
  return made->pad();
}

void Returns::release(GstPad* pad) {
  const std::lock_guard lock(shared_->mutex);
  std::erase_if(pads_, [&](const PadPtr& own) { return own->pad() == pad; });
  shared_->changed.notify_all();
}

std::vector<Returns::PadPtr> Returns::pads() const {
  std::vector<PadPtr> held;
  const std::lock_guard lock(shared_->mutex);
  for (const PadPtr& pad : pads_) {
    // `release` waits for the mutex before the element lets go of the pad.
    const std::shared_ptr<void> owner(gst_object_ref(pad->pad()), gst_object_unref);
    held.emplace_back(owner, pad.get());
  }
  return held;
}

void Returns::set_flushing(bool flushing) {
  const std::lock_guard lock(shared_->mutex);
  shared_->flushing = flushing;
  // No branch has sent on yet: what comes before `sink` has sent both ends of the flush by then.
  if (flushing)
    for (const PadPtr& pad : pads_) pad->clear();
  shared_->changed.notify_all();
}

void Returns::start() {
  const std::lock_guard lock(shared_->mutex);
  shared_->ended = false;
  shared_->missing = shared_->late = 0;
}

void Returns::set_ended(bool ended) {
  const std::lock_guard lock(shared_->mutex);
  shared_->ended = ended;
  if (ended)
    for (const PadPtr& pad : pads_) pad->clear();
  shared_->changed.notify_all();
}

void Returns::forget_device() {
  readers_.clear();
  edit_.reset();
  device_.reset();
}

void Returns::describe(GstStructure* stats) const {
  const std::lock_guard lock(shared_->mutex);
  if (!pads_.empty())
    gst_structure_set(stats, "returned-missing", G_TYPE_UINT64, shared_->missing, "returned-late",
                      G_TYPE_UINT64, shared_->late, nullptr);
}

void Returns::add_latency(GstQuery* query) {
  gboolean live = FALSE;
  GstClockTime min = 0, max = 0;
  gst_query_parse_latency(query, &live, &min, &max);
  for (const PadPtr& pad : pads()) {
    const Latency branch = latency_of(pad->pad());
    if (!branch.live) continue;
    live = TRUE;
    min = std::max(min, branch.min);
    max = std::min(max, branch.max);  // GST_CLOCK_TIME_NONE, no limit, is the largest
  }
  gst_query_set_latency(query, live, min, max);
}

Returns::Limits Returns::limits(GstElement* element, ReturnPad::Time time,
                                GstClockTime duration) const {
  const Clock::time_point now = Clock::now();
  const Latency main = latency_of(GST_BASE_TRANSFORM_SINK_PAD(element));
  Latency all = main;
  for (const PadPtr& pad : pads()) {
    const Latency branch = latency_of(pad->pad());
    all.live |= branch.live;
    all.min = std::max(all.min, branch.min);
  }
  if (!all.live) return {false, now + std::chrono::nanoseconds(kTimeout)};
  // How much later than this frame its pictures may come, however late the frame is.
  auto wait = static_cast<GstClockTimeDiff>(all.min - main.min + duration);
  if (GstClock* clock = time ? gst_element_get_clock(element) : nullptr) {
    const auto due =
        static_cast<GstClockTimeDiff>(gst_element_get_base_time(element) + all.min) + *time;
    wait = std::max(wait, due - static_cast<GstClockTimeDiff>(gst_clock_get_time(clock)));
    gst_object_unref(clock);
  }
  return {true, now + std::chrono::nanoseconds(std::min<GstClockTimeDiff>(wait, kTimeout))};
}

std::vector<Returns::Arrival> Returns::collect(GstElement* element, GstBuffer* in) {
  using Found = ReturnPad::Found;
  std::vector<Arrival> arrivals;
  for (PadPtr& pad : pads()) arrivals.push_back({std::move(pad)});
  const ReturnPad::Time time = running_time(element, in);
  const GstClockTime duration = duration_of(in, GST_BASE_TRANSFORM_SINK_PAD(element));
  const auto complete = [&](auto counts) {
    bool all = true;
    for (Arrival& arrival : arrivals) {
      if (arrival.found == Found::nothing_yet)
        arrival.found =
            arrival.pad->take(time, static_cast<GstClockTimeDiff>(duration / 2), arrival.picture);
      all &= arrival.found != Found::nothing_yet || !counts(arrival);
    }
    return all;
  };
  std::unique_lock lock(shared_->mutex);
  if (!complete([](const Arrival&) { return true; })) {
    lock.unlock();
    const Limits limit = limits(element, time, duration);
    on_wait_(true);
    lock.lock();
    // A branch that is unresponsive is looked at; one that sends again, but not in time, gets
    // little.
    const auto unresponsive = [](const Arrival& arrival) {
      return arrival.pad->stalled && arrival.pad->unresponsive;
    };
    const auto hurried = [&](const Arrival& arrival) {
      return arrival.pad->stalled && !arrival.pad->unresponsive && !limit.live;
    };
    const auto wait = [&](Deadline deadline, auto counts) {
      shared_->changed.wait_until(lock, deadline,
                                  [&] { return complete(counts) || shared_->flushing; });
    };
    wait(Clock::now() + kStalledPatience, hurried);
    wait(limit.deadline,
         [&](const Arrival& arrival) { return !unresponsive(arrival) && !hurried(arrival); });
    for (Arrival& arrival : arrivals)
      if (arrival.found == Found::nothing_yet && !shared_->flushing) {
        arrival.gave_up = !limit.live && !std::exchange(arrival.pad->warned, true);
        arrival.pad->stalled = arrival.pad->unresponsive = true;
      }
    lock.unlock();
    on_wait_(false);
    lock.lock();
  }
  if (shared_->flushing) throw Flushing{};
  for (Arrival& arrival : arrivals) {
    ReturnPad& pad = *arrival.pad;
    if (arrival.found == Found::picture) {
      pad.stalled = false;
      pad.came = true;
    } else {
      ++shared_->missing;
      arrival.never_came =
          !pad.came && ++pad.absent >= kEnoughAbsent && !std::exchange(pad.warned, true);
    }
  }
  return arrivals;
}

void Returns::apply(GstElement* element, FrameContext& frame, const ReturnParams& params) {
  if (pads().empty()) return;
  Layers& layers = frame.layers;
  if (layers.material())
    throw Error(ErrorKind::unsupported,
                label_of(element) +
                    " takes back pictures of reflectance, shading and light, and these layers are "
                    "those of limematerial; put intrinsicdecomp in its place");
  const std::string label = label_of(element);
  if (!edit_ || device_ != frame.commands.device() || extent_ != layers.extent) {
    device_ = frame.commands.device();
    extent_ = layers.extent;
    edit_.emplace(device_, extent_);
  }
  std::vector<ReturnedPicture> pictures;
  const std::vector<Arrival> arrivals = collect(element, frame.in);
  for (const Arrival& arrival : arrivals) {
    const SplitLayer layer = arrival.pad->layer();
    // A mask from elsewhere selects, where there was none to change.
    if (layer == SplitLayer::mask && !layers[Role::mask])
      layers[Role::mask] = edit_->no_mask(frame.commands);
    if (arrival.gave_up) frame.warnings.push_back(no_picture(layer, label));
    if (arrival.never_came) frame.warnings.push_back(only_absent(layer, label));
    if (arrival.found != ReturnPad::Found::picture || !(params.strength > 0)) continue;
    const SplitLayer shown = arrival.picture.format->sent.layer;
    if (shown != layer) throw wrong_layer(layer, label, shown);
    pictures.push_back(readers_[layer].record(frame.commands, layers, arrival.picture, frame.number,
                                              label.c_str()));
  }
  if (pictures.empty()) return;
  for (const ReturnedPicture& picture : pictures) {
    const bool mask = picture.layer == ReturnedPicture::Layer::mask;
    edit_->record(frame.commands, layers, picture, params.strength,
                  params.use_mask && !mask ? layers[Role::mask] : nullptr);
  }
  frame.commands.stage("returned");
}

}  // namespace inverse
