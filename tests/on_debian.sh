#!/usr/bin/env bash
# What a new user of a Debian release sees: tests/on_debian.sh bookworm|trixie|testing [quickstart|tests|packages [OPTIONS...]]
# Unpacks a fresh root folder of that release, clones HEAD into it, and runs there apps/quickstart.sh (the default),
# tests/run.sh --install OPTIONS..., or tests/packages/build.sh and then, in a second fresh root folder, tests/packages/try.sh
# with the packages made. Ends with the time of each step and the versions found.
# Base systems and packages are kept in build/debian (or $ROSEFUSION_DEBIAN_ROOTS), from the mirror apt is set up with.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
fail() {
  echo "on_debian: $*" >&2
  exit 1
}
usage="use: tests/on_debian.sh bookworm|trixie|testing [quickstart|tests|packages [OPTIONS...]]"
release=${1:-} what=${2:-quickstart}
case "$release" in bookworm | trixie | testing) ;; *) fail "there is no release '$release'; $usage" ;; esac
case "$what" in
  quickstart) command=(bash apps/quickstart.sh) ;;
  tests) command=(bash tests/run.sh --install "${@:3}") ;;
  packages) command=(bash tests/packages/build.sh) ;;
  *) fail "'$what' is nothing to run; $usage" ;;
esac
[[ $(id -u) -eq 0 ]] || fail "must be root, to make and enter a root folder; start it with sudo."
command -v debootstrap >/dev/null || fail "debootstrap is missing; install the package debootstrap."
[[ -z "$(git -C "$root" status --porcelain)" ]] || echo "on_debian: what is not committed is not tried." >&2

# Its own mount and process namespaces: however this ends, nothing stays mounted and nothing goes on running.
if [[ -z ${ROSEFUSION_IN_NAMESPACE:-} ]]; then
  exec env ROSEFUSION_IN_NAMESPACE=1 unshare --mount --pid --fork --kill-child --propagation private "${BASH_SOURCE[0]}" "$@"
fi

kept=${ROSEFUSION_DEBIAN_ROOTS:-$root/build/debian}
base=$kept/$release.tar
system=$kept/$release-$what
downloads=$kept/$release-downloads
mkdir -p "$kept" "$downloads/partial"

mirror=$(apt-get indextargets --format '$(LABEL) $(REPO_URI)' 'Created-By: Packages' | awk '$1 == "Debian" {print $2; exit}')
mirror=${mirror:-http://deb.debian.org/debian/}
proxy=$(apt-config shell p Acquire::http::Proxy | sed "s/^p='\(.*\)'$/\1/")
[[ -z $proxy || $proxy == DIRECT ]] || export http_proxy=$proxy

begun=$SECONDS
times=()
last="root folder"
# step NAME: what comes next is NAME; what came before has ended.
step() {
  times+=("$(printf '%4d min %02d s  %s' $(((SECONDS - begun) / 60)) $(((SECONDS - begun) % 60)) "$last")")
  begun=$SECONDS last=$1
}
if [[ ! -e $base ]]; then
  rm -rf "$system"
  debootstrap --variant=minbase --include=ca-certificates "$release" "$system" "$mirror" >"$kept/$release.log" 2>&1 ||
    fail "no base system of $release from $mirror: $(tail -n 3 "$kept/$release.log")"
  rm -f "$system"/var/cache/apt/archives/*.deb
  tar -C "$system" -cf "$base.part" . && mv "$base.part" "$base"
fi
# fresh_root NAME: a new root folder, brought up to date, with a clone of HEAD in /root/rosefusion; the rest runs in it.
fresh_root() {
  system=$kept/$1
  rm -rf "$system"
  mkdir -p "$system"
  tar -C "$system" -xf "$base"
  # How this system reaches its mirror: that one reaches the same.
  apt-config dump Acquire | grep -E '^Acquire::(https?|Check-)' >"$system/etc/apt/apt.conf.d/90host" || true
  cp /etc/resolv.conf "$system/etc/resolv.conf"
  mount -t proc proc "$system/proc"
  mount --rbind /dev "$system/dev"
  mount --bind "$downloads" "$system/var/cache/apt/archives"
  inside sh -c 'apt-get update && apt-get -y dist-upgrade' >"$kept/$release.log" 2>&1 ||
    fail "$release could not be brought up to date: $(tail -n 5 "$kept/$release.log")"
  git clone --quiet --no-hardlinks "$root" "$system/root/rosefusion"
}
inside() {
  env -i HOME=/root LANG=C.UTF-8 TERM=dumb PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    DEBIAN_FRONTEND=noninteractive chroot "$system" "$@" </dev/null
}
# run COMMAND...: in the clone, with the time of each of its steps, which begin with "== "; sets status.
run() {
  while IFS= read -r line; do
    if [[ $line == exit\ * ]]; then
      status=${line#exit }
    else
      [[ $line != "== "* ]] || step "${line#== }"
      printf '%s\n' "$line"
    fi
  done < <(inside bash -c 'cd /root/rosefusion && "$@" 2>&1; echo "exit $?"' bash "$@")
}

fresh_root "$release-$what"
step "before the first step"
status=0
run "${command[@]}"
if [[ $what == packages && $status == 0 ]]; then
  made=$system/root/rosefusion/build/packages/packages
  fresh_root "$release-installed"
  cp -r "$made" "$system/root/packages"
  step "second root folder"
  command=(bash tests/packages/try.sh /root/packages)
  run "${command[@]}"
fi
step ""

printf '\n== %s on %s (%s)\n' "${command[*]}" "$release" "$(inside sh -c '. /etc/os-release; echo "$PRETTY_NAME"')"
printf '%s\n' "${times[@]}"
echo "$(date +%F), $(nproc) cores: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)"
inside dpkg-query -W -f='${db:Status-Status} ${Package} ${Version}\n' g++ 'g++-[0-9]*' cmake libvulkan-dev mesa-vulkan-drivers \
  libembree-dev libopencv-core-dev libeigen3-dev glslang-tools 2>/dev/null | sed -n 's/^installed /  /p' | sort
[[ $status == 0 ]] || fail "${command[*]} ended with $status on $release; the root folder is $system."
echo "on_debian: ${command[*]} passed on $release."
