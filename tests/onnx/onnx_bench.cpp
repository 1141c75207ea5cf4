// SPDX-License-Identifier: LGPL-2.1-or-later
// The device and OpenCV's dnn with the same model in turn: onnx-bench [--layers] [--runs N] [--size
// N] [MODEL.onnx …]. Without a model: U-Nets of three widths. --layers: node by node, by the
// model's names.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "kernels/network/network.hpp"
#include "onnx_builder.hpp"
#include "tests/bench/material/network_figures.hpp"
#include "tests/bench/support/timing.hpp"
#include "tools/onnx/onnx_import.hpp"

namespace {

using namespace inverse;
using bench::Clock;

/// Like image-to-image networks: four strided steps down and up again.
std::string u_net(int64_t width, int64_t size) {
  testing::OnnxBuilder b(1);
  std::string value = b.input("image", {1, 3, size, size});
  std::vector<std::string> skips;
  std::vector<int64_t> widths = {3};
  const auto layer = [&b](const std::string& from, int64_t in, int64_t out, int64_t stride) {
    return b.op("Relu", {b.convolution(from, in, out, 3, stride)});
  };
  for (int level = 0; level < 5; ++level) {
    const int64_t channels = width * (level + 1);
    value = layer(value, widths.back(), channels, level ? 2 : 1);
    widths.push_back(channels);
    skips.push_back(value);
  }
  for (int level = 4; level-- > 0;) {
    const int64_t below = widths[static_cast<size_t>(level) + 2],
                  here = widths[static_cast<size_t>(level) + 1];
    value = layer(b.concat({b.upsample(value), skips[static_cast<size_t>(level)]}), below + here,
                  here, 1);
  }
  b.output(b.op("Sigmoid", {b.convolution(value, width, 1, 1)}), {1, 1, size, size});
  return b.bytes();
}

/// The model's name of a node, from this project's text (Conv "NAME") or OpenCV's (onnx_node!NAME).
std::string node_name(const std::string& text) {
  const size_t quote = text.find('"'), mark = text.find('!');
  if (quote != std::string::npos) return text.substr(quote + 1, text.rfind('"') - quote - 1);
  return mark == std::string::npos ? text : text.substr(mark + 1);
}

/// Runs both in turn and prints the median time of every node in both; the last row is OpenCV's
/// time in nodes that are fused here.
void compare_layers(const network::Network& net, cv::dnn::Net& peer, const cv::Mat& image, int runs,
                    const std::shared_ptr<gpu::Device>& device) {
  gpu::Commands commands(device);
  std::vector<std::vector<double>> ours(net.plan().steps.size());
  std::map<std::string, std::vector<double>> theirs;
  const std::vector<std::string> names = peer.getLayerNames();
  for (int i = -3; i < runs; ++i) {
    commands.begin();
    net.record(commands, true);
    commands.submit();
    commands.wait();
    if (commands.stages().size() != ours.size())
      throw Error(ErrorKind::unsupported, "--layers: the device times " +
                                              std::to_string(commands.stages().size()) + " of " +
                                              std::to_string(ours.size()) + " nodes");
    peer.setInput(image);
    peer.forward();
    if (i < 0) continue;
    for (size_t s = 0; s < ours.size(); ++s) ours[s].push_back(commands.stages()[s].milliseconds);
    std::vector<double> ticks;
    peer.getPerfProfile(ticks);
    for (size_t l = 0; l < ticks.size() && l < names.size(); ++l)
      theirs[node_name(names[l])].push_back(1e3 * ticks[l] / cv::getTickFrequency());
  }
  for (size_t s = 0; s < ours.size(); ++s) {
    const network::Step& step = net.plan().steps[s];
    const network::Shape& out = net.plan().shapes[net.graph().inputs.size() + step.node];
    const std::string name = node_name(net.graph().nodes[step.node].name);
    const double work = bench::gflop(net, step.node), ms = bench::median(ours[s]);
    std::printf("  %-36s %4u x %3u x %3u %8.4f GFLOP  device %7.3f ms %6.1f GFLOP/s", name.c_str(),
                out.channels, out.height, out.width, work, ms, 1e3 * work / ms);
    const auto peer_times = theirs.find(name);
    if (peer_times != theirs.end()) {
      const double peer_ms = bench::median(peer_times->second);
      std::printf("  OpenCV %7.3f ms %6.1f GFLOP/s  %5.2f", peer_ms, 1e3 * work / peer_ms,
                  ms / peer_ms);
      theirs.erase(peer_times);
    }
    std::printf("\n");
  }
  double rest = 0;
  for (const auto& [name, times] : theirs) rest += bench::median(times);
  std::printf("  %-36s %75s OpenCV %7.3f ms\n", "nodes of OpenCV alone", "", rest);
}

/// Runs both in turn and prints medians.
void compare(const std::string& name, const std::string& model, uint32_t size, int runs,
             bool layers, const std::shared_ptr<gpu::Device>& device) {
  const network::Graph graph = onnx_import::graph_of(std::as_bytes(std::span(model)), name);
  const std::vector<network::Shape> shapes = bench::shapes_at(graph, size);
  const network::Network net(device, graph, shapes);
  cv::dnn::Net peer = cv::dnn::readNetFromONNX(model.data(), model.size());
  peer.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  const cv::Mat image(
      {1, static_cast<int>(shapes[0].channels), static_cast<int>(size), static_cast<int>(size)},
      CV_32F, 0.5);
  gpu::Commands commands(device);
  std::vector<double> ours, theirs;
  for (int i = -3; i < runs; ++i) {
    const auto start = Clock::now();
    commands.begin();
    net.record(commands);
    commands.submit();
    commands.wait();
    const auto middle = Clock::now();
    peer.setInput(image);
    peer.forward();
    if (i < 0) continue;
    ours.push_back(bench::milliseconds(middle - start));
    theirs.push_back(bench::milliseconds(Clock::now() - middle));
  }
  const double work = bench::gflop(net);
  const double a = bench::median(ours), b = bench::median(theirs);
  std::printf(
      "%-24s %4u x %-4u %8.4f GFLOP  device %8.2f ms %6.1f GFLOP/s  OpenCV %8.2f ms %6.1f GFLOP/s  "
      "%5.2f\n",
      name.c_str(), size, size, work, a, 1e3 * work / a, b, 1e3 * work / b, a / b);
  if (layers) compare_layers(net, peer, image, runs, device);
}

}  // namespace

int main(int argc, char** argv) {
  bench::NetworkArguments requested;
  bool layers = false;
  if (!requested.read(argc, argv, "onnx_bench.cpp",
                      {{"--layers", bench::flag([&layers] { layers = true; })}}))
    return 2;
  const uint32_t size = requested.size();
  try {
    const auto device = gpu::Device::open();
    std::printf("%s, %d threads of OpenCV\n", device->name().c_str(), cv::getNumThreads());
    for (const std::string& path : requested.files) {
      std::ifstream file(path, std::ios::binary);
      if (!file) throw Error(ErrorKind::file, path + ": it cannot be read");
      compare(path, {std::istreambuf_iterator<char>(file), {}}, size, requested.runs, layers,
              device);
    }
    if (requested.files.empty())
      for (const int64_t width : {8, 16, 32})
        compare("U-Net of " + std::to_string(width), u_net(width, size), size, requested.runs,
                layers, device);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
