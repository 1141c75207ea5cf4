// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdsrc: plays a recording of a camera with depth.
#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>

#include <cmath>
#include <cstring>
#include <deque>
#include <future>
#include <mutex>

#include "common/background.hpp"
#include "gst/base/element_class.hpp"
#include "gst/base/log/errors.hpp"
#include "gst/depth/meta/depth_meta.hpp"
#include "recording.hpp"

namespace inverse {
namespace {

struct RgbdSrcParams : RecordingSettings {
  bool live = false, loop = false, attach_poses = true;
};

const PropertyTable<RgbdSrcParams>& rgbd_src_properties() {
  using P = RgbdSrcParams;
  constexpr Mutable kReady = Mutable::ready;
  static const PropertyTable<P> table{
      text<P>("location", &P::location,
              "Folder of a recording: of TUM RGB-D, of 7-Scenes, or with a folder for color and "
              "one for depth",
              kReady),
      flag<P>("is-live", &P::live,
              "Produce frames in time, as a camera does; false = as fast as possible", kReady),
      flag<P>("loop", &P::loop, "Begin again at the end"),
      number<P>("framerate", &P::rate, 0., 1000.,
                "Pictures a second; 0 = by the recording's time stamps, 30 if it has none", kReady),
      flag<P>("attach-poses", &P::attach_poses, "Attach the camera's recorded poses"),
      text<P>(
          "poses", &P::poses,
          "File of poses in place of the recorded ones, as TUM RGB-D has: lines \"time tx ty tz "
          "qx qy qz qw\", in the recording's time, or seconds from the first picture if it has "
          "none",
          kReady),
      text<P>("calibration", &P::calibration,
              "JSON file with both cameras and how they stand to each other (OpenCV's "
              "conventions), as rgbdmerge takes; empty = depth shows what the picture shows",
              kReady),
      number<P>("depth-unit", &P::unit, 0., 1.,
                "Meters of a step of depth; 0 = as calibration or recording say", kReady),
      number<P>("fx", &P::fx, 0., 1e5,
                "Focal length in pixels of the picture; 0 = the recording's, else a view of 62 "
                "degrees across",
                kReady),
      number<P>("fy", &P::fy, 0., 1e5, "The same along y; 0 = as fx", kReady),
      number<P>("cx", &P::cx, 0., 1e5, "Center in pixels of the picture; 0 = the recording's",
                kReady),
      number<P>("cy", &P::cy, 0., 1e5, "The same along y; 0 = the recording's", kReady),
      number<P>("max-difference", &P::max_difference, 0., 1e4,
                "Time between a picture and its depth image or pose, at most, ms", kReady),
      text<P>("color-folder", &P::color_folder,
              "Folder of the pictures in location; empty = found by its name", kReady),
      text<P>("depth-folder", &P::depth_folder,
              "Folder of the depth images in location; empty = found by its name", kReady),
  };
  return table;
}

GstClockTime nanoseconds(double seconds) {
  return static_cast<GstClockTime>(std::llround(seconds * GST_SECOND));
}

/// The recording that is played, and the place in it. Frames are counted through all rounds of a
/// loop.
class RecordingPlayer {
 public:
  Parameters<RgbdSrcParams>& parameters() { return parameters_; }
  RgbdSrcParams params() const { return parameters_.snapshot(); }
  /// Null while none is open.
  std::shared_ptr<const Recording> recording() const {
    std::lock_guard lock(mutex_);
    return recording_;
  }
  GstStructure* stats() const {
    std::lock_guard lock(mutex_);
    return gst_structure_new("inverse-stats", "frames", G_TYPE_UINT64, frames_, "posed",
                             G_TYPE_UINT64, posed_, "skipped", G_TYPE_UINT64, skipped_, "unpaired",
                             G_TYPE_UINT64, recording_ ? guint64{recording_->unpaired()} : 0,
                             nullptr);
  }
  /// Throws Error.
  void open() {
    auto opened = std::make_shared<const Recording>(params());
    next_ = 0;
    std::lock_guard lock(mutex_);
    recording_ = std::move(opened);
    frames_ = posed_ = skipped_ = 0;
  }
  void close() {
    ahead_.clear();
    std::lock_guard lock(mutex_);
    recording_.reset();
  }

  // Of the streaming thread.
  uint64_t frame() const { return next_; }
  bool ended() const { return next_ > 0 && at(next_) == 0 && !params().loop; }
  GstClockTime time(uint64_t frame) const {
    return frame / recording_->frames() * length() + nanoseconds(recording_->seconds(at(frame)));
  }
  GstClockTime length() const { return nanoseconds(recording_->seconds(recording_->frames())); }
  /// Goes to the frame that is seen at a time.
  void seek(GstClockTime to) {
    const uint64_t frames = recording_->frames();
    next_ = frames;
    if (to >= length() && !params().loop) return;
    next_ = to / length() * frames;
    while (at(next_ + 1) != 0 && time(next_ + 1) <= to) ++next_;
  }
  /// Reads the frame, and has those behind it decoded meanwhile. Throws Error.
  Recording::Frame read();
  /// Goes on to the next one. True if this is the first that could not be read.
  bool went_by(bool skipped, bool posed) {
    ++next_;
    std::lock_guard lock(mutex_);
    if (skipped) return ++skipped_ == 1;
    ++frames_;
    if (posed) ++posed_;
    return false;
  }
  size_t at(uint64_t frame) const { return frame % recording_->frames(); }

 private:
  struct Decoding {
    uint64_t frame;
    std::future<Recording::Frame> result;
  };
  Parameters<RgbdSrcParams> parameters_{rgbd_src_properties()};
  mutable std::mutex mutex_;  // recording_, where another thread reads it; counts
  std::shared_ptr<const Recording> recording_;
  guint64 frames_ = 0, posed_ = 0, skipped_ = 0;
  uint64_t next_ = 0;
  std::deque<Decoding> ahead_;
};

Recording::Frame RecordingPlayer::read() {
  constexpr uint64_t kAhead = 2;
  while (!ahead_.empty() && ahead_.front().frame != next_) ahead_.pop_front();
  const bool loop = params().loop;
  for (uint64_t n = next_ + ahead_.size(); n <= next_ + kAhead; ++n) {
    if (n > next_ && at(n) == 0 && !loop) break;
    ahead_.push_back(
        {n, in_background([from = recording_, frame = at(n)] { return from->read(frame); })});
  }
  auto result = std::move(ahead_.front().result);
  ahead_.pop_front();
  return result.get();
}

}  // namespace
}  // namespace inverse

using inverse::RecordingPlayer;

struct GstRgbdSrc {
  GstPushSrc parent;
  RecordingPlayer* body;
  GstVideoInfo info;  // of the streaming thread
};

namespace {

using Class = inverse::ElementClass<GstRgbdSrc>;

RecordingPlayer& player_of(gpointer object) { return Class::body_of(object); }
GstBaseSrcClass* parent_class() { return GST_BASE_SRC_CLASS(Class::parent_class); }

gboolean start(GstBaseSrc* base) {
  const inverse::Log log = inverse::log_of(GST_ELEMENT(base));
  RecordingPlayer& player = player_of(base);
  if (!inverse::check_parameters(log, player.parameters()) ||
      !inverse::guarded(GST_ELEMENT(base), [&] { player.open(); }))
    return FALSE;
  const auto recording = player.recording();
  GST_CAT_INFO_OBJECT(log.category, base,
                      "%" G_GSIZE_FORMAT " frames in %.3f s; %" G_GSIZE_FORMAT
                      " pictures and depth images without a partner",
                      recording->frames(), recording->seconds(recording->frames()),
                      recording->unpaired());
  for (const std::string& warning : recording->warnings())
    inverse::post_warning(log, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ, "%s", warning.c_str());
  return TRUE;
}

gboolean stop(GstBaseSrc* base) {
  player_of(base).close();
  return TRUE;
}

GstCaps* get_caps(GstBaseSrc* base, GstCaps* filter) {
  const auto recording = player_of(base).recording();
  if (!recording) return parent_class()->get_caps(base, filter);
  GstVideoInfo info;
  gst_video_info_set_format(&info, GST_VIDEO_FORMAT_RGB, recording->extent().width,
                            recording->extent().height);
  gst_video_guess_framerate(inverse::nanoseconds(recording->period()), &info.fps_n, &info.fps_d);
  GstCaps* caps = gst_video_info_to_caps(&info);
  if (!filter) return caps;
  GstCaps* both = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return both;
}

gboolean set_caps(GstBaseSrc* base, GstCaps* caps) {
  GstVideoInfo& info = static_cast<GstRgbdSrc*>(static_cast<gpointer>(base))->info;
  GST_CAT_INFO_OBJECT(inverse::log_of(GST_ELEMENT(base)).category, base, "caps: %" GST_PTR_FORMAT,
                      caps);
  if (!gst_video_info_from_caps(&info, caps)) return FALSE;
  gst_base_src_set_blocksize(base, static_cast<guint>(GST_VIDEO_INFO_SIZE(&info)));
  return TRUE;
}

gboolean is_seekable(GstBaseSrc* base) { return !gst_base_src_is_live(base); }

gboolean do_seek(GstBaseSrc* base, GstSegment* segment) {
  RecordingPlayer& player = player_of(base);
  if (segment->rate <= 0) return FALSE;
  segment->time = segment->start;
  segment->duration = player.params().loop ? GST_CLOCK_TIME_NONE : player.length();
  player.seek(segment->position);
  return TRUE;
}

/// A live frame is due at its time stamp.
void get_times(GstBaseSrc* base, GstBuffer* buffer, GstClockTime* start, GstClockTime* end) {
  *start = *end = GST_CLOCK_TIME_NONE;
  if (!gst_base_src_is_live(base) || !GST_BUFFER_PTS_IS_VALID(buffer)) return;
  *start = GST_BUFFER_PTS(buffer);
  *end = *start + GST_BUFFER_DURATION(buffer);
}

gboolean query(GstBaseSrc* base, GstQuery* query) {
  const auto recording = player_of(base).recording();
  if (recording && GST_QUERY_TYPE(query) == GST_QUERY_DURATION) {
    GstFormat format = GST_FORMAT_UNDEFINED;
    gst_query_parse_duration(query, &format, nullptr);
    if (format != GST_FORMAT_TIME || player_of(base).params().loop) return FALSE;
    gst_query_set_duration(
        query, format,
        static_cast<gint64>(inverse::nanoseconds(recording->seconds(recording->frames()))));
    return TRUE;
  }
  if (recording && GST_QUERY_TYPE(query) == GST_QUERY_LATENCY) {
    const bool live = gst_base_src_is_live(base);
    gst_query_set_latency(query, live, live ? inverse::nanoseconds(recording->period()) : 0,
                          GST_CLOCK_TIME_NONE);
    return TRUE;
  }
  return parent_class()->query(base, query);
}

void write_color(const inverse::Picture8& picture, const GstVideoInfo& info, GstBuffer* buffer) {
  GstVideoFrame frame;
  if (!gst_video_frame_map(&frame, &info, buffer, GST_MAP_WRITE))
    throw inverse::Error(inverse::ErrorKind::internal, "a buffer for a picture cannot be written");
  for (uint32_t y = 0; y < picture.extent.height; ++y) {
    const uint8_t* from = &picture.rgba[size_t{4} * y * picture.extent.width];
    auto* to = static_cast<uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)) +
               size_t{y} * static_cast<size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0));
    for (uint32_t x = 0; x < picture.extent.width; ++x, from += 4, to += 3) memcpy(to, from, 3);
  }
  gst_video_frame_unmap(&frame);
}

void attach_depth(const inverse::Recording& recording, size_t n, const std::vector<uint16_t>& depth,
                  bool with_pose, GstBuffer* buffer) {
  const gsize bytes = depth.size() * sizeof(uint16_t);
  GstBuffer* image = gst_buffer_new_allocate(nullptr, bytes, nullptr);
  if (!image)
    throw inverse::Error(inverse::ErrorKind::out_of_memory, "no memory for a depth image");
  gst_buffer_fill(image, 0, depth.data(), bytes);
  GstInverseDepthMeta* meta =
      inverse::add_depth_meta(buffer, image, recording.unit(), recording.lens(n));
  const auto& pose = recording.pose(n);
  if (!with_pose || !pose) return;
  meta->posed = TRUE;
  std::ranges::copy(*pose, meta->pose);
}

/// The next frame that can be read. What cannot be is left out, and said once.
GstFlowReturn read_next(GstBaseSrc* base, inverse::Recording::Frame& frame) {
  RecordingPlayer& player = player_of(base);
  const size_t frames = player.recording()->frames();
  for (size_t failures = 0; failures < frames; ++failures) {
    if (GST_PAD_IS_FLUSHING(base->srcpad)) return GST_FLOW_FLUSHING;
    if (player.ended()) return GST_FLOW_EOS;
    try {
      frame = player.read();
      return GST_FLOW_OK;
    } catch (const inverse::Error& error) {
      const inverse::Log log = inverse::log_of(GST_ELEMENT(base));
      GST_CAT_INFO_OBJECT(log.category, base, "skipped: %s", error.what());
      if (player.went_by(true, false))
        inverse::post_warning(
            log, inverse::Error(error.kind(), std::string(error.what()) +
                                                  "; this frame is skipped, as others will be that "
                                                  "cannot be read (\"skipped\" in stats)"));
    }
  }
  if (player.ended()) return GST_FLOW_EOS;
  throw inverse::Error(inverse::ErrorKind::file,
                       "none of the recording's frames can be read any more; was it removed?");
}

GstFlowReturn create(GstPushSrc* push, GstBuffer** buffer) {
  auto* base = GST_BASE_SRC(push);
  RecordingPlayer& player = player_of(push);
  inverse::Recording::Frame frame;
  GstFlowReturn flow = GST_FLOW_ERROR;
  if (!inverse::guarded(GST_ELEMENT(push), [&] { flow = read_next(base, frame); }) ||
      flow != GST_FLOW_OK)
    return flow;
  GstBuffer* made = nullptr;
  flow = parent_class()->alloc(base, 0, gst_base_src_get_blocksize(base), &made);
  if (flow != GST_FLOW_OK) return flow;
  const uint64_t n = player.frame();
  const bool with_pose = player.params().attach_poses;
  const auto recording = player.recording();
  if (!inverse::guarded(GST_ELEMENT(push), [&] {
        write_color(frame.color, static_cast<GstRgbdSrc*>(static_cast<gpointer>(push))->info, made);
        attach_depth(*recording, player.at(n), frame.depth, with_pose, made);
      })) {
    gst_buffer_unref(made);
    return GST_FLOW_ERROR;
  }
  GST_BUFFER_PTS(made) = player.time(n);
  GST_BUFFER_DTS(made) = GST_CLOCK_TIME_NONE;
  GST_BUFFER_DURATION(made) = player.time(n + 1) - player.time(n);
  GST_BUFFER_OFFSET(made) = n;
  GST_BUFFER_OFFSET_END(made) = n + 1;
  GST_CAT_LOG_OBJECT(inverse::log_of(GST_ELEMENT(push)).category, push,
                     "frame %" G_GUINT64_FORMAT ": %" GST_PTR_FORMAT, n, made);
  player.went_by(false, with_pose && recording->pose(player.at(n)));
  *buffer = made;
  return GST_FLOW_OK;
}

GstStateChangeReturn change_state(GstElement* element, GstStateChange transition) {
  if (transition == GST_STATE_CHANGE_READY_TO_PAUSED)
    gst_base_src_set_live(GST_BASE_SRC(element), player_of(element).params().live);
  return GST_ELEMENT_CLASS(Class::parent_class)->change_state(element, transition);
}

void class_init(GstElementClass* element) {
  element->change_state = change_state;
  inverse::add_pad_template(
      element, "src", GST_PAD_SRC, GST_PAD_ALWAYS,
      gst_caps_from_string("video/x-raw, format = (string) RGB, width = (int) [ 1, 32767 ], height "
                           "= (int) [ 1, 32767 ], framerate = (fraction) [ 0, max ]"));
  auto* base = GST_BASE_SRC_CLASS(element);
  base->start = start;
  base->stop = stop;
  base->get_caps = get_caps;
  base->set_caps = set_caps;
  base->is_seekable = is_seekable;
  base->do_seek = do_seek;
  base->get_times = get_times;
  base->query = query;
  GST_PUSH_SRC_CLASS(element)->create = create;
  Class::install_properties(element, "Frames so far: played, with a pose, and left out",
                            inverse::rgbd_src_properties());
}

void instance_init(GstRgbdSrc* self) {
  self->body = new RecordingPlayer;
  gst_video_info_init(&self->info);
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
}

constexpr Class kClass{"rgbdsrc",
                       "GstRgbdSrc",
                       "RGB-D source",
                       "Source/Video",
                       "Plays a recording of a camera with depth: pictures with their depth images "
                       "and poses",
                       gst_push_src_get_type,
                       class_init,
                       instance_init};

}  // namespace

namespace inverse {

gboolean register_rgbdsrc(GstPlugin* plugin);
gboolean register_rgbdsrc(GstPlugin* plugin) { return kClass.register_element(plugin); }

}  // namespace inverse
