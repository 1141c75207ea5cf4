// SPDX-License-Identifier: LGPL-2.1-or-later
#include "marked_regions.hpp"

#include <algorithm>
#include <cstring>

#include "common/error.hpp"

namespace inverse {
namespace {

constexpr uint32_t kFewPixels = 32;  // smaller regions may grow as if they had as many
// The layout of orders and counts is in regions.glsl.
using Shader = shaders::thesis_chapter5_regions_regions_probe;
constexpr uint64_t kNumbers = Shader::kMaxRegions;
static_assert(kNumbers == MarkedRegions::kMaxRegions + 1 &&
              Shader::kMaxClicks == MarkedRegions::kMaxClicks);
constexpr uint64_t kCounts = 2 * kNumbers;
constexpr uint64_t kClicksAt = 2 * kNumbers;
constexpr uint64_t kOrders = kClicksAt + 4 * MarkedRegions::kMaxClicks;

/// Rank of a claim on a component; the highest wins. Clicks outrank proposals, also later ones,
/// which are of an earlier frame.
enum class Rank : uint32_t { proposed, tracked_proposal, tracked, clicked };

uint32_t claim(const MarkedRegions::Region& region, bool continued) {
  const Rank rank = region.proposed ? (continued ? Rank::tracked_proposal : Rank::proposed)
                                    : (continued ? Rank::tracked : Rank::clicked);
  return static_cast<uint32_t>(region.number) +
         static_cast<uint32_t>(kNumbers) * static_cast<uint32_t>(rank);
}

}  // namespace

MarkedRegions::MarkedRegions(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      components_(device, extent),
      probe_(device),
      click_(device),
      mark_(device),
      claims_(gpu::Buffer::create(device, gpu::Element::word, extent.pixels())),
      plane_(gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels())),
      clusters_(gpu::Buffer::create(device, gpu::Element::word, kNumbers)),
      counts_(gpu::Buffer::create(device, gpu::Element::word, kCounts)) {
  static_assert(kMaxClicks >= kMaxRegions);  // every waiting click has a number
  for (Frame& frame : frames_) {
    frame.orders = gpu::Buffer::create(device, gpu::Element::word, kOrders, gpu::Memory::upload);
    frame.clusters =
        gpu::Buffer::create(device, gpu::Element::word, kNumbers, gpu::Memory::readback);
    frame.counts = gpu::Buffer::create(device, gpu::Element::word, kCounts, gpu::Memory::readback);
  }
}

/// `number` is chosen here. Returns it, or 0.
int MarkedRegions::add(const Click& click, int color, bool proposed) {
  if (click.x < 0 || click.y < 0 || static_cast<uint32_t>(click.x) >= extent_.width ||
      static_cast<uint32_t>(click.y) >= extent_.height) {
    return 0;
  }
  int number = 1;
  while (number <= kMaxRegions && std::any_of(regions_.begin(), regions_.end(),
                                              [&](const Region& r) { return r.number == number; }))
    ++number;
  if (number > kMaxRegions) {
    const Region* smallest = nullptr;
    for (const Region& region : regions_)
      if (region.proposed && (!smallest || region.pixels < smallest->pixels)) smallest = &region;
    if (proposed || !smallest) return 0;
    number = smallest->number;
    remove(number, Loss::made_room);
  }
  Region region{number, -1, color};
  region.proposed = proposed;
  regions_.push_back(region);
  waiting_.push_back({click.x, click.y, number, click.cluster});
  return number;
}

int MarkedRegions::click(int x, int y) { return add({x, y, 0, -1}, -1, false); }

int MarkedRegions::propose(int x, int y, int cluster, int color) {
  return add({x, y, 0, std::max(cluster, -1)}, std::max(color, -1), true);
}

void MarkedRegions::set_color(int number, int slot) {
  for (Region& region : regions_)
    if (region.number == number) region.color = std::max(slot, -1);
}

bool MarkedRegions::remove(int number, Loss loss) {
  std::erase_if(waiting_, [&](const Click& click) { return click.number == number; });
  if (!std::erase_if(regions_, [&](const Region& region) { return region.number == number; }))
    return false;
  lost_.push_back({number, loss});
  return true;
}

void MarkedRegions::reset(Loss loss) {
  for (const Region& region : regions_) lost_.push_back({region.number, loss});
  regions_.clear();
  waiting_.clear();
  clear_ = true;
  ++epoch_;
}

void MarkedRegions::record(gpu::Commands& commands, const Plane& features) {
  if (features.extent != extent_)
    throw Error(ErrorKind::internal, "the regions were made for another frame size");
  const gpu::Items pixels{extent_.width, extent_.height};
  Shader::Push push{.size = extent_, .clicks = 0};
  if (clear_) {
    commands.fill(plane_);
    commands.fill(clusters_);
    clear_ = false;
  }
  const uint64_t number = recorded_++;
  Frame& frame = frames_[number];
  frame.epoch = epoch_;
  frame.collected = false;
  auto* orders = frame.orders->map_as<uint32_t>();
  std::memset(orders, 0, kOrders * sizeof(uint32_t));
  const size_t clicks = waiting_.size();
  for (size_t i = 0; i < clicks; ++i) {
    uint32_t* order = orders + kClicksAt + 4 * i;
    order[0] = static_cast<uint32_t>(waiting_[i].x);
    order[1] = static_cast<uint32_t>(waiting_[i].y);
    order[3] = static_cast<uint32_t>(waiting_[i].cluster + 1);
  }
  for (Region& region : regions_) {
    orders[region.number] = static_cast<uint32_t>(region.color + 1);
    if (region.since < number)
      orders[kNumbers + static_cast<uint64_t>(region.number)] = claim(region, true);
    for (size_t i = 0; i < clicks; ++i) {
      if (waiting_[i].number != region.number) continue;
      orders[kClicksAt + 4 * i + 2] = claim(region, false);
      region.since = number;
    }
  }
  waiting_.clear();

  components_.record(commands, features.buffer);
  commands.fill(claims_);
  commands.fill(counts_);
  commands.dispatch(probe_,
                    {.features = features.buffer,
                     .regions = plane_,
                     .clusters = clusters_,
                     .roots = components_.roots(),
                     .claims = claims_,
                     .orders = frame.orders,
                     .counts = counts_},
                    push, pixels);
  if (clicks > 0) {
    push.clicks = static_cast<int32_t>(clicks);
    commands.dispatch(click_,
                      {.features = features.buffer,
                       .orders = frame.orders,
                       .clusters = clusters_,
                       .roots = components_.roots(),
                       .claims = claims_},
                      push, {kMaxClicks});
  }
  commands.dispatch(mark_,
                    {.claims = claims_,
                     .orders = frame.orders,
                     .roots = components_.roots(),
                     .regions = plane_,
                     .counts = counts_},
                    push, pixels);
  commands.copy(clusters_, frame.clusters, kNumbers * sizeof(uint32_t));
  commands.copy(counts_, frame.counts, kCounts * sizeof(uint32_t));
}

void MarkedRegions::collect(uint64_t number) {
  if (number >= recorded_ || number + frames_.size() < recorded_) return;
  Frame& frame = frames_[number];
  if (frame.collected) return;
  frame.collected = true;
  if (frame.epoch != epoch_) return;
  const auto* clusters = frame.clusters->map_as<uint32_t>();
  const auto* counts = frame.counts->map_as<uint32_t>();
  for (Region& region : regions_) {
    if (region.since > number) continue;
    region.cluster = static_cast<int>(clusters[region.number]) - 1;
    const uint32_t before = std::exchange(region.pixels, counts[region.number]);
    if (region.since < number && before > 0 &&
        region.pixels > kMaxGrowth * std::max(before, kFewPixels)) {
      lost_.push_back({region.number, Loss::spilled});
      region.pixels = 0;
      continue;
    }
    if (region.pixels > 0) continue;
    const bool claimed = region.since == number
                             ? region.cluster >= 0
                             : counts[kNumbers + static_cast<size_t>(region.number)] > 0;
    const Loss alone = region.since == number ? Loss::nothing_there : Loss::lost;
    lost_.push_back({region.number, claimed ? Loss::taken_over : alone});
  }
  std::erase_if(regions_,
                [&](const Region& region) { return region.since <= number && region.pixels == 0; });
}

}  // namespace inverse
