// SPDX-License-Identifier: LGPL-2.1-or-later
// The device and OpenCV's dnn with the same model in turn: onnx-bench [--layers] [--runs N] [--size
// N] MODEL.onnx …; --layers: node by node, by the model's names. N: number of runs; image's side.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "kernels/network/network.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/timing.hpp"
#include "tools/onnx/onnx_import.hpp"

namespace {

using namespace inverse;
using bench::Clock;

/// 1e9 floating-point operations of a node.
double gflop(const network::Network& net, uint32_t node) {
  return 1e-9 * static_cast<double>(network::operations_of(net.graph(), node, net.plan().shapes));
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
    const double work = gflop(net, step.node), ms = bench::median(ours[s]);
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
  std::vector<network::Shape> shapes;  // one image for each input
  for (const network::Input& input : graph.inputs) shapes.push_back({input.channels, size, size});
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
  double work = 0;
  for (const network::Step& step : net.plan().steps) work += gflop(net, step.node);
  const double a = bench::median(ours), b = bench::median(theirs);
  std::printf(
      "%-24s %4u x %-4u %8.4f GFLOP  device %8.2f ms %6.1f GFLOP/s  OpenCV %8.2f ms %6.1f GFLOP/s  "
      "%5.2f\n",
      name.c_str(), size, size, work, a, 1e3 * work / a, b, 1e3 * work / b, a / b);
  if (layers) compare_layers(net, peer, image, runs, device);
}

}  // namespace

int main(int argc, char** argv) {
  bool layers = false;
  int runs = 21, size = 128;
  std::vector<std::string> files;
  if (!bench::read({{"--runs", bench::integer(runs)},
                    {"--size", bench::integer(size)},
                    {"--layers", bench::flag([&layers] { layers = true; })}},
                   argc, argv, "onnx_bench.cpp", &files))
    return 2;
  try {
    const auto device = gpu::Device::open();
    std::printf("%s, %d threads of OpenCV\n", device->name().c_str(), cv::getNumThreads());
    for (const std::string& path : files) {
      std::ifstream file(path, std::ios::binary);
      if (!file) throw Error(ErrorKind::file, path + ": it cannot be read");
      compare(path, {std::istreambuf_iterator<char>(file), {}},
              static_cast<uint32_t>(std::max(size, 1)), std::max(runs, 1), layers, device);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
