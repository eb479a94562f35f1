#!/usr/bin/env bash
# Installs the .deb packages of FOLDER with apt on a system that has nothing of rosefusion, and uses each: try.sh FOLDER
set -euo pipefail
folder=$(cd "$1" && pwd)
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
fail() {
  echo "try: $*" >&2
  exit 1
}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
install() {
  DEBIAN_FRONTEND=noninteractive apt-get -y --no-install-recommends install "$@" </dev/null >"$scratch/apt.log" 2>&1 ||
    fail "$(tail -n 5 "$scratch/apt.log")"
}

echo "== Program and viewer"
install "$folder"/rosefusion_*.deb
rosefusion --version
rosefusion synth room --frames 60 >synth.log 2>&1 || fail "$(cat synth.log)"
rosefusion run room --out result >run.log 2>&1 || fail "$(cat run.log)"
rosefusion eval result room | grep -i ATE || fail "the trajectory cannot be compared."
[[ -s result/mesh.ply && -s result/preview.png ]] || fail "the run left no mesh or picture."
rosefusion-viewer room --screenshot picture.png --after-frames 20 --headless >viewer.log 2>&1 || fail "$(cat viewer.log)"
[[ $(stat -c %s picture.png) -gt 20000 ]] || fail "the viewer's picture is empty."
[[ -s /usr/share/man/man1/rosefusion.1 || -s /usr/share/man/man1/rosefusion.1.gz ]] || fail "there is no manual page."
bash -c 'source /usr/share/bash-completion/completions/rosefusion; complete -p rosefusion' || fail "there is no completion."

echo "== Python module"
install "$folder"/python3-rosefusion_*.deb
python3 -c 'import rosefusion, numpy
p = rosefusion.Reconstructor(rosefusion.Camera(320, 240, 160, 160, 159.5, 119.5))
print(p.process(numpy.full((240, 320), 1500, numpy.uint16), 0.0).status)'

echo "== Library"
install "$folder"/librosefusion-dev_*.deb g++ cmake make glslang-tools libvulkan-dev
sed -n '/^```cpp$/,/^```$/p' "$here/../../README.md" | sed '/^```/d' >quickstart.cpp
cmake -S "$here/../consumer" -B consumer -DCMAKE_BUILD_TYPE=Release -DQUICKSTART="$scratch/quickstart.cpp" >consumer.log || fail "$(cat consumer.log)"
cmake --build consumer >consumer.log 2>&1 || fail "$(tail -n 20 consumer.log)"
consumer/embedded || fail "the Vulkan header's program ended with $?."
consumer/quickstart | tail -n 1
echo "try: all three packages work"
