#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Makes everything that shows or tests with the bundled clip, from source to file:
#
#   media/clip.webm        5 s, 640×480, 25 frames a second, VP8 and Vorbis
#   media/layers.png       a frame with its true reflectance and shading, for the documentation
#   tests/data/clip/       four frames with ground truth, and two of them as a flat dump
#
# Usage: tools/clip/make_clip.sh [video|truth|all]     (default: all)
#
# Rendering takes about half an hour on two cores. Frames are kept in out/clip, so a run that was
# interrupted goes on where it stopped; delete out/clip/frames after changing the scene.
# Needs g++ (C++20), zlib1g-dev, gstreamer1.0-tools, gstreamer1.0-plugins-base and -good.
set -eu

what=${1:-all}
case $what in video | truth | all) ;; *) echo "usage: $0 [video|truth|all]" >&2; exit 2 ;; esac

root=$(cd "$(dirname "$0")/../.." && pwd)
source=$root/tools/clip
work=$root/out/clip
threads=$(nproc)
last_frame=124
rate=25
mkdir -p "$work" "$root/media" "$root/tests/data/clip"

flags="-std=c++20 -O3 -march=native -fno-math-errno -Wall -Wextra"
# shellcheck disable=SC2086
g++ $flags -pthread "$source"/render.cpp "$source"/transport.cpp "$source"/denoise.cpp \
  "$source"/still_life.cpp "$source"/hierarchy.cpp "$source"/shapes.cpp "$source"/paint.cpp \
  "$source"/image_files.cpp -lz -o "$work/render"
# shellcheck disable=SC2086
g++ $flags "$source"/melody.cpp -o "$work/melody"

render() { nice -n 15 "$work/render" --threads="$threads" "$@"; }

if [ "$what" != truth ]; then
  render --size=640x480 --frames=0-$last_frame --out="$work/frames" --write=video
  cat "$work"/frames/[0-9][0-9][0-9].rgb >"$work/frames.rgb"
  "$work/melody" "$work/melody.wav" $(((last_frame + 1) / rate))
  # The frames carry the BT.601 transfer curve, so only the matrix is applied here.
  nice -n 15 gst-launch-1.0 -q \
    filesrc location="$work/frames.rgb" ! \
    rawvideoparse format=rgb width=640 height=480 framerate=$rate/1 ! \
    videoconvert dither=none ! video/x-raw,format=I420,colorimetry=bt601 ! \
    vp8enc deadline=0 cpu-used=0 end-usage=cq cq-level=2 min-quantizer=0 max-quantizer=8 \
    target-bitrate=8000000 keyframe-max-dist=50 lag-in-frames=16 ! queue ! mux. \
    filesrc location="$work/melody.wav" ! wavparse ! audioconvert ! vorbisenc quality=0.3 ! \
    queue ! mux. \
    webmmux name=mux writing-app=gst-inverse offset-to-zero=true ! \
    filesink location="$root/media/clip.webm"
  rm "$work/frames.rgb"
fi

if [ "$what" != video ]; then
  data=$root/tests/data/clip
  render --size=160x120 --frames=12,45,62,104 --samples=256 --soft=256 --out="$data" --write=truth
  render --size=80x60 --frames=45,104 --samples=256 --soft=256 --out="$data" --write=flat
  render --size=320x240 --frames=62 --samples=64 --soft=64 --out="$work" --write=sheet
  cp "$work/062_sheet.png" "$root/media/layers.png"
fi
