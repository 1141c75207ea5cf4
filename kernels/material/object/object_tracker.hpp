// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse {

/// A square of a frame, in pixels; may extend beyond the frame.
struct Square {
  float x = 0, y = 0;  ///< top left corner
  float size = 0;
  bool operator==(const Square&) const = default;
};

/// Tracks the object: analyzes the mask found in a square and selects the next square. Uses the
/// largest connected part of the mask within the frame. The object fills two thirds of the square.
/// The square does not follow small motion or growth, so that estimates stay stable. If a closer
/// square shows much less of the object, as with patterned objects, the previous square is the
/// closest for a time that grows with each failure.
class ObjectTracker {
 public:
  explicit ObjectTracker(Extent frame) : frame_(frame) { reset(); }

  /// Returns to the whole frame.
  void reset();
  /// Adds the object's probabilities at `side` x `side` points of a square, row by row, `stride`
  /// floats apart. NaN counts as 0.
  void update(std::span<const float> probabilities, uint32_t side, uint32_t stride,
              const Square& square);

  /// The next square to analyze.
  const Square& square() const { return square_; }
  bool found() const { return found_; }
  /// The last square was a closer one that lost the object: ignore its result.
  bool ambiguous() const { return ambiguous_; }
  /// The last result does not overlap the previous one: another object, as after a cut, or one too
  /// fast to track.
  bool jumped() const { return jumped_; }
  /// The object's share of the square in which it was found, 0…1.
  float share() const { return share_; }
  /// Its bounding box, in pixels of the frame.
  struct Box {
    float left = 0, top = 0, right = 0, bottom = 0;

    /// Distance of the centers, relative to the longest side of both boxes.
    float distance(const Box& other) const;
    /// Intersection area over the smaller area: 1 if one box contains the other, 0 if they are
    /// disjoint.
    float overlap(const Box& other) const;
  };
  const Box& box() const { return box_; }
  /// Its points in the last square, one byte each; empty if the object was not there.
  std::span<const uint8_t> mask() const { return before_; }
  /// For the next analysis of a square: one byte per point, 1 beyond the frame and near another
  /// object of the last analysis. Empty if no point is.
  std::vector<uint8_t> foreign(const Square& square, uint32_t side) const;
  /// Share of the object's points that changed between object and background.
  float moved() const { return moved_; }
  /// Below this share the object rests.
  static constexpr float kMoved = 0.02F;
  bool rests() const { return moved_ < kMoved; }

 private:
  Square whole() const;

  Extent frame_;
  Square square_;
  Box box_;
  bool found_ = false, ambiguous_ = false, jumped_ = false;
  uint32_t missing_ = 0;  // frames in a row
  float share_ = 0, moved_ = 1;
  float closest_ = 0;  // size of squares that is no less, pixels
  uint32_t retry_after_ = 0,
           waited_ = 0;          // searches until a closer one is tried again, and searches since
  std::vector<uint8_t> before_;  // the object's points
  std::vector<uint8_t> others_;  // those of others, and next to them; none: empty
  float before_area_ = 0;        // of the frame, pixels
  Square before_square_;
};

}  // namespace inverse
