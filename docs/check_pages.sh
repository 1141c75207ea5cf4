#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Fails where docs/reference/elements is not what the elements say of themselves; run ./dev docs then.
set -euo pipefail
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
"$1" "$fresh" "$2/intro"
diff -r --exclude=intro "$2" "$fresh" || { echo "docs/reference/elements is out of date: run ./dev docs"; exit 1; }
