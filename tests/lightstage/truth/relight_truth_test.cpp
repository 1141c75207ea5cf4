// SPDX-License-Identifier: LGPL-2.1-or-later
// olatrelight against truth: the virtual stage's head, seen from a side that no other test uses,
// under gradients of 42 lights; what it looks like under other light is the sum of its pictures
// under single ones.
#include <filesystem>

#include "kernels/lightstage/relighting.hpp"
#include "kernels/lightstage/virtual_stage/virtual_head.hpp"
#include "tests/has_networks.hpp"
#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {
namespace {

constexpr Extent kExtent{96, 128};
constexpr uint32_t kLights = 42;
constexpr float kGain = 1.6F / kLights;

class RelightTruth : public GpuTest {
 protected:
  void SetUp() override {
    GpuTest::SetUp();
    stage_ = std::make_shared<const RelightStage>(geodesic_directions(kLights));
    stack_ = std::make_unique<OlatStack>(device, kExtent, kLights, uint64_t{1} << 30);
    HeadView view;
    view.turn = -0.37F;
    view.height = 2.9F;
    ASSERT_TRUE(render_head(*stack_, stage_->lights(), view));
    std::vector<LightColor> a(kLights), b(kLights);
    for (size_t i = 0; i < kLights; ++i)
      for (size_t c = 0; c < 3; ++c) {
        const auto along = static_cast<float>(stage_->lights()[i][c]);
        a[i][c] = kGain * (1 + along) / 2;
        b[i][c] = kGain * (1 - along) / 2;
      }
    a_ = lit(a);
    b_ = lit(b);
  }
  /// The head under lights of these colors: truth.
  PlanePtr lit(const std::vector<LightColor>& colors) {
    PlanePtr sum;
    run([&](gpu::Commands& commands) { sum = stack_->record(commands, colors); });
    return sum;
  }
  Pixels true_picture(std::vector<LightColor> colors) {
    for (LightColor& color : colors)
      for (float& c : color) c *= kGain;
    return download(lit(colors)->buffer);
  }
  /// Sum of absolute differences over the sum of truth, of all pictures that were added.
  struct Distance {
    double off = 0, all = 0;
    void add(const Pixels& got, const Pixels& truth) {
      for (size_t i = 0; i < truth.size(); ++i) {
        if (i % 4 == 3) continue;
        off += std::abs(static_cast<double>(got[i] - truth[i]));
        all += static_cast<double>(truth[i]);
      }
    }
    double share() const { return off / all; }
  };
  struct Errors {
    double light, environment;
  };
  /// Of pictures under single lights, and under an environment.
  Errors errors(Relighting::Model model, const RelightModels* models) {
    Relighting method(device, kExtent, stage_, models);
    const LightCells::Map map = LightCells::map(Environment::studio());
    method.set_environment(map);
    const Relighting::Params params{.model = model, .adaptive = false};
    const Plane target = plane(kExtent);
    Distance light, environment;
    constexpr size_t kEvery = 5;
    for (size_t i = 0; i < kLights; i += kEvery) {
      run([&](gpu::Commands& commands) {
        method.record_pair(commands, {*a_, *b_}, params, i / kEvery, i > 0, true);
        method.record_olat(commands, params, stage_->lights()[i], target);
      });
      std::vector<LightColor> one(kLights);
      one[i].fill(kLights / 4.0F);
      light.add(download(target), true_picture(one));
    }
    run([&](gpu::Commands& commands) {
      method.record_pair(commands, {*a_, *b_}, params, kLights, true, false);
      method.record_relit(commands, params, target);
    });
    const auto weights = stage_->cells.weights(map);
    environment.add(download(target), true_picture({weights.begin(), weights.end()}));
    const Errors e{light.share(), environment.share()};
    printf("  one light %.4f, environment %.4f\n", e.light, e.environment);
    return e;
  }

  std::shared_ptr<const RelightStage> stage_;
  std::unique_ptr<OlatStack> stack_;
  PlanePtr a_, b_;
};

TEST_F(RelightTruth, TheNetworkIsAsGoodAsItWas) {
  const char* folder = std::getenv("INVERSE_MODELS");
  if (!folder || !std::filesystem::exists(std::string(folder) + "/olat/features.net"))
    GTEST_SKIP() << "built without inverse-onnx-import";
  const RelightModels models = RelightModels::load(std::string(folder) + "/olat");
  const Errors e = errors(Relighting::Model::network, &models);
  EXPECT_LT(e.light, 0.164);         // 0.1564 when this was written
  EXPECT_LT(e.environment, 0.0807);  // 0.0769
}

TEST_F(RelightTruth, TheCosineLobeIsAsGoodAsItWas) {
  const Errors e = errors(Relighting::Model::cosine_lobe, nullptr);
  EXPECT_LT(e.light, 0.191);         // 0.1819
  EXPECT_LT(e.environment, 0.0741);  // 0.0706
}

}  // namespace
}  // namespace inverse::testing
