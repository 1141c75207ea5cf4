// Labels of frames of a light stage: that none is wrong, and that each loss is counted.
#include "light_stage/frame_labeler.hpp"

#include <gtest/gtest.h>

#include "labeling_simulation.hpp"

namespace inverse::testing {
namespace {

using Fate = FrameLabeler::Fate;

std::vector<StageLight> some_lights(uint32_t count = 64) {
  return stage_lights(geodesic_directions(count));
}

/// A program whose pictures all look alike: times and ids are all there is.
LightProgram featureless() {
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

LightProgram endless_static() {
  LightProgram program = static_capture(some_lights(331));
  program.repeat = 0;
  return program;
}

void expect_all_right(const SimulationResult& result, const std::string& what) {
  EXPECT_EQ(result.mislabeled, 0U) << what;
  EXPECT_LE(static_cast<double>(result.ambiguous), 0.01 * static_cast<double>(result.sent)) << what;
  EXPECT_EQ(result.counts.missing, result.lost) << what;
  EXPECT_EQ(result.counts.resynchronizations, 0U) << what;
  EXPECT_EQ(result.counts.markers, 1U) << what;
}

class Programs : public ::testing::TestWithParam<int> {
 protected:
  LightProgram program() const {
    return GetParam() == 0   ? performance(some_lights())
           : GetParam() == 1 ? endless_static()
                             : featureless();
  }
};
INSTANTIATE_TEST_SUITE_P(Labeling, Programs, ::testing::Values(0, 1, 2));

TEST_P(Programs, TenThousandFramesByTimesAlone) {
  const LightProgram lights = program();
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    CameraSimulation camera;
    camera.seed = seed;
    camera.idle = seed % 3 == 0 ? 0 : 50;
    camera.drift = seed % 2 ? 120 : -120;
    camera.distribution =
        seed % 4 < 2 ? CameraSimulation::Jitter::uniform : CameraSimulation::Jitter::normal;
    expect_all_right(simulate(lights, camera, {}), "seed " + std::to_string(seed));
  }
}

TEST_P(Programs, TenThousandFramesByIds) {
  const LightProgram lights = program();
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    CameraSimulation camera;
    camera.seed = seed;
    camera.idle = seed % 3 == 0 ? 0 : 50;
    camera.id_bits = seed % 3 == 0 ? 16 : seed % 3 == 1 ? 64 : 32;
    camera.first_id = camera.id_bits == 16 ? 65400 : ~uint64_t{0} - 3000;
    camera.ids_skip_zero = seed % 2;
    FrameLabeler::Params params;
    params.id_bits = camera.id_bits;
    const auto result = simulate(lights, camera, params);
    expect_all_right(result, "seed " + std::to_string(seed));
    EXPECT_EQ(result.labeled, result.sent) << seed;
  }
}

}  // namespace
}  // namespace inverse::testing
