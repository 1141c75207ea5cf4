// SPDX-License-Identifier: LGPL-2.1-or-later
// Labels of a light stage's frames while some are lost, duplicated and stamped unevenly. Options:
// --frames N, --seeds N, --jitter PERIODS, --drift PPM, --lost SHARE, --doubled SHARE, --late SHARE
// (stamped 0.5 to 0.75 periods too late), --full-frame-lost 1 (of the marker, which otherwise is
// never lost).
#include <cstdio>
#include <exception>

#include "tests/bench/support/command_line.hpp"
#include "tests/lightstage/host/labeling_simulation.hpp"

namespace {

using namespace inverse;
using testing::CameraSimulation;

struct Row {
  uint64_t runs = 0, sent = 0, labeled = 0, mislabeled = 0, ambiguous = 0, uncounted = 0;
  uint64_t unlabeled_runs = 0, late = 0, late_mislabeled = 0;
  uint64_t lost = 0, missing = 0, doubled = 0, duplicates = 0;
  double held = 0, worst = 0;

  void add(const testing::SimulationResult& result) {
    ++runs;
    sent += result.sent;
    labeled += result.labeled;
    late += result.late;
    late_mislabeled += result.late_mislabeled;
    unlabeled_runs += result.counts.markers == 0 ? 1 : 0;
    mislabeled += result.mislabeled;
    ambiguous += result.ambiguous;
    lost += result.lost;
    missing += result.counts.missing;
    uncounted += result.lost != result.counts.missing ? 1 : 0;
    doubled += result.doubled;
    duplicates += result.counts.duplicates;
    held = std::max(held, result.held);
    worst =
        std::max(worst, static_cast<double>(result.ambiguous) / static_cast<double>(result.sent));
  }
};

/// Two cameras with their own clocks, losses and ids: equal triggers form a set.
uint64_t false_sets(const testing::SimulationResult& a, const testing::SimulationResult& b) {
  std::vector<int64_t> truth_of_label;
  for (size_t i = 0; i < a.label_of_token.size(); ++i) {
    if (a.label_of_token[i] < 0) continue;
    const auto label = static_cast<size_t>(a.label_of_token[i]);
    if (truth_of_label.size() <= label) truth_of_label.resize(label + 1, -1);
    truth_of_label[label] = a.trigger_of_token[i];
  }
  uint64_t wrong = 0;
  for (size_t i = 0; i < b.label_of_token.size(); ++i) {
    const int64_t label = b.label_of_token[i];
    if (label < 0 || static_cast<size_t>(label) >= truth_of_label.size()) continue;
    const int64_t truth = truth_of_label[static_cast<size_t>(label)];
    wrong += truth >= 0 && truth != b.trigger_of_token[i] ? 1 : 0;
  }
  return wrong;
}

}  // namespace

int main(int argc, char** argv) try {
  CameraSimulation camera;
  int frames = 10000, seeds = 50, full_lost = 0;
  const bench::Options known{
      {"--frames", bench::integer(frames)},       {"--seeds", bench::integer(seeds)},
      {"--jitter", bench::number(camera.jitter)}, {"--drift", bench::number(camera.drift)},
      {"--lost", bench::number(camera.lost)},     {"--doubled", bench::number(camera.doubled)},
      {"--late", bench::number(camera.late)},     {"--full-frame-lost", bench::integer(full_lost)}};
  if (!bench::read(known, argc, argv, "labeling_bench.cpp") || frames < 1 || seeds < 1) return 2;
  camera.frames = static_cast<uint64_t>(frames);
  camera.full_frame_lost = full_lost != 0;
  const auto lights = stage_lights(geodesic_directions(331));
  LightProgram endless = static_capture(lights);
  endless.repeat = 0;
  const std::pair<const char*, LightProgram> programs[] = {{"performance", performance(lights)},
                                                           {"static, again and again", endless}};
  std::printf(
      "%d runs of %d triggers each; %.3g %% lost, %.3g %% doubled, jitter up to %.3g "
      "periods, drift %.3g ppm\n\n",
      seeds, frames, camera.lost * 100, camera.doubled * 100, camera.jitter, camera.drift);
  std::printf(
      "| program | jitter | labels from | good frames | mislabeled | not labeled (worst run) | "
      "lost: true / counted | doubled: true / counted | runs miscounted | held, frames at "
      "most | two cameras: false sets | runs without labels | "
      "late: mislabeled / all |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, program] : programs)
    for (const auto distribution :
         {CameraSimulation::Jitter::uniform, CameraSimulation::Jitter::normal})
      for (const uint32_t bits : {0U, 16U, 64U}) {
        Row row;
        uint64_t wrong_sets = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
          testing::SimulationResult pair[2];
          for (int which = 0; which < 2; ++which) {
            CameraSimulation one = camera;
            one.distribution = distribution;
            one.seed = static_cast<uint64_t>(2 * seed + which);
            one.id_bits = bits;
            one.first_id = bits == 64 ? ~uint64_t{0} - 3000 : 65400;
            one.ids_skip_zero = seed % 2;
            one.drift *= which ? -1 : 1;
            one.idle = seed % 5 == 0 ? 0 : 50;
            FrameLabeler::Params params;
            params.id_bits = bits;
            pair[which] = testing::simulate(program, one, params);
            row.add(pair[which]);
          }
          wrong_sets += false_sets(pair[0], pair[1]);
        }
        std::printf(
            "| %s | %s | %s | %llu | %llu | %.4f %% (%.3f %%) | %llu / %llu | %llu / %llu | "
            "%llu | %.0f | %llu | %llu | %llu / %llu |\n",
            name, distribution == CameraSimulation::Jitter::uniform ? "uniform" : "normal, cut",
            bits == 0    ? "times"
            : bits == 16 ? "ids of 16 bits"
                         : "ids of 64 bits",
            static_cast<unsigned long long>(row.sent),
            static_cast<unsigned long long>(row.mislabeled),
            100.0 * static_cast<double>(row.ambiguous) / static_cast<double>(row.sent),
            100 * row.worst, static_cast<unsigned long long>(row.lost),
            static_cast<unsigned long long>(row.missing),
            static_cast<unsigned long long>(row.doubled),
            static_cast<unsigned long long>(row.duplicates),
            static_cast<unsigned long long>(row.uncounted), row.held,
            static_cast<unsigned long long>(wrong_sets),
            static_cast<unsigned long long>(row.unlabeled_runs),
            static_cast<unsigned long long>(row.late_mislabeled),
            static_cast<unsigned long long>(row.late));
      }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "labeling-bench: %s\n", error.what());
  return 1;
}
