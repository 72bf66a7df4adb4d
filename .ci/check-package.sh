#!/bin/sh
# Install the package the way a newcomer does, `pip install .` with build isolation, from what a source
# distribution holds, into an environment that has nothing else; then use it there.
#
#     check-package.sh PYTHON
#
# PYTHON has setuptools. Set CARGO_TARGET_DIR to keep what cargo compiles.
set -eu

python=$1
root=$(pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

log=$folder/log
quietly() {
    "$@" > "$log" 2>&1 || { cat "$log" >&2; exit 1; }
}

quietly "$python" -c "from setuptools import build_meta; build_meta.build_sdist('$folder')"
mkdir "$folder/source"
tar -xzf "$folder"/openmm_helfrich-*.tar.gz -C "$folder/source" --strip-components=1
"$python" -m venv "$folder/venv"
cd "$folder/source"
quietly "$folder/venv/bin/python" -m pip --disable-pip-version-check -q install .

# Elsewhere than in the source, and without what a developer's shell may have set.
cd "$folder"
env -u LD_LIBRARY_PATH -u PYTHONPATH -u OPENMM_PLUGIN_DIR \
    "$folder/venv/bin/python" "$root/tests/installed.py"
