#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse {

/// A square of a frame, in pixels; may reach over its borders.
struct Square {
  float x = 0, y = 0;  ///< top left corner
  float size = 0;
  bool operator==(const Square&) const = default;
};

/// Where the object is: looks at the mask that was found in a square, and says where to look next.
/// The largest connected part of a mask within the frame counts. The square is chosen so that the
/// object fills two thirds of it, and stays where it is while the object moves or grows little, so
/// that what is estimated from it stays alike. Where a closer look finds much less of it, as it
/// does with things that have things on them, the square before is as close as it gets, for a while
/// that grows each time.
class ObjectTracker {
 public:
  explicit ObjectTracker(Extent frame) : frame_(frame) { reset(); }

  /// Back to looking at the whole frame.
  void reset();
  /// Takes the probabilities of the object at `side` x `side` points of a square, row by row,
  /// `stride` floats apart. Numbers that are none count as 0.
  void update(std::span<const float> probabilities, uint32_t side, uint32_t stride,
              const Square& square);

  /// Where to look next.
  const Square& square() const { return square_; }
  bool found() const { return found_; }
  /// The last look was a closer one that lost the object: what it showed is of something else.
  bool misled() const { return misled_; }
  /// What was found in the last look is elsewhere than what was before: another object, as after a
  /// cut, or one that moves faster than looks follow it.
  bool jumped() const { return jumped_; }
  /// The object's share of the square where it was found, 0…1.
  float share() const { return share_; }
  /// The box around it, in pixels of the frame.
  struct Box {
    float left = 0, top = 0, right = 0, bottom = 0;

    /// Of the middles, over the longer of the longer sides.
    float distance(const Box& other) const;
    /// What both cover over what the smaller one does: 1 where one lies in the other, 0 of boxes
    /// apart.
    float overlap(const Box& other) const;
  };
  const Box& box() const { return box_; }
  /// Its points in the square that was looked at last, a byte each; empty where it was not there.
  std::span<const uint8_t> mask() const { return before_; }
  /// Of the next look at a square: a byte for each of its points, 1 for what is beyond the frame,
  /// and where another object than this one was in the last look, or near it. Empty where there is
  /// no such point.
  std::vector<uint8_t> foreign(const Square& square, uint32_t side) const;
  /// Share of the object's points that are no longer, or were not before, of the object.
  float moved() const { return moved_; }
  /// Less than this is rest.
  static constexpr float kMoved = 0.02F;
  bool rests() const { return moved_ < kMoved; }

 private:
  Square whole() const;

  Extent frame_;
  Square square_;
  Box box_;
  bool found_ = false, misled_ = false, jumped_ = false;
  uint32_t missing_ = 0;  // frames in a row
  float share_ = 0, moved_ = 1;
  float closest_ = 0;                   // size of squares that is no less, pixels
  uint32_t patience_ = 0, waited_ = 0;  // looks until a closer one is tried again, and since
  std::vector<uint8_t> before_;         // the object's points
  std::vector<uint8_t> others_;         // those of others, and next to them; none: empty
  float before_area_ = 0;               // of the frame, pixels
  Square before_square_;
};

}  // namespace inverse
