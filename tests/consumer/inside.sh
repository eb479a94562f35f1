#!/usr/bin/env bash
# rosefusion inside another project: inside.sh subdirectory|fetch SCRATCH [all]. Configures the project of inside/ without
# the packages that only programs and tests need, and compiles its own file; with 'all' also links it, which takes minutes.
set -euo pipefail
how=$1 scratch=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
fail() {
  echo "inside: $*" >&2
  exit 1
}

rm -rf "$scratch"
mkdir -p "$scratch"
absent=()
for package in embree assimp CLI11 nanoflann GTest benchmark glfw3; do absent+=("-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done
# What is missing is named in one sentence, with its package.
said=$(cmake -S "$here/inside" -B "$scratch" -G Ninja -DROSEFUSION="$here/../.." -DHOW="$how" -DCMAKE_DISABLE_FIND_PACKAGE_glm=ON 2>&1 || true)
grep -q "install the package libglm-dev" <<<"$(tr -s '\n ' ' ' <<<"$said")" || fail "without glm it says: $said"
rm -rf "$scratch"
cmake -S "$here/inside" -B "$scratch" -G Ninja -DROSEFUSION="$here/../.." -DHOW="$how" "${absent[@]}" >"$scratch.log" 2>&1 ||
  fail "$(tail -n 20 "$scratch.log")"
[[ ! -e $scratch/compile_commands.json ]] || fail "rosefusion has compile_commands.json written for another project."
grep -q '^CMAKE_BUILD_TYPE:STRING=$' "$scratch/CMakeCache.txt" || fail "rosefusion chose another project's build type."
# Nothing is built yet: what would be installed is missing, and named.
DESTDIR=$scratch/installed cmake --install "$scratch" >"$scratch.log" 2>&1 || fail "rosefusion installs with another project: $(cat "$scratch.log")"
[[ -z "$(find "$scratch/installed" -type f 2>/dev/null)" ]] || fail "rosefusion installs with another project."
if [[ ${3:-} == all ]]; then
  cmake --build "$scratch" --target app >"$scratch.log" 2>&1 || fail "$(tail -n 30 "$scratch.log")"
else  # its compiler's command by itself: Ninja would build the library first
  (cd "$scratch" && mkdir -p CMakeFiles/app.dir && ninja -t commands CMakeFiles/app.dir/main.cpp.o | tail -n 1 | bash) \
    >"$scratch.log" 2>&1 || fail "$(tail -n 30 "$scratch.log")"
  [[ -s $scratch/CMakeFiles/app.dir/main.cpp.o ]] || fail "nothing was compiled."
fi
rm -f "$scratch.log"
echo "inside: $how${3:+, $3}"
