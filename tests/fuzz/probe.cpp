// SPDX-License-Identifier: LGPL-2.1-or-later
// Tests whether this compiler supports fuzzing.
extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }
