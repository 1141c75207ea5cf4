# SPDX-License-Identifier: LGPL-2.1-or-later
# Sourced by the scripts beside it.
#
# SOURCE and SINK in the environment replace a script's first and last elements, so that every
# pipeline runs without a camera or a window:
#   SOURCE="videotestsrc is-live=true num-buffers=90" SINK=fakesink pipelines/webcam
set -euo pipefail
set -f   # caps hold brackets and stars: no file names here
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

fail() { echo "$(basename "$0"): $*" >&2; exit 1; }

# Prints the head comment of the script.
usage() { sed -n '3,/^[^#]/{s/^# \{0,1\}//p}' "$0"; exit "${1:-0}"; }
case "${1:-}" in -h | --help) usage ;; esac

# Takes --overwrite out of the words of the script, and looks whether one is an address.
overwrite='' remote='' given=()
while [ $# -gt 0 ] && [ "$1" != -- ]; do
  if [ "$1" = --overwrite ]; then overwrite=$1; else given+=("$1"); fi
  shift
done
set -- "${given[@]}" "$@"
for word in "${given[@]}" ${SOURCE:-}; do
  word=${word#*=} word=${word//\"/} && word=${word,,}
  [[ $word != [a-z]*://* || $word == file://* || ${word%%://*} == *[^a-z0-9.+-]* ]] || remote=true
done

# Files open no connections: elements that play lists of streams, which name other hosts, are for addresses that the user typed.
# In Python: inverse_common.media.allow_lists.
lists="hlsdemux hlsdemux2 dashdemux dashdemux2 mssdemux mssdemux2 sdpdemux gesdemux"
ranks=jpegparse:257,avdec_mjpeg:257 # rather than jpegdec: inverse_common.media.prefer_decoders
[ -n "$remote" ] || ranks+=",${lists// /:NONE,}:NONE"
export GST_PLUGIN_FEATURE_RANK=${GST_PLUGIN_FEATURE_RANK:+$GST_PLUGIN_FEATURE_RANK,}$ranks

# The plugin: installed, on GST_PLUGIN_PATH (./dev shell), or built here.
command -v gst-launch-1.0 >/dev/null || fail "gst-launch-1.0 is missing: install gstreamer1.0-tools"
if ! gst-inspect-1.0 --exists --atleast-version=0.0.0 intrinsicdecomp 2>/dev/null; then
  export GST_PLUGIN_PATH=$root/build/gst${GST_PLUGIN_PATH:+:$GST_PLUGIN_PATH} GST_PRESET_PATH=${GST_PRESET_PATH:-$root/gst/edit/presets} INVERSE_MODELS=${INVERSE_MODELS:-$root/build/models}
  gst-inspect-1.0 --exists --atleast-version=0.0.0 intrinsicdecomp || fail "the plugin inverse is not built: ./dev shell builds it"
fi

# Fails if an element of the plugin for light stages is missing.
need_stage() {
  gst-inspect-1.0 --exists --atleast-version=0.0.0 "$1" ||
    fail "the plugin inversestage is not built: install libopencv-video-dev and libopenexr-dev, then ./dev shell builds it"
}

# Fails if an environment map is named that cannot be read.
need_environment() { [ -z "$1" ] || [ -r "$1" ] || fail "there is no environment map $1"; }

# Fails if the folder of a result is missing.
need_folder_of() { [ -d "$(dirname "$1")" ] || fail "there is no folder $(dirname "$1") to write to"; }

# Fails if there is something at the place of a result, unless --overwrite is among the words; always if it is one of the inputs, which follow.
need_new() {
  local result=$1 input
  shift
  for input; do
    [ ! "$result" -ef "$input" ] || fail "the result would replace the input $input: name another"
  done
  [ -n "$overwrite" ] || { [ ! -e "$result" ] && [ ! -L "$result" ]; } ||
    fail "$result is there already: name another result, or give --overwrite to replace it"
}

# Plays a line that decodes an input, and names the file if it cannot be decoded.
play() {
  local input=$1
  shift
  [ -z "$remote${SOURCE:-}" ] || exec gst-launch-1.0 -e "$@"
  exec gst-launch-1.0 -e "$@" 2> >(
    trap '' INT TERM
    while IFS= read -r line || [ -n "$line" ]; do
      echo "$line"
      [[ $line != "ERROR: from element "*decodebin* ]] || failed=true
    done >&2
    [ -z "${failed:-}" ] ||
      fail "cannot play $input; if it is a list of streams, or has one in it, open one of them by its address, if you trust it")
}

# A window. sync=false shows a camera's frames on arrival.
window() {
  [ -n "${SINK:-}${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] ||
    fail "there is no display for a window; SINK=… names another sink, for example SINK=\"$encoder ! matroskamux ! filesink location=out.mkv\""
  echo "${SINK:-videoconvert ! autovideosink ${1:-}}"
}

# After a camera: drop frames that became old during processing.
newest="queue leaky=downstream max-size-buffers=1"

# To a file: VP8, supported by all browsers and players, fast enough for real time on two cores.
encoder="videoconvert ! vp8enc deadline=1 cpu-used=8 threads=4 end-usage=cq cq-level=16 target-bitrate=20000000 keyframe-max-dist=60"

# The URI of a file, or the URI itself.
uri_of() {
  case "$1" in
    *://*) echo "$1" ;;
    *)
      [ -e "$1" ] || fail "there is no file $1"
      [ -f "$1" ] && [ -r "$1" ] || fail "cannot read $1"
      gst_path=$(realpath "$1") && printf 'file://'
      # Everything but letters, digits and -._~/ as %XX.
      LC_ALL=C awk -v path="$gst_path" 'BEGIN {
        for (i = 1; i < 256; i++) code[sprintf("%c", i)] = i
        for (i = 1; i <= length(path); i++) {
          c = substr(path, i, 1)
          printf (c ~ /[A-Za-z0-9._~\/-]/) ? "%s" : "%%%02X", (c ~ /[A-Za-z0-9._~\/-]/) ? c : code[c]
        }
        print ""
      }'
      ;;
  esac
}
