#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds the corpus library, out/lime/libcorpus.so in the project's root.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
out=../../../out/lime
mkdir -p "$out"
"${CXX:-g++}" -std=c++20 -O3 -march=native -fno-math-errno -fno-trapping-math -Wall -Wextra -Wno-psabi -fPIC -shared -pthread \
  -fvisibility=default ./*.cpp -o "$out/libcorpus.so.new"
mv "$out/libcorpus.so.new" "$out/libcorpus.so"  # a running training keeps the old one
