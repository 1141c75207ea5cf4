#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# The README's picture, docs/images/decomposition.webp: a clip, its reflectance, its shading, and the clip with the color of a mug changed.
#   docs/make_picture.sh CLIP [BUILD]     (default build, which ./dev build-only build makes)
# CLIP is demo/data/gallery/04_coffee.mp4 of https://github.com/facebookresearch/sam2 (docs/reference/licenses.md). Needs python3-pil.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
clip=${1:?usage: docs/make_picture.sh CLIP [BUILD]} build=$(realpath "${2:-build}")
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
export GST_PLUGIN_PATH="$build/gst" INVERSE_MODELS="$build/models" GST_REGISTRY="$folder/registry.bin"
rate=10 seconds=6
view='videoconvert ! videoscale method=lanczos ! video/x-raw,width=320,height=180 !'
gst-launch-1.0 -q filesrc location="$clip" ! decodebin ! videoconvert ! videoscale ! video/x-raw,width=640,height=360 ! \
  videorate ! video/x-raw,framerate=$rate/1 ! identity eos-after=$((rate * seconds + 1)) ! \
  intrinsicdecomp quality=high adaptive=false ! tee name=layers \
  layers. ! queue ! intrinsiccompose show=input ! $view mosaic.sink_0 \
  layers. ! queue ! intrinsiccompose show=reflectance ! $view mosaic.sink_1 \
  layers. ! queue ! intrinsiccompose show=shading ! $view mosaic.sink_2 \
  layers. ! queue ! intrinsicrecolor key=0xff2070c0 target=0xffd05010 tolerance=0.8 softness=0.6 ! intrinsiccompose ! $view mosaic.sink_3 \
  compositor name=mosaic sink_1::xpos=320 sink_2::ypos=180 sink_3::xpos=320 sink_3::ypos=180 ! video/x-raw,format=RGB ! \
  pngenc compression-level=1 ! multifilesink location="$folder/%03d.png"
/usr/bin/python3 - "$folder" $rate $seconds <<'TEXT'
import pathlib
import sys

from PIL import Image

rate, seconds = map(int, sys.argv[2:])
frames = [Image.open(path) for path in sorted(pathlib.Path(sys.argv[1]).glob("*.png"))[:rate * seconds]]  # compositor may repeat the last
# Each frame by itself: differences of frames leave traces of what moved.
frames[0].save("docs/images/decomposition.webp", save_all=True, append_images=frames[1:], duration=1000 // rate, loop=0, quality=70, method=6,
               kmin=0, kmax=1)
TEXT
