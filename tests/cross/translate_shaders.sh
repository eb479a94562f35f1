#!/usr/bin/env bash
# Every shader can be had in Apple's Metal language and in Direct3D's HLSL: translate_shaders.sh SPIRV_CROSS FOLDER, where
# the folder holds the .spv files of a build. MoltenVK and Dozen translate much as spirv-cross does.
set -euo pipefail

spirv_cross=$1 folder=$2
number=0 failed=0
for shader in "$folder"/*.spv; do
  [[ -e $shader ]] || break
  number=$((number + 1))
  for language in "--msl --msl-version 20300" "--hlsl --shader-model 60"; do
    read -ra options <<<"$language"
    if ! text=$("$spirv_cross" "${options[@]}" "$shader" 2>&1); then
      echo "translate_shaders: $(basename "$shader") cannot be translated with $language: $text" >&2
      failed=1
    elif ! grep -qE '^(kernel )?void [a-z0-9_]+\(' <<<"$text"; then
      echo "translate_shaders: $(basename "$shader") with $language has no entry point." >&2
      failed=1
    fi
  done
done
[[ $number -gt 0 ]] || { echo "translate_shaders: there is no .spv file in $folder; build rosefusion_shaders." >&2; exit 1; }
[[ $failed == 0 ]] && echo "translate_shaders: $number shaders in two languages"
