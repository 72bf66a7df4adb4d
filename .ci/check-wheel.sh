#!/bin/sh
# Install the wheel in dist/ where there is neither Rust nor a compiler nor SWIG, and run the README's first example.
#
#     check-wheel.sh PYTHON
#
# This is done with PYTHON and with every python3.10 and later in PATH that runs.
set -eu

root=$(pwd)
wheel=$(echo "$root"/dist/openmm_helfrich-*.whl)
. .ci/scratch.sh

# Nothing of the system's is in PATH there, nor what a developer's shell may have set.
apart() {
    quietly env -u LD_LIBRARY_PATH -u PYTHONPATH -u OPENMM_PLUGIN_DIR -u OPENMM_DIR PATH="$folder/venv/bin" "$@"
}

sed -n '/^```python$/,/^```$/{/^```$/q;/^```/!p}' README.md > "$folder/example.py"
cd "$folder"
seen=
for python in "$1" python3.10 python3.11 python3.12 python3.13 python3.14; do
    version=$("$python" -c 'import ensurepip, venv, platform; print(platform.python_version())' 2> /dev/null) || continue
    case " $seen" in *" $version "*) continue ;; esac
    seen="$seen$version "
    rm -rf venv
    "$python" -m venv venv
    apart venv/bin/python -m pip --disable-pip-version-check -q install --only-binary :all: "$wheel"
    for tool in cargo rustc cc gcc g++ clang swig; do
        if (PATH=$folder/venv/bin; command -v $tool > /dev/null); then
            echo "openmm-helfrich: the wheel brought $tool, so that this is no test without it" >&2
            exit 1
        fi
    done
    apart venv/bin/python example.py
    # It ends with the platform that OpenMM has chosen.
    [ "$(tail -n 1 "$log")" = Helfrich ] || { cat "$log" >&2; exit 1; }
    apart venv/bin/python "$root/tests/installed.py"
    cat "$log"
done
