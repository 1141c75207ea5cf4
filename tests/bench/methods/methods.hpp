// SPDX-License-Identifier: LGPL-2.1-or-later
// The project's own methods in the benchmark. For a new one, add a function here, a file
// method_*.cpp and a line in methods_main.cpp.
#pragma once

#include <array>

#include "kernels/quality_levels.hpp"
#include "kernels/thesis/chapter3/thesis_params.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"

namespace inverse::bench {

inline constexpr std::array<std::pair<Quality, const char*>, 4> kQualities{
    {{Quality::low, "low"},
     {Quality::medium, "medium"},
     {Quality::high, "high"},
     {Quality::best, "best"}}};

Method intrinsicdecomp(DeviceSession& session);
Method globalintrinsic(DeviceSession& session);
Method globalintrinsicthesis(DeviceSession& session);
Method thesis(DeviceSession& session, ThesisParams::Solver solver);
/// Baselines for methods with direct and indirect light.
Method indirect_guesses(DeviceSession& session);

}  // namespace inverse::bench
