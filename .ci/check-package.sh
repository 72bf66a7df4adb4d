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
. .ci/scratch.sh

unpack_source "$python"
"$python" -m venv "$folder/venv"
cd "$folder/source"
quietly "$folder/venv/bin/python" -m pip --disable-pip-version-check -q install .

# Elsewhere than in the source, and without what a developer's shell may have set.
cd "$folder"
env -u LD_LIBRARY_PATH -u PYTHONPATH -u OPENMM_PLUGIN_DIR \
    "$folder/venv/bin/python" "$root/tests/installed.py"
