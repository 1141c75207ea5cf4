// SPDX-License-Identifier: LGPL-2.1-or-later
// Base colors: modes of the log chroma after the light's tint is divided out.
#pragma once

#include <optional>

#include "global_color.hpp"

namespace inverse::reference::global {

/// A square histogram over log chroma with hat functions; gray is at the center of a bin.
class ChromaHistogram {
 public:
  ChromaHistogram(int bins, double width);
  void add(const Chroma& c, double weight);
  int bins() const { return bins_; }
  double width() const { return width_; }
  /// Center of a bin.
  Chroma center(std::size_t bin) const;
  /// The bin whose center is nearest.
  std::size_t nearest(const Chroma& c) const;
  std::vector<double>& values() { return values_; }
  const std::vector<double>& values() const { return values_; }
  double total() const;
  /// - sum p ln p of the normalized bins.
  double entropy() const;

 private:
  int bins_;
  double width_;
  std::vector<double> values_;
};

struct PaletteParams {
  int bins = 64;
  double bin_width = 0.08;
  double smoothing = 1.2;    ///< Standard deviation, bins.
  double min_share = 0.004;  ///< Of all mass, for a mode.
  int most = 16;             ///< Base colors at most, 1 ... 16.
  double same = 0.3;         ///< Log chroma up to which a mode continues a base color.
  double follow = 0.1;       ///< Weight of the newest frame in a base color's mean position.
  int keep = 50;     ///< Frames for which a base color without a mode remains, if half of min_share
                     ///< is left
  int around = 2;    ///< in this many bins around its mean position.
  int forget = 250;  ///< Frames after which its slot is free.
};

/// Base colors in slots that keep their number over time.
struct BaseColors {
  /// State of a slot in use.
  struct Memory {
    Chroma usual;    ///< Running mean of the positions of its modes.
    int absent = 0;  ///< Frames since it had one.
  };
  std::vector<std::optional<Chroma>> color;   ///< Per slot; empty without a mode.
  std::vector<std::optional<Memory>> memory;  ///< Per slot.
  std::vector<int> label;                     ///< Per bin of the histogram: its slot.
  int used() const;
};

/// Modes of the histogram: every bin of the smoothed histogram climbs to its largest neighbor;
/// small peaks are merged into the nearest center. Modes continue the slots of `before`, nearest
/// pairs first. A base color without a mode remains for a while in the basin that contains it; bins
/// of a basin belong to the nearest of its colors.
BaseColors find_modes(const ChromaHistogram& histogram, const BaseColors& before,
                      const PaletteParams& params);

}  // namespace inverse::reference::global
