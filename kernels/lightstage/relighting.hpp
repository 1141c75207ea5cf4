// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "kernels/lightstage/lights/light_reduction.hpp"
#include "kernels/lightstage/lights/measured_light.hpp"
#include "kernels/lightstage/lobe/cosine_lobe.hpp"
#include "kernels/lightstage/network/relight_network.hpp"

namespace inverse {

/// A stage for relighting: directions of its lights and derived quantities.
struct RelightStage {
  explicit RelightStage(std::vector<Direction> lights)
      : cells(std::move(lights)),
        moments(std::make_shared<const LobeMoments>(cells.lights())),
        share(cells.covered() /
              (4 * 3.14159265358979 * static_cast<double>(cells.lights().size()))) {}
  const std::vector<Direction>& lights() const { return cells.lights(); }

  LightCells cells;
  std::shared_ptr<const LobeMoments> moments;
  double share;  ///< of the sphere that one light stands for
};

/// Relights a subject from two gradients of a light stage, frame by frame. Results that depend on
/// the image alone are computed once and reused while it is unchanged. The network evaluates only
/// the lights of the environment that matter.
class Relighting {
 public:
  enum class Model : uint8_t { cosine_lobe, network };
  struct Params {
    Model model = Model::cosine_lobe;
    float rotation = 0;       ///< of the environment about y, degrees
    float exposure = 0;       ///< stops
    float max_error = 0.02F;  ///< of a relit image with few lights, relative to its mean
    bool adaptive = true;     ///< false: all lights at every pixel
    CosineLobe::Params lobe;
  };
  struct Stats {
    uint64_t lights = 0;        ///< of the stage
    uint64_t lit = 0;           ///< of these, lights that the environment turns on
    uint64_t evaluated = 0;     ///< lights that were summed
    double expected_error = 0;  ///< from skipped lights
    double shown = 1;           ///< share of the environment's light within the stage's cells
    bool fitted = false;        ///< the image differs from the one before
  };

  /// `models` may be null: then there is no network.
  Relighting(const std::shared_ptr<gpu::Device>& device, Extent extent,
             std::shared_ptr<const RelightStage> stage, const RelightModels* models);

  void set_environment(LightCells::Map map);
  /// A new scene: discards results of earlier frames.
  void forget();

  /// Adds the frame of this number (increasing by one per frame). `again`: it is unchanged. `lit`:
  /// relit images will be drawn. Throws Error(internal) if the network is requested and missing.
  void record_pair(gpu::Commands& commands, const GradientPair& pair, const Params& params,
                   uint64_t number, bool again, bool lit);
  /// The subject under the environment.
  void record_relit(gpu::Commands& commands, const Params& params, const Plane& target);
  /// The subject under one light from any direction, as bright as a quarter of the stage's lights:
  /// a white wall facing it is as bright as under all of them.
  void record_olat(gpu::Commands& commands, const Params& params, const Direction& light,
                   const Plane& target);
  const CosineLobe& lobes() const { return lobe_; }

  /// Increases whenever an image with the same parameters would differ.
  uint64_t version() const { return version_; }
  const Stats& stats() const { return stats_; }
  uint64_t network_bytes() const { return network_ ? network_->bytes() : 0; }

  static constexpr uint64_t kEvery = 8;       ///< frames from one selection of lights to the next
  static constexpr uint64_t kRetry = 64;      ///< the same after few lights were not enough
  static constexpr uint32_t kSamples = 1600;  ///< sampled pixels

 private:
  void take_responses(const Params& params, uint64_t number);
  void choose(const Params& params);
  RelightNetwork& network() const;

  std::shared_ptr<gpu::Device> device_;
  std::shared_ptr<const RelightStage> stage_;
  CosineLobe lobe_;
  std::unique_ptr<RelightNetwork> network_;
  LightCells::Map map_;

  std::optional<Params> weighed_;  // parameters that weights_ are of
  std::vector<Rgb> weights_;
  SplitLight split_;  // these, for the network
  std::optional<LightReduction::Choice> choice_;
  std::optional<Params> chosen_;  // parameters that choice_ is of
  uint64_t retry_ = 0;            // the frame before which all lights stay all
  bool table_is_old_ = true;
  float table_exposure_ = 0;

  std::optional<CosineLobe::Params> fitted_;  // of the frame that lobe_ holds
  bool has_features_ = false;
  gpu::BufferPtr samples_, responses_;
  std::optional<uint64_t> asked_;        // the frame whose responses are on their way
  std::optional<uint64_t> measured_at_;  // the frame whose light was measured last
  LightReduction reduction_;
  uint64_t version_ = 0;
  Stats stats_;
};

}  // namespace inverse
