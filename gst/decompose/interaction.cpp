// SPDX-License-Identifier: LGPL-2.1-or-later
#include "interaction.hpp"

#include "decomposer.hpp"

namespace inverse {

void Interaction::configure(const std::shared_ptr<gpu::Device>& device, Extent extent,
                            const Log& log) {
  log_.emplace(log);
  stroke_work_.configure(device, extent);
  scene_->configure(device);
}

void Interaction::release() {
  stroke_work_.release();
  scene_->release();
}

Interaction::Known Interaction::before(FrameContext& frame, uint64_t number,
                                       const InteractionParams& params, bool mosaic) {
  stroke_work_.take(frame, number, params, mosaic);
  const KnownReflectance* reflectance =
      scene_->recall(frame, number, params, stroke_work_.wanted());
  if (scene_->began()) strokes_.forget_scene();
  stroke_work_.see(number, scene_->seen());
  return {stroke_work_.solved(), stroke_work_.tracker(), scene_->seen(), reflectance};
}

void Interaction::after(FrameContext& frame) {
  scene_->remember(frame);
  stroke_work_.edit(frame);
}

void Interaction::completed(uint64_t number, const std::vector<float>& rms,
                            const InteractionParams& params) {
  const auto view = scene_->view(number);
  strokes_.add_loaded(*log_, scene_->take_loaded());
  stroke_work_.completed(*log_, number, rms, view);
  strokes_.touch(*log_, scene_->touch(number), view, params);
}

void Interaction::describe(GstStructure* stats, uint64_t number,
                           const std::vector<float>& rms) const {
  stroke_work_.describe(stats, number, rms);
  scene_->describe(stats, number);
}

std::vector<Action> interaction_actions() {
  static constexpr auto kInteraction = [](Filter& filter) -> Interaction& {
    return *static_cast<Decomposer&>(filter).method().interaction();
  };
  static constexpr auto kEditor = [](Filter& filter) -> StrokeEditor& {
    return kInteraction(filter).strokes();
  };
  std::vector<Action> actions{edit_action<kEditor, &StrokeEditor::add>("add-stroke"),
                              edit_action<kEditor, &StrokeEditor::remove>("remove-stroke"),
                              edit_action<kEditor, &StrokeEditor::clear>("clear-strokes"),
                              edit_action<kEditor, &StrokeEditor::undo>("undo-stroke")};
  if (!kHasScene) return actions;
  actions.push_back({"save-scene",
                     {G_TYPE_STRING},
                     [](Filter& filter, const GValue* argument) {
                       const char* path = g_value_get_string(argument);
                       kInteraction(filter).scene().save(path ? path : "");
                     },
                     true});
  actions.push_back({"forget-scene", {}, [](Filter& filter, const GValue*) {
                       kInteraction(filter).scene().forget();
                     }});
  return actions;
}

}  // namespace inverse
