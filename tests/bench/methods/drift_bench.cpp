// SPDX-License-Identifier: LGPL-2.1-or-later
// How the brightness and color of what stays in view change while a camera zooms and pans, its
// exposure or its white balance changes, and a hand enters.
//
//   drift-bench PICTURE… [--json FILE]
//
// PICTURE is a PNG file or a scene as ./dev bench keeps it, of which the first frame is taken. A
// view of it, 320 pixels wide at most, zooms in (1 to 1.9), and one of half the picture's width
// pans by half its own; before a still one the exposure falls by half (ln -.7), the white balance
// moves by .2 of ln R/B, or a hand comes in front of a third; 120 frames each. Methods run at their
// defaults, intrinsicdecomp also with gray light. Prints the common drift over 60 frames of
// reflectance and input: of brightness, and of ln R/B. The first five frames of a shot do not
// count. The thesis is shown the moving camera only.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "methods.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/metrics/png_file.hpp"
#include "tests/bench/support/json.hpp"
#include "tests/bench/support/scene.hpp"

namespace inverse::bench {
namespace {

constexpr int kFrames = 120, kFirst = 5;
constexpr std::size_t kSpan = 60;

/// Upper left corner of a view in the picture, and picture pixels a view's pixel.
struct Camera {
  double x, y, step;
};

/// Of the view; 4 : 3.
Size view_size(const Image& picture) {
  const int width = std::min({320, picture.width / 2, picture.height * 2 / 3}) / 4 * 4;
  if (width < 64) throw std::runtime_error("a picture is smaller than 128x96");
  return {width, width * 3 / 4};
}

Camera zoom(int k, Size view, const Image& picture) {
  const double zoomed = 1 + 0.0075 * k;
  const double step =
      std::min(double(picture.width) / view.width, double(picture.height) / view.height) / zoomed;
  return {0.5 * (picture.width - step * view.width), 0.5 * (picture.height - step * view.height),
          step};
}

/// To the right by half the view's width.
Camera pan(int k, Size view, const Image& picture) {
  const double step =
      0.5 * std::min(double(picture.width) / view.width, double(picture.height) / view.height);
  const double share = (k / (kFrames - 1.0) - 0.5) * 0.5;
  return {0.5 * picture.width + (share - 0.5) * step * view.width,
          0.5 * (picture.height - step * view.height), step};
}

Camera still(int /*k*/, Size view, const Image& picture) { return zoom(0, view, picture); }

void none(int /*k*/, Image& /*view*/) {}

/// From 0 in frame 20 to 1 in frame 50.
float ramp(int k) { return std::clamp(float(k - 20) / 30, 0.0F, 1.0F); }

void scale(Image& view, const std::array<float, 3>& factors) {
  for (std::size_t i = 0; i < view.data.size(); ++i) view.data[i] *= factors[i % 3];
}

void exposure(int k, Image& view) {
  const float factor = std::exp(-0.7F * ramp(k));
  scale(view, {factor, factor, factor});
}

void white_balance(int k, Image& view) {
  const float red = std::exp(0.1F * ramp(k));
  scale(view, {red, 1, 1 / red});
}

/// A round thing the color of skin, as high as the view, from the right.
void hand(int k, Image& view) {
  const float radius = 0.5F * float(view.height),
              center = float(view.width) + radius - ramp(k) * float(view.width) / 3 - radius / 4;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const float u = (float(x) - center) / radius, v = float(y) / radius - 1;
      const float height = 1 - u * u - v * v;
      if (height <= 0) continue;
      const float light = 0.3F + 0.7F * std::sqrt(height);
      constexpr std::array<float, 3> kSkin{0.55F, 0.32F, 0.22F};
      for (int c = 0; c < 3; ++c) view.at(x, y, c) = light * kSkin[std::size_t(c)];
    }
}

/// R/B, one channel.
Image warmth(const Image& image) {
  constexpr float kFloor = 1e-3F;
  Image out(image.width, image.height, 1);
  for (std::size_t i = 0; i < out.data.size(); ++i)
    out.data[i] = (image.data[3 * i] + kFloor) / (image.data[3 * i + 2] + kFloor);
  return out;
}

/// Clamped to the image.
float bilinear(const Image& image, double x, double y, int c) {
  const double u = std::clamp(x, 0.0, image.width - 1.0),
               v = std::clamp(y, 0.0, image.height - 1.0);
  const int x0 = int(u), y0 = int(v), x1 = std::min(x0 + 1, image.width - 1),
            y1 = std::min(y0 + 1, image.height - 1);
  const auto fx = float(u - x0), fy = float(v - y0);
  return (1 - fy) * ((1 - fx) * image.at(x0, y0, c) + fx * image.at(x1, y0, c)) +
         fy * ((1 - fx) * image.at(x0, y1, c) + fx * image.at(x1, y1, c));
}

/// Means of 4 x 4 bilinear samples a pixel.
Image view_of(const Image& picture, const Camera& camera, Size size) {
  constexpr int kSamples = 4;
  Image view(size.width, size.height, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const double u = camera.x + camera.step * (x + (k % kSamples + 0.5) / kSamples) - 0.5;
        const double v = camera.y + camera.step * (y + (k / kSamples + 0.5) / kSamples) - 0.5;
        for (int c = 0; c < 3; ++c)
          view.at(x, y, c) += bilinear(picture, u, v, c) / (kSamples * kSamples);
      }
  return view;
}

/// Of points on a grid over the picture.
std::vector<Track> tracks(const Image& picture, const std::vector<Camera>& cameras, Size size) {
  constexpr double kMargin = 4;
  std::vector<Track> all;
  const double spacing = std::max(2.0, picture.width / 100.0);
  for (double y = 0.5 * spacing; y < picture.height; y += spacing)
    for (double x = 0.5 * spacing; x < picture.width; x += spacing) {
      Track track;
      for (const Camera& camera : cameras) {
        const double u = (x - camera.x) / camera.step - 0.5, v = (y - camera.y) / camera.step - 0.5;
        const bool seen = u >= kMargin && v >= kMargin && u <= size.width - 1 - kMargin &&
                          v <= size.height - 1 - kMargin;
        track.push_back(seen ? std::array{u, v} : std::array{std::nan(""), std::nan("")});
      }
      all.push_back(track);
    }
  return all;
}

Image picture_of(const std::filesystem::path& path) {
  return path.extension() == ".png" ? read_png(path.string(), true)
                                    : read_scene(path.string()).frames.front().input;
}

const Setting& setting_of(const Method& method, bool gray_light) {
  for (const Setting& setting : method.settings)
    if (gray_light ? setting.name == "color of light" : setting.base) return setting;
  throw std::runtime_error(method.name + " lacks a setting");
}

/// Common drift of brightness, and of color.
std::array<double, 2> drift_of(const std::vector<Image>& images, const std::vector<Track>& points) {
  std::vector<Image> color;
  for (const Image& image : images) color.push_back(warmth(image));
  return {common_drift(images, points, kSpan), common_drift(color, points, kSpan)};
}

void run(int argc, char** argv) {
  std::string out;
  std::vector<std::filesystem::path> pictures;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--json" && i + 1 < argc) {
      out = argv[++i];
    } else {
      pictures.emplace_back(word);
    }
  }
  if (pictures.empty()) throw std::runtime_error("usage: drift-bench PICTURE… [--json FILE]");
  DeviceSession session("");
  const Method own = intrinsicdecomp(session), global = globalintrinsic(session),
               printed = thesis(session, ThesisParams::Solver::pcg);
  const std::pair<std::string, const Setting*> methods[] = {
      {own.name, &setting_of(own, false)},
      {own.name + ", gray light", &setting_of(own, true)},
      {global.name, &setting_of(global, false)},
      {global.name + ", gray light", &setting_of(global, true)},
      {printed.name, &setting_of(printed, false)}};
  const struct {
    const char* name;
    Camera (*camera)(int, Size, const Image&);
    void (*change)(int, Image&);
  } motions[] = {{"zoom", zoom, none},
                 {"pan", pan, none},
                 {"exposure", still, exposure},
                 {"white balance", still, white_balance},
                 {"hand", still, hand}};
  std::string json;
  std::printf("%-16s %-14s %-28s %8s %8s %8s %8s\n", "picture", "motion", "method", "drift",
              "input", "color", "input");
  for (std::size_t p = 0; p < pictures.size(); ++p) {
    const Image picture = picture_of(pictures[p]);
    const Size size = view_size(picture);
    for (const auto& motion : motions) {
      std::vector<Camera> cameras;
      std::vector<Image> views;
      for (int k = 0; k < kFrames; ++k) {
        const Camera camera = motion.camera(k, size, picture);
        Image view = view_of(picture, camera, size);
        motion.change(k, view);
        views.push_back(through_8_bits(view));
        if (k >= kFirst) cameras.push_back(camera);
      }
      const std::vector<Track> points = tracks(picture, cameras, size);
      const auto input = drift_of({views.begin() + kFirst, views.end()}, points);
      for (const auto& [method, setting] : methods) {
        if (motion.change != none && method == printed.name) continue;
        const auto solver = setting->make(size);
        std::vector<Image> reflectance;
        Cost cost;
        for (int k = 0; k < kFrames; ++k) {
          Image found = solver->run(views[std::size_t(k)], k > 0, cost).reflectance;
          if (k >= kFirst) reflectance.push_back(std::move(found));
        }
        const auto drift = drift_of(reflectance, points);
        std::printf("%-16s %-14s %-28s %8.4f %8.4f %8.4f %8.4f\n", pictures[p].stem().c_str(),
                    motion.name, method.c_str(), drift[0], input[0], drift[1], input[1]);
        std::fflush(stdout);
        json += (json.empty() ? "" : ",\n ") +
                json::Object()
                    .add("picture", json::text(pictures[p].stem().string()))
                    .add("motion", json::text(motion.name))
                    .add("method", json::text(method))
                    .add("drift", json::number(drift[0]))
                    .add("input", json::number(input[0]))
                    .add("color", json::number(drift[1]))
                    .add("input_color", json::number(input[1]))
                    .str();
      }
      std::fprintf(stderr, "@progress %.3f %s %s\n",
                   double(std::size(motions) * p + std::size_t(&motion - motions) + 1) /
                       double(std::size(motions) * pictures.size()),
                   pictures[p].stem().c_str(), motion.name);
    }
  }
  if (out.empty()) return;
  std::ofstream file(out);
  file << "[" << json << "]\n";
  if (!file) throw std::runtime_error("cannot write " + out);
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  inverse::bench::run(argc, argv);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "drift-bench: %s\n", error.what());
  return 1;
}
