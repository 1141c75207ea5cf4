#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds the corpus library, out/olat/libcorpus.so in the project's root. Random numbers and vectors are limematerial's.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
out=../../../out/olat
mkdir -p "$out"
"${CXX:-g++}" -std=c++20 -O3 -march=native -fno-math-errno -fno-trapping-math -Wall -Wextra -Wno-psabi -fPIC -shared -pthread \
  -I../../lime/corpus -fvisibility=default ./*.cpp -lembree3 -o "$out/libcorpus.so.new"
mv "$out/libcorpus.so.new" "$out/libcorpus.so"  # a running training keeps the old one
