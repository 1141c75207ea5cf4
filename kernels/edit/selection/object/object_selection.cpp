// SPDX-License-Identifier: LGPL-2.1-or-later
#include "object_selection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/image/pack4.hpp"

namespace inverse {
namespace {

using Count = shaders::edit_selection_object_count;
constexpr auto kBins = static_cast<uint32_t>(Count::kBinCount);
// Rounds of learning and segmenting with the first strokes (one with others: it would go on
// growing), and steps of diffusion in each.
constexpr int kRounds = 5;
constexpr uint32_t kSteps = 48;
// Passes of shortest paths, along rows and columns: paths have some corners.
constexpr int kPasses = 8;
// Those of a frame that follows, which starts from the frame before.
constexpr uint32_t kFollowSteps = 8;
constexpr float kFollowRate = .1F;
// Reach of the object's surroundings, share of the frame's diagonal.
constexpr float kMinReach = .02F;

Extent blocks_of(Extent cells) {
  constexpr auto side = static_cast<uint32_t>(Count::kCoarse);
  return {(cells.width + side - 1) / side, (cells.height + side - 1) / side};
}

}  // namespace

ObjectSelection::ObjectSelection(const std::shared_ptr<gpu::Device>& device, const CellGrid& grid)
    : grid_(grid),
      blocks_(blocks_of(grid.cells)),
      smooth_counts_(device, {.counts = true}),
      smooth_again_(device, {.counts = false}),
      learn_(device, {.raise = false}, device->variant().lone_workgroup),
      raise_(device, {.raise = true}, device->variant().lone_workgroup),
      start_(device),
      marks_(device),
      first_rows_(device, {.rows = true, .first = true}),
      rows_(device, {.rows = true, .first = false}),
      columns_(device, {.rows = false, .first = false}),
      remember_(device),
      terms_of_(device),
      diffuse_first_(device, {.first = true}),
      diffuse_(device, {.first = false}),
      label_(device),
      claim_(device),
      keep_(device, {.seeded = false}),
      keep_seeded_(device, {.seeded = true}),
      occupy_(device),
      near_of_(device),
      components_(device, grid.cells) {
  using gpu::Element;
  const uint64_t cells = grid.cells.pixels();
  const auto make = [&](Element element, uint64_t count) {
    return gpu::Buffer::create(device, element, count);
  };
  for (int density = 0; density < Count::kDensities; ++density)
    count_[density] = {device, {.density = density}};
  for (auto& alpha : alpha_) alpha = make(Element::scalar, cells);
  region_ = make(Element::word, cells);
  none_drawn_ = make(Element::word, cells);
  seeds_ = make(Element::word, cells);
  memory_ = make(Element::vec4, cells);
  paths_ = make(Element::vec4, cells);
  terms_ = make(Element::vec4, cells);
  labels_ = make(Element::vec4, cells);
  claims_ = make(Element::word, 3 * cells);
  counts_ = make(Element::word, kBins);
  for (auto& smoothed : smoothed_) smoothed = make(Element::scalar, kBins);
  model_ = make(Element::scalar, uint64_t{kBins} * Count::kDensities);
  totals_ = make(Element::vec4, Count::kDensities);
  occupied_ = make(Element::word, blocks_.pixels());
  near_ = make(Element::word, blocks_.pixels());
  status_ = make(Element::word, Count::kStatusWords);
  last_area_ = make(Element::word, 1);
}

void ObjectSelection::select(gpu::Commands& commands, const gpu::BufferPtr& colors,
                             std::span<const SelectionStroke> strokes, Extent drawn, bool restart) {
  commands.write_table(drawn_, gpu::Element::word,
                       draw_seeds(strokes, drawn, grid_, &stroke_cells_));
  if (!active_) commands.fill(none_drawn_);
  const bool first = restart || !active_;
  if (first)  // densities of nothing, so that a frame without strokes that add selects nothing
    for (const auto& buffer :
         {model_, totals_, region_, near_, status_, last_area_, alpha_[0], terms_, memory_})
      commands.fill(buffer);
  mark(commands, colors, drawn_);
  learn(commands, colors, Count::kAddedDensity, 1);
  learn(commands, colors, Count::kSubtractedDensity, 1);
  if (first) {
    commands.dispatch(
        start_,
        {.colors = colors, .model = model_, .totals = totals_, .seeds = seeds_, .alpha = alpha_[0]},
        {.cells = grid_.cells}, per_cell());
    find_region(commands, true);
    learn(commands, colors, 1);
  }
  find_paths(commands, colors);
  for (int round = 0; round < (first ? kRounds : 1); ++round) {
    segment(commands, colors, kSteps);
    learn(commands, colors, 1);
  }
  active_ = true;
  lost_ = false;
}

void ObjectSelection::follow(gpu::Commands& commands, const gpu::BufferPtr& colors) {
  mark(commands, colors, none_drawn_);
  segment(commands, colors, std::exchange(lost_, false) ? kSteps : kFollowSteps);
  learn(commands, colors, kFollowRate);
}

void ObjectSelection::lose(gpu::Commands& commands) {
  if (!active_) return;
  for (const auto& buffer : {alpha_[0], region_, status_}) commands.fill(buffer);
  lost_ = true;
}

ObjectSelection::State ObjectSelection::save(gpu::Commands& commands) {
  State state;
  if (!active_) return state;
  for (const gpu::BufferPtr* buffer : lasting()) {
    state.push_back(
        gpu::Buffer::create((*buffer)->device(), gpu::Element::word, (*buffer)->bytes() / 4));
    commands.copy(*buffer, state.back(), (*buffer)->bytes());
  }
  return state;
}

void ObjectSelection::restore(gpu::Commands& commands, const State& state) {
  active_ = !state.empty();
  lost_ = false;
  if (!active_) return;
  size_t next = 0;
  for (const gpu::BufferPtr* buffer : lasting())
    commands.copy(state[next++], *buffer, (*buffer)->bytes());
}

void ObjectSelection::mark(gpu::Commands& commands, const gpu::BufferPtr& colors,
                           const gpu::BufferPtr& drawn) {
  commands.dispatch(
      marks_,
      {.colors = colors, .drawn = drawn, .region = region_, .memory = memory_, .seeds = seeds_},
      {.cells = grid_.cells}, per_cell());
}

void ObjectSelection::find_paths(gpu::Commands& commands, const gpu::BufferPtr& colors) {
  for (int pass = 0; pass < kPasses; ++pass) {
    commands.dispatch(pass ? rows_ : first_rows_,
                      {.colors = colors, .seeds = seeds_, .paths = paths_}, {.cells = grid_.cells},
                      line_of(grid_.cells.height));
    commands.dispatch(columns_, {.colors = colors, .seeds = seeds_, .paths = paths_},
                      {.cells = grid_.cells}, line_of(grid_.cells.width));
  }
  commands.dispatch(remember_,
                    {.colors = colors, .paths = paths_, .seeds = seeds_, .memory = memory_},
                    {.cells = grid_.cells}, per_cell());
}

void ObjectSelection::segment(gpu::Commands& commands, const gpu::BufferPtr& colors,
                              uint32_t steps) {
  static_assert(kSteps % 2 == 0 && kFollowSteps % 2 == 0, "the last step writes alpha_[0]");
  commands.dispatch(terms_of_,
                    {.colors = colors,
                     .model = model_,
                     .totals = totals_,
                     .memory = memory_,
                     .region = region_,
                     .terms = terms_},
                    {.cells = grid_.cells}, per_cell());
  for (uint32_t step = 0; step < steps; ++step)
    commands.dispatch(
        step ? diffuse_ : diffuse_first_,
        {.terms = terms_, .before = alpha_[step % 2], .alpha = alpha_[(step + 1) % 2]},
        {.cells = grid_.cells}, per_cell());
  find_region(commands, false);
}

void ObjectSelection::find_region(gpu::Commands& commands, bool seeded) {
  commands.dispatch(label_, {.alpha = alpha_[0], .labels = labels_}, {.cells = grid_.cells},
                    per_cell());
  components_.record(commands, labels_);
  commands.fill(claims_);
  commands.dispatch(claim_,
                    {.labels = labels_,
                     .region = region_,
                     .roots = components_.roots(),
                     .seeds = seeds_,
                     .terms = terms_,
                     .status = status_,
                     .claims = claims_},
                    {.cells = grid_.cells}, per_cell());
  commands.dispatch(seeded ? keep_seeded_ : keep_,
                    {.labels = labels_,
                     .roots = components_.roots(),
                     .claims = claims_,
                     .status = status_,
                     .last_area = last_area_,
                     .alpha = alpha_[0],
                     .region = region_},
                    {.cells = grid_.cells}, per_cell());
  commands.fill(status_);
  commands.dispatch(occupy_, {.region = region_, .occupied = occupied_, .status = status_},
                    {.cells = grid_.cells, .blocks = blocks_}, {blocks_.width, blocks_.height});
  const auto width = static_cast<float>(grid_.cells.width),
             height = static_cast<float>(grid_.cells.height);
  commands.dispatch(
      near_of_, {.occupied = occupied_, .status = status_, .near = near_, .last_area = last_area_},
      {.blocks = blocks_, .min_reach = kMinReach * std::hypot(width, height)},
      {blocks_.width, blocks_.height});
}

void ObjectSelection::learn(gpu::Commands& commands, const gpu::BufferPtr& colors, float rate) {
  learn(commands, colors, Count::kObjectDensity, rate);
  learn(commands, colors, Count::kBackgroundDensity, rate);
}

void ObjectSelection::learn(gpu::Commands& commands, const gpu::BufferPtr& colors, int density,
                            float rate) {
  commands.fill(counts_);
  commands.dispatch(count_[density],
                    {.colors = colors,
                     .alpha = alpha_[0],
                     .region = region_,
                     .seeds = drawn_,
                     .near = near_,
                     .model = model_,
                     .totals = totals_,
                     .counts = counts_},
                    {.cells = grid_.cells}, per_cell());
  commands.dispatch(smooth_counts_,
                    {.counts = counts_, .before = smoothed_[1], .smoothed = smoothed_[0]},
                    line_of(kBins));
  commands.dispatch(smooth_again_,
                    {.counts = counts_, .before = smoothed_[0], .smoothed = smoothed_[1]},
                    line_of(kBins));
  const bool strokes = density == Count::kAddedDensity || density == Count::kSubtractedDensity;
  commands.dispatch(strokes ? raise_ : learn_,
                    {.histogram = smoothed_[1], .model = model_, .totals = totals_},
                    {.density = density, .rate = rate}, {});
}

ObjectSelection::Place ObjectSelection::place_of(const uint32_t* status) const {
  const auto at = [&](int word) { return static_cast<double>(status[word]); };
  const double area = at(Count::kArea), side = grid_.side;
  if (!(area > 0)) return {};
  return {area / static_cast<double>(grid_.cells.pixels()),
          (at(Count::kSumX) / area + .5) * side,
          (at(Count::kSumY) / area + .5) * side,
          (grid_.cells.width - at(Count::kLeft)) * side,
          (grid_.cells.height - at(Count::kTop)) * side,
          std::min(at(Count::kRight) * side, static_cast<double>(grid_.frame.width)),
          std::min(at(Count::kBottom) * side, static_cast<double>(grid_.frame.height))};
}

}  // namespace inverse
