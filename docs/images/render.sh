#!/usr/bin/env bash
# The pictures of the README, made anew by sdfc: docs/images/render.sh [SCENE ...]
set -euo pipefail
cd "$(dirname "$0")/../.."

scenes=("$@")
((${#scenes[@]})) || scenes=(scenes/*.sdf scenes/*.csg)
for scene in "${scenes[@]}"; do
    name=$(basename "${scene%.*}")
    size=480x270
    [[ $name == die ]] && size=960x540
    sdfc render "$scene" --size "$size" --samples 16 -o "docs/images/$name.png"
done
