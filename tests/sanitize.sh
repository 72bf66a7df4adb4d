#!/usr/bin/env bash
# Sanitizers over all that is not Python, in parts by name, or all of them:
#
#     make sanitize                            make sanitize PART="loom miri"
#
# loom      the thread team in all orders, and 26 changes with which its models must fail
# miri      unit tests of Rust, interpreted: what unsafe code may not do
# address   AddressSanitizer and UndefinedBehaviorSanitizer over Rust, C++ and the extension, below Python's tests
# leaks     the same build: what is never freed
# thread    ThreadSanitizer over tests of Rust with several threads
#
# All but loom need a nightly Rust. TESTS names other tests for miri, address and leaks. What is built stays in
# target/sanitize (4 GB), reports in out/sanitize.
set -euo pipefail
cd "$(dirname "$0")/.."

site_packages=$(echo "$PWD"/.venv/lib/python3*/site-packages)
export PYTHON=$PWD/.venv/bin/python OPENMM_DIR=$site_packages/OpenMM.libs
export PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-1}
folder=${CARGO_TARGET_DIR:-$PWD/target}/sanitize
unset CARGO_TARGET_DIR
host=$(rustc -vV | sed -n 's/^host: //p')

missing() {
    echo "sanitize: $1" >&2
    exit 1
}

needs_nightly() {
    cargo +nightly --version > /dev/null 2>&1 ||
        missing "nightly Rust is missing; 'rustup toolchain install nightly --component miri,rust-src' brings it."
}

needs_miri() {
    needs_nightly
    cargo +nightly miri --version > /dev/null 2>&1 ||
        missing "Miri is missing; 'rustup component add --toolchain nightly miri rust-src' brings it."
}

needs_sources() {
    needs_nightly
    [ -d "$(rustc +nightly --print sysroot)/lib/rustlib/src/rust/library" ] ||
        missing "the standard library's sources are missing; 'rustup component add --toolchain nightly rust-src' brings them."
}

# library NAME: where the compiler has it.
library() {
    path=$(${CXX:-c++} -print-file-name="$1")
    [ -e "$path" ] || missing "$1 is missing, which comes with g++; name it: make CXX=g++ sanitize."
    echo "$path"
}

part_loom() {
    models=(cargo test -q --release --locked --manifest-path tests/loom/Cargo.toml --target-dir "$folder/loom" --)
    LOOM_MAX_PREEMPTIONS=100 "${models[@]}" two_look --skip two_look_once
    LOOM_MAX_PREEMPTIONS=4 "${models[@]}" two_sleep two_look_once
    "${models[@]}" three_
    "$PYTHON" tests/loom/weaken.py "$folder/loom"
}

part_miri() {
    needs_miri
    # Where the unsafe code is; the rest of the unit tests takes hours.
    # shellcheck disable=SC2086
    MIRIFLAGS=-Zmiri-disable-isolation PROPTEST_CASES=${PROPTEST_CASES:-2} \
        cargo +nightly miri test -q --locked --no-default-features --target-dir "$folder/miri" --lib -- \
        ${TESTS:-team:: membrane::crowd ffi::}
}

# The library and the extension, all with the same run-time library, that of the C++ compiler.
build_address() {
    needs_nightly
    local flags="-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer -g1"
    # OpenMM hides what `vptr` looks for.
    flags+=" -fno-sanitize=vptr"
    RUSTUP_TOOLCHAIN=nightly CARGO_BUILD_TARGET=$host CARGO_TARGET_DIR=$folder/address \
        RUSTFLAGS="-Zsanitizer=address -Clink-arg=-fsanitize=address,undefined" \
        CARGO_PROFILE_RELEASE_STRIP=none CARGO_PROFILE_RELEASE_DEBUG=line-tables-only \
        CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 CARGO_PROFILE_RELEASE_DEBUG_ASSERTIONS=true \
        env "CXXFLAGS_${host//-/_}=$flags" CFLAGS="$flags" CXXFLAGS="$flags" LDFLAGS="-fsanitize=address,undefined" \
        "$PYTHON" setup.py -q build --build-base out/sanitize/build --build-lib out/sanitize/address
}

# under_address OPTIONS COMMAND...: Python with what build_address made; OPTIONS are AddressSanitizer's.
under_address() {
    local options=$1 asan ubsan
    asan=$(library libasan.so) ubsan=$(library libubsan.so)
    shift
    # Python's own pools would hide what lies beyond a buffer. Drivers of OpenCL and Vulkan compile for minutes.
    env OCL_ICD_VENDORS=/none VK_DRIVER_FILES=/none PYTHONMALLOC=malloc LD_PRELOAD="$asan $ubsan $(library libstdc++.so.6)" LD_LIBRARY_PATH="$OPENMM_DIR/lib" \
        PYTHONPATH="$PWD/out/sanitize/address" \
        ASAN_OPTIONS="$options:log_path=$PWD/out/sanitize/report" \
        UBSAN_OPTIONS="halt_on_error=1:print_stacktrace=1:log_path=$PWD/out/sanitize/report" \
        "$PYTHON" "$@"
}

part_address() {
    build_address
    rm -f out/sanitize/report.*
    # What compiles programs, measures time or takes minutes without a sanitizer has no part here.
    local tests=${TESTS:-$(ls tests/python/test_*.py | grep -v -e _forces.py -e _examples -e _paper -e _benches \
        -e _compilers -e _accelerate -e _golden -e _gpu -e _languages -e _plugin_cpp)}
    # shellcheck disable=SC2086
    under_address detect_leaks=0:detect_stack_use_after_return=1 -m pytest -q -n 2 --dist loadfile $tests
}

part_leaks() {
    build_address
    rm -f out/sanitize/report.*
    # shellcheck disable=SC2086
    under_address detect_leaks=1:exitcode=0 -m pytest -q ${TESTS:-tests/python/test_crowd.py}
    "$PYTHON" tests/leaks.py out/sanitize/report.*
}

part_thread() {
    needs_sources
    RUSTFLAGS=-Zsanitizer=thread TSAN_OPTIONS=halt_on_error=1 \
        CARGO_PROFILE_RELEASE_STRIP=none CARGO_PROFILE_RELEASE_DEBUG=line-tables-only \
        CARGO_PROFILE_RELEASE_CODEGEN_UNITS=16 CARGO_PROFILE_RELEASE_OPT_LEVEL=1 \
        cargo +nightly test -q --locked --release --no-default-features -Zbuild-std --target "$host" \
        --target-dir "$folder/thread" --lib --test rust -- threads team crowd
}

parts=${*:-loom miri address leaks thread}
for part in $parts; do
    declare -F "part_$part" > /dev/null || missing "there is no part '$part'; parts are loom, miri, address, leaks, thread."
done
for part in $parts; do
    echo "== $part"
    "part_$part"
done
