// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernels/camera/camera.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// A camera as OpenCV calibrates it.
struct CalibratedCamera {
  Extent size;                            ///< of the pictures that it was calibrated with
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
  std::array<double, 5> distortion{};     ///< k1, k2, p1, p2, k3

  /// The lens for pictures of another size that show the same.
  CalibratedCamera for_size(Extent other) const;
  /// The same with these numbers, as far as they are above 0; fy is as fx if only that is.
  CalibratedCamera with_lens(double fx, double fy, double cx, double cy) const;
  /// Whether its focal lengths are above 0, and all is finite.
  bool usable() const;
};

/// A view of 62 degrees across, as depth cameras have.
CalibratedCamera typical_camera(Extent size);

/// A camera for color and one for depth. A point x of the depth camera, in meters, is rotation x +
/// translation in the color camera's axes, as cv::stereoCalibrate has it with depth as the first
/// one.
struct Calibration {
  CalibratedCamera color, depth;
  std::optional<double> unit;  ///< meters of a step of depth
  std::array<double, 9> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<double, 3> translation{};
};

/// Reads a JSON file:
///   {"color": {"size": [640, 480], "matrix": [[fx, 0, cx], [0, fy, cy], [0, 0, 1]],
///              "distortion": [k1, k2, p1, p2, k3]},
///    "depth": {the same, "unit": 0.001}, "rotation": [3 rows of 3], "translation": [x, y, z]}
/// distortion, unit, rotation and translation may be missing. Throws Error(file).
Calibration read_calibration(const std::string& path);

/// The pose of the color camera (rows as in GstInverseDepthMeta) where the depth camera has this
/// one.
std::array<double, 12> color_pose(const Calibration& calibration,
                                  std::span<const double, 12> depth_pose);

/// What a camera for depth sees, as the color camera sees it.
class Registration {
 public:
  /// `depth`: the size of depth images; those that `run` makes have it, too.
  Registration(const Calibration& calibration, Extent depth);
  /// `rows`: 16 bits a pixel, `stride` bytes from row to row; 0 and 65535 are unknown; `unit`
  /// meters a step. Writes steps of the same unit, 0 where nothing falls.
  void run(const uint8_t* rows, size_t stride, double unit,
           std::vector<uint16_t>& registered) const;
  /// Of what `run` makes.
  const CalibratedCamera& lens() const { return target_; }

 private:
  Calibration calibration_;
  Extent extent_;
  CalibratedCamera target_;
  std::vector<std::array<float, 2>> rays_;  // of pixels: x / z and y / z without distortion
};

}  // namespace inverse
