// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <span>

#include "kernels/edit/recolor.hpp"
#include "kernels/edit_selection_cells.spv.hpp"
#include "matte/matte.hpp"
#include "object/object_selection.hpp"

namespace inverse {

/// What is selected.
enum class SelectBy : uint8_t {
  strokes,     ///< the object that the user points at
  key,         ///< a reflectance
  cluster,     ///< a cluster of reflectance
  base_color,  ///< the surfaces of a base color of bounced light
  picture,     ///< a picture of the mask
};

struct SelectionParams : Matte::Settings {
  SelectBy by = SelectBy::strokes;
  /// Of key, cluster and base_color: their tolerances. `base` and `cluster` count with theirs only.
  RecolorParams color;
};

/// Writes the mask layer of decomposed frames.
class Selection {
 public:
  Selection(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Strokes that were drawn since the frame before, on a frame of the size `drawn`. `restart`: all
  /// that there are, those before do not count.
  struct Strokes {
    std::span<const SelectionStroke> strokes;
    Extent drawn;
    bool restart = false;
  };
  /// Selects by reflectance before any edit (Role::model). `picture`, of SelectBy::picture, has
  /// the mask in x; nothing is selected without one.
  void record(gpu::Commands& commands, Layers& layers, const SelectionParams& params,
              const Strokes& strokes, const Plane* picture);
  /// Forgets the object, its colors, and clusters.
  void reset();
  /// The next frame is of another time: forgets where the object is, and clusters.
  void lose(gpu::Commands& commands);
  /// What was selected by strokes and learned of it, to come back to on a frame of the same time.
  ObjectSelection::State save(gpu::Commands& commands);
  void restore(gpu::Commands& commands, const ObjectSelection::State& state);

  /// Where the object is; null before one was selected.
  const ObjectSelection* object() const { return object_ ? &*object_ : nullptr; }
  /// The clusters in use; null before a cluster was selected.
  const Palette* palette() const { return recolor_ ? recolor_->palette() : nullptr; }

 private:
  void find_cells(gpu::Commands& commands, const Layers& layers, bool colors);

  std::shared_ptr<gpu::Device> device_;
  CellGrid grid_;
  gpu::Program<shaders::edit_selection_cells> light_of_, colors_of_;
  gpu::BufferPtr light_, colors_;
  Matte matte_;
  std::optional<ObjectSelection> object_;  // made on first use
  std::optional<Recolor> recolor_;         // made on first use
  PlanePtr nothing_;                       // a mask of zeros, made on first use
};

}  // namespace inverse
