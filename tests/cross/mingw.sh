#!/usr/bin/env bash
# What Windows needs of the code: the engine, the public headers and the host's system file compile with MinGW-w64
# (package g++-mingw-w64-x86-64-posix, 70 MB, which unpacks to 420; skipped without it). Nothing is linked or run.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
compiler=x86_64-w64-mingw32-g++-posix
if ! command -v "$compiler" >/dev/null; then
  echo "mingw: skipped, because the package g++-mingw-w64-x86-64-posix is not installed"
  exit 0
fi
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rosefusion-mingw.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
# Of this system's headers only those that are the same on every system.
mkdir -p "$scratch/include/rosefusion" "$scratch/objects"
for headers in vulkan vk_video glm spirv_cross; do
  [[ ! -e /usr/include/$headers ]] || ln -s "/usr/include/$headers" "$scratch/include/$headers"
done
sed 's/@[A-Z_]*@/0/' "$root/host/public/rosefusion/version.h.in" >"$scratch/include/rosefusion/version.h"
for header in reconstructor types vulkan; do
  printf '#include <rosefusion/%s.h>\n' "$header" >"$scratch/$header.cpp"
  printf '#define ROSEFUSION_SHARED\n#include <rosefusion/%s.h>\n' "$header" >"$scratch/${header}_shared.cpp"
done

compile() {
  "$compiler" -std=c++20 -O0 -Wall -Wextra -Werror -Wno-missing-field-initializers -I"$root" -I"$root/host/public" \
    -isystem "$scratch/include" -isystem "$scratch/include/spirv_cross" -c "$1" \
    -o "$scratch/objects/$(basename "$1").o" || echo "mingw: $1 does not compile for Windows." >&2
}
sources=("$root"/engine/*.cpp "$root"/engine/passes/*.cpp "$root/host/core/system_windows.cpp" "$root/host/core/system_sockets.cpp" "$scratch"/*.cpp)
export -f compile
export compiler root scratch
printf '%s\0' "${sources[@]}" | xargs -0 -P "$(nproc)" -I{} bash -c 'compile {}'
made=$(find "$scratch/objects" -name '*.o' | wc -l)
[[ $made == "${#sources[@]}" ]] || { echo "mingw: $((${#sources[@]} - made)) files do not compile." >&2; exit 1; }
echo "mingw: $made files compile for Windows"
