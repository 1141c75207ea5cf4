// SPDX-License-Identifier: LGPL-2.1-or-later
// Compiled once for the program that tests kernels. Each file still includes what it uses.

#include "common/precompiled/kernel_tests.hpp"
#include "tests/kernels/gpu_fixture.hpp"
