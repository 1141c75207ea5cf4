#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Fails if docs/reference/elements differs from the elements' property tables; then run ./dev docs.
set -euo pipefail
fresh=$(mktemp -d)
trap 'rm -rf "$fresh"' EXIT
"$1" "$fresh" "$2/intro"
diff -r --exclude=intro "$2" "$fresh" || { echo "docs/reference/elements is out of date: run ./dev docs"; exit 1; }
