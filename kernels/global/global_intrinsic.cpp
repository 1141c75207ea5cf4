#include "global_intrinsic.hpp"

namespace inverse {
namespace {

constexpr uint64_t kVec4 = 16, kSceneSize = 4;

}  // namespace

GlobalIntrinsic::GlobalIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      planes_(device_, extent),
      light_(device_, extent),
      solver_(device_, extent),
      found_(gpu::Buffer::create(device_, gpu::Element::vec4, kSceneSize + LightModel::kSlots + 1,
                                 gpu::Memory::readback)) {}

GlobalIntrinsic::Result GlobalIntrinsic::record(gpu::Commands& commands, const PlanePtr& input,
                                                const Params& params, const FrameInfo& info) {
  if (info.reset) history_ = false;
  const PlanePtr plain = planes_.acquire(), tints = planes_.acquire();
  light_.record(commands, input, {solver_.memory(), solver_.field(), solver_.gauge()}, !history_,
                params.light, plain, tints);
  const Layers solved = solver_.record(commands, plain, params.solve, info);
  const Result result{planes_.acquire(), planes_.acquire(), tints};
  light_.record_split(commands, input, solved[Role::intrinsic], tints, result.light,
                      result.reflectance);
  commands.copy(light_.scene(), found_, kSceneSize * kVec4, 0, 0);
  commands.copy(light_.base(), found_, (LightModel::kSlots + 1) * kVec4, 0, kSceneSize * kVec4);
  history_ = true;
  for (const PlanePtr& plane : {input, plain, result.reflectance, result.light, tints})
    commands.keep(plane);
  return result;
}

GlobalIntrinsic::Findings GlobalIntrinsic::findings() const {
  const float* scene = found_->map_as<float>();
  const float* base = scene + 4 * kSceneSize;
  Findings out;
  out.cut = scene[0] > 0;
  out.amount = scene[8];
  out.confidence = scene[9];
  out.tint = scene[12];
  out.colors = static_cast<uint32_t>(base[4 * LightModel::kSlots]);
  for (uint32_t s = 0; s < LightModel::kSlots; ++s) {
    out.base[s] = {base[4 * s], base[4 * s + 1]};
    out.used[s] = base[4 * s + 2] > 0;
  }
  return out;
}

}  // namespace inverse
