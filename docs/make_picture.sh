#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# The README's picture, docs/images/decomposition.jpg: a frame of what `./dev run --file` shows, 2 s into the bundled clip.
#   docs/make_picture.sh [BUILD]     (default build, which ./dev build-only build makes)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build}
export GST_PLUGIN_PATH="$PWD/$build/gst" INVERSE_RUN="$PWD/$build/tools/runner/inverse-run"
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
export GST_REGISTRY="$folder/registry.bin"
pipelines/run --file --seconds 2 --out "$folder"
# The last of its frames.
gst-launch-1.0 -q filesrc location="$folder/decomposition.mkv" ! decodebin ! videoconvert ! videoscale method=lanczos \
  ! video/x-raw,format=I420,width=640,height=480 ! jpegenc quality=92 ! multifilesink location="$folder/%05d.jpg" max-files=1
mv "$folder"/*.jpg docs/images/decomposition.jpg
