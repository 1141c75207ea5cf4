#pragma once
#include <optional>

#include "base/filter.hpp"
#include "image/mosaic.hpp"
#include "palette/scene_palette.hpp"
#include "quality.hpp"

namespace inverse {

/// What a decomposer shows where pixels go out.
enum class Show { reflectance, shading, input, mosaic, clusters };

/// What every decomposer of reflectance and shading shares: `show`. A method derives from it and
/// fills the layers.
class Decomposer : public Filter {
 public:
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override;
  void release() override;
  void process(FrameWork& frame) final;

 protected:
  /// Fills `frame.layers` from its input layer and returns what to show.
  virtual Show decompose(FrameWork& frame) = 0;

  void reset() override;

  /// The property `show`, for the parameters of any method.
  template <typename P>
  static Property<P> show_property() {
    return choice<P>(
        "show", &P::show, "GstInverseShow", show_choices(),
        "What to show where ordinary video goes out; elements that take layers get all "
        "of them");
  }
  /// The property `quality`; `sets` says which group of parameters it stands for.
  template <typename P>
  static Property<P> quality_property(const char* sets) {
    return choice<P>("quality", &P::quality, "GstInverseQuality", quality_choices(), sets);
  }

 private:
  static std::vector<Choice> show_choices();
  static std::vector<Choice> quality_choices();
  PlanePtr draw_clusters(FrameWork& frame);

  std::shared_ptr<gpu::Device> device_;
  std::optional<PlanePool> planes_;
  // Made when they are first asked for.
  std::optional<Mosaic> mosaic_;
  std::optional<ScenePalette> palette_;
};

/// A decomposer whose frames all go through one object of the method, made anew for each size:
/// `Method(device, extent)`, with `reset()` for what it remembers of earlier frames.
template <typename Method>
class MethodDecomposer : public Decomposer {
 public:
  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    Decomposer::configure(device, extent);
    method_.emplace(device, extent);
  }
  void release() override {
    method_.reset();
    Decomposer::release();
  }
  void reset() override {
    Decomposer::reset();
    method_->reset();
  }

 protected:
  std::optional<Method> method_;
};

}  // namespace inverse
