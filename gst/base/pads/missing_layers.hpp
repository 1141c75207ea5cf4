// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <string>

#include "kernels/image/layers.hpp"

namespace inverse {

/// What layers of a kind (caps.hpp) consist of, in words: "reflectance and shading". Empty for
/// others.
std::string contents_of(const std::string& kind);

/// The same of the layers of a frame.
std::string contents_of(const Layers& layers);

/// Why an element that works on layers got none, or none of its kind, at this pad, and what to do:
/// what upstream makes them, and which element there, on the way or in another branch of a tee,
/// takes no layers. `accepts` are the kinds that it takes, `maker` the element to recommend.
std::string missing_layers(GstPad* sink, const char* accepts, const char* maker);

/// Whether an element downstream of this pad is made for layers, with none between that is made for
/// something. The caps that downstream takes do not tell: behind a tee the order of its branches
/// decides which come first, and editors offer to take pictures, too, so that they can say what is
/// missing.
bool wants_layers(GstPad* src);

/// Which editor downstream of this pad, or before it, sends layers to what takes pictures only, and
/// what to do; empty if none does.
std::string untaken_layers(GstPad* src);

}  // namespace inverse
