#!/usr/bin/env bash
# The Debian packages of this system: installs what is missing, builds, and leaves the .deb files in build/packages/packages.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
echo "== Packages that the build needs"
bash apps/install_packages.sh --packages
echo "== Build"
cmake --preset packages
cmake --build --preset packages --parallel "$(nproc)"
echo "== cpack"
(cd build/packages && cpack)
for package in build/packages/packages/*.deb; do dpkg-deb --field "$package" Package Version Installed-Size Depends Recommends; done
