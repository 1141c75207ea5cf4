// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_history.hpp"

#include <utility>

namespace inverse {
namespace {

constexpr float kElsewhere = 0.25F;  // of the object's size: the light may differ at a greater
                                     // distance

}  // namespace

void LightHistory::begin() {
  light_.reset();
  at_.reset();
}

void LightHistory::forget() {
  begin();
  known_ = nullptr;
  change_.reset();
  changed_ = {};
}

void LightHistory::rest(const ObjectTracker::Box& here) {
  if (!at_ || at_->distance(here) < kElsewhere) return;
  light_.shorten(1);
  at_ = here;
}

void LightHistory::take(const ObjectLight::View& view, const ObjectTracker::Box& here, bool restart,
                        const std::shared_ptr<const NormalMap>& map, const Material& material,
                        const ObjectLight::Params& params) {
  if (restart) light_.reset();
  if (!at_) at_ = here;
  light_.add(view, map, params);
  if (auto light = light_.light(material, params)) known_ = std::move(light);
}

void LightHistory::compare(std::span<const float> image, std::span<const uint8_t> mask,
                           uint32_t side, bool begins, bool in_place) {
  if (begins) change_.keep(image, mask, side);
  changed_ = change_.since(image, mask, side);
  if (!in_place || changed_.moved >= ObjectTracker::kMoved) change_.reset();
}

std::optional<CropChange::Difference> LightHistory::changed() const {
  if (!change_.kept()) return std::nullopt;
  return changed_;
}

}  // namespace inverse
