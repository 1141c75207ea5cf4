// SPDX-License-Identifier: LGPL-2.1-or-later
// A subject of an OlatSet on the device, for the benchmarks of relighting.
#pragma once

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "kernels/lightstage/relighting.hpp"
#include "olat_set.hpp"
#include "tests/bench/support/timing.hpp"
#include "tests/lab.hpp"

namespace inverse::bench {

struct NamedEnvironment {
  std::string name;
  LightCells::Map map;
};

/// One subject on the device with one method. Frames of another size than the set's repeat pixels.
class Subject {
 public:
  Subject(const std::shared_ptr<gpu::Device>& device, const OlatSet& set, Extent extent,
          const RelightModels* models)
      : device_(device),
        stage_(std::make_shared<const RelightStage>(set.directions)),
        extent_(extent),
        lobe_(device, extent, stage_->moments, stage_->lights()),
        a_(uploaded(set.a)),
        b_(uploaded(set.b)),
        target_(PlanePool(device, extent).acquire()),
        commands_(device) {
    if (models) network_ = std::make_unique<RelightNetwork>(device, extent, *models);
    run([&] {
      find_lobes();
      if (network_) network_->record_features(commands_, {*a_, *b_});
    });
  }

  /// Responses to lights, summed one by one; the network adds the measured light, too.
  Image sum(std::span<const WeightedLight> lights, const MeasuredLight& measured = {}) {
    run([&] { record_sum(lights, measured); });
    return picture();
  }
  void record_sum(std::span<const WeightedLight> lights, const MeasuredLight& measured = {}) {
    if (network_)
      network_->record_sum(commands_, *lobe_.full(), lights, stage_->share, *target_, measured);
    else
      lobe_.record_sum(commands_, lights, *target_);
  }
  Image relit_by_table(std::span<const WeightedLight> lights) {
    run([&] {
      lobe_.record_lights(commands_, lights);
      lobe_.record_relit(commands_, *target_);
    });
    return picture();
  }
  /// Responses of these pixels to every light.
  std::vector<float> responses(const std::vector<uint32_t>& pixels) {
    const auto words =
        gpu::Buffer::create(device_, gpu::Element::word, pixels.size(), gpu::Memory::upload);
    std::copy(pixels.begin(), pixels.end(), words->map_as<uint32_t>());
    const auto out =
        gpu::Buffer::create(device_, gpu::Element::vec4, pixels.size() * stage_->lights().size(),
                            gpu::Memory::readback);
    run([&] {
      if (network_)
        network_->record_responses(commands_, *lobe_.full(), stage_->lights(), stage_->share, words,
                                   out);
      else
        lobe_.record_responses(commands_, words, out);
    });
    return {out->map_as<float>(), out->map_as<float>() + 4 * out->count()};
  }
  template <typename Record>
  double time(int runs, Record record) {
    std::vector<double> times;
    for (int i = 0; i <= runs; ++i) {
      const auto start = Clock::now();
      run(record);
      if (i > 0) times.push_back(milliseconds(Clock::now() - start));
    }
    return median(times);
  }
  template <typename Record>
  void run(Record record) {
    commands_.begin();
    record();
    commands_.submit();
    commands_.wait();
  }
  void find_lobes() { lobe_.record_lobes(commands_, {*a_, *b_}, {}); }
  void find_features() { network_->record_features(commands_, {*a_, *b_}); }
  void make_table(std::span<const WeightedLight> lights) { lobe_.record_lights(commands_, lights); }
  void look_up() { lobe_.record_relit(commands_, *target_); }
  const RelightStage& stage() const { return *stage_; }

 private:
  PlanePtr uploaded(const Image& image) {
    const auto buffer =
        gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels(), gpu::Memory::upload);
    auto* to = buffer->map_as<float>();
    for (uint32_t y = 0; y < extent_.height; ++y)
      for (uint32_t x = 0; x < extent_.width; ++x, to += 4) {
        for (int c = 0; c < 3; ++c)
          to[c] =
              image.at(static_cast<int>(x) * image.width / static_cast<int>(extent_.width),
                       static_cast<int>(y) * image.height / static_cast<int>(extent_.height), c);
        to[3] = 1;
      }
    return std::make_shared<Plane>(Plane{extent_, buffer});
  }
  Image picture() {
    const Pixels pixels = Lab(device_).download(target_->buffer);
    Image image(static_cast<int>(extent_.width), static_cast<int>(extent_.height), 3);
    for (size_t i = 0; i < image.data.size(); ++i) image.data[i] = pixels[i / 3 * 4 + i % 3];
    return image;
  }

  std::shared_ptr<gpu::Device> device_;
  std::shared_ptr<const RelightStage> stage_;
  Extent extent_;
  CosineLobe lobe_;
  std::unique_ptr<RelightNetwork> network_;
  PlanePtr a_, b_, target_;
  gpu::Commands commands_;
};

/// Prints a message if no set is named.
std::vector<OlatSet> read_sets(const std::vector<std::string>& paths);
/// The studio if no environment is named.
std::vector<NamedEnvironment> read_environments(const std::vector<std::string>& paths);
/// All lights of a stage with their weights.
std::vector<WeightedLight> weighted(const RelightStage& stage, std::span<const Rgb> weights);
/// The subject under all lights of the set, weighted.
Image true_sum(const OlatSet& set, std::span<const Rgb> weights);
/// Mean absolute difference over the subject, relative to the mean of `truth`.
double relative(const Image& got, const Image& truth, const Image& mask);
/// An image at another size: box means if smaller, bilinear if larger.
Image resized(const Image& image, int width, int height);

}  // namespace inverse::bench
