// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_program.hpp"

#include <cmath>
#include <numeric>
#include <set>

#include "common/error.hpp"

namespace inverse {
namespace {

[[noreturn]] void refuse(const LightProgram& program, const std::string& text) {
  const std::string name = program.name.empty() ? "the light program" : "\"" + program.name + "\"";
  throw Error(ErrorKind::file, name + ": " + text);
}

void check_color(const LightProgram& program, const LightColor& color, const std::string& where) {
  for (const float c : color)
    if (!(c >= 0 && c <= 1)) refuse(program, where + " has a color outside of 0…1");
}

void check_times(const LightProgram& program, double exposure, double guard,
                 const std::string& where) {
  if (!(exposure >= 0 && guard >= 0)) refuse(program, where + ": a time is negative or no number");
  const double step = double(program.rate_denominator) / program.rate_numerator;
  if (exposure + guard > step * (1 + 1e-6))
    refuse(program, where + ": guard and exposure take " + std::to_string(exposure + guard) +
                        " s, a step only " + std::to_string(step) + " s");
}

void check_light(const LightProgram& program, size_t index, StageLight& light) {
  const std::string where = "light " + std::to_string(index);
  const auto [x, y, z] = light.direction;
  const double length = std::sqrt(x * x + y * y + z * z);
  if (!(std::abs(length - 1) <= 1e-3))  // also rejects NaN
    refuse(program,
           where + ": its direction is not a unit vector, its length is " + std::to_string(length));
  // Leave rounding errors alone, so that a program that was saved and loaded keeps its id.
  if (std::abs(length - 1) > 1e-12)
    for (double& c : light.direction) c /= length;
  const size_t channels = light.channels.size();
  if (channels > 4 || channels == 2)
    refuse(program, where + " has " + std::to_string(channels) +
                        " channels; lights have 1 (gray), 3 (RGB), 4 (RGB and white) or none");
  if (channels != program.lights.front().channels.size())
    refuse(program, where + " has " + std::to_string(channels) + " channels, light 0 has " +
                        std::to_string(program.lights.front().channels.size()));
}

void check_channels(const LightProgram& program) {
  constexpr uint32_t kLast = 63999 * 512;  // universes of E1.31
  std::set<uint32_t> used;
  for (size_t i = 0; i < program.lights.size(); ++i)
    for (const uint32_t channel : program.lights[i].channels) {
      if (channel < 1 || channel > kLast)
        refuse(program, "light " + std::to_string(i) + ": there is no channel " +
                            std::to_string(channel) + "; they are counted from 1");
      if (!used.insert(channel).second)
        refuse(program, "light " + std::to_string(i) + ": channel " + std::to_string(channel) +
                            " is another light's, too");
    }
}

}  // namespace

const char* name_of(StepKind kind) {
  constexpr std::array kNames = {"olat", "gradient-a", "gradient-b", "tracking", "black", "custom"};
  return kNames[static_cast<size_t>(kind)];
}

void LightProgram::check() {
  if (lights.empty()) refuse(*this, "it has no lights");
  if (lights.size() > kMaxLights)
    refuse(*this, "it has more than " + std::to_string(kMaxLights) + " lights");
  if (steps.empty()) refuse(*this, "it has no steps");
  if (steps.size() > kMaxSteps)
    refuse(*this, "it has more than " + std::to_string(kMaxSteps) + " steps");
  if (rate_numerator < 1 || rate_denominator < 1 || rate_numerator / rate_denominator > 1000000)
    refuse(*this, "its rate has to be more than 0 and at most a million steps a second");
  check_times(*this, exposure, guard, "the program");
  for (size_t i = 0; i < lights.size(); ++i) check_light(*this, i, lights[i]);
  check_channels(*this);
  for (size_t i = 0; i < steps.size(); ++i) {
    const LightStep& step = steps[i];
    const std::string where = "step " + std::to_string(i);
    if (step.kind == StepKind::olat && step.light >= lights.size())
      refuse(*this, where + ": there is no light " + std::to_string(step.light));
    if (step.kind == StepKind::custom && step.colors.size() != lights.size())
      refuse(*this, where + " has " + std::to_string(step.colors.size()) + " colors for " +
                        std::to_string(lights.size()) + " lights");
    for (const LightColor& color : step.colors) check_color(*this, color, where);
    check_times(*this, step.exposure.value_or(exposure), step.guard.value_or(guard), where);
  }
}

uint64_t LightProgram::id() const {
  uint64_t hash = 14695981039346656037U;  // FNV-1a
  for (const char c : json()) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

LightProgram::Position LightProgram::at(uint64_t trigger) const {
  using Part = Position::Part;
  const uint64_t pass_length = steps.size() + (marker == Marker::pass ? kMarkerSteps : 0);
  if (marker == Marker::start) {
    if (trigger < kMarkerSteps) return {Part::marker, static_cast<uint32_t>(trigger), 0};
    trigger -= kMarkerSteps;
  }
  const uint64_t pass = trigger / pass_length;
  if (repeat && pass >= repeat) return {Part::ended, 0, repeat};
  auto index = static_cast<uint32_t>(trigger % pass_length);
  if (marker == Marker::pass) {
    if (index < kMarkerSteps) return {Part::marker, index, pass};
    index -= kMarkerSteps;
  }
  return {Part::step, index, pass};
}

std::optional<uint64_t> LightProgram::triggers() const {
  if (!repeat) return std::nullopt;
  const uint64_t markers = marker == Marker::none ? 0 : marker == Marker::start ? 1 : repeat;
  return repeat * steps.size() + markers * kMarkerSteps;
}

StepKind LightProgram::kind(Position position) const {
  if (position.part == Position::Part::step) return steps[position.index].kind;
  const bool full = position.part == Position::Part::marker && position.index == 1;
  return full ? StepKind::tracking : StepKind::black;
}

std::vector<LightColor> LightProgram::colors(Position position) const {
  if (position.part == Position::Part::step) return colors(steps[position.index]);
  return colors(LightStep{kind(position)});
}

std::vector<LightColor> LightProgram::colors(const LightStep& step) const {
  if (step.kind == StepKind::custom) return step.colors;
  std::vector<LightColor> all(lights.size(), LightColor{});
  if (step.kind == StepKind::olat) all[step.light] = {1, 1, 1};
  if (step.kind == StepKind::tracking) all.assign(lights.size(), LightColor{1, 1, 1});
  if (step.kind == StepKind::gradient_a || step.kind == StepKind::gradient_b) {
    const double sign = step.kind == StepKind::gradient_a ? 1 : -1;
    for (size_t i = 0; i < lights.size(); ++i)
      for (size_t c = 0; c < 3; ++c)
        all[i][c] = static_cast<float>((1 + sign * lights[i].direction[c]) / 2);
  }
  return all;
}

}  // namespace inverse
