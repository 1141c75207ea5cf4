// SPDX-License-Identifier: LGPL-2.1-or-later
#include "object_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/material_layers_layers.spv.hpp"

namespace inverse {
namespace {

constexpr float kObject = shaders::material_layers_layers::kObject;  // probability
constexpr float kMinShare = 0.005F;                                  // of the square
constexpr float kFill = 0.66F;   // of the square: target of the object's longer side
constexpr float kRest = 0.12F;   // of the square's size: smaller changes neither move nor resize it
constexpr float kMinSize = 32;   // pixels
constexpr float kCloser = 0.9F;  // ratio of sizes below which a square is a closer one
constexpr float kSame = 0.65F;   // of the object's area: below this it is another object
constexpr uint32_t kTryAgain = 60;  // analyses before a closer square that failed is tried again
constexpr uint32_t kReach = 3;      // points that another object may move between analyses
constexpr float kStays = 0.2F;  // overlap with the previous box: below this the object is elsewhere
constexpr uint32_t kMaxMissing = 3;  // frames without the object before the whole frame is searched

struct Part {
  uint32_t area = 0, left = ~0u, top = ~0u, right = 0, bottom = 0;
};

/// Dilates a mask by this number of points in rows and columns.
std::vector<uint8_t> widened(const std::vector<uint8_t>& mask, uint32_t side, uint32_t reach) {
  std::vector<uint8_t> wide = mask;
  for (const size_t step : {size_t{1}, size_t{side}}) {
    const std::vector<uint8_t> in = wide;
    for (uint32_t row = 0; row < side; ++row)
      for (uint32_t column = 0; column < side; ++column) {
        const uint32_t at = step == 1 ? column : row;
        const size_t i = size_t{row} * side + column;
        const uint32_t back = std::min(at, reach), ahead = std::min(side - 1 - at, reach);
        for (size_t k = i - back * step; k <= i + ahead * step; k += step) wide[i] |= in[k];
      }
  }
  return wide;
}

/// Keeps the largest connected part of a mask.
Part keep_largest(std::vector<uint8_t>& mask, uint32_t side) {
  std::vector<uint32_t> part_of(mask.size(), 0), open;
  std::vector<Part> parts(1);
  for (uint32_t start = 0; start < mask.size(); ++start) {
    if (!mask[start] || part_of[start]) continue;
    const auto number = static_cast<uint32_t>(parts.size());
    Part part;
    open.assign(1, start);
    part_of[start] = number;
    while (!open.empty()) {
      const uint32_t at = open.back(), x = at % side, y = at / side;
      open.pop_back();
      ++part.area;
      part.left = std::min(part.left, x);
      part.right = std::max(part.right, x + 1);
      part.top = std::min(part.top, y);
      part.bottom = std::max(part.bottom, y + 1);
      const auto visit = [&](bool inside, uint32_t next) {
        if (!inside || !mask[next] || part_of[next]) return;
        part_of[next] = number;
        open.push_back(next);
      };
      visit(x > 0, at - 1);
      visit(x + 1 < side, at + 1);
      visit(y > 0, at - side);
      visit(y + 1 < side, at + side);
    }
    parts.push_back(part);
  }
  const auto best = std::max_element(parts.begin(), parts.end(),
                                     [](const Part& a, const Part& b) { return a.area < b.area; });
  const auto kept = static_cast<uint32_t>(best - parts.begin());
  for (size_t i = 0; i < mask.size(); ++i) mask[i] = kept && part_of[i] == kept;
  return *best;
}

}  // namespace

float ObjectTracker::Box::distance(const Box& other) const {
  const float longer =
      std::max({right - left, bottom - top, other.right - other.left, other.bottom - other.top});
  return std::hypot(left + right - other.left - other.right,
                    top + bottom - other.top - other.bottom) /
         (2 * longer);
}

float ObjectTracker::Box::overlap(const Box& other) const {
  const auto area = [](const Box& box) {
    return std::max(box.right - box.left, 0.0F) * std::max(box.bottom - box.top, 0.0F);
  };
  const float both = area({std::max(left, other.left), std::max(top, other.top),
                           std::min(right, other.right), std::min(bottom, other.bottom)});
  return both / std::min(area(*this), area(other));
}

Square ObjectTracker::whole() const {
  const auto width = static_cast<float>(frame_.width), height = static_cast<float>(frame_.height);
  const float size = std::max(width, height);
  return {(width - size) / 2, (height - size) / 2, size};
}

void ObjectTracker::reset() {
  square_ = whole();
  found_ = ambiguous_ = jumped_ = false;
  missing_ = 0;
  closest_ = 0;
  retry_after_ = waited_ = 0;
  share_ = 0;
  moved_ = 1;
  before_.clear();
  others_.clear();
}

std::vector<uint8_t> ObjectTracker::foreign(const Square& square, uint32_t side) const {
  std::vector<uint8_t> foreign;
  const float scale = square.size / static_cast<float>(side);
  const auto side_before = static_cast<uint32_t>(std::lround(std::sqrt(others_.size())));
  for (uint32_t row = 0; row < side; ++row)
    for (uint32_t column = 0; column < side; ++column) {
      const float left = square.x + scale * static_cast<float>(column),
                  top = square.y + scale * static_cast<float>(row);
      bool is = left + scale <= 0 || left >= static_cast<float>(frame_.width) || top + scale <= 0 ||
                top >= static_cast<float>(frame_.height);
      if (!is && side_before > 0) {
        const float to = static_cast<float>(side_before) / before_square_.size;
        const float x = (left + scale / 2 - before_square_.x) * to,
                    y = (top + scale / 2 - before_square_.y) * to;
        const auto end = static_cast<float>(side_before);
        is = x >= 0 && y >= 0 && x < end && y < end &&
             others_[static_cast<size_t>(y) * side_before + static_cast<size_t>(x)];
      }
      if (!is) continue;
      if (foreign.empty()) foreign.resize(size_t{side} * side);
      foreign[size_t{row} * side + column] = 1;
    }
  return foreign;
}

void ObjectTracker::update(std::span<const float> probabilities, uint32_t side, uint32_t stride,
                           const Square& square) {
  if (side == 0) return;
  std::vector<uint8_t> mask(size_t{side} * side);
  const float scale = square.size / static_cast<float>(side);
  // Beyond the frame the networks see its extended border: results there are invalid.
  const auto within = [&](float corner, uint32_t point, uint32_t size) {
    const float start = corner + scale * static_cast<float>(point);
    return start + scale > 0 && start < static_cast<float>(size);
  };
  for (uint32_t row = 0; row < side; ++row)
    for (uint32_t column = 0; column < side; ++column) {
      const size_t i = size_t{row} * side + column;
      mask[i] = within(square.x, column, frame_.width) && within(square.y, row, frame_.height) &&
                probabilities[i * stride] > kObject;
    }
  std::vector<uint8_t> others = mask;
  const Part part = keep_largest(mask, side);
  const float area = static_cast<float>(part.area) * scale * scale;
  jumped_ = false;
  ambiguous_ = found_ && square.size < kCloser * before_square_.size && area < kSame * before_area_;
  if (ambiguous_) {
    moved_ = 1;
    if (square_ == before_square_) return;  // a search that was in flight
    square_ = before_square_;
    closest_ = square_.size;
    retry_after_ = std::max(2 * retry_after_, kTryAgain);
    waited_ = 0;
    return;
  }
  share_ = static_cast<float>(part.area) / static_cast<float>(mask.size());
  if (share_ < kMinShare) {
    moved_ = 1;
    before_.clear();
    others_.clear();
    if (++missing_ >= kMaxMissing || !found_) reset();
    return;
  }
  const bool known = found_;
  found_ = true;
  missing_ = 0;

  moved_ = 1;
  if (before_.size() == mask.size() && before_square_ == square) {
    uint32_t differ = 0;
    for (size_t i = 0; i < mask.size(); ++i) differ += mask[i] != before_[i];
    moved_ = std::min(1.0F, static_cast<float>(differ) / static_cast<float>(part.area));
  }
  bool alone = true;
  for (size_t i = 0; i < mask.size(); ++i) alone &= !(others[i] -= mask[i]);
  others_.clear();
  if (!alone) {
    others_ = widened(others, side, kReach);
    const std::vector<uint8_t> own = widened(mask, side, 1);
    for (size_t i = 0; i < own.size(); ++i) others_[i] &= !own[i];
  }
  if (closest_ > 0 && ++waited_ > retry_after_) closest_ = 0;
  before_ = std::move(mask);
  before_area_ = area;
  before_square_ = square;

  const auto width = static_cast<float>(frame_.width), height = static_cast<float>(frame_.height);
  const Box before =
      std::exchange(box_, {std::max(square.x + scale * static_cast<float>(part.left), 0.0F),
                           std::max(square.y + scale * static_cast<float>(part.top), 0.0F),
                           std::min(square.x + scale * static_cast<float>(part.right), width),
                           std::min(square.y + scale * static_cast<float>(part.bottom), height)});
  jumped_ = known && box_.overlap(before) < kStays;
  // Cut by the square but not by the frame: the object extends beyond it.
  const bool cut = (part.left == 0 && box_.left > 0) || (part.top == 0 && box_.top > 0) ||
                   (part.right == side && box_.right < width) ||
                   (part.bottom == side && box_.bottom < height);
  const float longer = std::max(box_.right - box_.left, box_.bottom - box_.top);
  const float largest = whole().size;
  const float smallest = std::min(std::max(kMinSize, closest_), largest);
  const float size = std::clamp(longer / kFill * (cut ? 1.3F : 1.0F), smallest, largest);
  const float middle_x = (box_.left + box_.right) / 2, middle_y = (box_.top + box_.bottom) / 2;
  const Square wanted{middle_x - size / 2, middle_y - size / 2, size};
  const float off = std::max({std::fabs(wanted.size - square_.size),
                              std::fabs(middle_x - square_.x - square_.size / 2),
                              std::fabs(middle_y - square_.y - square_.size / 2)});
  if (off > kRest * square_.size || cut) square_ = wanted;
}

}  // namespace inverse
