// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "gst/base/property_table.hpp"
#include "stroke_editor.hpp"

namespace inverse {

/// What is wrong with a value of the property `strokes`, in words.
std::string wrong_strokes(const GValue* value);

/// The properties of StrokeParams.
template <typename P>
PropertyTable<P> stroke_properties() {
  Property<P> strokes = text<P>(
      "strokes::list", &P::strokes,
      "JSON list of strokes inside which shading or reflectance is constant, or that recolor, "
      "in pixels: [{\"kind\":\"shading\",\"radius\":12,\"points\":[[x,y],...]}]");
  strokes.wrong = wrong_strokes;
  return {
      strokes,
      choice<P>(
          "strokes::mode", &P::stroke_mode, "GstInverseStrokeMode",
          {{static_cast<int>(StrokeMode::off), "off", "Navigation events do nothing"},
           {static_cast<int>(StrokeMode::shading), "shading",
            "Drags draw strokes of constant shading"},
           {static_cast<int>(StrokeMode::reflectance), "reflectance",
            "Drags draw strokes of constant reflectance"},
           {static_cast<int>(StrokeMode::recolor), "recolor",
            "Drags draw strokes that give surfaces strokes::color"},
           {static_cast<int>(StrokeMode::erase), "erase", "Presses remove strokes"},
           {static_cast<int>(StrokeMode::select), "select",
            "Drags draw strokes that the mask layer selects, for elements that follow"},
           {static_cast<int>(StrokeMode::pick), "pick",
            "A press sets strokes::color to the reflectance there, then strokes::mode=recolor"}},
          "What the mouse draws on the picture, and a hand in the scene (strokes::touch)"),
      number<P>("strokes::radius", &P::stroke_radius, 1.f, 1000.f,
                "Radius of the brush for strokes, pixels"),
      flag<P>("strokes::fill", &P::stroke_fill,
              "Extend drawn strokes to their connected surroundings of similar reflectance"),
      color<P>(
          "strokes::color", &P::stroke_color,
          "Reflectance that strokes of strokes::mode=recolor give to surfaces (0xAARRGGBB, sRGB; "
          "alpha is ignored)"),
      flag<P>("strokes::follow", &P::stroke_follow,
              "Move strokes with what they were drawn on; turn off to keep them in their place"),
      flag<P>(
          "strokes::touch", &P::stroke_touch,
          "Let a bare hand that touches the remembered scene draw as the mouse does; what is in "
          "front of the scene is then not remembered"),
  };
}

}  // namespace inverse
