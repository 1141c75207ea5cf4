// SPDX-License-Identifier: LGPL-2.1-or-later
#include "olat_assembler.hpp"

#include <ImfHeader.h>
#include <ImfRgbaFile.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "common/error.hpp"
#include "common/new_file.hpp"
#include "common/replace_file.hpp"
#include "frame_picture.hpp"
#include "gst/base/log/log.hpp"
#include "gst/exr/exr_stream.hpp"
#include "kernels/lightstage/program/light_list.hpp"
#include "motion.hpp"
#include "olat_motion.hpp"

namespace inverse {
namespace {

using Json = nlohmann::ordered_json;
using Position = LightProgram::Position;

/// Linear light as half floats.
void write_exr(const std::string& path, const cv::Mat& light) try {
  std::vector<Imf::Rgba> row(static_cast<size_t>(light.cols));
  NewFile made(path);
  ExrWriter stream(made);
  {
    const Imf::Header header(light.cols, light.rows, 1, {0, 0}, 1, Imf::INCREASING_Y,
                             Imf::PIZ_COMPRESSION);
    Imf::RgbaOutputFile file(stream, header, Imf::WRITE_RGB);
    for (int y = 0; y < light.rows; ++y) {
      const auto* from = light.ptr<cv::Vec3f>(y);
      for (int x = 0; x < light.cols; ++x)
        row[static_cast<size_t>(x)] = Imf::Rgba(from[x][0], from[x][1], from[x][2]);
      file.setFrameBuffer(row.data() - static_cast<ptrdiff_t>(y) * light.cols, 1,
                          static_cast<size_t>(light.cols));
      file.writePixels(1);
    }
  }
  made.close();
} catch (const Error&) {
  throw;
} catch (const std::exception& error) {
  throw Error(ErrorKind::output, "cannot write " + path + ": " + error.what());
}

constexpr double kMaxClipped = 0.1;
constexpr double kWhole = 0.9;  // of the pictures: frames are lost now and then

/// Share of the lit pixels that are at the end of the scale in all channels.
double clipped_share(const cv::Mat& light) {
  double lit = 0, clipped = 0;
  for (int y = 0; y < light.rows; y += 2)
    for (int x = 0; x < light.cols; x += 2) {
      const auto& rgb = light.at<cv::Vec3f>(y, x);
      lit += std::max({rgb[0], rgb[1], rgb[2]}) > 0.05F ? 1 : 0;
      clipped += std::min({rgb[0], rgb[1], rgb[2]}) > 0.97F ? 1 : 0;
    }
  return lit > 0 ? clipped / lit : 0;
}

std::string file_name(const LightStep& step) {
  if (step.kind != StepKind::olat) return std::string(name_of(step.kind)) + ".exr";
  char name[32];
  std::snprintf(name, sizeof name, "olat/%03u.exr", step.light);
  return name;
}

/// Whether a capture writes files of this name, below its folder.
bool is_of_capture(const std::filesystem::path& name) {
  if (name == "lights.json") return true;
  if (name.extension() != ".exr") return false;
  const std::string stem = name.stem().string();
  if (name.parent_path() == "olat")
    return stem.find_first_not_of("0123456789") == std::string::npos;
  return name.parent_path().empty() &&
         (stem == "tracking" || stem == "gradient-a" || stem == "gradient-b");
}

/// Puts what is in the folder of an earlier capture and is none of its files into the new one as
/// well: they are in one of the two at any time.
void link_others(const std::filesystem::path& before, const std::filesystem::path& now) {
  namespace fs = std::filesystem;
  constexpr auto kAll = fs::copy_options::recursive | fs::copy_options::copy_symlinks;
  for (const fs::path& folder : {fs::path(), fs::path("olat")}) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(before / folder, none)) {
      const fs::path name = folder / entry.path().filename();
      if (name == "olat" || is_of_capture(name) || fs::exists(now / name)) continue;
      std::error_code failed;
      fs::copy(entry.path(), now / name, kAll | fs::copy_options::create_hard_links, failed);
      if (!failed) continue;  // else not a file system that has them
      fs::remove_all(now / name);
      fs::copy(entry.path(), now / name, kAll);
    }
  }
}

/// How many pictures a whole capture has.
size_t pictures_of(const LightProgram& program) {
  std::set<std::string> names;
  for (const LightStep& step : program.steps) names.insert(file_name(step));
  return names.size();
}

}  // namespace

OlatAssembler::OlatAssembler(GstElement* element, GstPad* src,
                             std::shared_ptr<const StageLabels> labels, const SyncParams& params,
                             uint32_t camera)
    : FrameAssembler(element, src, std::move(labels)), location_(params.location), camera_(camera) {
  gst_video_info_init(&info_);
}

void OlatAssembler::check(const SyncParams& params, const LightProgram& program) {
  if (params.assemble != SyncParams::Assemble::olat) return;
  const auto has = [&](StepKind kind) {
    return std::any_of(program.steps.begin(), program.steps.end(),
                       [&](const LightStep& step) { return step.kind == kind; });
  };
  if (!has(StepKind::olat) || !has(StepKind::tracking))
    throw Error(ErrorKind::file, "\"" + program.name +
                                     "\" has no single lights with tracking frames among them to "
                                     "assemble; take the program \"static\", or assemble=none");
  if (params.location.empty()) return;
  std::error_code failed;
  std::filesystem::create_directories(params.location, failed);
  if (failed || !std::filesystem::is_directory(params.location))
    throw Error(ErrorKind::output,
                "the folder " + params.location + " cannot be made: " +
                    (failed ? failed.message() : "there is a file of this name"));
}

uint64_t OlatAssembler::longest_pass(const LightProgram& program) {
  const bool marked = program.marker != LightProgram::Marker::none;
  return program.steps.size() + (marked ? LightProgram::kMarkerSteps : 0);
}

bool OlatAssembler::set_caps(GstCaps* caps) {
  // Frames of the old size or format are assembled first, as far as they came.
  if (finish(false) < GST_FLOW_EOS) return false;
  if (!gst_video_info_from_caps(&info_, caps)) return false;
  linear_.emplace(info_);
  return FrameAssembler::set_caps(caps);
}

GstFlowReturn OlatAssembler::take(GstBuffer* buffer, const FrameLabel* label) {
  if (!label) {
    gst_buffer_unref(buffer);
    return GST_FLOW_OK;
  }
  GstFlowReturn flow = GST_FLOW_OK;
  const bool new_pass =
      !held_.empty() && (held_.back().label.trigger > label->trigger ||
                         held_.back().label.position.pass != label->position.pass);
  if (new_pass) flow = assemble(true);
  if (flow != GST_FLOW_OK) {
    gst_buffer_unref(buffer);
    return flow;
  }
  // A camera has few buffers, and a capture many frames.
  held_.push_back({HeldBuffer(gst_buffer_copy_deep(buffer)), *label});
  gst_buffer_unref(buffer);
  const bool step = label->position.part == Position::Part::step;
  return step && label->position.index + 1 == labels_->program().steps.size() ? assemble(true)
                                                                              : GST_FLOW_OK;
}

GstFlowReturn OlatAssembler::finish(bool program_over) {
  return held_.empty() ? GST_FLOW_OK : assemble(program_over);
}

void OlatAssembler::forget() { held_.clear(); }

GstFlowReturn OlatAssembler::assemble(bool ended) {
  // After an error, too, they are not assembled again, and no draft stays.
  std::vector<Held> all = std::exchange(held_, {});
  const auto remove_draft = [this](const void*) {
    std::error_code none;
    if (!location_.empty()) std::filesystem::remove_all(draft(), none);
  };
  const std::unique_ptr<const void, decltype(remove_draft)> draft_guard(this, remove_draft);
  remove_draft(this);
  files_.clear();
  olat_files_.clear();
  std::map<uint64_t, cv::Mat> tracking;
  double clipped = 0;
  for (const Held& held : all) {
    if (labels_->program().kind(held.label.position) != StepKind::tracking) continue;
    const cv::Mat light = linear_light(*linear_, read_codes(info_, held.buffer.get()));
    clipped = std::max(clipped, clipped_share(light));
    tracking[held.label.trigger] = Motion::gray(light);
  }
  if (clipped > kMaxClipped)
    post_warning(
        log_of(element_), GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
        "%d %% of what is lit in a tracking frame is at the maximum of the camera: motion is "
        "not seen there; let the camera or the lights' controller expose the steps \"tracking\" "
        "for a shorter time than single lights, and say so in the program (\"exposure\" of these "
        "steps: it changes nothing by itself)",
        static_cast<int>(std::lround(100 * clipped)));
  std::unique_ptr<OlatMotion> motion;
  if (!tracking.empty()) motion = std::make_unique<OlatMotion>(tracking);
  const uint64_t last = tracking.empty() ? 0 : tracking.rbegin()->first;
  GstFlowReturn flow = GST_FLOW_OK;
  for (const Held& held : all) {
    if (flow != GST_FLOW_OK) break;
    const bool moves = motion && held.label.trigger < last;
    flow = send(held, moves ? motion->at(held.label.trigger) : cv::Mat());
  }
  if (!files_.empty() || !olat_files_.empty()) publish(ended && flow == GST_FLOW_OK);
  std::lock_guard lock(mutex_);
  ++passes_;
  mean_motion_ = motion ? motion->mean_length() : 0;
  return flow;
}

GstFlowReturn OlatAssembler::send(const Held& held, const cv::Mat& displacement) {
  cv::Mat codes;
  // Of the tracking frames the last is the one that all are moved to.
  const bool tracking = labels_->program().kind(held.label.position) == StepKind::tracking;
  const bool to_disk = !location_.empty() && !(tracking && !displacement.empty()) &&
                       held.label.position.part == Position::Part::step;
  if (to_disk || !displacement.empty()) codes = read_codes(info_, held.buffer.get());
  if (to_disk) {
    cv::Mat light = linear_light(*linear_, codes);
    if (!displacement.empty()) light = Motion::moved(light, displacement);
    save(held, light);
  }
  GstBuffer* buffer = gst_buffer_ref(held.buffer.get());
  if (!displacement.empty()) {
    GstBuffer* there = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&info_), nullptr);
    if (!there) {
      gst_buffer_unref(buffer);
      throw Error(ErrorKind::out_of_memory, "no memory for a frame; use smaller ones");
    }
    gst_buffer_copy_into(
        there, buffer,
        static_cast<GstBufferCopyFlags>(GST_BUFFER_COPY_FLAGS | GST_BUFFER_COPY_TIMESTAMPS), 0,
        static_cast<gsize>(-1));
    gst_buffer_unref(buffer);
    buffer = there;
    write_codes(info_, buffer, Motion::moved(codes, displacement));
  }
  {
    std::lock_guard lock(mutex_);
    ++(displacement.empty() ? still_ : moved_);
  }
  return FrameAssembler::take(buffer, &held.label);
}

/// A folder for each camera, which may be a link to one on another disk.
std::string OlatAssembler::folder() const {
  const std::string path = location_ + "/camera_" + std::to_string(camera_);
  std::error_code none;
  return std::filesystem::is_symlink(path, none)
             ? std::filesystem::weakly_canonical(path, none).string()
             : path;
}

/// Others may write to the location: a link where the draft will be is not followed.
void OlatAssembler::make_draft() const {
  std::error_code failed;
  std::filesystem::create_directories(location_, failed);
  for (const std::string& path : {draft(), draft() + "/olat"})
    if (!failed && !std::filesystem::create_directory(path, failed) && !failed)
      failed = std::make_error_code(std::errc::file_exists);
  if (failed)
    throw Error(ErrorKind::output, "the folder " + draft() +
                                       " cannot be made: " + failed.message() +
                                       "; name a location that only you write to");
}

void OlatAssembler::save(const Held& held, const cv::Mat& light) {
  if (files_.empty() && olat_files_.empty()) make_draft();
  const LightStep& step = labels_->program().steps[held.label.position.index];
  const std::string name = file_name(step);
  const bool again = step.kind == StepKind::olat ? olat_files_.contains(step.light)
                                                 : files_.contains(name_of(step.kind));
  if (again) std::filesystem::remove(draft() + "/" + name);
  write_exr(draft() + "/" + name, cv::max(light, 0));
  if (step.kind == StepKind::olat)
    olat_files_[step.light] = name;
  else
    files_[name_of(step.kind)] = name;
  std::lock_guard lock(mutex_);
  ++written_;
}

/// lights.json beside the pictures, in the format of lightstagetestsrc.
void OlatAssembler::save_list() const {
  const LightProgram& program = labels_->program();
  Json list = {{"format", LightList::kCapture},
               {"version", 1},
               {"program", program.name},
               {"camera", camera_},
               {"width", GST_VIDEO_INFO_WIDTH(&info_)},
               {"height", GST_VIDEO_INFO_HEIGHT(&info_)},
               {"light", "linear, 1 = full scale of the camera"}};
  for (const auto& [kind, file] : files_) list[kind] = file;
  list["lights"] = Json::array();
  // All lights: one whose frame was lost has no file.
  for (uint32_t light = 0; light < program.lights.size(); ++light) {
    Json one = {{"index", light}, {"direction", program.lights[light].direction}};
    if (const auto file = olat_files_.find(light); file != olat_files_.end())
      one["file"] = file->second;
    list["lights"].push_back(one);
  }
  NewFile file(draft() + "/lights.json");
  const std::string text = list.dump(2) + "\n";
  file.write(0, text.data(), text.size());
  file.close();
}

/// Replaces an earlier capture by the draft. An incomplete draft is put beside it.
void OlatAssembler::publish(bool ended) try {
  save_list();
  const size_t wanted = pictures_of(labels_->program()), got = files_.size() + olat_files_.size();
  const bool whole = got == wanted || (ended && static_cast<double>(got) >= kWhole * wanted);
  std::string to = folder();
  const bool beside = !whole && std::filesystem::exists(to + "/lights.json");
  if (beside) to += ".partial";
  if (!whole)
    post_warning(log_of(element_), GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED,
                 "the capture was cut short: %zu of %zu pictures are in %s%s", got, wanted,
                 to.c_str(), beside ? ", and the one before it stays where it is" : "");
  link_others(to, draft());
  replace_folder(draft(), to);
} catch (const std::filesystem::filesystem_error& error) {
  throw Error(ErrorKind::output,
              std::string("the capture cannot be put where it belongs: ") + error.what());
}

void OlatAssembler::add_stats(GstStructure* stats) const {
  std::lock_guard lock(mutex_);
  gst_structure_set(stats, "passes", G_TYPE_UINT64, passes_, "compensated", G_TYPE_UINT64, moved_,
                    "as-they-were", G_TYPE_UINT64, still_, "written", G_TYPE_UINT64, written_,
                    "mean-motion", G_TYPE_DOUBLE, mean_motion_, nullptr);
}

}  // namespace inverse
