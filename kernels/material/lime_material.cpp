#include "lime_material.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "../gpu/shaders.hpp"

INVERSE_SHADER(material_crop);
INVERSE_SHADER(material_layers);
INVERSE_SHADER(material_masked);
INVERSE_SHADER(material_mirror_out);
INVERSE_SHADER(material_own);
INVERSE_SHADER(material_specular_out);

namespace inverse {
namespace {

/// Whether most of an object's points were left out, for another one's sake.
bool mostly(std::span<const uint8_t> object, std::span<const uint8_t> left_out) {
  if (left_out.empty()) return false;
  size_t points = 0, among = 0;
  for (size_t i = 0; i < object.size(); ++i) {
    points += object[i] != 0;
    among += object[i] && left_out[i];
  }
  return 2 * among > points;
}

struct Place {
  Place(Extent extent, const Square& square, uint32_t points)
      : width(static_cast<int32_t>(extent.width)),
        height(static_cast<int32_t>(extent.height)),
        x(square.x),
        y(square.y),
        pixels(square.size / static_cast<float>(points)),
        side(static_cast<int32_t>(points)) {}
  int32_t width, height;
  float x, y, pixels;
  int32_t side;
};

network::Network make(const std::shared_ptr<gpu::Device>& device, network::Graph& graph,
                      uint32_t side) {
  const network::Shape shape{graph.inputs[0].channels, side, side};
  return {device, std::move(graph), std::span(&shape, 1)};
}

}  // namespace

LimeMaterial::LimeMaterial(const std::shared_ptr<gpu::Device>& device, Extent extent,
                           LimeModels models)
    : device_(device),
      extent_(extent),
      side_(models.side),
      segmentation_(make(device, models.segmentation, side_)),
      specular_(make(device, models.specular, side_)),
      mirror_(make(device, models.mirror, side_)),
      albedo_(make(device, models.albedo, side_)),
      exponent_(make(device, models.exponent, side_)),
      crop_(device->kernel(shaders::material_crop)),
      own_(device->kernel(shaders::material_own)),
      masked_(device->kernel(shaders::material_masked)),
      specular_out_(device->kernel(shaders::material_specular_out)),
      mirror_out_(device->kernel(shaders::material_mirror_out)),
      guided_(device, side_),
      under_(device, side_),
      layers_{device->kernel(shaders::material_layers, {0}),
              device->kernel(shaders::material_layers, {1})},
      planes_(device, extent),
      tracker_(extent) {
  const auto readback = [&device](const gpu::BufferPtr& like) {
    return gpu::Buffer::create(device, gpu::Element::vec4, like->count(), gpu::Memory::readback);
  };
  for (Slot& slot : slots_) {
    slot.probability = readback(segmentation_.output(0));
    slot.albedo = readback(albedo_.output(0));
    slot.exponent = readback(exponent_.output(0));
  }
}

uint64_t LimeMaterial::network_bytes() const {
  uint64_t sum = 0;
  for (const network::Network* net : {&segmentation_, &specular_, &mirror_, &albedo_, &exponent_})
    sum += net->plan().bytes() + net->weight_bytes();
  return sum;
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
}

/// Where normals can be known.
bool LimeMaterial::wants_light(const Params& params) const {
  return params.lit && (normal_map_ || params.light.inflate);
}

NetworkSchedule::Known LimeMaterial::known(const Params& params, bool still) const {
  NetworkSchedule::Known known{.square = tracker_.square(),
                               .still = still,
                               .found = object_.found,
                               .placed = have_layers_ && tracker_.square() == estimated_in_,
                               .moved = tracker_.moved(),
                               .steady = fusion_.steady(params.steady),
                               .drawn = drawn_,
                               .lit = wants_light(params),
                               .views = light_.views(),
                               .changed = {},
                               .relit = light_.changed()};
  if (change_.kept()) known.changed = changed_;
  return known;
}

void LimeMaterial::record_segmentation(gpu::Commands& commands, const Plane& frame, Slot& slot) {
  commands.dispatch(crop_, {frame.buffer, segmentation_.input(0)},
                    Place(extent_, slot.square, side_), {side_ * side_});
  segmentation_.record(commands);
  new_mask_ = true;
  commands.stage("segmentation");
  commands.copy(segmentation_.output(0), slot.probability, slot.probability->bytes());
  // Layers and material are the followed object's alone.
  slot.left_out = tracker_.foreign(slot.square, side_);
  if (!slot.left_out.empty()) leave_out(commands, slot);
}

void LimeMaterial::leave_out(gpu::Commands& commands, Slot& slot) {
  if (!slot.foreign)
    slot.foreign =
        gpu::Buffer::create(device_, gpu::Element::word, slot.left_out.size(), gpu::Memory::upload);
  std::copy(slot.left_out.begin(), slot.left_out.end(), slot.foreign->map_as<uint32_t>());
  commands.dispatch(own_, {segmentation_.output(0), slot.foreign},
                    static_cast<int32_t>(side_ * side_), {side_ * side_});
}

void LimeMaterial::record_networks(gpu::Commands& commands, Slot& slot) {
  const auto points = static_cast<int32_t>(side_ * side_);
  const gpu::Items items{side_ * side_};
  commands.dispatch(masked_, {segmentation_.input(0), segmentation_.output(0), specular_.input(0)},
                    points, items);
  specular_.record(commands);
  commands.stage("specular");
  commands.dispatch(specular_out_,
                    {specular_.input(0), specular_.output(0), mirror_.input(0), albedo_.input(0)},
                    points, items);
  mirror_.record(commands);
  commands.stage("mirror");
  commands.dispatch(mirror_out_,
                    {specular_.input(0), mirror_.input(0), mirror_.output(0), exponent_.input(0)},
                    points, items);
  under_.record(commands, specular_.input(0), exponent_.input(0));
  commands.stage("under-highlights");
  albedo_.record(commands);
  commands.stage("albedo");
  exponent_.record(commands);
  new_codes_ = true;
  commands.stage("exponent");
  commands.copy(albedo_.output(0), slot.albedo, slot.albedo->bytes());
  commands.copy(exponent_.output(0), slot.exponent, slot.exponent->bytes());
}

void LimeMaterial::read_back(gpu::Commands& commands, const gpu::BufferPtr& source,
                             gpu::BufferPtr& copy) {
  if (!copy)
    copy = gpu::Buffer::create(source->device(), gpu::Element::vec4, source->count(),
                               gpu::Memory::readback);
  commands.copy(source, copy, copy->bytes());
}

void LimeMaterial::take_light(const Slot& slot) {
  const size_t numbers = size_t{4} * side_ * side_;
  light_.take({{slot.image->map_as<float>() + 4, numbers},
               {slot.codes->map_as<float>() + 4, numbers},
               tracker_.mask(),
               side_,
               slot.square,
               extent_},
              tracker_.box(), slot.plan.light_anew, normal_map_.get(), fusion_.material(),
              slot.params.light);
}

LimeMaterial::Layers LimeMaterial::record_layers(gpu::Commands& commands, const Plane& frame) {
  drawn_ = true;
  return draw_layers(commands, frame, object_.found && have_layers_);
}

LimeMaterial::Layers LimeMaterial::draw_layers(gpu::Commands& commands, const Plane& frame,
                                               bool known) {
  if (known && (new_mask_ || new_codes_)) {
    if (new_mask_) guided_.record_mask(commands, segmentation_.input(0), segmentation_.output(0));
    if (new_codes_) guided_.record_specular(commands, specular_.input(0), exponent_.input(0));
    new_mask_ = new_codes_ = false;
    commands.stage("guided-layers");
  }
  Layers layers{planes_.acquire(), planes_.acquire()};
  commands.dispatch(layers_[known],
                    {frame.buffer, guided_.mask(), exponent_.input(0), guided_.specular(),
                     under_.diffuse(), layers.diffuse->buffer, layers.gloss->buffer},
                    Place(extent_, estimated_in_, side_), {extent_.width, extent_.height});
  commands.stage("layers");
  return layers;
}

void LimeMaterial::warm_up() {
  gpu::Commands commands(device_);
  const PlanePtr frame = planes_.acquire();
  slots_[0].square = estimated_in_ = tracker_.square();
  commands.begin();
  commands.fill(frame->buffer);
  record_segmentation(commands, *frame, slots_[0]);
  slots_[0].left_out.resize(size_t{side_} * side_);
  leave_out(commands, slots_[0]);
  record_networks(commands, slots_[0]);
  for (const bool known : {false, true}) draw_layers(commands, *frame, known);
  commands.submit();
  commands.wait();
}

void LimeMaterial::record(gpu::Commands& commands, const Plane& frame, const Params& params,
                          bool still) {
  Slot& slot = slots_[recorded_ % slots_.size()];
  slot.params = params;
  slot.square = tracker_.square();
  slot.epoch = epoch_;
  const NetworkSchedule::Plan plan = slot.plan =
      schedule_.next({params.adaptive, params.recheck}, known(params, still));
  drawn_ = false;
  if (!wants_light(params)) light_.forget();
  if (plan.segments) record_segmentation(commands, frame, slot);
  if (plan.estimates) {
    record_networks(commands, slot);
    estimated_in_ = slot.square;
    have_layers_ = true;
  }
  if (plan.lights) read_back(commands, exponent_.input(0), slot.codes);
  if (plan.lights || plan.compares) read_back(commands, segmentation_.input(0), slot.image);
  segmentations_ += plan.segments;
  estimates_ += plan.estimates;
  slot.report = {plan.segments, plan.estimates, segmentations_, estimates_, plan.skipped};
  ++recorded_;
}

void LimeMaterial::compare(const Slot& slot) {
  const std::span image(slot.image->map_as<float>() + 4, size_t{4} * side_ * side_);
  // What has just been found anew was another picture: the next one may be, too.
  if (slot.square == estimated_in_) changed_ = change_.since(image, tracker_.mask(), side_);
  if (slot.plan.estimates) change_.keep(image, tracker_.mask(), side_);
  if (wants_light(slot.params))
    light_.compare(image, tracker_.mask(), side_,
                   slot.plan.light_anew || (slot.plan.rests && !light_.watched()),
                   tracker_.moved() < NetworkSchedule::kMoved && slot.square == estimated_in_);
}

void LimeMaterial::done(uint64_t number) {
  const Slot& slot = this->slot(number);
  if (slot.epoch != epoch_ || !slot.plan.segments) return;
  const bool was_found = tracker_.found();
  tracker_.update({slot.probability->map_as<float>() + 4, size_t{4} * side_ * side_}, side_, 4,
                  slot.square);
  if (was_found && (!tracker_.found() || tracker_.jumped())) {
    fusion_.reset();
    have_layers_ = false;
  }
  if (slot.plan.compares)
    compare(slot);
  else if (slot.plan.estimates)
    change_.reset();  // the layers are of another picture than the one that is kept
  // What was taken for another object when the frame was recorded is the one that is followed now,
  // where the one before has gone: the networks did not see it.
  const bool seen = tracker_.found() && !tracker_.misled() && !tracker_.mask().empty() &&
                    !mostly(tracker_.mask(), slot.left_out);
  if (seen && slot.plan.rests && tracker_.moved() < NetworkSchedule::kMoved)
    light_.rest(tracker_.box());
  if (seen && slot.plan.estimates) {
    const float *albedo = slot.albedo->map_as<float>() + 4,
                *bins = slot.exponent->map_as<float>() + 4;
    Material estimate;
    std::copy_n(albedo, 3, estimate.diffuse.begin());
    estimate.specular = albedo[3];
    std::copy_n(bins, Material::kBins, estimate.bins.begin());
    latest_ = estimate;
    fusion_.add(estimate, slot.params.fusion);
    if (fusion_.count() <= 1) light_.begin();  // another object, of another material
    if (slot.plan.lights && fusion_.count()) take_light(slot);
  }
  object_ = {tracker_.found(), fusion_.material(), latest_,       fusion_.averaged(),
             fusion_.spread(), tracker_.share(),   tracker_.box()};
}

}  // namespace inverse
