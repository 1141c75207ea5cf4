// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "common.glsl"

// Sets every word of a buffer, if a transfer command may not (Commands::when). One word an invocation.
WORD_OUT(0, words);
layout(push_constant) uniform Push {
  uint count;
  uint word;
} push;

void main() {
  uint i = line_index();
  if (i < push.count) STORE(words, i, push.word);
}
