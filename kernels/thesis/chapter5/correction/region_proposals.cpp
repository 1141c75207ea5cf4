// SPDX-License-Identifier: LGPL-2.1-or-later
#include "region_proposals.hpp"

#include <algorithm>
#include <utility>

#include "common/error.hpp"

namespace inverse {
namespace {

const MarkedRegions::Region* find(const MarkedRegions& regions, int number) {
  for (const MarkedRegions::Region& region : regions.regions())
    if (region.number == number) return &region;
  return nullptr;
}

}  // namespace

RegionProposals::RegionProposals(const std::shared_ptr<gpu::Device>& device, Extent extent,
                                 size_t max_count)
    : device_(device), extent_(extent), max_count_(max_count), survey_(device) {
  const auto part = [&](uint32_t size) { return (size - 1) / static_cast<uint32_t>(factor_) + 1; };
  do {
    small_ = {part(extent.width), part(extent.height)};
  } while (small_.pixels() > kMaxPixels && ++factor_);
}

/// Discards results that were recorded in another mode.
void RegionProposals::change(Mode mode, MarkedRegions& regions) {
  if (mode == mode_) return;
  if (mode_ == Mode::correct) {
    std::vector<int> proposed;
    for (const MarkedRegions::Region& region : regions.regions())
      if (region.proposed) proposed.push_back(region.number);
    for (const int number : proposed) regions.remove(number, MarkedRegions::Loss::withdrawn);
    for (Seen& seen : seen_) seen.region = 0;
  }
  mode_ = mode;
  quiet_ = false;
  due_ = 0;
  ++epoch_;
  if (mode == Mode::off) reset();
}

uint64_t RegionProposals::record(gpu::Commands& commands, const GlobalThesis& method,
                                 MarkedRegions& regions, Mode mode) {
  if (method.extent() != extent_)
    throw Error(ErrorKind::internal, "the proposals were made for another frame size");
  const uint64_t number = recorded_++;
  Frame& frame = frames_[number];
  frame.pending = false;
  change(mode, regions);
  if (mode == Mode::off) {
    quiet_ = true;
    due_ = recorded_;
    return number;
  }
  if (number < due_) return number;
  // From a cut on until the scene's base colors are known, clusters mean nothing.
  if (method.scene_since() == UINT64_MAX || method.colors().colors().empty()) return number;
  due_ = number + (quiet_ ? kLater : kSoon);
  const uint64_t count = small_.pixels();
  if (!pixels_) pixels_ = gpu::Buffer::create(device_, gpu::Element::vec4, count);
  if (!frame.pixels)
    frame.pixels = gpu::Buffer::create(device_, gpu::Element::vec4, count, gpu::Memory::readback);
  frame.pending = true;
  frame.mode = mode;
  frame.epoch = epoch_;
  frame.colors = method.colors().colors();
  frame.given.fill(-1);
  for (const MarkedRegions::Region& region : regions.regions())
    frame.given.at(static_cast<size_t>(region.number)) = region.color;
  commands.dispatch(survey_,
                    {.image = method.image().buffer,
                     .features = method.features(),
                     .regions = regions.plane().buffer,
                     .survey = pixels_},
                    {.size = small_, .fine_size = extent_, .factor = factor_},
                    {small_.width, small_.height});
  commands.copy(pixels_, frame.pixels, pixels_->bytes());
  commands.stage("proposals");
  return number;
}

std::vector<RegionProposals::Proposal> RegionProposals::collect(uint64_t number,
                                                                MarkedRegions& regions) {
  if (number >= recorded_ || number + frames_.size() < recorded_) return {};
  Frame& frame = frames_[number];
  if (!frame.pending) return {};
  frame.pending = false;
  if (frame.epoch != epoch_) return {};
  forget_lost(regions);
  const SurveyResult result = find_misclustered(
      {small_, {frame.pixels->map_as<float>(), 4 * small_.pixels()}, frame.colors, frame.given});
  for (Seen& seen : seen_) ++seen.misses;
  std::vector<Proposal> added;
  std::vector<int> marked;  // clusters of regions just marked
  for (const Misclustered& found : result.found) {
    const auto seen = std::find_if(seen_.begin(), seen_.end(), [&](const Seen& s) {
      const auto at = static_cast<size_t>(s.y) * small_.width + static_cast<size_t>(s.x);
      return (found.region > 0 && s.region == found.region) ||
             result.components[at] == found.component;
    });
    if (seen != seen_.end()) {
      seen->x = found.x;
      seen->y = found.y;
      seen->misses = 0;
      if (seen->refused || seen->region > 0 || frame.mode == Mode::report) continue;
    }
    if (found.region > 0) continue;  // clicked
    if (seen == seen_.end() && seen_.size() >= max_count_) continue;
    const auto of_frame = [&](int v, uint32_t size) {
      return std::min(v * factor_ + factor_ / 2, static_cast<int>(size) - 1);
    };
    const auto area = static_cast<uint64_t>(factor_) * static_cast<uint64_t>(factor_);
    Proposal proposal{of_frame(found.x, extent_.width),
                      of_frame(found.y, extent_.height),
                      static_cast<uint64_t>(found.pixels) * area,
                      found.cluster,
                      found.color,
                      found.score,
                      0};
    if (frame.mode == Mode::correct) {
      // Its color may be that of a region that was itself misclustered: the next search decides.
      if (std::find(marked.begin(), marked.end(), found.color) != marked.end()) continue;
      proposal.region = regions.propose(proposal.x, proposal.y, found.cluster, found.color);
      if (proposal.region > 0) marked.push_back(found.cluster);
    }
    if (seen != seen_.end()) {
      seen->region = proposal.region;
      if (proposal.region == 0) continue;  // reported before
    } else {
      seen_.push_back({found.x, found.y, proposal.region, 0, false});
    }
    added.push_back(proposal);
  }
  std::erase_if(seen_, [&](const Seen& seen) {
    if (seen.refused || seen.misses < kMisses) return false;
    if (seen.region > 0) regions.remove(seen.region, MarkedRegions::Loss::withdrawn);
    return true;
  });
  const bool waits = std::any_of(seen_.begin(), seen_.end(),
                                 [](const Seen& s) { return !s.refused && s.misses > 0; });
  quiet_ = added.empty() && !waits && marked.empty();
  if (!quiet_) due_ = std::min(due_, recorded_ + kSoon);
  return added;
}

/// Regions that were lost, or whose number has another region, may be proposed once more.
void RegionProposals::forget_lost(const MarkedRegions& regions) {
  for (Seen& seen : seen_) {
    if (seen.region == 0) continue;
    const MarkedRegions::Region* region = find(regions, seen.region);
    if (region && region->proposed) continue;
    seen.region = 0;
    seen.refused = ++seen.failures >= kMaxFailures;
  }
}

void RegionProposals::refuse(int region) {
  for (Seen& seen : seen_) {
    if (seen.region != region) continue;
    seen.region = 0;
    seen.refused = true;
  }
}

void RegionProposals::reset() {
  seen_.clear();
  ++epoch_;
  quiet_ = false;
  due_ = 0;
}

int RegionProposals::count() const {
  return static_cast<int>(
      std::count_if(seen_.begin(), seen_.end(), [](const Seen& s) { return !s.refused; }));
}

}  // namespace inverse
