// SPDX-License-Identifier: LGPL-2.1-or-later
// A FrameLabeler with frames pushed by the test.
#pragma once
#include <gtest/gtest.h>

#include "labeling_simulation.hpp"

namespace inverse::testing {

using Fate = FrameLabeler::Fate;

inline std::vector<StageLight> some_lights(uint32_t count = 64) {
  return stage_lights(geodesic_directions(count));
}

/// A program whose images are all alike: only times and ids distinguish steps.
inline LightProgram featureless() {
  LightProgram program = performance(some_lights());
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0.3F, 0.7F);
  program.steps.clear();
  for (int i = 0; i < 97; ++i) {
    LightStep step{StepKind::custom};
    for (size_t l = 0; l < program.lights.size(); ++l)
      step.colors.push_back({unit(random), unit(random), unit(random)});
    program.steps.push_back(step);
  }
  program.check();
  return program;
}

/// Pushes frames by hand: pictures of a program, times in periods.
struct HandCamera {
  using Labels = std::vector<FrameLabeler::Labeled>;
  explicit HandCamera(LightProgram program, uint32_t id_bits = 0)
      : program_(std::move(program)), labeler_(program_, params(id_bits)) {}
  static FrameLabeler::Params params(uint32_t id_bits) { return {.id_bits = id_bits}; }

  ImageEvidence picture(int64_t trigger) {
    ImageEvidence image;
    image.level = trigger < 0 ? mean_picture(program_, {LightProgram::Position::Part::ended, 0, 0})
                              : mean_picture(program_, program_.at(static_cast<uint64_t>(trigger)));
    image.content = ++content_;
    return image;
  }
  /// The same at another framing, with a smaller or larger share of the subject.
  ImageEvidence scaled(int64_t trigger, double by) {
    ImageEvidence image = picture(trigger);
    for (double& level : image.level) level *= by;
    return image;
  }
  void collect(const Labels& labels) {
    for (const auto& one : labels) {
      if (labels_.size() <= one.token) labels_.resize(one.token + 1);
      labels_[one.token] = one;
    }
  }
  static int64_t at(double time) {
    return static_cast<int64_t>(std::llround((time + 100) * 1e9 / 60));
  }
  /// Returns the frame's token.
  uint64_t push(double time, const ImageEvidence& image, std::optional<uint64_t> id = {}) {
    const uint64_t token = tokens_++;
    collect(labeler_.push({token, at(time), id, image}, running_));
    return token;
  }
  /// Triggers of the program, on time.
  void play(int64_t from, int64_t to) {
    for (int64_t n = from; n < to; ++n) push(static_cast<double>(n), picture(n));
  }
  /// The program, seen from `first` on under the lights `ahead` of its times, in another framing.
  void play_scaled(int64_t from, int64_t to, double by, int64_t ahead = 0) {
    for (int64_t n = from; n < to; ++n) push(static_cast<double>(n), scaled(n + ahead, by));
  }
  /// The lights are off.
  void play_dark(int64_t from, int64_t to) {
    for (int64_t n = from; n < to; ++n) push(static_cast<double>(n), picture(-1));
  }
  /// The program, started again at another time.
  void play_at(double start, int64_t from, int64_t to) {
    for (int64_t n = from; n < to; ++n) push(start + static_cast<double>(n), picture(n));
  }
  void expect_last(uint64_t trigger) {
    EXPECT_EQ(labels_.back().fate, Fate::labeled);
    EXPECT_EQ(labels_.back().trigger, trigger);
  }
  /// Expects no label of this frame and those that were sent after it.
  void expect_none_labeled(uint64_t first) {
    for (uint64_t token = first; token < tokens_; ++token)
      EXPECT_NE(fate(token), Fate::labeled) << token - first;
  }
  Fate fate(uint64_t token) { return token < labels_.size() ? labels_[token].fate : Fate::untimed; }

  LightProgram program_;
  FrameLabeler labeler_;
  std::vector<FrameLabeler::Labeled> labels_;
  std::optional<FrameLabeler::Running> running_;  // of another camera
  uint64_t content_ = 0, tokens_ = 0;
};

class ByHand : public ::testing::Test, protected HandCamera {
 protected:
  explicit ByHand(LightProgram program = performance(some_lights()), uint32_t id_bits = 0)
      : HandCamera(std::move(program), id_bits) {}
};

}  // namespace inverse::testing
