// SPDX-License-Identifier: LGPL-2.1-or-later
// FrameLabeler: detection of the marker of a light program (black, full on, black).
#include <algorithm>
#include <cmath>

#include "frame_labeler.hpp"

namespace inverse {
namespace {

using Position = LightProgram::Position;

constexpr double kMinContrast = 0.004;          // of full scale: one code value in dark gray
constexpr double kMinContrastToAmbient = 0.05;  // relative to the light without the stage
constexpr double kMaxBlackDifference = 0.15;    // of the contrast
constexpr int64_t kFull = 1, kBlack = 2;        // triggers from the marker's first
constexpr double kDark = 0.25;                  // of the contrast; tracking frames are brighter
constexpr size_t kManyLights = 16;              // with so many, a single one is dim
constexpr double kMaxTimeDifference = 1.0 / 3;  // between cameras, of a pass
// Frames after the marker that have to fit.
constexpr uint32_t kMinGradients = 2, kMinWithoutFull = 6, kMinTracking = 2;

bool is_gradient(StepKind kind) {
  return kind == StepKind::gradient_a || kind == StepKind::gradient_b;
}

/// Triggers of the first two tracking frames.
std::optional<std::pair<int64_t, int64_t>> first_tracking(const LightProgram& program) {
  std::optional<int64_t> first;
  for (uint32_t i = 0; i < program.steps.size(); ++i) {
    if (program.steps[i].kind != StepKind::tracking) continue;
    const int64_t trigger = int64_t{LightProgram::kMarkerSteps} + i;
    if (first) return std::pair{*first, trigger};
    first = trigger;
  }
  return std::nullopt;
}

/// Distances between tracking frames of a running program, triggers.
std::vector<int64_t> tracking_distances(const LightProgram& program) {
  std::vector<int64_t> at, distances;
  for (uint32_t i = 0; i < program.steps.size(); ++i)
    if (program.steps[i].kind == StepKind::tracking) at.push_back(i);
  for (size_t i = 1; i < at.size(); ++i) distances.push_back(at[i] - at[i - 1]);
  if (!at.empty() && program.repeat != 1 && program.marker != LightProgram::Marker::pass)
    distances.push_back(static_cast<int64_t>(program.steps.size()) - at.back() + at.front());
  std::ranges::sort(distances);
  distances.erase(std::unique(distances.begin(), distances.end()), distances.end());
  return distances;
}

/// Number of check frames among the first `within` steps.
uint32_t checks_within(const LightProgram& program, uint32_t within) {
  const auto count = std::min<size_t>(within, program.steps.size());
  return static_cast<uint32_t>(
      std::count_if(program.steps.begin(), program.steps.begin() + static_cast<ptrdiff_t>(count),
                    [](const LightStep& step) { return is_check(step.kind); }));
}

/// Check frames that must fit before a marker is accepted. Programs that begin with single lights
/// need only the first tracking frame.
uint32_t required_checks(const LightProgram& program, uint32_t within) {
  uint32_t gradients = 0;
  for (uint32_t i = 0; i < std::min<size_t>(within, program.steps.size()); ++i) {
    if (program.steps[i].kind == StepKind::tracking) return 1;
    gradients += is_gradient(program.steps[i].kind) ? 1 : 0;
  }
  return std::min(gradients, kMinGradients);
}

}  // namespace

const FrameLabeler::Seen* FrameLabeler::seen_at(int64_t trigger) const {
  const auto at = std::find_if(seen_.begin(), seen_.end(),
                               [&](const Seen& seen) { return seen.trigger == trigger; });
  return at == seen_.end() ? nullptr : &*at;
}

/// Whether the frames after a marker fit the program.
FrameLabeler::Match FrameLabeler::follows(const Anchor& anchor, uint32_t required) const {
  LightEvidence evidence(program_);
  evidence.start(anchor.black, anchor.full, anchor.clipped);
  uint32_t checks = 0, frames = 0;
  for (const Seen& seen : seen_) {
    if (seen.trigger < anchor.trigger) continue;
    const Position position = program_.at(static_cast<uint64_t>(seen.trigger - anchor.trigger));
    if (evidence.contradicts(position, seen.image)) return Match::no;
    // No frame is darker than one without light.
    if (seen.image.luminance() < anchor.black - kMaxBlackDifference * (anchor.full - anchor.black))
      return Match::no;
    if (seen.trigger <= anchor.trigger + kBlack) continue;
    if (position.part != Position::Part::step) continue;
    ++frames;
    const StepKind kind = program_.kind(position);
    if (kind == StepKind::tracking || is_gradient(kind)) ++checks;
  }
  if (checks >= required && frames >= kMinGradients) return Match::yes;
  return Match::wait;
}

/// The anchor if the full frame was lost: two black frames, one trigger between them, then
/// gradients.
std::optional<FrameLabeler::Anchor> FrameLabeler::without_full_frame(int64_t start) const {
  if (program_.steps.size() < 2 || !is_gradient(program_.steps[0].kind) ||
      !is_gradient(program_.steps[1].kind) || program_.steps[0].kind == program_.steps[1].kind)
    return std::nullopt;
  for (const LightStep& step : program_.steps)
    if (!is_gradient(step.kind)) return std::nullopt;
  const Seen *black1 = seen_at(start), *black2 = seen_at(start + kBlack),
             *first = seen_at(start + kBlack + 1);
  if (!black1 || !black2 || !first) return std::nullopt;
  // A + B is the image under all lights plus twice the ambient light.
  for (int64_t second = start + kBlack + 2; second < start + kBlack + 8; second += 2) {
    const Seen* other = seen_at(second);
    if (!other) continue;
    const double black = (black1->image.luminance() + black2->image.luminance()) / 2;
    const double full = first->image.luminance() + other->image.luminance() - black;
    if (std::abs(black1->image.luminance() - black2->image.luminance()) >
        kMaxBlackDifference * (full - black))
      return std::nullopt;
    return Anchor{start, black, full, true};
  }
  return std::nullopt;
}

/// The same for a program that begins with single lights: black frames and the first two tracking
/// frames. In a running program, earlier tracking frames would have been seen.
FrameLabeler::Match FrameLabeler::matches_by_tracking(int64_t start, Anchor& anchor) const {
  const auto tracking = first_tracking(program_);
  if (!tracking || program_.lights.size() < kManyLights) return Match::no;
  const auto [first, second] = *tracking;
  const int64_t newest = seen_.back().trigger;
  const Seen *black1 = seen_at(start), *black2 = seen_at(start + kBlack);
  if (!black1 || (!black2 && newest >= start + kBlack)) return Match::no;
  if (second >= int64_t{params_.hold} + kBlack + 1) return Match::no;  // beyond the hold limit
  if (newest < start + first) return Match::wait;
  const Seen* bright = seen_at(start + first);
  if (!bright) return Match::no;
  const LightStep& step = program_.steps[static_cast<size_t>(first - kBlack - 1)];
  const double exposure =
      program_.exposure > 0 ? step.exposure.value_or(program_.exposure) / program_.exposure : 1;
  const double a = black1->image.luminance(), b = black2->image.luminance(), black = (a + b) / 2;
  const double added = (bright->image.luminance() - black) / std::max(exposure, 1e-6);
  anchor = {start, black, black + added, bright->image.clipped > 0.02};
  if (std::abs(a - b) > kMaxBlackDifference * added) return Match::no;
  for (const int64_t distance : tracking_distances(program_)) {
    // A frame of no trigger may have been that tracking frame.
    if (last_off_ && *last_off_ + 2 >= std::min(start, start + first - distance)) return Match::no;
    const Seen* before = seen_at(start + first - distance);
    if (!before || before->image.luminance() - black > kDark * added) return Match::no;
  }
  if (newest >= start + second && !seen_at(start + second)) return Match::no;
  return newest >= start + second ? Match::yes : Match::wait;
}

/// Whether a full frame may be a tracking frame of a running program: one came before it.
bool FrameLabeler::may_be_tracking(const Seen& full, const Anchor& anchor) const {
  const double bright = anchor.black + (1 - kDark) * (anchor.full - anchor.black);
  return std::ranges::any_of(tracking_distances(program_), [&](int64_t distance) {
    const Seen* before = seen_at(full.trigger - distance);
    return before && before->image.luminance() > bright;
  });
}

FrameLabeler::Match FrameLabeler::matches(int64_t start, Anchor& anchor) const {
  const Seen *full = seen_at(start + kFull), *black1 = seen_at(start),
             *black2 = seen_at(start + kBlack);
  const int64_t newest = seen_.back().trigger;
  uint32_t required = required_checks(program_, params_.hold);
  // After a loss, accept a marker only when one extra check frame confirms it.
  bool careful = confirmed_until_ && !anchor_;
  if (full) {
    if (!black1 && newest < start + kBlack) return Match::wait;
    if (!black1 && !black2) return Match::no;
    anchor = {start, 0, full->image.luminance(), full->image.clipped > 0.02};
    const double a = (black1 ? black1 : black2)->image.luminance();
    const double b = (black2 ? black2 : black1)->image.luminance();
    anchor.black = (a + b) / 2;
    if (std::abs(a - b) > kMaxBlackDifference * (anchor.full - anchor.black)) return Match::no;
    careful |= may_be_tracking(*full, anchor);
  } else {
    if (newest < start + kFull) return Match::no;
    if (is_gradient(program_.steps.front().kind)) {
      const auto found = without_full_frame(start);
      // Black, then one missing frame: the next frames decide.
      if (!found) return black1 && newest <= start + kBlack + 2 ? Match::wait : Match::no;
      anchor = *found;
      required = kMinWithoutFull;
    } else {
      const Match match = matches_by_tracking(start, anchor);
      if (match != Match::yes) return match;
      required = kMinTracking;
    }
  }
  if (anchor.full - anchor.black < std::max(kMinContrast, kMinContrastToAmbient * anchor.black))
    return Match::no;
  // One more check frame, if the program has one.
  if (careful)
    required = std::max(required, std::min(required + 1, checks_within(program_, params_.hold)));
  return follows(anchor, required);
}

void FrameLabeler::find_marker(std::vector<Labeled>& out) {
  if (program_.marker == LightProgram::Marker::none) return report_all_seen(out);
  const int64_t newest = seen_.back().trigger;
  // Always keep the last two frames: they may be the first two of a marker.
  int64_t keep_from = newest - 1;
  for (const Seen& seen : seen_) {
    // The frame may be the marker's first, or its second or third after lost ones.
    for (int64_t start = seen.trigger - kBlack; start <= seen.trigger; ++start) {
      if (confirmed_until_ && start + kFull < *confirmed_until_) continue;
      Anchor anchor;
      const Match match = matches(start, anchor);
      if (match == Match::yes) return take_anchor(anchor, out);
      if (match == Match::wait) keep_from = std::min(keep_from, start);
    }
  }
  keep_from = std::max(keep_from, newest - longest_search());
  for (Seen& seen : seen_)
    if (seen.trigger < keep_from && !seen.reported) {
      report(seen.token, outside(), out);
      seen.reported = true;
    }
}

/// Whether a trigger is the first of a marker.
bool FrameLabeler::begins_pass(int64_t trigger) const {
  if (trigger < 0) return false;
  const Position position = program_.at(static_cast<uint64_t>(trigger));
  return position.part == Position::Part::marker && position.index == 0;
}

/// The counter's trigger at which the run of another camera began, if this marker belongs to it.
/// Time stamps of the same trigger differ by less than half a pass between cameras.
std::optional<int64_t> FrameLabeler::start_of_running(int64_t marker) const {
  const auto timed = std::ranges::find_if(
      seen_, [&](const Seen& seen) { return seen.trigger >= marker && seen.time; });
  if (timed == seen_.end()) return std::nullopt;
  const double pass = double(LightProgram::kMarkerSteps) + double(program_.steps.size());
  const double since = static_cast<double>(*timed->time - running_->time) / period_ -
                       static_cast<double>(timed->trigger - marker);
  const double passes = (static_cast<double>(running_->trigger) + since) / pass;
  const double whole = std::round(passes);
  if (whole < 0 || std::abs(passes - whole) > kMaxTimeDifference) return std::nullopt;
  const auto triggers = static_cast<int64_t>(whole * pass);
  return begins_pass(triggers) ? std::optional(marker - triggers) : std::nullopt;
}

/// Start of the program of a marker. If the marker is at the place of a later pass's marker, the
/// count goes on, as for cameras without a loss. A camera that starts late or has lost its count
/// continues that of the other cameras.
int64_t FrameLabeler::start_of(int64_t marker) {
  const bool many = program_.marker == LightProgram::Marker::pass;
  const bool continues = many && running_ && !(running_->ours && lost_anchor_);
  const auto running = continues ? start_of_running(marker) : std::nullopt;
  if (!running && many && lost_anchor_ && begins_pass(marker - *lost_anchor_)) return *lost_anchor_;
  start_ = {start_.number + 1, running ? std::optional(running_->run) : std::nullopt,
            continues && !running};
  return running.value_or(marker);
}

void FrameLabeler::take_anchor(const Anchor& anchor, std::vector<Labeled>& out) {
  ++counts_.markers;
  over_ = false;
  found_marker_ = anchor.trigger;
  anchor_ = start_of(anchor.trigger);
  last_ = anchor.trigger - 1;
  dropped_since_last_ = 0;
  waiting_since_.reset();
  evidence_.start(anchor.black, anchor.full, anchor.clipped);
  for (Seen& seen : seen_) {
    if (seen.reported) {
      if (seen.trigger >= anchor.trigger) ++dropped_since_last_;
      continue;
    }
    seen.reported = true;
    if (seen.trigger < anchor.trigger)
      report(seen.token, outside(), out);
    else
      label(seen.token, seen.trigger, seen.image, out);
  }
  if (ended_) end();
}

}  // namespace inverse
