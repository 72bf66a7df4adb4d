#!/bin/sh
# Build a source distribution, and from what it holds a wheel for other machines, into dist/.
#
#     build-wheel.sh PYTHON
#
# PYTHON is of an environment with everything of constraints.txt. Set CARGO_TARGET_DIR to keep what cargo compiles.
# The wheel is named after the glibc that it needs, which is that of the build or an older one.
set -eu

python=$1
dist=$(pwd)/dist
here=$(pwd)/.ci
. .ci/scratch.sh

unpack_source "$python"
cd "$folder/source"
# pyproject.toml's license-files have them too.
"$python" "$here/licenses.py" .

# Messages of the library name sources; where these were here is of no use elsewhere.
packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("platlib"))')
export CARGO_ENCODED_RUSTFLAGS="--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}/registry/src=crates"
export CXXFLAGS="${CXXFLAGS:-} -ffile-prefix-map=$packages=."
quietly "$python" -m pip --disable-pip-version-check wheel -q --no-index --no-deps --no-build-isolation \
    --check-build-dependencies -w "$folder/plain" .

# OpenMM's libraries come with the package openmm, beside which this one is installed.
PATH=$(dirname "$python"):$PATH
quietly "$python" -m auditwheel repair --exclude libOpenMM.so -w "$folder/wheel" "$folder"/plain/*.whl
"$python" "$here/inspect_wheel.py" "$folder"/wheel/*.whl "$packages" "$folder" "${CARGO_TARGET_DIR:-target}"

mkdir -p "$dist"
rm -f "$dist"/openmm_helfrich-*
mv "$folder"/openmm_helfrich-*.tar.gz "$folder"/wheel/*.whl "$dist"
