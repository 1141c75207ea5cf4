// Base colors: modes of the log chroma that is left when the tint of the light is divided out.
#pragma once

#include <optional>

#include "global_color.hpp"

namespace inverse::reference::global {

/// A square histogram over log chroma, with hat functions; gray is a bin's center, or it would be
/// the corner of four.
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
  double smoothing = 1.2;      ///< Standard deviation, bins.
  double least_share = 0.004;  ///< Of all mass, for a mode to count.
  int most = 16;               ///< Base colors at most, 1 ... 16.
  double same = 0.3;           ///< Log chroma up to which a mode continues a base color.
  double follow = 0.1;         ///< Share of the newest frame in where a base color usually is.
  int keep = 50;     ///< Frames that a base color without a mode stays, where half of the least
                     ///< share is left ...
  int around = 2;    ///< ... in bins up to so many away from where it usually is.
  int forget = 250;  ///< Frames after which its slot is another's.
};

/// Base colors in slots that keep their number over time.
struct BaseColors {
  /// Of a slot, while it is one color's, seen or not.
  struct Memory {
    Chroma usual;    ///< Where its modes were, on a decaying average.
    int absent = 0;  ///< Frames since it had one.
  };
  std::vector<std::optional<Chroma>> color;   ///< Per slot, where there is such a color.
  std::vector<std::optional<Memory>> memory;  ///< Per slot.
  std::vector<int> label;                     ///< Per bin of the histogram: its slot.
  int used() const;
};

/// Modes of the histogram: every bin of its smoothed self climbs to its largest neighbor; peaks of
/// little mass fall to the nearest center. `before` gives slots to what it already knew, nearest
/// pairs first; a color that it knew and that has no mode now stays a while, in the basin that it
/// fell into, and bins of a basin belong to the nearest of its colors.
BaseColors find_modes(const ChromaHistogram& histogram, const BaseColors& before,
                      const PaletteParams& params);

}  // namespace inverse::reference::global
