// SPDX-License-Identifier: LGPL-2.1-or-later
#include "inputs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace inverse::extremes {
namespace {

constexpr float kPlusInfinity = std::numeric_limits<float>::infinity();
constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kLargest = std::numeric_limits<float>::max();

/// A picture to be spoilt.
class Canvas {
 public:
  Canvas(const Case& one, uint32_t frame)
      : one_(one), frame_(frame), pixels_(4 * size_t{one.width} * one.height, 1.0F) {
    std::mt19937 random(one.seed);
    std::uniform_real_distribution<float> unit(0, 1);
    float paints[16][3];
    for (auto& paint : paints)
      for (float& channel : paint) channel = 0.05F + 0.9F * unit(random);
    each_pixel([&](uint32_t x, uint32_t y, float* pixel) {
      const float light = x + 2 * y + frame > one.width ? 0.9F : 0.35F;
      for (size_t c = 0; c < 3; ++c) pixel[c] = light * paints[(x / 5 + y / 3 * 7) % 16][c];
    });
  }

  Pixels take() { return std::move(pixels_); }

  void lay(Fault fault) {
    std::mt19937 random(one_.seed * 64 + static_cast<uint32_t>(fault));
    std::uniform_real_distribution<float> unit(0, 1);
    const float red = unit(random);
    switch (fault) {
      case kBlack:
        return fill(0, 0, 0);
      case kWhite:
        return fill(1, 1, 1);
      case kOneColor:
        return fill(red, unit(random) < 0.5F ? 0 : 1, unit(random));
      case kFaintNoise:
        return each_channel([&](float& v) { v = unit(random) / 255; });
      case kCheckerboard:
        return each_pixel(
            [](uint32_t x, uint32_t y, float* p) { std::fill_n(p, 3, (x + y) % 2 ? 1.0F : 0.0F); });
      case kFlashing:
        return fill(static_cast<float>(frame_ % 2), static_cast<float>(frame_ % 2),
                    static_cast<float>(frame_ % 2));
      case kHalfBlack:
        return each_pixel([&](uint32_t x, uint32_t y, float* p) {
          if (red < 0.5F ? 2 * x < one_.width : 2 * y < one_.height) std::fill_n(p, 3, 0.0F);
        });
      case kStripes:
        return each_pixel([&](uint32_t x, uint32_t y, float* p) {
          if ((red < 0.5F ? x : y) % 3 == 0) std::fill_n(p, 3, unit(random) < 0.5F ? 0.0F : 1e4F);
        });
      case kNegative:
        return some(0.1F, -3, random);
      case kHotPixel:
        pixels_[4 * (random() % (pixels_.size() / 4)) + random() % 3] = 1e4F;
        return;
      case kHuge:
        return some(0.02F, unit(random) < 0.5F ? 3e38F : kLargest, random);
      case kDenormal:
        return some(0.1F, 1e-40F, random);
      case kNan:
        return some(0.05F, kNoNumber, random);
      case kInfinite:
        return some(0.05F, kPlusInfinity, random);
      case kMinusInfinite:
        return some(0.05F, -kPlusInfinity, random);
      case kColorNoise:
        return each_channel([&](float& v) { v += 0.6F * (unit(random) - 0.5F); });
      case kSaturated: {
        const float left = red - 0.5F, top = unit(random) - 0.5F;
        const uint32_t full = 1 + random() % 7;
        return each_pixel([&](uint32_t x, uint32_t y, float* p) {
          const auto within = [](float from, uint32_t at, uint32_t size) {
            const float u = (static_cast<float>(at) + 0.5F) / static_cast<float>(size) - from;
            return u >= 0 && u <= 0.6F;
          };
          if (!within(left, x, one_.width) || !within(top, y, one_.height)) return;
          for (uint32_t c = 0; c < 3; ++c)
            if (full >> c & 1U) p[c] = 1;
        });
      }
      case kGray:
        return each_pixel([](uint32_t, uint32_t, float* p) { p[0] = p[2] = p[1]; });
      case kFaults:
        return;
    }
  }

 private:
  template <typename F>
  void each_pixel(F f) {
    for (uint32_t y = 0; y < one_.height; ++y)
      for (uint32_t x = 0; x < one_.width; ++x) f(x, y, &pixels_[4 * (size_t{y} * one_.width + x)]);
  }
  template <typename F>
  void each_channel(F f) {
    for (size_t i = 0; i < pixels_.size(); ++i)
      if (i % 4 < 3) f(pixels_[i]);
  }
  void fill(float r, float g, float b) {
    each_pixel([&](uint32_t, uint32_t, float* p) { p[0] = r, p[1] = g, p[2] = b; });
  }
  void some(float share, float value, std::mt19937& random) {
    std::uniform_real_distribution<float> unit(0, 1);
    each_channel([&](float& v) { v = unit(random) < share ? value : v; });
  }

  const Case& one_;
  uint32_t frame_;
  Pixels pixels_;
};

}  // namespace

const char* name_of(Fault fault) {
  constexpr const char* kNames[] = {
      "black",      "white",    "one color",      "faint noise", "checkerboard", "flashing",
      "half black", "stripes",  "negative",       "hot pixel",   "huge",         "denormal",
      "NaN",        "infinite", "minus infinite", "color noise", "saturated",    "gray"};
  static_assert(std::size(kNames) == kFaults);
  return kNames[fault];
}

uint32_t faults_for(Solver solver) { return is_global(solver) ? kFaults : kColorNoise; }

Pixels frame_of(const Case& one, uint32_t frame) {
  Canvas canvas(one, frame);
  for (uint32_t bit = 0; bit < kFaults; ++bit)
    if (one.faults >> bit & 1U) canvas.lay(static_cast<Fault>(bit));
  return canvas.take();
}

namespace {

/// Of what solves: intrinsicdecomp's knobs, in whatever has its parameters.
template <typename Params>
void turn_knobs(const Case& one, Params& params) {
  std::mt19937 random(one.seed);
  const auto end = [&] { return random() % 2 ? 1e3F : 1e-3F; };  // drawn whether it is used or not
  const float ends[] = {end(), end(), end(), end(), end()};
  const bool less = random() % 2;
  params.light.slope = 0;
  if (one.knobs & 1U) params.prior.reflectance_weight = ends[0];
  if (one.knobs & 2U) params.prior.shading_weight = ends[1];
  if (one.knobs & 4U) params.prior.value_weight = ends[2];
  if (one.knobs & 8U) params.prior.chroma_weight = ends[3] < 1 ? 0 : ends[3];
  if (one.knobs & 16U) {
    params.anchor.anchor_weight = ends[4] < 1 ? 0 : ends[4];
    params.light.slope.reset();
  }
  if (one.knobs & 32U) {
    params.cycles = less ? 1 : 32;
    params.warm_cycles = less ? 1 : 8;
    params.anchor.hold = 0.99F;
    params.anchor.hold_light = less ? 1e-3F : 10;
    params.scale.white_quantile = less ? 0 : 1;
    params.light.slope = less ? -SceneLight::kMaxSlope : SceneLight::kMaxSlope;
  }
}

}  // namespace

IntrinsicDecomposition::Params intrinsic_params_of(const Case& one) {
  IntrinsicDecomposition::Params params;
  turn_knobs(one, params);
  return params;
}

GlobalIntrinsic::Params global_params_of(const Case& one) {
  GlobalIntrinsic::Params params;
  std::mt19937 random(~one.seed);
  const auto either = [&](float low, float high) { return random() % 2 ? high : low; };
  // Drawn whether they are used or not.
  const float reach = either(0.02F, 2), near = either(0, 1), own = either(0, 0.95F),
              amount = either(0.01F, 2), typical = either(0.05F, 2),
              measurement_weight = either(0, 100), neutral = either(0, 10), share = either(0, 0.5F),
              same = either(0, 3), white = either(0, 1), cut = either(0, 1),
              renew = either(0.01F, 1), smoothing = either(0.5F, 2.5F), residual = either(0, 1);
  const bool one_color = random() % 2;
  if (one.knobs & 1U) params.reach = reach, params.near_share = near, params.own = own;
  if (one.knobs & 2U) params.amount = amount;
  if (one.knobs & 4U)
    params.typical_amount = typical, params.measurement_weight = measurement_weight,
    params.neutral = neutral;
  if (one.knobs & 8U) {
    params.base_colors = one_color ? 1 : 16;
    params.min_share = share;
    params.same_color = same;
  }
  if (one.knobs & 16U) {
    params.white_balance = white;
    params.cut_chroma = cut;
    params.update_rate = renew;
    params.smoothing = smoothing;
    params.residual = residual;
  }
  if (one.knobs & 32U) {
    Case solve = one;
    solve.knobs = one.seed % 63 + 1;
    turn_knobs(solve, params);
  }
  return params;
}

GlobalThesisParams global_thesis_params_of(const Case& one) {
  GlobalThesisParams params;
  std::mt19937 random(~one.seed);
  const auto end = [&] { return random() % 2 ? 1e6F : random() % 2 ? 1e-6F : 0.0F; };
  const float ends[] = {end(), end(), end(), end(), end(), end(), end(), end()};
  const uint32_t draw = random();
  if (one.knobs & 1U) params.lambda_data = ends[0], params.lambda_clustering = ends[1];
  if (one.knobs & 2U) params.lambda_r_sparsity = ends[2], params.lambda_r_consistency = ends[3];
  if (one.knobs & 4U) params.lambda_monochrome = ends[4], params.lambda_i_sparsity = ends[5];
  if (one.knobs & 8U) params.lambda_smoothness = ends[6], params.lambda_non_negativity = ends[7];
  if (one.knobs & 16U) {
    params.p = draw % 3 == 0 ? 0.0F : draw % 3 == 1 ? 2.0F : 1.0F;
    params.epsilon = params.epsilon_r = draw & 4U ? 1e-4F : 1.0F;
    params.irls =
        draw & 8U ? GlobalThesisParams::Irls::printed : GlobalThesisParams::Irls::consistent;
    params.warm_start = draw & 16U;
    params.steps = draw & 32U ? 1 : 20;
  }
  if (one.knobs & 32U) {
    params.alpha_sr = draw & 64U ? 1e4F : 0;
    params.tau_cc = params.tau_merge = draw & 128U ? 3.0F : 0;
    params.tau_neutral = draw & 256U ? 3.0F : 0;
    params.log_floor = params.chroma_floor = draw & 512U ? 1e-6F : 0.5F;
    params.indirect_start = draw & 1024U ? 1.0F : 0;
    params.clusters = draw & 2048U ? 1 : 16;
    params.keyframe_spacing = 1;
  }
  return params;
}

ThesisParams thesis_params_of(const Case& one) {
  ThesisParams params;
  params.solver =
      one.solver == Solver::schwarz ? ThesisParams::Solver::schwarz : ThesisParams::Solver::pcg;
  std::mt19937 random(one.seed);
  const auto end = [&] { return random() % 2 ? 1e6F : random() % 2 ? 1e-6F : 0.0F; };
  const float ends[] = {end(), end(), end(), end(), end(), end()};
  const uint32_t draw = random();
  if (one.knobs & 1U) params.w_data = ends[0];
  if (one.knobs & 2U) params.w_reflectance = ends[1];
  if (one.knobs & 4U) params.w_shading = ends[2], params.w_chromaticity = ends[3];
  if (one.knobs & 8U) params.w_non_local = ends[4], params.w_clustering = ends[5];
  if (one.knobs & 16U) {
    params.p = draw % 3 == 0 ? 0.0F : draw % 3 == 1 ? 1.0F : 0.01F;
    params.epsilon = draw & 4U ? 1e-6F : 1.0F;
    params.irls = draw & 8U ? ThesisParams::Irls::printed : ThesisParams::Irls::consistent;
  }
  if (one.knobs & 32U) {
    params.alpha_cs = draw & 16U ? 1e4F : 0.0F;
    params.tau_cc = draw & 32U ? 3.0F : 0.0F;
    params.log_floor = params.chroma_floor = draw & 64U ? 1e-6F : 0.5F;
    params.levels = draw & 128U ? 1 : 12;
    params.keyframe_spacing = 1;
  }
  return params;
}

float finite_light(float value, float largest) {
  if (!(value > 0)) return 0;
  return std::isinf(value) ? 1 : std::min(value, largest);
}

}  // namespace inverse::extremes
