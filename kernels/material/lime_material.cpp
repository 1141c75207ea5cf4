// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lime_material.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace inverse {
namespace {

/// Whether most of an object's points were masked out because of another object.
bool mostly(std::span<const uint8_t> object, std::span<const uint8_t> foreign_mask) {
  if (foreign_mask.empty()) return false;
  size_t points = 0, among = 0;
  for (size_t i = 0; i < object.size(); ++i) {
    points += object[i] != 0;
    among += object[i] && foreign_mask[i];
  }
  return 2 * among > points;
}

gpu::BufferPtr readback(const gpu::BufferPtr& like) {
  return gpu::Buffer::create(like->device(), gpu::Element::vec4, like->count(),
                             gpu::Memory::readback);
}

/// Values of all points in a readback buffer, after its first vec4.
std::span<const float> points(const gpu::BufferPtr& copy) {
  return std::span<const float>(copy->map_as<float>(), size_t{4} * copy->count()).subspan(4);
}

}  // namespace

LimeMaterial::LimeMaterial(const std::shared_ptr<gpu::Device>& device, Extent extent,
                           LimeModels models)
    : device_(device),
      extent_(extent),
      networks_(device, extent, std::move(models)),
      tracker_(extent) {
  for (Slot& slot : slots_) {
    slot.probability = readback(networks_.probability());
    slot.albedo = readback(networks_.albedo());
    slot.exponent = readback(networks_.bins());
  }
}

void LimeMaterial::reset() {
  tracker_.reset();
  fusion_.reset();
  object_ = {};
  have_layers_ = false;
  change_.reset();
  changed_ = {};
  schedule_.restart();
  light_.forget();
  ++epoch_;
  ++message_count_;
}

/// Whether the light is requested and normals are available.
bool LimeMaterial::finds_light(const Params& params) const {
  return params.light_asked && (normal_map_ || params.light.inflate);
}

NetworkSchedule::Known LimeMaterial::known(const Params& params, bool unchanged) const {
  NetworkSchedule::Known known{.square = tracker_.square(),
                               .unchanged = unchanged,
                               .found = object_.found,
                               .placed = have_layers_ && tracker_.square() == estimated_in_,
                               .moved = tracker_.moved(),
                               .converged = fusion_.converged(params.converged_error),
                               .draws = params.layers_asked,
                               .finds_light = finds_light(params),
                               .views = light_.views(),
                               .changed = {},
                               .light_changed = light_.changed()};
  if (change_.kept()) known.changed = changed_;
  return known;
}

void LimeMaterial::find_object(gpu::Commands& commands, const Plane& frame, Slot& slot) {
  networks_.record_mask(commands, frame, slot.square);
  commands.copy(networks_.probability(), slot.probability, slot.probability->bytes());
  // Layers and material belong to the tracked object alone.
  slot.foreign_mask = tracker_.foreign(slot.square, networks_.side());
  if (slot.foreign_mask.empty()) return;
  if (!slot.foreign)
    slot.foreign = gpu::Buffer::create(device_, gpu::Element::word, slot.foreign_mask.size(),
                                       gpu::Memory::upload);
  std::copy(slot.foreign_mask.begin(), slot.foreign_mask.end(), slot.foreign->map_as<uint32_t>());
  networks_.record_foreign(commands, slot.foreign);
}

void LimeMaterial::estimate(gpu::Commands& commands, Slot& slot) {
  networks_.record_material(commands);
  commands.copy(networks_.albedo(), slot.albedo, slot.albedo->bytes());
  commands.copy(networks_.bins(), slot.exponent, slot.exponent->bytes());
  estimated_in_ = slot.square;
  have_layers_ = true;
}

void LimeMaterial::read_back(gpu::Commands& commands, const gpu::BufferPtr& source,
                             gpu::BufferPtr& copy) {
  if (!copy) copy = readback(source);
  commands.copy(source, copy, copy->bytes());
}

void LimeMaterial::take_light(const Slot& slot) {
  light_.take({points(slot.image), points(slot.codes), tracker_.mask(), networks_.side(),
               slot.square, extent_},
              tracker_.box(), slot.plan.light_restarts, normal_map_, fusion_.material(),
              slot.params.light);
}

LimeMaterial::Layers LimeMaterial::record_layers(gpu::Commands& commands, const Plane& frame) {
  return object_.found && have_layers_ ? networks_.record_layers(commands, frame, estimated_in_)
                                       : networks_.record_bare_layers(commands, frame);
}

void LimeMaterial::record(gpu::Commands& commands, const Plane& frame, const Params& params,
                          bool unchanged) {
  Slot& slot = slots_[recorded_];
  slot.params = params;
  slot.square = tracker_.square();
  slot.epoch = epoch_;
  const NetworkSchedule::Plan plan = slot.plan =
      schedule_.next({params.adaptive, params.estimate_interval}, known(params, unchanged));
  if (!finds_light(params)) {
    message_count_ += light_.light() != nullptr;
    light_.forget();
  }
  if (plan.segments) find_object(commands, frame, slot);
  if (plan.estimates) estimate(commands, slot);
  if (plan.lights) read_back(commands, networks_.codes(), slot.codes);
  if (plan.lights || plan.compares) read_back(commands, networks_.picture(), slot.image);
  message_count_ += plan.segments && object_.found;
  segmentations_ += plan.segments;
  estimates_ += plan.estimates;
  slot.report = {plan.segments, plan.estimates, segmentations_, estimates_, plan.skipped};
  ++recorded_;
}

void LimeMaterial::compare(const Slot& slot) {
  const std::span<const float> image = points(slot.image);
  const uint32_t side = networks_.side();
  // What has just been found again was another picture: the next one may be, too.
  if (slot.square == estimated_in_) changed_ = change_.since(image, tracker_.mask(), side);
  if (slot.plan.estimates) change_.keep(image, tracker_.mask(), side);
  if (finds_light(slot.params))
    light_.compare(image, tracker_.mask(), side,
                   slot.plan.light_restarts || (slot.plan.static_object && !light_.watched()),
                   tracker_.rests() && slot.square == estimated_in_);
}

void LimeMaterial::done(uint64_t number) {
  const Slot& slot = this->slot(number);
  if (slot.epoch != epoch_ || !slot.plan.segments) return;
  const bool was_found = tracker_.found();
  tracker_.update(points(slot.probability), networks_.side(), 4, slot.square);
  message_count_ += was_found || tracker_.found();
  if (was_found && (!tracker_.found() || tracker_.jumped())) {
    fusion_.reset();
    have_layers_ = false;
  }
  if (slot.plan.compares)
    compare(slot);
  else if (slot.plan.estimates)
    change_.reset();  // the layers are of another picture than the one that is kept
  // Points that were masked out as another object when the frame was recorded may now be the
  // tracked object, after the first one left: the networks did not process it.
  const bool seen = tracker_.found() && !tracker_.ambiguous() && !tracker_.mask().empty() &&
                    !mostly(tracker_.mask(), slot.foreign_mask);
  if (seen && slot.plan.static_object && tracker_.rests()) light_.rest(tracker_.box());
  if (seen && slot.plan.estimates) {
    const std::span<const float> albedo = points(slot.albedo), bins = points(slot.exponent);
    std::copy_n(albedo.begin(), 3, latest_.diffuse.begin());
    latest_.specular = albedo[3];
    std::copy_n(bins.begin(), Material::kBins, latest_.bins.begin());
    fusion_.add(latest_, slot.params.fusion);
    if (fusion_.count() <= 1) light_.begin();  // another object, of another material
    if (slot.plan.lights && fusion_.count()) take_light(slot);
  }
  object_ = {tracker_.found(), fusion_.material(), latest_,       fusion_.averaged(),
             fusion_.spread(), tracker_.share(),   tracker_.box()};
}

}  // namespace inverse
