// How a FrameLabeler finds the marker of a light program: black, full on, black.
#include <algorithm>
#include <cmath>

#include "frame_labeler.hpp"

namespace inverse {
namespace {

using Position = LightProgram::Position;

constexpr double kLeastContrast = 0.004;     // of full scale: what one code value is in dark gray
constexpr double kContrastOfAmbient = 0.05;  // of the light that is there without the stage
constexpr double kBlacksAlike = 0.15;        // of the contrast
constexpr int64_t kFull = 1, kBlack = 2;     // triggers from the marker's first
constexpr double kDark = 0.25;               // of the contrast: no tracking frame
constexpr size_t kManyLights = 16;           // of which one alone is not bright
constexpr double kWithinPass = 1.0 / 3;      // of a pass, by which cameras' times may differ
constexpr uint32_t kGradientsWanted = 2, kWithoutFull = 6, kTrackingWanted = 2;

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

/// How far tracking frames of a program that runs are apart.
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

/// Frames after a marker that would not be so bright elsewhere.
uint32_t told_within(const LightProgram& program, uint32_t within) {
  const auto count = std::min<size_t>(within, program.steps.size());
  return static_cast<uint32_t>(
      std::count_if(program.steps.begin(), program.steps.begin() + static_cast<ptrdiff_t>(count),
                    [](const LightStep& step) { return is_check(step.kind); }));
}

/// What has to be seen of these to believe in a marker. Programs that begin with single lights have
/// the first tracking frame for that.
uint32_t wanted_after(const LightProgram& program, uint32_t within) {
  uint32_t gradients = 0;
  for (uint32_t i = 0; i < std::min<size_t>(within, program.steps.size()); ++i) {
    if (program.steps[i].kind == StepKind::tracking) return 1;
    gradients += is_gradient(program.steps[i].kind) ? 1 : 0;
  }
  return std::min(gradients, kGradientsWanted);
}

}  // namespace

const FrameLabeler::Seen* FrameLabeler::seen_at(int64_t trigger) const {
  const auto at = std::find_if(seen_.begin(), seen_.end(),
                               [&](const Seen& seen) { return seen.trigger == trigger; });
  return at == seen_.end() ? nullptr : &*at;
}

/// Whether what was seen after a marker is what the program says.
FrameLabeler::Match FrameLabeler::follows(const Anchor& anchor, uint32_t wanted) const {
  LightEvidence evidence(program_);
  evidence.start(anchor.black, anchor.full, anchor.clipped);
  uint32_t told = 0, frames = 0;
  for (const Seen& seen : seen_) {
    if (seen.trigger < anchor.trigger) continue;
    const Position position = program_.at(static_cast<uint64_t>(seen.trigger - anchor.trigger));
    if (evidence.contradicts(position, seen.image)) return Match::no;
    // Nothing is darker than without light.
    if (seen.image.luminance() < anchor.black - kBlacksAlike * (anchor.full - anchor.black))
      return Match::no;
    if (seen.trigger <= anchor.trigger + kBlack) continue;
    if (position.part != Position::Part::step) continue;
    ++frames;
    const StepKind kind = program_.kind(position);
    if (kind == StepKind::tracking || is_gradient(kind)) ++told;
  }
  if (told >= wanted && frames >= kGradientsWanted) return Match::yes;
  return Match::wait;
}

/// Where the full frame is the one that was lost: between two black ones, one trigger apart, and
/// gradients right after.
std::optional<FrameLabeler::Anchor> FrameLabeler::without_full_frame(int64_t start) const {
  if (program_.steps.size() < 2 || !is_gradient(program_.steps[0].kind) ||
      !is_gradient(program_.steps[1].kind) || program_.steps[0].kind == program_.steps[1].kind)
    return std::nullopt;
  for (const LightStep& step : program_.steps)
    if (!is_gradient(step.kind)) return std::nullopt;
  const Seen *black1 = seen_at(start), *black2 = seen_at(start + kBlack),
             *first = seen_at(start + kBlack + 1);
  if (!black1 || !black2 || !first) return std::nullopt;
  // A + B is the picture under all lights, with twice the light that is always there.
  for (int64_t second = start + kBlack + 2; second < start + kBlack + 8; second += 2) {
    const Seen* other = seen_at(second);
    if (!other) continue;
    const double black = (black1->image.luminance() + black2->image.luminance()) / 2;
    const double full = first->image.luminance() + other->image.luminance() - black;
    if (std::abs(black1->image.luminance() - black2->image.luminance()) >
        kBlacksAlike * (full - black))
      return std::nullopt;
    return Anchor{start, black, full, true};
  }
  return std::nullopt;
}

/// The same of a program that begins with single lights: darkness, and the first two tracking
/// frames. Such frames of a program that runs would have come before, too.
FrameLabeler::Match FrameLabeler::told_by_tracking(int64_t start, Anchor& anchor) const {
  const auto tracking = first_tracking(program_);
  if (!tracking || program_.lights.size() < kManyLights) return Match::no;
  const auto [first, second] = *tracking;
  const int64_t newest = seen_.back().trigger;
  const Seen *black1 = seen_at(start), *black2 = seen_at(start + kBlack);
  if (!black1 || (!black2 && newest >= start + kBlack)) return Match::no;
  if (second >= int64_t{params_.hold} + kBlack + 1) return Match::no;  // nobody waits for so long
  if (newest < start + first) return Match::wait;
  const Seen* bright = seen_at(start + first);
  if (!bright) return Match::no;
  const LightStep& step = program_.steps[static_cast<size_t>(first - kBlack - 1)];
  const double exposure =
      program_.exposure > 0 ? step.exposure.value_or(program_.exposure) / program_.exposure : 1;
  const double a = black1->image.luminance(), b = black2->image.luminance(), black = (a + b) / 2;
  const double added = (bright->image.luminance() - black) / std::max(exposure, 1e-6);
  anchor = {start, black, black + added, bright->image.clipped > 0.02};
  if (std::abs(a - b) > kBlacksAlike * added) return Match::no;
  for (const int64_t distance : tracking_distances(program_)) {
    // A frame of no trigger may have been that tracking frame.
    if (trouble_ && *trouble_ + 2 >= std::min(start, start + first - distance)) return Match::no;
    const Seen* before = seen_at(start + first - distance);
    if (!before || before->image.luminance() - black > kDark * added) return Match::no;
  }
  if (newest >= start + second && !seen_at(start + second)) return Match::no;
  return newest >= start + second ? Match::yes : Match::wait;
}

/// Whether a full frame may be a tracking frame of a program that runs: there was one before it.
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
  uint32_t wanted = wanted_after(program_, params_.hold);
  bool careful = confirmed_until_ && !anchor_;  // labels were lost
  if (full) {
    if (!black1 && newest < start + kBlack) return Match::wait;
    if (!black1 && !black2) return Match::no;
    anchor = {start, 0, full->image.luminance(), full->image.clipped > 0.02};
    const double a = (black1 ? black1 : black2)->image.luminance();
    const double b = (black2 ? black2 : black1)->image.luminance();
    anchor.black = (a + b) / 2;
    if (std::abs(a - b) > kBlacksAlike * (anchor.full - anchor.black)) return Match::no;
    careful |= may_be_tracking(*full, anchor);
  } else {
    if (newest < start + kFull) return Match::no;
    if (is_gradient(program_.steps.front().kind)) {
      const auto found = without_full_frame(start);
      // Black, a gap of one: what follows may tell.
      if (!found) return black1 && newest <= start + kBlack + 2 ? Match::wait : Match::no;
      anchor = *found;
      wanted = kWithoutFull;
    } else {
      const Match told = told_by_tracking(start, anchor);
      if (told != Match::yes) return told;
      wanted = kTrackingWanted;
    }
  }
  if (anchor.full - anchor.black < std::max(kLeastContrast, kContrastOfAmbient * anchor.black))
    return Match::no;
  // More of the program has to fit, where it has more.
  if (careful) wanted = std::max(wanted, std::min(wanted + 1, told_within(program_, params_.hold)));
  return follows(anchor, wanted);
}

void FrameLabeler::look_for_marker(std::vector<Labeled>& out) {
  if (program_.marker == LightProgram::Marker::none) return tell_all_seen(out);
  const int64_t newest = seen_.back().trigger;
  // The first two of a marker are kept in any case.
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
    if (seen.trigger < keep_from && !seen.told) {
      tell(seen.token, outside(), out);
      seen.told = true;
    }
}

/// Whether a pass' marker is where the program is at a trigger.
bool FrameLabeler::begins_pass(int64_t trigger) const {
  if (trigger < 0) return false;
  const Position position = program_.at(static_cast<uint64_t>(trigger));
  return position.part == Position::Part::marker && position.index == 0;
}

/// The counter's trigger at which the program that another camera counts has begun, if a marker is
/// of that one: frames of the same trigger are stamped well within half a pass of each other.
std::optional<int64_t> FrameLabeler::start_of_running(int64_t marker) const {
  const auto timed = std::ranges::find_if(
      seen_, [&](const Seen& seen) { return seen.trigger >= marker && seen.time; });
  if (timed == seen_.end()) return std::nullopt;
  const double pass = double(LightProgram::kMarkerSteps) + double(program_.steps.size());
  const double since = static_cast<double>(*timed->time - running_->time) / period_ -
                       static_cast<double>(timed->trigger - marker);
  const double passes = (static_cast<double>(running_->trigger) + since) / pass;
  const double whole = std::round(passes);
  if (whole < 0 || std::abs(passes - whole) > kWithinPass) return std::nullopt;
  const auto triggers = static_cast<int64_t>(whole * pass);
  return begins_pass(triggers) ? std::optional(marker - triggers) : std::nullopt;
}

/// Where the program of a marker began. One that comes where a later pass has its own is that one:
/// the count of triggers goes on, as it does for cameras that saw no trouble. So does that of other
/// cameras for one that comes later, or has lost its own.
int64_t FrameLabeler::start_of(int64_t marker) {
  const bool many = program_.marker == LightProgram::Marker::pass;
  const bool asks = many && running_ && !(running_->ours && lost_anchor_);
  const auto running = asks ? start_of_running(marker) : std::nullopt;
  if (!running && many && lost_anchor_ && begins_pass(marker - *lost_anchor_)) return *lost_anchor_;
  start_ = {start_.number + 1, running ? std::optional(running_->run) : std::nullopt,
            asks && !running};
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
    if (seen.told) {
      if (seen.trigger >= anchor.trigger) ++dropped_since_last_;
      continue;
    }
    seen.told = true;
    if (seen.trigger < anchor.trigger)
      tell(seen.token, outside(), out);
    else
      label(seen.token, seen.trigger, seen.image, out);
  }
  if (ended_) end();
}

}  // namespace inverse
