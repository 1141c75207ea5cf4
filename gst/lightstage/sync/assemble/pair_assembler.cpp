// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pair_assembler.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "frame_picture.hpp"
#include "gst/base/log/log.hpp"
#include "gst/base/meta/view_meta.hpp"
#include "gst/base/pads/caps.hpp"
#include "gst/base/pads/pads.hpp"
#include "kernels/lightstage/gray_gradients.hpp"
#include "motion.hpp"

namespace inverse {
namespace {

using Position = LightProgram::Position;

/// Whether planes of two frames can be joined side by side, byte by byte.
bool joins_by_bytes(const GstVideoInfo& info) {
  const GstVideoFormatInfo* format = info.finfo;
  if (GST_VIDEO_FORMAT_INFO_IS_COMPLEX(format) || GST_VIDEO_FORMAT_INFO_IS_TILED(format))
    return false;
  for (guint c = 0; c < GST_VIDEO_FORMAT_INFO_N_COMPONENTS(format); ++c)
    if (GST_VIDEO_INFO_WIDTH(&info) % (1 << GST_VIDEO_FORMAT_INFO_W_SUB(format, c)) ||
        GST_VIDEO_FORMAT_INFO_PSTRIDE(format, c) <= 0 || GST_VIDEO_FORMAT_INFO_BITS(format) < 8)
      return false;
  // Formats that share bytes between two pixels need an even width.
  return GST_VIDEO_INFO_WIDTH(&info) % 2 == 0 || !GST_VIDEO_FORMAT_INFO_IS_YUV(format);
}

void join_bytes(GstVideoFrame* out, const GstVideoFrame* a, const GstVideoFrame* b) {
  for (guint plane = 0; plane < GST_VIDEO_FRAME_N_PLANES(out); ++plane) {
    gint components[GST_VIDEO_MAX_COMPONENTS];
    gst_video_format_info_component(a->info.finfo, plane, components);
    const gint rows = GST_VIDEO_FRAME_COMP_HEIGHT(a, components[0]);
    const auto bytes = static_cast<size_t>(GST_VIDEO_FRAME_COMP_WIDTH(a, components[0])) *
                       static_cast<size_t>(GST_VIDEO_FRAME_COMP_PSTRIDE(a, components[0]));
    for (gint row = 0; row < rows; ++row) {
      auto* to = static_cast<guint8*>(GST_VIDEO_FRAME_PLANE_DATA(out, plane)) +
                 ptrdiff_t{row} * GST_VIDEO_FRAME_PLANE_STRIDE(out, plane);
      const auto from = [&](const GstVideoFrame* frame) {
        return static_cast<const guint8*>(GST_VIDEO_FRAME_PLANE_DATA(frame, plane)) +
               ptrdiff_t{row} * GST_VIDEO_FRAME_PLANE_STRIDE(frame, plane);
      };
      memcpy(to, from(a), bytes);
      memcpy(to + bytes, from(b), bytes);
    }
  }
}

}  // namespace

struct PairAssembler::Before {
  uint64_t trigger;
  cv::Mat gray;
};

PairAssembler::PairAssembler(GstElement* element, GstPad* src,
                             std::shared_ptr<const StageLabels> labels, const SyncParams& params,
                             DeviceContext& context)
    : FrameAssembler(element, src, std::move(labels)),
      align_(params.align == SyncParams::Align::flow),
      device_(params.device),
      context_(context) {
  gst_video_info_init(&info_);
  gst_video_info_init(&out_info_);
}

PairAssembler::~PairAssembler() { gst_clear_buffer(&a_); }

void PairAssembler::check(const SyncParams& params, const LightProgram& program) {
  if (params.assemble != SyncParams::Assemble::pairs) return;
  for (size_t i = 0; i + 1 < program.steps.size(); ++i)
    if (program.steps[i].kind == StepKind::gradient_a &&
        program.steps[i + 1].kind == StepKind::gradient_b)
      return;
  throw Error(ErrorKind::file,
              "\"" + program.name +
                  "\" has no gradient B right after a gradient A, so there are no pairs to "
                  "assemble; take the program \"performance\", or assemble=none");
}

/// Chooses layers or pictures by downstream's preference; pictures if it accepts anything.
bool PairAssembler::choose_caps(GstCaps* caps) {
  GstCaps* ours = assembled_caps(caps, SyncParams::Assemble::pairs);
  GstCaps* taken = gst_pad_peer_query_caps(src_, nullptr);
  GstCaps* chosen = nullptr;
  for (guint i = 0; i < gst_caps_get_size(taken) && !chosen; ++i) {
    const GstCapsFeatures* features = gst_caps_get_features(taken, i);
    GstCaps* one = gst_caps_copy_nth(taken, i);
    if (gst_caps_features_is_any(features)) gst_caps_set_features(one, 0, nullptr);
    GstCaps* both = gst_caps_intersect_full(ours, one, GST_CAPS_INTERSECT_FIRST);
    gst_caps_unref(one);
    if (gst_caps_is_empty(both))
      gst_caps_unref(both);
    else
      chosen = gst_caps_fixate(gst_caps_truncate(both));
  }
  if (!chosen && gst_caps_is_any(taken)) chosen = gst_caps_fixate(gst_caps_copy_nth(ours, 0));
  gst_caps_unref(taken);
  gst_caps_unref(ours);
  if (!chosen) return false;
  const bool layers = carries_layers(chosen);
  layers_.reset();
  bool good = layers || gst_video_info_from_caps(&out_info_, chosen);
  if (good && layers) {
    context_.acquire(device_);
    layers_ = std::make_unique<GradientLayers>(info_, context_.current());
  }
  if (good) good = gst_pad_push_event(src_, gst_event_new_caps(chosen));
  gst_caps_unref(chosen);
  return good;
}

bool PairAssembler::set_caps(GstCaps* caps) {
  // Frames of two sizes are no pair.
  drop_first();
  before_.reset();
  negotiated_ = false;
  if (!gst_video_info_from_caps(&info_, caps)) return false;
  linear_.emplace(info_);
  negotiated_ = choose_caps(caps);
  if (!negotiated_)
    GST_ELEMENT_ERROR(element_, STREAM, FORMAT,
                      ("what follows lightstagesync takes neither layers of gradients nor pictures "
                       "of double width; insert olatrelight, videoconvert or videoscale"),
                      ("frames are %" GST_PTR_FORMAT, caps));
  // For pictures, downstream can decide.
  if (layers_ && GST_VIDEO_INFO_IS_GRAY(&info_))
    post_warning(log_of(GST_ELEMENT(element_)), GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT, "%s",
                 kGrayGradients);
  return negotiated_;
}

void PairAssembler::drop_first() {
  if (!a_) return;
  gst_clear_buffer(&a_);
  std::lock_guard lock(mutex_);
  ++unpaired_;
}

GstFlowReturn PairAssembler::take(GstBuffer* buffer, const FrameLabel* label) {
  if (!label) {
    gst_buffer_unref(buffer);
    return GST_FLOW_OK;
  }
  const bool step = label->position.part == Position::Part::step;
  const StepKind kind = step ? labels_->program().kind(label->position) : StepKind::black;
  if (step && kind == StepKind::gradient_a) {
    drop_first();
    a_ = buffer;
    a_label_ = *label;
    return GST_FLOW_OK;
  }
  if (step && kind == StepKind::gradient_b) return pair(buffer, *label);
  gst_buffer_unref(buffer);
  drop_first();
  std::lock_guard lock(mutex_);
  ++other_;
  return GST_FLOW_OK;
}

/// B aligned with the subject in A, a new buffer, or null if the motion is not known. The motion is
/// half of that from this B to the one before, which are lit alike, with A halfway between them.
GstBuffer* PairAssembler::aligned(GstBuffer* b, const FrameLabel& label) {
  const cv::Mat codes = read_codes(info_, b);
  auto now =
      std::make_unique<Before>(Before{label.trigger, Motion::gray(linear_light(*linear_, codes))});
  GstBuffer* result = nullptr;
  if (before_ && before_->trigger + 2 == label.trigger) {
    const cv::Mat there = Motion::moved(codes, Motion::half(now->gray, before_->gray));
    result = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info_), nullptr);
    if (!result) throw Error(ErrorKind::out_of_memory, "no memory for a frame; use smaller ones");
    write_codes(info_, result, there);
  }
  before_ = std::move(now);
  if (result) return result;
  std::lock_guard lock(mutex_);
  ++unaligned_;
  return nullptr;
}

GstBuffer* PairAssembler::side_by_side(GstBuffer* a, GstBuffer* b) {
  GstBuffer* pair = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&out_info_), nullptr);
  if (!pair) throw Error(ErrorKind::out_of_memory, "no memory for a pair; use smaller frames");
  try {
    RawFrame left(info_, a, GST_MAP_READ), right(info_, b, GST_MAP_READ);
    RawFrame both(out_info_, pair, GST_MAP_WRITE);
    if (joins_by_bytes(info_)) {
      join_bytes(both.frame(), left.frame(), right.frame());
    } else {
      std::vector<uint64_t> row(both.row_bytes() / 8 + 2);
      auto* bytes = reinterpret_cast<uint8_t*>(row.data());
      for (uint32_t y = 0; y < left.height(); ++y) {
        left.unpack(y, bytes);
        right.unpack(y, bytes + left.row_bytes());
        both.pack(y, bytes);
      }
    }
  } catch (...) {
    gst_buffer_unref(pair);
    throw;
  }
  return pair;
}

GstFlowReturn PairAssembler::pair(GstBuffer* b, const FrameLabel& label) {
  if (!negotiated_) {
    gst_buffer_unref(b);
    return GST_FLOW_NOT_NEGOTIATED;
  }
  struct Held {  // whatever is thrown
    GstBuffer* buffer;
    ~Held() { gst_clear_buffer(&buffer); }
  } second{b};
  if (align_)
    if (GstBuffer* there = aligned(b, label)) {
      gst_buffer_unref(b);
      second.buffer = there;
    }
  if (!a_ || a_label_.trigger + 1 != label.trigger) {
    drop_first();
    std::lock_guard lock(mutex_);
    ++unpaired_;
    return GST_FLOW_OK;
  }
  Held first{a_};
  a_ = nullptr;
  GstBuffer* pair = layers_ ? layers_->make(first.buffer, second.buffer)
                            : side_by_side(first.buffer, second.buffer);
  gst_buffer_copy_into(
      pair, first.buffer,
      static_cast<GstBufferCopyFlags>(GST_BUFFER_COPY_FLAGS | GST_BUFFER_COPY_TIMESTAMPS), 0,
      static_cast<gsize>(-1));
  GST_BUFFER_DURATION(pair) = 2 * labels_->period();
  labels_->attach(pair, a_label_);
  gst_buffer_get_light_stage_meta(pair)->kind = GST_LIGHT_STAGE_GRADIENTS;
  if (!layers_) mark_view(pair, {label_of(element_), kGradientsView, "set assemble=none"});
  {
    std::lock_guard lock(mutex_);
    ++pairs_;
  }
  return gst_pad_push(src_, pair);
}

GstFlowReturn PairAssembler::finish(bool /*program_over*/) {
  drop_first();
  return GST_FLOW_OK;
}

void PairAssembler::return_buffers() {
  if (!a_) return;
  GstBuffer* copy = gst_buffer_copy_deep(a_);
  if (!copy) throw Error(ErrorKind::out_of_memory, "no memory for a frame; use smaller ones");
  gst_buffer_unref(std::exchange(a_, copy));
}

void PairAssembler::forget() {
  gst_clear_buffer(&a_);
  before_.reset();
}

void PairAssembler::add_stats(GstStructure* stats) const {
  std::lock_guard lock(mutex_);
  gst_structure_set(stats, "pairs", G_TYPE_UINT64, pairs_, "unpaired", G_TYPE_UINT64, unpaired_,
                    "unaligned", G_TYPE_UINT64, unaligned_, "other-steps", G_TYPE_UINT64, other_,
                    nullptr);
}

}  // namespace inverse
