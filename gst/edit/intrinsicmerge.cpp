// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicmerge: takes pictures of layers that went through other effects back into the layers.
#include "effects/returns.hpp"

namespace inverse {
namespace {

const PropertyTable<ReturnParams>& table() {
  using P = ReturnParams;
  static const PropertyTable<P> table{
      number<P>("strength", &P::strength, 0, 1,
                "Share of the change; 0 = layers pass through unchanged"),
      flag<P>("use-mask", &P::use_mask,
              "Change layers by the mask layer only, if the frame has one"),
  };
  return table;
}

class MergeElement final : public ReturningFilter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  void configure(const std::shared_ptr<gpu::Device>&, Extent) override {}
  void process(FrameContext& frame) override { apply_returned(frame, parameters_.snapshot()); }

 private:
  Parameters<ReturnParams> parameters_{table()};
};

}  // namespace

extern const ElementInfo kIntrinsicMerge;
const ElementInfo kIntrinsicMerge{
    .factory = "intrinsicmerge",
    .type_name = "GstIntrinsicMerge",
    .long_name = "Intrinsic merge",
    .klass = "Filter/Video",
    .description =
        "Takes pictures of layers that other effects changed back into "
        "the layers",
    .sink = Flow::layers_or_pixels,
    .src = Flow::layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new MergeElement); },
    .accepts = kAnyLayers,
    .plain_caps = nullptr,
    .side_sinks = Returns::pad_names(),
};

}  // namespace inverse
