// SPDX-License-Identifier: LGPL-2.1-or-later
// Reflectance clusters (section 3.4.4) in double precision: histogram, temporal average, weighted
// k-means, merging. This is the specification of kernels/palette.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// The fields are documented in kernels/palette/palette.hpp.
struct PaletteParams {
  int clusters = 10;
  int iterations = 8;
  double decay = 0.1;
  double apart = 0;
  double fade = 0.1;  ///< for bins that are empty in a frame
  double tau_cc = 0.05;
  double tau_intensity = 0.15;
  double chroma_floor = 3e-3;
  double white_quantile = 0.995;
  double white_level = 0.95;
  std::uint32_t seed = 1;
};

constexpr int kHistogramBins = 30;  ///< per channel
constexpr int kScaleBins = 2048;    ///< of ln R from −16 to 16

/// One bin of the histogram: number of pixels and the sum of their colors.
using HistogramBin = Vec4;

class Palette {
 public:
  struct Cluster {
    Vec3 color{};       ///< linear reflectance in the palette's scale
    double weight = 0;  ///< pixels; 0: the cluster is unused
    int alias = 0;      ///< the lower index that it was merged into, or its own
    Vec3 merged{};      ///< color after merging, for representatives
  };

  explicit Palette(const PaletteParams& params) : params_(params) {}

  /// Adds a frame's log reflectance (rgb) and updates scale, histogram and clusters.
  void update(const Plane& log_reflectance);

  /// Representatives with pixels, as log reflectance in the solver's scale.
  std::vector<Vec3> log_colors() const;

  /// ln of the factor by which reflectance is scaled: e^(r + scale) has its quantile at 0.95.
  double scale() const { return scale_; }
  const std::vector<Cluster>& clusters() const { return clusters_; }
  const std::vector<HistogramBin>& histogram() const { return histogram_; }

  /// The scale of one frame, before averaging over time.
  double frame_scale(const Plane& log_reflectance) const;

  /// The parts of update, for the tests.
  std::vector<HistogramBin> count(const Plane& log_reflectance) const;
  void seed_clusters();
  void lloyd();
  void merge();
  void set_clusters(std::vector<Cluster> clusters) { clusters_ = std::move(clusters); }

 private:
  PaletteParams params_;
  std::uint32_t frame_ = 0;
  double scale_ = 0;
  std::vector<HistogramBin> histogram_;
  std::vector<Cluster> clusters_;
};

/// The color nearest to r by Euclidean distance; ties go to the lowest index. `colors` not empty.
std::size_t nearest_color(const Vec4& r, const std::vector<Vec3>& colors);

/// Every pixel's nearest color and its position in `colors` (w); empty if there are no colors.
Plane clustered(const Plane& r, const std::vector<Vec3>& colors);

}  // namespace inverse::reference
