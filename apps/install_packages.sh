#!/usr/bin/env bash
# Installs the Debian or Ubuntu packages that rosefusion needs and that are missing. With --tests: also those of the
# tests; with --live: those of the viewer, of cameras, of network streams and of loop closure; with --packages: those and
# what makes .deb packages. ROSEFUSION_NO_INSTALL=1 skips all of it, for systems where the libraries come from elsewhere.
set -euo pipefail

fail() {
  echo "install_packages: $*" >&2
  exit 1
}

packages=(
  g++ cmake ninja-build pkg-config ccache
  mesa-vulkan-drivers libvulkan1 libvulkan-dev glslang-tools spirv-tools libspirv-cross-c-shared-dev
  libeigen3-dev libglm-dev libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev libopencv-calib3d-dev
  libembree-dev libassimp-dev libcli11-dev libspdlog-dev nlohmann-json3-dev libyaml-cpp-dev libnanoflann-dev
  liblz4-dev libzstd-dev libsqlite3-dev zlib1g-dev libzip-dev libebml-dev libmatroska-dev
  libmeshoptimizer-dev libstb-dev gnuplot-nox
)
live=(libzmq3-dev cppzmq-dev libopenni2-dev libglfw3-dev libimgui-dev fonts-dejavu-core libceres-dev)
case "${1:-}" in
  "") ;;
  --live) packages+=("${live[@]}") ;;
  --tests) packages+=("${live[@]}" git spirv-cross abigail-tools xz-utils vulkan-validationlayers libgtest-dev libgmock-dev libbenchmark-dev libx11-dev xvfb xdotool
    pybind11-dev python3-dev python3-numpy) ;;
  --packages) packages+=("${live[@]}" dpkg-dev file pybind11-dev python3-dev) ;;
  *) fail "there is no option '$1'; known are --live, --tests and --packages." ;;
esac

if [[ "${ROSEFUSION_NO_INSTALL:-0}" == 1 ]]; then
  echo "Packages: not looked at (ROSEFUSION_NO_INSTALL=1)."
  exit 0
fi
if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "this is neither Debian nor Ubuntu; install what these packages hold, then start again with" \
    "ROSEFUSION_NO_INSTALL=1: ${packages[*]}"
fi

missing=()
for package in "${packages[@]}"; do
  [[ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)" == installed ]] || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then
  echo "Packages: all ${#packages[@]} are installed."
  exit 0
fi

as_root=()
if [[ $(id -u) -ne 0 ]]; then
  command -v sudo >/dev/null ||
    fail "not root, and there is no sudo; have an administrator run: apt-get install ${missing[*]}"
  as_root=(sudo)
fi
echo "Packages: installing ${#missing[@]}: ${missing[*]}"
log=$(mktemp /tmp/rosefusion-packages.XXXXXX)
apt() {  # stdin stays closed, so that no question can wait for an answer; sudo asks on the terminal itself
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -y -o DPkg::Lock::Timeout=300 "$@" </dev/null >>"$log" 2>&1
}
# A source of packages that cannot be reached does not matter when the rest has what is needed.
apt update || echo "Packages: the lists could not all be updated; going on with those at hand."
if ! apt install --no-install-recommends "${missing[@]}"; then
  tail -n 20 "$log" >&2
  fail "apt-get could not install the packages; the lines above say why, all of them are in $log."
fi
rm -f "$log"
