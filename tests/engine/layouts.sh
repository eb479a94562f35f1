#!/usr/bin/env bash
# The build's assertions on layouts hold for a struct as GLSL lays it out, and refuse a vec3 that C++ packs, members that
# changed places, and one too few: layouts.sh ASSERT_LAYOUTS ALLOCATE.spv COMPILER
set -euo pipefail
asserted=$("$1" "$2")
[[ $asserted == *"offsetof(AllocateParams, capacity)"* ]] || { echo "layouts: $2 gave no assertion on AllocateParams" >&2; exit 1; }
# compiles MEMBERS: of AllocateParams in C++
compiles() {
  "$3" -std=c++20 -fsyntax-only -x c++ - 2>/dev/null <<<"#include <cstddef>
struct AllocateParams { float world_from_camera[16]; $1 };
$(grep 'AllocateParams' <<<"$2")"
}
right="float focal_centre[4]; int size[4]; unsigned capacity; float band;"
compiles "$right" "$asserted" "$3" || { echo "layouts: the right layout is refused" >&2; exit 1; }
for wrong in "${right/centre\[4]/centre[3]}" "${right/unsigned capacity; float band/float band; unsigned capacity}" "${right/float band;/}"; do
  if compiles "$wrong" "$asserted" "$3"; then
    echo "layouts: accepted: $wrong" >&2
    exit 1
  fi
done
