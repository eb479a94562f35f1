#!/usr/bin/env bash
# What Mesa's driver for AMD (RADV) makes of every shader, without the hardware: radv_table.sh FOLDER >TABLE, where the folder
# holds the .spv files of a build (build/ci/shaders/compute). Debian: mesa-vulkan-drivers, libvulkan-dev,
# libspirv-cross-c-shared-dev. The table kept is tests/bench/radv.md. Fails when a shader does not compile.
set -euo pipefail

folder=$1
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
g++ -O1 -std=c++20 "$here/shader_statistics.cpp" -o "$scratch/statistics" -lvulkan -lspirv-cross-c-shared
icd=$(ls /usr/share/vulkan/icd.d/radeon_icd*.json)
export XDG_RUNTIME_DIR=$scratch VK_ICD_FILENAMES=$icd VK_DRIVER_FILES=$icd MESA_SHADER_CACHE_DISABLE=1

# Specialisation constants of the default path: one pool; of fitness also the squared loss, compensated, overlap, no race;
# of the descents that a lane of a GPU adds few terms.
constants() {
  case $1 in
    fitness) echo 1 0 1 1 0 ;;
    refine | refine_colour) echo 1 0 ;;
    *) echo 1 ;;
  esac
}
value() { sed -n "s/.*|$1 \([0-9]*\)|.*/\1/p" <<<"|$2"; }

version=$(dpkg-query -W -f='${Version}' mesa-vulkan-drivers 2>/dev/null || echo unknown)
echo "# Shaders on AMD, without the hardware"
echo
echo "Mesa's RADV $version with null hardware, one pool, as \`tests/drivers/radv_table.sh\` printed it on $(date +%F)." \
  "In each cell: vector registers, bytes of code, waves a SIMD at most; \"+n\" counts spilled registers, which are read and" \
  "written through memory. No time is measured: nothing runs."
echo
# Mesa 22 calls it by its instruction set, later ones by its chip.
rdna3=gfx1100
any=("$folder"/*.spv)
said=$(RADV_FORCE_FAMILY=$rdna3 "$scratch/statistics" "${any[0]}" 1 2>&1) || true
[[ $said != *"Unknown family"* ]] || rdna3=navi31
families=(polaris10 vega10 navi10 navi21 "$rdna3")
printf '| shader |'; printf ' %s |' "${families[@]}"; echo
printf '%s' '|---|'; printf '%.0s---|' "${families[@]}"; echo
failed=0
for shader in "$folder"/*.spv; do
  name=$(basename "$shader" .spv)
  [[ $name != *_texels ]] || continue  # those are for processors
  row="| $name |"
  for family in "${families[@]}"; do
    # shellcheck disable=SC2046
    if ! line=$(RADV_FORCE_FAMILY=$family "$scratch/statistics" "$shader" $(constants "$name") 2>"$scratch/log"); then
      echo "radv_table: $name does not compile for $family: $(tail -n 1 "$scratch/log")" >&2
      failed=1
      row+=" - |"
      continue
    fi
    spilled=$(($(value "Spilled VGPRs" "$line") + $(value "Spilled SGPRs" "$line")))
    [[ $spilled == 0 ]] && spilled="" || spilled="+$spilled"
    row+=" $(value VGPRs "$line")$spilled, $(value "Code size" "$line") B, $(value "Subgroups per SIMD" "$line") |"
  done
  echo "$row"
done
exit "$failed"
