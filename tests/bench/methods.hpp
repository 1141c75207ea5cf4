// The decomposition methods that the accuracy bench compares, under one signature.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "kernels/intrinsic_thesis/thesis_params.hpp"
#include "tests/bench/baselines.hpp"
#include "tests/reference/intrinsic_decomposition.hpp"

namespace inverse::bench {

/// Decomposes a frame; with `continues` it is the next one of the sequence that the method saw last
/// (a method without memory ignores that).
using Method = std::function<Decomposition(const Image& frame, bool continues)>;

struct Named {
  std::string name;
  Method run;
  bool parallel = true;  ///< May run on several frames at a time, and knows no sequences.
};

/// What has no relation to this project's methods: trivial answers and Retinex.
std::vector<Named> baselines();

/// The plain C++ specification; with `memory` it follows one sequence, without it takes every frame
/// on its own.
Named reference_intrinsic(const std::string& name, const reference::IntrinsicParams& params,
                          bool memory);
/// The same of the thesis' method, every frame on its own.
Named reference_thesis();

/// The kernels, and how long they take. Every method has a memory of its own.
class DeviceMethods {
 public:
  DeviceMethods();
  Named intrinsic(const std::string& name, const IntrinsicDecomposition::Params& params);
  Named thesis(const std::string& name, const ThesisParams& params);

  /// Of the frames decomposed since the last call, from the recording of the commands to their end,
  /// without the first frame of each size, for 640 x 480 pixels: milliseconds on the
  /// clock and of the processor, all threads.
  struct Time {
    double wall = 0, processor = 0;
  };
  Time take_time();
  std::string device_name() const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace inverse::bench
