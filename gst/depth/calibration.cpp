// SPDX-License-Identifier: LGPL-2.1-or-later
#include "calibration.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json.hpp"
#include "common/open_file.hpp"

namespace inverse {
namespace {

using Json = nlohmann::json;

CalibratedCamera camera_of(const Json& json) {
  CalibratedCamera camera;
  const auto& matrix = json.at("matrix");
  camera.size = {json_count(json.at("size").at(0)).value_or(0),
                 json_count(json.at("size").at(1)).value_or(0)};
  camera.fx = matrix.at(0).at(0).get<double>();
  camera.fy = matrix.at(1).at(1).get<double>();
  camera.cx = matrix.at(0).at(2).get<double>();
  camera.cy = matrix.at(1).at(2).get<double>();
  if (json.contains("distortion"))
    for (size_t i = 0; i < camera.distortion.size() && i < json.at("distortion").size(); ++i)
      camera.distortion[i] = json.at("distortion").at(i).get<double>();
  return camera;
}

/// Whether R has the columns of a rotation.
bool turns(const std::array<double, 9>& r) {
  constexpr double kTolerance = 1e-2;
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) {
      const double product = r[i] * r[j] + r[3 + i] * r[3 + j] + r[6 + i] * r[6 + j];
      if (!(std::abs(product - (i == j ? 1 : 0)) < kTolerance)) return false;
    }
  const double det = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                     r[2] * (r[3] * r[7] - r[4] * r[6]);
  return det > 0;
}

/// Where a ray (x / z, y / z) falls, in pixels (OpenCV's model of distortion).
std::array<double, 2> seen_at(const CalibratedCamera& camera, double x, double y) {
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const double r2 = x * x + y * y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double dx = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
               dy = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  return {camera.fx * dx + camera.cx, camera.fy * dy + camera.cy};
}

/// The ray that falls on a pixel: iterated, as cv::undistortPoints does.
std::array<double, 2> ray_at(const CalibratedCamera& camera, double u, double v) {
  constexpr int kRounds = 10;
  const double u0 = (u - camera.cx) / camera.fx, v0 = (v - camera.cy) / camera.fy;
  double x = u0, y = v0;
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  for (int round = 0; round < kRounds; ++round) {
    const double r2 = x * x + y * y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const double dx = 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                 dy = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
    x = (u0 - dx) / radial;
    y = (v0 - dy) / radial;
  }
  return {x, y};
}

}  // namespace

CalibratedCamera CalibratedCamera::for_size(Extent other) const {
  CalibratedCamera scaled = *this;
  const double across = double{1} * other.width / size.width,
               down = double{1} * other.height / size.height;
  scaled.size = other;
  scaled.fx *= across;
  scaled.fy *= down;
  scaled.cx = (cx + 0.5) * across - 0.5;
  scaled.cy = (cy + 0.5) * down - 0.5;
  return scaled;
}

CalibratedCamera CalibratedCamera::with_lens(double x_focal, double y_focal, double x_center,
                                             double y_center) const {
  CalibratedCamera other = *this;
  if (x_focal > 0) other.fx = other.fy = x_focal;
  if (y_focal > 0) other.fy = y_focal;
  if (x_center > 0) other.cx = x_center;
  if (y_center > 0) other.cy = y_center;
  return other;
}

bool CalibratedCamera::usable() const {
  return size.pixels() > 0 && fx > 0 && fy > 0 && std::isfinite(fx) && std::isfinite(fy) &&
         std::isfinite(cx) && std::isfinite(cy);
}

CalibratedCamera typical_camera(Extent size) {
  constexpr double kTanHalfView = 0.6008606190275604;  // of 62 degrees
  CalibratedCamera camera{.size = size};
  camera.fx = camera.fy = size.width / (2 * kTanHalfView);
  camera.cx = (size.width - 1) / 2.0;
  camera.cy = (size.height - 1) / 2.0;
  return camera;
}

Calibration read_calibration(const std::string& path) {
  constexpr uint64_t kMaxBytes = uint64_t{1} << 20;
  std::string fault;
  const std::string text = read_file(path, kMaxBytes, fault);
  if (!fault.empty()) throw Error(ErrorKind::file, "calibration " + path + " " + fault);
  const Json json = parse_json<Json>(text, fault);
  if (!fault.empty()) throw Error(ErrorKind::file, "calibration " + path + " " + fault);
  Calibration read;
  try {
    read.color = camera_of(json.at("color"));
    read.depth = camera_of(json.at("depth"));
    if (json.at("depth").contains("unit")) read.unit = json.at("depth").at("unit").get<double>();
    if (json.contains("rotation"))
      for (size_t i = 0; i < 9; ++i)
        read.rotation[i] = json.at("rotation").at(i / 3).at(i % 3).get<double>();
    if (json.contains("translation"))
      for (size_t i = 0; i < 3; ++i)
        read.translation[i] = json.at("translation").at(i).get<double>();
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::file, path + " is no calibration: " + json_fault(error));
  }
  for (const bool color : {true, false})
    if (!(color ? read.color : read.depth).usable())
      throw Error(ErrorKind::file, path + ": the matrix of \"" + (color ? "color" : "depth") +
                                       "\" is singular; its focal lengths must be above 0");
  if (!turns(read.rotation))
    throw Error(ErrorKind::file, path +
                                     ": \"rotation\" is no rotation; its rows must be three unit "
                                     "vectors at right angles");
  if (read.unit && !(*read.unit > 0 && *read.unit < 1))
    throw Error(ErrorKind::file, path + ": \"unit\" must be the meters of a step of depth");
  return read;
}

std::array<double, 12> color_pose(const Calibration& calibration,
                                  std::span<const double, 12> depth_pose) {
  const auto& r = calibration.rotation;
  const auto& t = calibration.translation;
  std::array<double, 12> rows{};
  for (size_t i = 0; i < 3; ++i) {
    const auto from = depth_pose.subspan(4 * i).first<4>();
    double place = from[3];
    for (size_t j = 0; j < 3; ++j) {
      const double turned = from[0] * r[3 * j] + from[1] * r[3 * j + 1] + from[2] * r[3 * j + 2];
      rows[4 * i + j] = turned;
      place -= turned * t[j];
    }
    rows[4 * i + 3] = place;
  }
  return rows;
}

Registration::Registration(const Calibration& calibration, Extent depth)
    : calibration_(calibration), extent_(depth), target_(calibration.color.for_size(depth)) {
  const CalibratedCamera from = calibration.depth.for_size(depth);
  for (uint32_t y = 0; y < depth.height; ++y)
    for (uint32_t x = 0; x < depth.width; ++x) {
      const auto [rx, ry] = ray_at(from, x, y);
      rays_.push_back({static_cast<float>(rx), static_cast<float>(ry)});
    }
}

void Registration::run(const uint8_t* rows, size_t stride, double unit,
                       std::vector<uint16_t>& registered) const {
  constexpr uint16_t kFarthest = 65534;
  registered.assign(extent_.pixels(), 0);
  const auto& r = calibration_.rotation;
  const auto& t = calibration_.translation;
  const auto width = static_cast<int>(extent_.width), height = static_cast<int>(extent_.height);
  for (uint32_t y = 0; y < extent_.height; ++y)
    for (uint32_t x = 0; x < extent_.width; ++x) {
      const uint8_t* at = rows + y * stride + size_t{2} * x;
      const auto steps = static_cast<uint16_t>(at[0] | at[1] << 8);
      if (steps == 0 || steps == 65535) continue;
      const auto [rx, ry] = rays_[size_t{y} * extent_.width + x];
      const double z = steps * unit, px = double{rx} * z, py = double{ry} * z;
      const double qx = r[0] * px + r[1] * py + r[2] * z + t[0],
                   qy = r[3] * px + r[4] * py + r[5] * z + t[1],
                   qz = r[6] * px + r[7] * py + r[8] * z + t[2];
      const double out = std::round(qz / unit);
      if (!(out >= 1 && out <= kFarthest)) continue;
      const auto [u, v] = seen_at(target_, qx / qz, qy / qz);
      if (!(u > -1 && v > -1 && u < width && v < height)) continue;
      // On the four pixels around it, so that there are no cracks; the nearest surface stays.
      const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
      for (int k = 0; k < 4; ++k) {
        const int tx = left + k % 2, ty = top + k / 2;
        if (tx < 0 || ty < 0 || tx >= width || ty >= height) continue;
        uint16_t& there =
            registered[static_cast<size_t>(ty) * extent_.width + static_cast<size_t>(tx)];
        if (there == 0 || out < there) there = static_cast<uint16_t>(out);
      }
    }
}

}  // namespace inverse
