// SPDX-License-Identifier: LGPL-2.1-or-later
#include "recording.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <queue>
#include <tuple>
#include <utility>

#include "common/error.hpp"
#include "common/json.hpp"
#include "common/open_file.hpp"
#include "kernels/environment/png_pixels.hpp"
#include "name_order.hpp"
#include "text_lines.hpp"

namespace inverse {
namespace {

namespace fs = std::filesystem;
using Entry = Recording::Entry;
using Warnings = std::vector<std::string>;

constexpr Extent kKinect{640, 480};

[[noreturn]] void refuse(const std::string& text) { throw Error(ErrorKind::file, text); }

/// "1 frame", "2 frames".
std::string count_text(size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

bool is_there(const std::string& path) {
  std::error_code none;
  return fs::exists(path, none);
}

/// What a folder says of its frames.
struct Listing {
  std::vector<Entry> entries;  // also those of which one picture is missing
  bool timed = false;          // else at the rate that was given
  double unit = 0.001;
  CalibratedCamera camera;  // of the pictures; without a size: not known
  size_t unpaired = 0;
};

// TUM RGB-D

struct Stamped {
  double seconds;
  std::string path;
};

std::vector<Stamped> read_stamped(const std::string& folder, const char* list, Warnings& warnings) {
  std::vector<Stamped> files;
  const std::string path = folder + "/" + list;
  read_lines(path, "time file", warnings, [&](const Words& words) {
    const auto seconds = time_number(words.front());
    if (!seconds || words.size() != 2) return false;
    files.push_back({*seconds, folder + "/" + std::string(words[1])});
    return true;
  });
  if (files.empty()) refuse(path + " lists no file; each of its lines is to be \"time file\"");
  order_by_time(files, path, warnings);
  return files;
}

/// Pairs of indices that are no more than `tolerance` seconds apart, the nearest first, each index
/// once; in the order of the first. Both lists are in the order of time.
std::vector<std::pair<size_t, size_t>> pairs_in_time(const std::vector<Stamped>& a,
                                                     const std::vector<Stamped>& b,
                                                     double tolerance) {
  // The nearest two that are left are always neighbors among those that are left: a list in the
  // order of time, from which pairs are taken out.
  constexpr size_t kNone = SIZE_MAX;
  struct Item {
    double seconds;
    bool of_b;
    size_t index, before, after;
    bool taken = false;
  };
  std::vector<Item> items;
  for (size_t i = 0; i < a.size(); ++i) items.push_back({a[i].seconds, false, i, kNone, kNone});
  for (size_t i = 0; i < b.size(); ++i) items.push_back({b[i].seconds, true, i, kNone, kNone});
  std::ranges::stable_sort(items, {}, &Item::seconds);
  using Candidate = std::tuple<double, size_t, size_t>;  // seconds apart, items
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> candidates;
  const auto consider = [&](size_t one, size_t other) {
    if (one == kNone || other == kNone || items[one].of_b == items[other].of_b) return;
    const double apart = items[other].seconds - items[one].seconds;
    if (apart <= tolerance) candidates.emplace(apart, one, other);
  };
  for (size_t i = 0; i < items.size(); ++i) {
    items[i].before = i > 0 ? i - 1 : kNone;
    items[i].after = i + 1 < items.size() ? i + 1 : kNone;
    consider(items[i].before, i);
  }
  std::vector<std::pair<size_t, size_t>> pairs;
  while (!candidates.empty()) {
    const auto [apart, one, other] = candidates.top();
    candidates.pop();
    if (items[one].taken || items[other].taken) continue;
    items[one].taken = items[other].taken = true;
    pairs.emplace_back(items[items[one].of_b ? other : one].index,
                       items[items[one].of_b ? one : other].index);
    const size_t before = items[one].before, after = items[other].after;
    if (before != kNone) items[before].after = after;
    if (after != kNone) items[after].before = before;
    consider(before, after);
  }
  std::ranges::sort(pairs);
  return pairs;
}

Listing list_tum(const std::string& folder, double tolerance, Warnings& warnings) {
  const auto color = read_stamped(folder, "rgb.txt", warnings),
             depth = read_stamped(folder, "depth.txt", warnings);
  Listing listing{.timed = true, .unit = 1 / 5000.0};
  listing.camera = {kKinect, 525, 525, 319.5, 239.5};  // that its authors recommend
  for (const auto& [c, d] : pairs_in_time(color, depth, tolerance))
    listing.entries.push_back({color[c].seconds, color[c].path, depth[d].path, {}, {}});
  const size_t pairs = listing.entries.size();
  if (pairs == 0)
    refuse(folder +
           ": none of the pictures of rgb.txt has a depth image within max-difference in "
           "depth.txt; are both lists of the same recording?");
  listing.unpaired = color.size() + depth.size() - 2 * pairs;
  if (2 * pairs < std::min(color.size(), depth.size()))
    warnings.push_back(
        folder + ": only " + count_text(pairs, "picture") + " of " + std::to_string(color.size()) +
        " have a depth image within max-difference; raise it if the lists are right");
  return listing;
}

// Pictures by name

using ByName = std::map<std::string, Entry>;

std::string stem_of(const fs::path& path) { return path.stem().string(); }

/// The order of these files, and of others with such names.
NameOrder order_of(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  std::ranges::transform(files, std::back_inserter(names), stem_of);
  return NameOrder(names);
}

bool is_picture(const fs::path& path) {
  std::string kind = path.extension().string();
  std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return kind == ".png" || kind == ".jpg" || kind == ".jpeg";
}

std::vector<fs::path> pictures_in(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code fault;
  for (fs::directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault))
    if (is_picture(at->path())) files.push_back(at->path());
  if (fault) refuse(folder + ": it cannot be read: " + fault.message());
  std::ranges::sort(files, order_of(files), stem_of);
  return files;
}

std::vector<Entry> entries_of(const ByName& frames, double rate) {
  std::vector<std::string> names;
  for (const auto& [name, entry] : frames) names.push_back(name);
  std::ranges::sort(names, NameOrder(names));
  std::vector<Entry> entries;
  for (const std::string& name : names) {
    entries.push_back(frames.at(name));
    entries.back().seconds = static_cast<double>(entries.size() - 1) / rate;
  }
  return entries;
}

void warn_of_poses(const std::string& where, size_t wrong, Warnings& warnings) {
  if (wrong > 0)
    warnings.push_back(where + ": " + count_text(wrong, "pose") +
                       " cannot be used (not finite, or no rotation and place); these frames come "
                       "without");
}

/// A file of four rows of four numbers, of which the last is not read.
std::optional<PoseRows> read_pose(const std::string& path) {
  PoseRows rows{};
  size_t count = 0;
  bool good = true;
  Warnings of_lines;  // one pose is good as a whole, or not at all
  read_lines(path, "", of_lines, [&](const Words& words) {
    for (const std::string_view word : words) {
      const auto number = finite_number(word);
      good = good && number;
      if (number && count < rows.size()) rows[count] = *number;
      ++count;
    }
    return true;
  });
  if (!good || count < rows.size() || !is_pose(rows)) return {};
  return rows;
}

// 7-Scenes: NAME.color.png, NAME.depth.png and NAME.pose.txt in one folder

/// NAME of a file NAME.KIND.png; empty if it is something else.
std::string name_before(const fs::path& path, const char* kind) {
  const fs::path stem = path.stem();
  return stem.extension() == kind ? stem.stem().string() : std::string();
}

bool is_7scenes(const std::string& folder) {
  return std::ranges::any_of(pictures_in(folder), [](const fs::path& path) {
    return !name_before(path, ".color").empty();
  });
}

Listing list_7scenes(const std::string& folder, double rate, Warnings& warnings) {
  ByName frames;
  for (const fs::path& path : pictures_in(folder)) {
    if (const auto name = name_before(path, ".color"); !name.empty())
      frames[name].color = path.string();
    if (const auto name = name_before(path, ".depth"); !name.empty())
      frames[name].depth = path.string();
  }
  size_t wrong = 0;
  for (auto& [name, entry] : frames) {
    const std::string path = fs::path(folder) / (name + ".pose.txt");
    if (!is_there(path)) continue;
    entry.pose = read_pose(path);
    if (!entry.pose) ++wrong;
  }
  warn_of_poses(folder, wrong, warnings);
  return {.entries = entries_of(frames, rate), .camera = {kKinect, 585, 585, 320, 240}};
}

// A folder of color and one of depth

/// Frames by what `key` makes of the names; nothing if it makes the same of two.
template <typename Key>
std::optional<ByName> joined(const std::vector<fs::path>& color, const std::vector<fs::path>& depth,
                             Key key) {
  ByName frames;
  for (const auto& [files, to] : {std::pair{&color, &Entry::color}, {&depth, &Entry::depth}})
    for (const fs::path& path : *files) {
      std::string& place = frames[key(path)].*to;
      if (!place.empty()) return {};
      place = path.string();
    }
  return frames;
}

/// Pairs pictures by their names, else by the numbers in these, else by their order.
ByName paired(const std::vector<fs::path>& color, const std::vector<fs::path>& depth,
              const std::string& folder) {
  const size_t fewer = std::min(color.size(), depth.size());
  std::vector<fs::path> all = color;
  all.insert(all.end(), depth.begin(), depth.end());
  const NameOrder order = order_of(all);
  for (const bool by_number : {false, true}) {
    auto frames = joined(color, depth, [&](const fs::path& path) {
      return by_number ? order.number_of(stem_of(path)) : stem_of(path);
    });
    if (frames && 2 * (color.size() + depth.size() - frames->size()) >= fewer)
      return std::move(*frames);
  }
  if (color.size() != depth.size())
    refuse(folder + ": " + count_text(color.size(), "picture") + " and " +
           count_text(depth.size(), "depth image") +
           " whose names do not tell which belong together; give both the same names or numbers");
  ByName frames;
  for (size_t i = 0; i < color.size(); ++i) {
    Entry& entry = frames[std::to_string(i)];
    entry.color = color[i].string();
    entry.depth = depth[i].string();
  }
  return frames;
}

CalibratedCamera camera_of(const nlohmann::json& json, const std::string& path) {
  CalibratedCamera camera;
  camera.size = {json_count(json.at("width")).value_or(0),
                 json_count(json.at("height")).value_or(0)};
  camera.fx = json.at("fx").get<double>();
  camera.fy = json.at("fy").get<double>();
  camera.cx = json.at("cx").get<double>();
  camera.cy = json.at("cy").get<double>();
  if (!camera.usable())
    refuse(path + ": a camera has no size, or a focal length that is not above 0");
  return camera;
}

/// meta.json: {"depth_units_per_metre": 5000, "frames": [{"frame": 0, "camera": {"width", "height",
/// "fx", "fy", "cx", "cy", "cam_to_world_opencv": 4 rows of 4}}]}, frames by the numbers of files.
void read_meta(const std::string& path, Listing& listing, Warnings& warnings) {
  constexpr uint64_t kMaxBytes = uint64_t{1} << 26;
  std::string fault;
  const std::string text = read_file(path, kMaxBytes, fault);
  const auto json = fault.empty() ? parse_json<nlohmann::json>(text, fault) : nlohmann::json();
  if (!fault.empty()) refuse(path + ": it " + fault + "; mend it, or remove it");
  std::map<std::string, Entry*> by_number;
  for (Entry& entry : listing.entries)
    by_number[NameOrder({}).number_of(stem_of(entry.color.empty() ? entry.depth : entry.color))] =
        &entry;
  size_t wrong = 0, matched = 0;
  uint32_t index = 0;
  try {
    if (json.contains("depth_units_per_metre")) {
      const auto steps = json["depth_units_per_metre"].get<double>();
      if (!(steps > 1 && std::isfinite(steps)))
        refuse(path + ": \"depth_units_per_metre\" must be above 1: the steps of depth in a meter");
      listing.unit = 1 / steps;
    }
    for (const auto& frame : json.value("frames", nlohmann::json::array())) {
      const auto number =
          frame.contains("frame") ? json_count(frame["frame"]) : std::optional(index);
      ++index;
      const auto found = number ? by_number.find(std::to_string(*number)) : by_number.end();
      if (found == by_number.end() || !frame.contains("camera")) continue;
      ++matched;
      const auto& camera = frame["camera"];
      Entry& entry = *found->second;
      entry.lens = camera_of(camera, path);
      if (listing.camera.size.pixels() == 0) listing.camera = *entry.lens;
      if (!camera.contains("cam_to_world_opencv")) continue;
      PoseRows rows{};
      for (size_t i = 0; i < rows.size(); ++i)
        rows[i] = camera["cam_to_world_opencv"].at(i / 4).at(i % 4).get<double>();
      if (is_pose(rows))
        entry.pose = rows;
      else
        ++wrong;
    }
  } catch (const nlohmann::json::exception& error) {
    refuse(path + " does not describe a recording: " + json_fault(error) +
           "; mend it, or remove it");
  }
  if (matched == 0)
    warnings.push_back(path +
                       ": none of its frames has the number of a picture, and a \"camera\"; lens "
                       "and poses are not known");
  warn_of_poses(path, wrong, warnings);
}

/// The first of these folders that exists in another one; empty without one.
std::string folder_in(const std::string& folder, const std::string& given,
                      std::initializer_list<const char*> names) {
  if (!given.empty()) return fs::path(given).is_absolute() ? given : folder + "/" + given;
  std::error_code none;
  for (const char* name : names)
    if (fs::is_directory(folder + "/" + name, none)) return folder + "/" + name;
  return {};
}

Listing list_folders(const std::string& folder, const std::string& color_folder,
                     const std::string& depth_folder, double rate, Warnings& warnings) {
  const auto color = pictures_in(color_folder), depth = pictures_in(depth_folder);
  for (const auto& [files, path] : {std::pair{&color, &color_folder}, {&depth, &depth_folder}})
    if (files->empty()) refuse(*path + " has no PNG or JPEG pictures");
  Listing listing{.entries = entries_of(paired(color, depth, folder), rate)};
  if (const std::string path = folder + "/meta.json"; is_there(path))
    read_meta(path, listing, warnings);
  return listing;
}

Listing list(const RecordingSettings& settings, double rate, Warnings& warnings) {
  const std::string& folder = settings.location;
  if (folder.empty()) refuse("location is not set; give the folder of a recording");
  if (folder.find("://") != folder.npos)
    refuse(folder + ": location takes the path of a folder, not a URI");
  std::error_code fault;
  const fs::file_status status = fs::status(folder, fault);
  if (!fs::exists(status))
    refuse(folder + ": it cannot be read: " + (fault ? fault.message() : "no such folder") +
           "; check location");
  if (!fs::is_directory(status))
    refuse(folder +
           " is no folder; play a Matroska file by \"filesrc ! matroskademux\" and rgbdmerge (the "
           "manual of rgbdmerge has the line)");
  const std::string color = folder_in(folder, settings.color_folder,
                                      {"color", "colour", "rgb", "image", "images", "I8"}),
                    depth = folder_in(folder, settings.depth_folder, {"depth", "Zkinect", "Z"});
  const bool named = !settings.color_folder.empty() || !settings.depth_folder.empty();
  if (!named && is_there(folder + "/rgb.txt"))
    return list_tum(folder, settings.max_difference / 1000, warnings);
  if (!named && is_7scenes(folder)) return list_7scenes(folder, rate, warnings);
  if (!color.empty() && !depth.empty()) return list_folders(folder, color, depth, rate, warnings);
  refuse(folder +
         " is no recording: it has neither rgb.txt and depth.txt (TUM RGB-D), nor "
         "NAME.color.png and NAME.depth.png (7-Scenes), nor folders color and depth; name these by "
         "color-folder and depth-folder");
}

}  // namespace

Recording::Recording(const RecordingSettings& settings) : settings_(settings) {
  constexpr double kRate = 30;
  const double rate = settings.rate > 0 ? settings.rate : kRate;
  Listing listing = list(settings, rate, warnings_);
  entries_ = std::move(listing.entries);
  unpaired_ = listing.unpaired;
  camera_ = listing.camera;
  unit_ = listing.unit;
  leave_out_unpaired();
  const std::string recorded = settings.location + "/groundtruth.txt";
  if (!settings.poses.empty())
    find_poses(settings.poses);
  else if (listing.timed && is_there(recorded))
    try {
      find_poses(recorded);
    } catch (const Error& error) {
      warnings_.push_back(std::string(error.what()) + "; frames come without poses");
    }
  if (listing.timed && settings.rate > 0)
    for (size_t n = 0; n < frames(); ++n) entries_[n].seconds = static_cast<double>(n) / rate;
  count_from_zero(1 / rate);
  read_first();
}

void Recording::leave_out_unpaired() {
  const auto unpaired = std::stable_partition(
      entries_.begin(), entries_.end(),
      [](const Entry& entry) { return !entry.color.empty() && !entry.depth.empty(); });
  if (unpaired == entries_.end()) return;
  const std::string text = unpaired->depth.empty() ? unpaired->color + " has no depth image"
                                                   : unpaired->depth + " has no picture";
  if (unpaired == entries_.begin())
    refuse(text + ", nor has any other a partner: names must be equal");
  unpaired_ += static_cast<size_t>(entries_.end() - unpaired);
  warnings_.push_back(text + "; " + count_text(unpaired_, "such frame") + " left out");
  entries_.erase(unpaired, entries_.end());
}

void Recording::find_poses(const std::string& path) {
  const Trajectory trajectory(path, warnings_);
  size_t found = 0;
  for (Entry& entry : entries_) {
    entry.pose = trajectory.at(entry.seconds, settings_.max_difference / 1000);
    if (entry.pose) ++found;
  }
  if (found == 0)
    warnings_.push_back(path + ": none of its poses, " + trajectory.span() +
                        ", is within max-difference of a frame; frames come without poses");
}

void Recording::count_from_zero(double period) {
  const double first = entries_.front().seconds;
  std::vector<double> periods;
  for (size_t n = 0; n < frames(); ++n) {
    entries_[n].seconds -= first;
    if (n > 0) periods.push_back(entries_[n].seconds - entries_[n - 1].seconds);
  }
  const auto middle = periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2);
  std::ranges::nth_element(periods, middle);
  constexpr double kShortest = 1e-3, kLongest = 1e7;
  period_ = std::max(periods.empty() ? period : *middle, kShortest);
  end_ = entries_.back().seconds + period_;
  if (!(end_ < kLongest))
    refuse(settings_.location + ": its first and last time stamp are " + std::to_string(end_) +
           " s apart; mend its lists, or set framerate");
}

void Recording::read_first() {
  std::optional<Error> first_error;
  for (size_t n = 0; n < frames() && depth_extent_.pixels() == 0; ++n) try {
      const Frame frame = read(n);
      extent_ = frame.color.extent;
      depth_extent_ = frame.depth_extent;
    } catch (const Error& error) {
      if (!first_error) first_error = error;
    }
  if (depth_extent_.pixels() == 0) throw *first_error;
  if (camera_.size.pixels() == 0) camera_ = typical_camera(extent_);
  if (!settings_.calibration.empty()) {
    const Calibration calibration = read_calibration(settings_.calibration);
    unit_ = calibration.unit.value_or(unit_);
    registration_.emplace(calibration, depth_extent_);
  }
  if (settings_.unit > 0) unit_ = settings_.unit;
}

CalibratedCamera Recording::lens(size_t n) const {
  if (registration_) return registration_->lens();
  return entries_[n]
      .lens.value_or(camera_)
      .for_size(extent_)
      .with_lens(settings_.fx, settings_.fy, settings_.cx, settings_.cy)
      .for_size(depth_extent_);
}

Recording::Frame Recording::read(size_t n) const {
  constexpr uint16_t kInvalid = 65535;
  const Entry& entry = entries_[n];
  const auto check_size = [](const std::string& path, Extent size, Extent first) {
    if (first.pixels() > 0 && size != first)
      refuse(path + ": its size is " + std::to_string(size.width) + "x" +
             std::to_string(size.height) + ", that of the first " + std::to_string(first.width) +
             "x" + std::to_string(first.height));
  };
  const PngPixels png = read_png_pixels(entry.depth, "depth images are gray PNG files of 16 bits");
  if (!png.gray() || !png.is_16_bits)
    refuse(entry.depth + ": it has " + (png.gray() ? "" : "color, and ") +
           (png.is_16_bits ? "16" : "8") +
           " bits a sample; depth images are gray PNG files of 16 bits");
  check_size(entry.depth, png.extent, depth_extent_);
  Frame frame{load_picture(entry.color, Turn::none), png.extent, {}};
  check_size(entry.color, frame.color.extent, extent_);
  frame.depth.reserve(png.extent.pixels());
  for (size_t i = 0; i < png.codes.size(); i += 4)
    frame.depth.push_back(png.codes[i] == kInvalid ? 0 : png.codes[i]);
  if (registration_) {
    std::vector<uint16_t> registered;
    registration_->run(reinterpret_cast<const uint8_t*>(frame.depth.data()),
                       size_t{2} * png.extent.width, unit_, registered);
    frame.depth = std::move(registered);
  }
  return frame;
}

}  // namespace inverse
