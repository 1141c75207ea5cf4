// SPDX-License-Identifier: LGPL-2.1-or-later
// A simulated camera of a light stage: frames of a light program, with lost and duplicated ones,
// time stamps with jitter and drift, and the result of labeling each.
#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "kernels/lightstage/labels/frame_labeler.hpp"

namespace inverse::testing {

struct CameraSimulation {
  enum class Jitter : uint8_t { uniform, normal };
  uint64_t frames = 10000;  ///< triggers of the program
  uint64_t idle = 50;       ///< triggers before it starts
  double lost = 0.02, doubled = 0.01;
  double jitter = 1.0 / 3;                ///< periods, the most either way
  Jitter distribution = Jitter::uniform;  ///< or normal, sigma half of that, cut there
  double late = 0;                        ///< share of frames stamped 0.5 to 0.75 periods late
  double drift = 80;                      ///< ppm
  uint32_t id_bits = 0;
  uint64_t first_id = 65400;
  bool ids_skip_zero = false;
  bool full_frame_lost = false, full_frame_kept = true;
  double noise = 0.002;
  uint64_t seed = 1;
};

struct SimulationResult {
  uint64_t sent = 0;  ///< frames of the program that were delivered, doubles apart
  uint64_t mislabeled = 0, labeled = 0;
  uint64_t late = 0, late_mislabeled = 0;  ///< frames that were stamped late; wrong ones of these
  uint64_t ambiguous = 0;                  ///< good frames that were not labeled
  uint64_t lost = 0;                       ///< truly, before the last that was delivered
  uint64_t doubled = 0;                    ///< truly
  FrameLabeler::Counts counts;
  double held = 0;                        ///< frames that the slowest decision waited for
  std::vector<int64_t> trigger_of_token;  ///< of each that was delivered; what was said of it
  std::vector<int64_t> label_of_token;    ///< -1: none
};

/// The image of a head-like subject under colored light: mean linear RGB.
inline std::array<double, 3> mean_picture(const LightProgram& program,
                                          LightProgram::Position position) {
  std::array<double, 3> level{0.01, 0.01, 0.012};  // ambient
  const auto colors = program.colors(position);
  for (size_t i = 0; i < colors.size(); ++i) {
    // Mostly what faces the camera, and a rim from behind.
    const double seen = 0.05 + 0.6 * std::max(0.0, 0.3 + 0.7 * program.lights[i].direction[2]);
    for (size_t c = 0; c < 3; ++c)
      level[c] += 0.6 * seen * colors[i][c] / static_cast<double>(colors.size());
  }
  return level;
}

inline SimulationResult simulate(const LightProgram& program, const CameraSimulation& camera,
                                 const FrameLabeler::Params& params) {
  std::mt19937_64 random(camera.seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal(0, 1);
  const auto jitter = [&] {
    if (camera.distribution == CameraSimulation::Jitter::uniform)
      return camera.jitter * (2 * unit(random) - 1);
    double value = 2;
    while (std::abs(value) > 1) value = normal(random) / 2;
    return camera.jitter * value;
  };
  const double period = 1e9 * program.rate_denominator / program.rate_numerator;
  const double phase = unit(random) * period * 100;
  const auto stamp = [&](uint64_t n) {
    return static_cast<int64_t>(std::llround(
        phase + period * ((1 + camera.drift * 1e-6) * static_cast<double>(n) + jitter() + 10)));
  };
  const uint64_t mask =
      camera.id_bits == 64 ? ~uint64_t{0} : (uint64_t{1} << std::max(camera.id_bits, 1u)) - 1;
  uint64_t id = camera.first_id & mask;

  std::vector<std::array<double, 3>> pictures;  // of the steps, with those of a marker behind
  const auto picture_of = [&](LightProgram::Position position) {
    using Part = LightProgram::Position::Part;
    if (pictures.empty()) {
      for (uint32_t i = 0; i < program.steps.size(); ++i)
        pictures.push_back(mean_picture(program, {Part::step, i, 0}));
      for (uint32_t i = 0; i < LightProgram::kMarkerSteps; ++i)
        pictures.push_back(mean_picture(program, {Part::marker, i, 0}));
    }
    if (position.part == Part::step) return pictures[position.index];
    return pictures[program.steps.size() + (position.part == Part::marker ? position.index : 0)];
  };

  SimulationResult result;
  FrameLabeler labeler(program, params);
  std::vector<bool> late_tokens;
  uint64_t none = 0;
  const auto collect = [&](const std::vector<FrameLabeler::Labeled>& labels) {
    for (const auto& one : labels) {
      const int64_t truth = result.trigger_of_token[one.token];
      result.held = std::max(result.held,
                             static_cast<double>(result.trigger_of_token.size() - 1 - one.token));
      if (one.fate != FrameLabeler::Fate::labeled) continue;
      ++result.labeled;
      result.label_of_token[one.token] = static_cast<int64_t>(one.trigger);
      const bool wrong = static_cast<int64_t>(one.trigger) != truth;
      ++(!wrong ? none : late_tokens[one.token] ? result.late_mislabeled : result.mislabeled);
    }
  };
  const auto send = [&](int64_t truth, int64_t time, const ImageEvidence& image, bool late) {
    late_tokens.push_back(late);
    result.trigger_of_token.push_back(truth);
    result.label_of_token.push_back(-1);
    FrameLabeler::Frame frame{result.trigger_of_token.size() - 1, time, std::nullopt, image};
    if (camera.id_bits) frame.id = id;
    collect(labeler.push(frame));
  };
  uint64_t lost_since = 0;
  for (uint64_t n = 0; n < camera.idle + camera.frames; ++n) {
    const int64_t truth = static_cast<int64_t>(n) - static_cast<int64_t>(camera.idle);
    id = (id + 1) & mask;
    if (camera.ids_skip_zero && id == 0) id = 1;
    const bool full = truth == 1;
    bool lost = unit(random) < camera.lost;
    if (full) lost = camera.full_frame_lost || (lost && !camera.full_frame_kept);
    if (lost) {
      lost_since += truth >= 0 ? 1 : 0;
      continue;
    }
    ImageEvidence image;
    image.level = truth < 0 ? picture_of({LightProgram::Position::Part::ended, 0, 0})
                            : picture_of(program.at(static_cast<uint64_t>(truth)));
    for (double& level : image.level) level *= 1 + camera.noise * normal(random);
    image.content = random() | 1;
    const bool late = camera.late > 0 && unit(random) < camera.late;
    result.late += late ? 1 : 0;
    const double off = late ? 0.5 + 0.25 * unit(random) : 0;
    const int64_t time =
        late
            ? static_cast<int64_t>(std::llround(
                  phase + period * ((1 + camera.drift * 1e-6) * static_cast<double>(n) + off + 10)))
            : stamp(n);
    if (truth >= 0) {
      ++result.sent;
      result.lost += lost_since;
      lost_since = 0;
    }
    send(truth, time, image, late);
    if (unit(random) < camera.doubled) {
      result.doubled += truth >= 0 ? 1 : 0;
      // As drivers have it: the same time again, or a later one of its own.
      send(truth, unit(random) < 0.5 ? time : std::max(time, stamp(n)), image, late);
    }
  }
  collect(labeler.drain());
  result.counts = labeler.counts();
  result.ambiguous = result.sent - std::min(result.sent, result.labeled);
  return result;
}

}  // namespace inverse::testing
