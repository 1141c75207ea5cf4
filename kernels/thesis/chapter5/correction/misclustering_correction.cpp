// SPDX-License-Identifier: LGPL-2.1-or-later
#include "misclustering_correction.hpp"

#include <algorithm>

namespace inverse {
namespace {

bool has(const std::vector<std::pair<int, uint64_t>>& list, const MarkedRegions::Region& region) {
  return std::find(list.begin(), list.end(), std::pair{region.number, region.since}) != list.end();
}

/// Of the decompositions that try a color, for a video that `method` decomposes.
GlobalThesis::Params params_of(const GlobalThesis& method) {
  GlobalThesis::Params params = method.params();
  params.keyframes = 0;
  params.refine_rounds = 0;
  params.cut_chroma = 0;
  params.warm_start = params.energy = params.trace = false;
  return params;
}

}  // namespace

MisclusteringCorrection::MisclusteringCorrection(const std::shared_ptr<gpu::Device>& device,
                                                 Extent extent)
    : device_(device), extent_(extent), halve_(device), reduce_(device), try_(device) {}

void MisclusteringCorrection::make_kernels(const GlobalThesis& method) const {
  GlobalThesis tiny(device_, {1, 1});
  tiny.set_params(params_of(method));
  tiny.make_kernels();
}

/// Made when a region first needs it.
MisclusteringCorrection::Level& MisclusteringCorrection::level(size_t index) {
  Level& level = levels_.at(index);
  if (level.method) return level;
  level.extent = extent_;
  for (size_t n = 0; n < index; ++n) level.extent = half_of(level.extent);
  for (auto* plane : {&level.image, &level.regions, &level.trial}) {
    *plane = {level.extent,
              gpu::Buffer::create(device_, gpu::Element::vec4, level.extent.pixels())};
  }
  level.method = std::make_unique<GlobalThesis>(device_, level.extent);
  return level;
}

/// Starts on the next region without a color: copies the frame and its regions.
void MisclusteringCorrection::begin(gpu::Commands& commands, const GlobalThesis& method,
                                    const MarkedRegions& regions) {
  for (const MarkedRegions::Region& region : regions.regions()) {
    if (region.color >= 0 || region.cluster < 0 || region.pixels == 0) continue;
    if (has(hopeless_, region)) continue;
    Job job{region, 0, {}, 0, {}};
    for (const BaseColors::Color& color : method.colors().colors())
      if (color.slot != region.cluster) job.candidates.push_back(color.slot);
    if (job.candidates.empty()) {
      hopeless_.emplace_back(region.number, region.since);
      reported_hopeless_.push_back(region.number);
      continue;
    }
    job.wanted = job.candidates.size();
    while (!has(thin_, region) && job.level < kMaxHalvings &&
           region.pixels >> (2 * job.level + 2) >= kMinPixels)
      ++job.level;
    Level& at = level(job.level);
    Plane image = method.image();
    for (size_t n = 1; n <= job.level; ++n) {
      Level& to = level(n);
      halve_.record(commands, image, to.image);
      image = to.image;
    }
    if (job.level == 0) commands.copy(image.buffer, at.image.buffer, at.image.buffer->bytes());
    commands.dispatch(reduce_, {.fine = regions.plane().buffer, .coarse = at.regions.buffer},
                      {.size = at.extent, .fine_size = extent_, .factor = 1 << job.level},
                      {at.extent.width, at.extent.height});
    at.method->set_params(params_of(method));
    at.method->set_base_colors(method.colors());
    job_ = std::move(job);
    ++jobs_;
    return;
  }
}

uint64_t MisclusteringCorrection::record(gpu::Commands& commands, const GlobalThesis& method,
                                         const MarkedRegions& regions) {
  if (method.extent() != extent_)
    throw Error(ErrorKind::internal, "the correction was made for another frame size");
  const uint64_t number = recorded_++;
  Frame& frame = frames_[number];
  // Not collected: try its candidate again.
  if (frame.pending && job_ && frame.job == jobs_) job_->candidates.push_back(frame.candidate);
  frame.pending = false;
  // From a cut on until the scene's base colors are known, there is nothing to choose from.
  if (!job_ && method.scene_since() != UINT64_MAX) begin(commands, method, regions);
  if (!job_ || job_->candidates.empty()) return number;
  Level& at = level(job_->level);
  const int candidate = job_->candidates.back();
  job_->candidates.pop_back();
  commands.dispatch(try_, {.regions = at.regions.buffer, .trial = at.trial.buffer},
                    {.size = at.extent, .number = job_->region.number, .color = candidate},
                    {at.extent.width, at.extent.height});
  Layers layers;
  GlobalThesis::Hints hints;
  hints.fixed_regions = &at.trial;
  hints.scored_region = job_->region.number;
  frame = {true, jobs_, at.method->record(commands, at.image, layers, hints), candidate};
  commands.stage("correction");
  return number;
}

std::optional<MisclusteringCorrection::Result> MisclusteringCorrection::collect(
    uint64_t number, MarkedRegions& regions) {
  if (number >= recorded_ || number + frames_.size() < recorded_) return {};
  Frame& frame = frames_[number];
  if (!frame.pending) return {};
  frame.pending = false;
  if (!job_ || frame.job != jobs_) return {};
  const GlobalThesis::Stats stats = level(job_->level).method->stats(frame.number);
  if (stats.region == 0) {
    thin_.emplace_back(job_->region.number, job_->region.since);
    job_.reset();
    return {};
  }
  job_->scores.push_back({frame.candidate, stats.score / stats.region});
  if (job_->scores.size() < job_->wanted) return {};
  const auto best =
      std::min_element(job_->scores.begin(), job_->scores.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  Result result{job_->region.number, job_->region.cluster, best->first, job_->scores};
  const uint64_t since = job_->region.since;
  job_.reset();
  for (const MarkedRegions::Region& region : regions.regions()) {
    if (region.number != result.number || region.since != since) continue;
    regions.set_color(region.number, result.color);
    return result;
  }
  return {};  // the region is gone
}

void MisclusteringCorrection::reset() {
  job_.reset();
  ++jobs_;
  hopeless_.clear();
  reported_hopeless_.clear();
  thin_.clear();
}

}  // namespace inverse
