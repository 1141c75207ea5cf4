// SPDX-License-Identifier: LGPL-2.1-or-later
// A lamp against the truth: frames are decomposed, relit and composed, and compared with the same
// room rendered again with a lamp in it.
//
//   lamp-bench DATA [--png FOLDER]
//
// Of the bundled clip's room the depth is known; DATA has edits/room_values_lamp and room_values,
// of which it is not. Prints PSNR in dB and SSIM of display codes, means over the frames of a room;
// --png writes a strip of images for each frame: before, truth, then the edits in the order of the
// table.
//
// The power of the lamp is known. The scale of a decomposition is not, so it is read off the frame
// before the edit: the median ratio of its shading to the true one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "kernels/edit/compose.hpp"
#include "kernels/edit/relight/relight.hpp"
#include "kernels/global/global_intrinsic.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/metrics/png_file.hpp"
#include "tests/bench/scenes/datasets.hpp"
#include "tests/bench/scenes/rendered.hpp"
#include "tests/lab.hpp"
#include "tests/srgb.hpp"

namespace inverse::bench {
namespace {

using Json = nlohmann::json;
constexpr clip::Vec3 kLampOfClip{0.15F, 0.45F, 0.35F};

Json read_json(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return Json::parse(file);
}

/// A frame, the same with the lamp, and the lamp.
struct Pair {
  std::string room;
  int index = 0;
  TruthFrame before;
  Image after;
  std::vector<float> depth;  ///< meters; empty: unknown
  float plane = 0;           ///< a depth in the middle of the room, meters
  float focal_length = 0;    ///< pixels
  std::array<float, 2> at;   ///< of the lamp, pixels
  float z = 0;               ///< of the lamp from the camera, meters
  float power = 0;           ///< shading at a meter
  float radius = 0;          ///< meters
};

std::vector<Pair> read_pairs(const std::string& data) {
  constexpr float kPlaneOfRoomValues = 3.5F;  // estimated by eye
  const std::string edited = data + "/edits/room_values_lamp";
  const Json edit = read_json(edited + "/edit.json");
  const Json cameras = read_json(data + "/room_values/meta.json")["frames"];
  constexpr double kPi = 3.14159265358979323846;
  std::vector<Pair> pairs;
  for (const Json& frame : edit["frames"]) {
    Pair pair{.room = "room_values", .index = frame["frame"]};
    pair.before = load_rendered(data + "/room_values", pair.index, Regime::kDiverseValue);
    std::array<char, 16> name{};
    std::snprintf(name.data(), name.size(), "%03d.png", pair.index);
    pair.after = read_png(edited + "/I8/" + name.data(), true);
    pair.plane = kPlaneOfRoomValues;
    for (const Json& camera : cameras)
      if (camera["frame"] == pair.index) pair.focal_length = camera["camera"]["fx"];
    // Pixel centers are at whole numbers in the file.
    for (std::size_t c = 0; c < 2; ++c) pair.at[c] = frame["lamp_px"][c].get<float>() + 0.5F;
    pair.z = frame["lamp_cam_m"][2];
    const double watts = edit["parameters"]["lamp_power_w"];
    pair.power = float(double(edit["exposure_scale_applied"]) * watts / (4 * kPi * kPi));
    pair.radius = edit["parameters"]["lamp_radius_m"];
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

float median(std::vector<float> values) {
  if (values.empty()) throw std::runtime_error("nothing is lit");
  std::nth_element(values.begin(), values.begin() + long(values.size() / 2), values.end());
  return values[values.size() / 2];
}

/// The room of the clip, and the same with a second lamp between the viewer and things: light adds.
Pair clip_pair() {
  constexpr int kWidth = 320, kHeight = 240;
  constexpr clip::Quality kStill{36, 25, 4};
  clip::Scene scene = clip::still_life(0);
  Pair pair{.room = "clip"};
  pair.before = rendered(scene, kWidth, kHeight, kStill);
  scene.lamp = {kLampOfClip, 0.02F, pair.power = 0.15F};
  scene.window.radiance = 0;
  pair.radius = scene.lamp.radius;
  const TruthFrame added = rendered(scene, kWidth, kHeight, kStill);
  pair.after = pair.before.reflectance;
  for (std::size_t i = 0; i < pair.after.data.size(); ++i)
    pair.after.data[i] *= pair.before.direct.data[i] + pair.before.indirect.data[i] +
                          added.direct.data[i] + added.indirect.data[i];
  const clip::Camera& camera = scene.camera;
  const clip::Vec3 forward = clip::normalize(camera.target - camera.position);
  const clip::Vec3 right = clip::normalize(clip::cross(forward, {0, 1, 0}));
  const clip::Vec3 down = clip::cross(forward, right);
  pair.focal_length = float(kHeight) / 2 / std::tan(camera.vertical_angle / 2);
  const clip::Vec3 lamp = scene.lamp.position - camera.position;
  pair.z = dot(lamp, forward);
  pair.at = {kWidth / 2.0F + pair.focal_length * dot(lamp, right) / pair.z,
             kHeight / 2.0F + pair.focal_length * dot(lamp, down) / pair.z};
  constexpr clip::Quality kGeometry{1, 1, 0};
  const clip::Layers layers = clip::render(scene, kWidth, kHeight, kGeometry, 1);
  for (const clip::Vec3& position : layers.position)
    pair.depth.push_back(dot(position - camera.position, forward));
  pair.plane = median(pair.depth);
  return pair;
}

/// Layers of a frame, and relit pictures of them.
class Editor {
 public:
  Editor(const std::shared_ptr<gpu::Device>& device, const Pair& pair)
      : device_(device),
        extent_{uint32_t(pair.before.input.width), uint32_t(pair.before.input.height)},
        pair_(pair),
        commands_(device),
        intrinsic_(device, extent_),
        global_(device, extent_),
        relight_(device, extent_),
        compose_(device, extent_),
        input_(upload(pair.before.input, nullptr)) {
    if (!pair.depth.empty())
      file_ = std::make_shared<const SurfaceFile>(DepthMap(extent_, pair.depth));
  }

  Layers two_layers() {
    return watched([&](bool first) {
      return intrinsic_.record(commands_, input_, ScaledIntrinsic::Params{}, {first});
    });
  }
  Layers all_layers() {
    return watched([&](bool first) {
      return global_.record(commands_, input_, GlobalIntrinsic::Params{}, {first, true});
    });
  }
  /// The frame itself as reflectance, under white light of 1.
  Layers no_layers() {
    return intrinsic_layers(input_, upload(pair_.before.input, &ones()), nullptr);
  }
  Layers true_layers() {
    return intrinsic_layers(input_, upload(pair_.before.reflectance, &pair_.before.shading),
                            nullptr);
  }

  /// With the lamp of the pair. Without depth, its place is known in widths of the frame at the
  /// depth of the picture plane.
  Image relit(Layers layers, RelightParams params, bool depth) {
    const float plane = pair_.plane;
    const float width = plane * float(extent_.width) / pair_.focal_length;  // meters
    const float unit = depth ? 1 : width;
    params.lamps = {{.position = {pair_.at[0], pair_.at[1], (plane - pair_.z) / unit},
                     .power = pair_.power * scale(layers) / (unit * unit),
                     .radius = pair_.radius / unit}};
    params.depth_units = 1;
    params.plane_depth = plane;
    constexpr float kDegrees = 180 / 3.14159265F;
    params.field_of_view = 2 * kDegrees * std::atan(float(extent_.width) / 2 / pair_.focal_length);
    relight_.set_surface(depth ? file_ : nullptr);
    relight_.reset();
    commands_.begin();
    relight_.record(commands_, layers, params);
    const PlanePtr picture = compose_.record(commands_, layers, {});
    commands_.submit();
    commands_.wait();
    const Pixels pixels = Lab(device_).download(picture->buffer);
    Image image(int(extent_.width), int(extent_.height), 3);
    for (std::size_t i = 0; i < extent_.pixels(); ++i)
      for (std::size_t c = 0; c < 3; ++c) image.data[3 * i + c] = pixels[4 * i + c];
    return image;
  }

 private:
  Image& ones() {
    ones_ = Image(int(extent_.width), int(extent_.height), 1);
    std::fill(ones_.data.begin(), ones_.data.end(), 1.0F);
    return ones_;
  }
  PlanePtr upload(const Image& image, const Image* fourth) {
    Pixels pixels(4 * extent_.pixels(), 1);
    for (std::size_t i = 0; i < extent_.pixels(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) pixels[4 * i + c] = image.data[3 * i + c];
      if (fourth) pixels[4 * i + 3] = fourth->data[i];
    }
    return Lab(device_).plane(extent_, pixels);
  }
  /// Uses a video that repeats the frame.
  Layers watched(const std::function<Layers(bool)>& record) {
    constexpr int kFrames = 3;
    Layers layers;
    for (int k = 0; k < kFrames; ++k) {
      commands_.begin();
      layers = record(k == 0);
      commands_.submit();
      commands_.wait();
    }
    return layers;
  }
  /// Median ratio of shading to the true one.
  float scale(const Layers& layers) {
    const Pixels pixels = Lab(device_).download(layers[Role::model]->buffer);
    std::vector<float> ratios;
    for (std::size_t i = 0; i < extent_.pixels(); ++i)
      if (pair_.before.shading.data[i] > 1e-3F)
        ratios.push_back(pixels[4 * i + 3] / pair_.before.shading.data[i]);
    return median(std::move(ratios));
  }

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  const Pair& pair_;
  gpu::Commands commands_;
  ScaledIntrinsic intrinsic_;
  GlobalIntrinsic global_;
  Relight relight_;
  Compose compose_;
  PlanePtr input_;
  Image ones_;
  std::shared_ptr<const SurfaceFile> file_;
};

struct Edit {
  std::string name;
  Image picture;
};

std::vector<Edit> edits_of(const std::shared_ptr<gpu::Device>& device, const Pair& pair) {
  Editor editor(device, pair);
  std::vector<Edit> edits{{"no edit", pair.before.input}};
  using Surface = RelightParams::Surface;
  const std::pair<const char*, Layers> sources[] = {{"the picture itself", editor.no_layers()},
                                                    {"`intrinsicdecomp`", editor.two_layers()},
                                                    {"`globalintrinsic`", editor.all_layers()},
                                                    {"true reflectance", editor.true_layers()}};
  for (const auto& [name, layers] : sources) {
    const std::string source = name;
    if (!pair.depth.empty()) edits.push_back({source + ", depth", editor.relit(layers, {}, true)});
    edits.push_back({source + ", shading", editor.relit(layers, {}, false)});
    edits.push_back({source + ", flat", editor.relit(layers, {.surface = Surface::flat}, false)});
  }
  return edits;
}

/// Display codes 0…1, in which pictures are compared.
Image displayed(const Image& linear) {
  Image out = linear;
  for (float& v : out.data) v = srgb_code(std::clamp(v, 0.0F, 1.0F));
  return out;
}

void write_strip(const std::string& folder, const Pair& pair, const std::vector<Edit>& edits) {
  std::vector<const Image*> parts{&pair.before.input, &pair.after};
  for (std::size_t k = 1; k < edits.size(); ++k) parts.push_back(&edits[k].picture);
  const int w = pair.after.width, h = pair.after.height;
  Image strip(w * int(parts.size()), h, 3);
  for (std::size_t k = 0; k < parts.size(); ++k)
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        for (int c = 0; c < 3; ++c) strip.at(int(k) * w + x, y, c) = parts[k]->at(x, y, c);
  std::filesystem::create_directories(folder);
  write_png(folder + "/lamp_" + pair.room + "_" + std::to_string(pair.index) + ".png", strip);
}

void run(const std::string& data, const std::string& png) {
  const std::shared_ptr<gpu::Device> device = gpu::Device::open("");
  std::vector<Pair> pairs = read_pairs(data);
  pairs.insert(pairs.begin(), clip_pair());
  std::vector<std::string> names, rooms;
  std::map<std::string, std::map<std::string, std::array<double, 3>>> scores;  // PSNR, SSIM, frames
  for (const Pair& pair : pairs) {
    if (rooms.empty() || rooms.back() != pair.room) rooms.push_back(pair.room);
    const std::vector<Edit> edits = edits_of(device, pair);
    const Image truth = displayed(pair.after);
    for (const Edit& edit : edits) {
      if (!scores.contains(edit.name)) names.push_back(edit.name);
      const Image picture = displayed(edit.picture);
      auto& [sum, structure, count] = scores[edit.name][pair.room];
      sum += psnr(picture, truth, {}), structure += ssim(picture, truth, {}), count += 1;
    }
    if (!png.empty()) write_strip(png, pair, edits);
  }
  std::printf("| lamp: PSNR / SSIM |");
  for (const std::string& room : rooms) std::printf(" %s |", room.c_str());
  std::printf("\n|---|---|---|\n");
  for (const std::string& name : names) {
    std::printf("| %s |", name.c_str());
    for (const std::string& room : rooms) {
      const auto& [sum, structure, count] = scores[name][room];
      if (count == 0)
        std::printf(" – |");
      else
        std::printf(" %.1f / %.3f |", sum / count, structure / count);
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  std::string data, png;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--png" && i + 1 < argc)
      png = argv[++i];
    else
      data = argument;
  }
  if (data.empty()) throw std::runtime_error("usage: lamp-bench DATA [--png FOLDER]");
  inverse::bench::run(data, png);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "lamp-bench: %s\n", error.what());
  return 1;
}
