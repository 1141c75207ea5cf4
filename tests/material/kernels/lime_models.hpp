// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <filesystem>

#include "kernels/material/networks/lime_models.hpp"
#include "kernels/network/graph_file.hpp"
#include "tests/kernels/network/network_builder.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {

/// Networks of limematerial that were made by hand, so that what comes of a frame is known: what is
/// red is the object; the code of its specular layer is half of blue, that of the mirror image
/// twice as much; the diffuse albedo is (r, g, b) = (.2, .5, .7), alpha is the logistic of 8 times
/// the mean code less 1, and bin 5 has by far the largest probability.
class HandMadeLime {
 public:
  static constexpr uint32_t kSide = 32;

  static LimeModels models() {
    using network::Activation;
    LimeModels m;
    m.side = kSide;
    m.segmentation = pointwise(3, {60, -60, 0}, -20, Activation::sigmoid);
    m.specular = pointwise(4, {0, 0, .5F, 0}, 0, Activation::relu);
    m.mirror = pointwise(1, {2}, 0, Activation::relu);
    NetworkBuilder albedo(1), exponent(1);
    albedo.output(albedo.dense(albedo.simple(network::Op::global_mean, image(albedo, 4)), 4, 4,
                               Activation::sigmoid));
    m.albedo = albedo.graph();
    m.albedo.weights.assign(m.albedo.weights.size(), 0);
    m.albedo.weights[4 * 3 + 3] = 8;
    const float bias[4] = {logit(.2F), logit(.5F), logit(.7F), -1};
    std::copy(bias, bias + 4, m.albedo.weights.end() - 4);
    exponent.output(exponent.simple(
        network::Op::softmax,
        exponent.dense(exponent.simple(network::Op::global_mean, image(exponent, 2)), 2, 8)));
    m.exponent = exponent.graph();
    m.exponent.weights.assign(m.exponent.weights.size(), 0);
    *(m.exponent.weights.end() - 3) = 5;
    return m;
  }

  /// The same in a folder, as the element takes them; removed with this object.
  HandMadeLime() {
    std::filesystem::create_directory(folder_ / "lime");
    const LimeModels m = models();
    write("segmentation", network::to_file(m.segmentation));
    write("specular", network::to_file(m.specular));
    write("mirror", network::to_file(m.mirror));
    write("albedo", network::to_file(m.albedo));
    write("exponent", network::to_file(m.exponent));
  }

  const std::string& folder() const { return folder_.path(); }
  std::string path(const std::string& name) const { return folder_ / ("lime/" + name + ".net"); }
  void write(const std::string& name, const std::vector<std::byte>& bytes) const {
    folder_.write("lime/" + name + ".net", bytes);
  }

 private:
  static float logit(float p) { return std::log(p / (1 - p)); }
  static uint32_t image(NetworkBuilder& b, uint32_t channels) {
    return b.input(channels, kSide, kSide);
  }
  static network::Graph pointwise(uint32_t channels, const std::vector<float>& weights, float bias,
                                  network::Activation activation) {
    NetworkBuilder b(1);
    b.output(b.convolution(image(b, channels), 1, 1, 1, activation));
    network::Graph graph = b.graph();
    graph.weights = weights;
    graph.weights.push_back(bias);
    return graph;
  }

  TemporaryFolder folder_;
};

}  // namespace inverse::testing
