#!/bin/sh
# Name the first tool that a build needs and does not find, in one line, with what to do about it.
# Only what a shell has built in is used here, for nothing else may be there either.

missing() {
    echo "openmm-helfrich: $1" >&2
    exit 1
}

# version_at_least 1.95.0 1.85
version_at_least() {
    major=${1%%.*} rest=${1#*.}
    minor=${rest%%.*}
    [ "$major" -gt "${2%%.*}" ] || { [ "$major" -eq "${2%%.*}" ] && [ "$minor" -ge "${2#*.}" ]; }
}

while read -r key _ value; do
    if [ "$key" = rust-version ]; then
        needed=${value#\"}
        needed=${needed%\"}
    fi
done < Cargo.toml

for tool in cargo rustc; do
    command -v $tool > /dev/null ||
        missing "Rust is missing ($tool is not in PATH); install Rust $needed or later from https://rustup.rs."
done
version=$(rustc --version 2>&1) || missing "rustc does not run: $version"
version=${version#rustc }
version_at_least "${version%% *}" "$needed" ||
    missing "Rust ${version%% *} is too old; install Rust $needed or later, for example by 'rustup update'."

compiler=${CXX:-c++}
command -v ${compiler%% *} > /dev/null ||
    missing "the C++ compiler $compiler is missing; install one (Debian: apt install g++), or name yours: make CXX=..."
message=$(echo '#include <optional>
std::optional<int> x;' | $compiler -std=c++17 -x c++ -fsyntax-only - 2>&1) ||
    missing "$compiler does not compile C++17; install g++ 9 or clang++ 10 or later, or name yours: make CXX=..."
command -v cc > /dev/null ||
    missing "cc is missing, with which Rust links; install a C compiler (Debian: apt install gcc)."

command -v ${PYTHON%% *} > /dev/null ||
    missing "$PYTHON is missing; install Python 3.10 or later, or name yours: make PYTHON=..."
version=$($PYTHON -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>&1) ||
    missing "$PYTHON does not run; install Python 3.10 or later, or name yours: make PYTHON=..."
version_at_least "$version" 3.10 ||
    missing "$PYTHON is Python $version, too old; install Python 3.10 or later, or name yours: make PYTHON=..."
$PYTHON -c 'import ensurepip, venv' 2> /dev/null ||
    missing "$PYTHON cannot make virtual environments with pip; install its venv (Debian: apt install python3-venv)."
header=$($PYTHON -c 'import os, sysconfig; print(os.path.join(sysconfig.get_path("include"), "Python.h"))')
[ -f "$header" ] ||
    missing "$PYTHON has no headers ($header); install them (Debian: apt install python3-dev)."
