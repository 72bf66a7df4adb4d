#!/usr/bin/env bash
# Correctness and speed on a machine with a GPU, in at most eight minutes:
#
#     bash benches/device.sh [--platform CUDA] [--quick] [--wheel FILE | --wheels FOLDER] [--cuda 13]
#
# It uses .venv if the project is installed there, else it makes out/device-venv and installs the
# project there: from the wheel that is given, from dist/*.whl, or from this tree, which needs Rust.
# Where there is no network, --wheels FOLDER installs all wheels of a folder and nothing else, for
# $PYTHON (python3), which has to have the rest. Then every part runs within its own time limit,
# whatever became of the others: the rows of tests/python/cases.py on the platform in all precisions
# against Reference, the paper's Table III, time steps, and OpenCL and wgpu if there are GPUs for
# them. device.md, device.json and log.txt come into $OUT, or out/device. The exit status is 1 if
# any part failed.
set -uo pipefail
cd "$(dirname "$0")/.." || exit 1

LIMIT=470 # s, of everything
platform='' quick='' wheel='' wheels='' cuda=12
usage() {
    sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "$0"
    exit "$1"
}
while [ $# -gt 0 ]; do
    case $1 in
        --quick) quick=--quick ;;
        -h | --help) usage 0 ;;
        --platform | --wheel | --wheels | --cuda)
            [ $# -gt 1 ] || usage 2 >&2
            printf -v "${1#--}" %s "$2"
            shift
            ;;
        *) usage 2 >&2 ;;
    esac
    shift
done

out=${OUT:-out/device}
mkdir -p "$out" && scratch=$(mktemp -d) || exit 1
child=''
trap 'rm -rf "$scratch"' EXIT
trap '[ -z "$child" ] || kill "$child"; exit 143' INT TERM
: > "$out/log.txt"
: > "$scratch/parts.tsv"
failed=0

say() {
    printf '%s\n' "$*" | tee -a "$out/log.txt"
}

# note NAME RESULT: what the report says of a part that was not run.
note() {
    say "== $1: $2"
    printf '%s\t%s\t\n' "$1" "$2" >> "$scratch/parts.tsv"
}

# part NAME SECONDS COMMAND...: run a command within a limit, and within what is left of the time.
# All processes of its group end with it, so that nothing outlasts the limit.
part() {
    local name=$1 limit=$2 begin=$SECONDS status=0 result=passed
    shift 2
    if [ "$limit" -gt $((LIMIT - SECONDS - 10)) ]; then limit=$((LIMIT - SECONDS - 10)); fi
    if [ "$limit" -lt 5 ]; then
        note "$name" "no time left"
        failed=1
        return 1
    fi
    say "== $name (at most $limit s)"
    timeout --kill-after=5 "$limit" "$@" > "$scratch/said" 2>&1 < /dev/null &
    child=$!
    wait "$child" || status=$?
    tee -a "$out/log.txt" < "$scratch/said"
    case $status in
        0) ;;
        124 | 137) result="stopped after $limit s" ;;
        *) result="failed ($status)" ;;
    esac
    [ "$status" -eq 0 ] || failed=1
    printf '%s\t%s\t%s\n' "$name" "$result" $((SECONDS - begin)) >> "$scratch/parts.tsv"
    say "-- $name: $result, $((SECONDS - begin)) s"
    return "$status"
}

# --- the card ------------------------------------------------------------------------------------

card=$(nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader 2> /dev/null | head -n 1)
[ -n "$platform" ] || platform=$([ -n "$card" ] && echo CUDA || echo OpenCL)
say "== ${card:-no NVIDIA card}; platform $platform"

# --- what is needed ------------------------------------------------------------------------------

base=${PYTHON:-python3}
has_project() {
    "$1" -c 'import openmmhelfrich, pytest, hypothesis' 2> /dev/null
}

# OpenMM's own package for a card brings CUDA's libraries with it.
openmm() {
    if [ "$platform" = CUDA ]; then echo "openmm[cuda$cuda]==8.6.1"; else echo openmm==8.6.1; fi
}

# shellcheck disable=SC2329 # `part` starts it in a shell of its own.
install_project() {
    local pip=("$python" -m pip --disable-pip-version-check -q) project=${wheel:-.}
    [ -x "$python" ] || "$base" -m venv out/device-venv || return 1
    "${pip[@]}" install -c constraints.txt "$(openmm)" "${project}[test]"
}

# shellcheck disable=SC2329 # Likewise.
install_wheels() {
    "$base" -m pip --disable-pip-version-check -q install --no-index --no-deps --upgrade \
        --target "$site" "$wheels"/*.whl
}

if [ -n "$wheels" ]; then
    python=$base site=$PWD/out/device-site
    export PYTHONPATH=$site
    export -f install_wheels
    export base site wheels
    part environment 90 bash -c install_wheels
    # OpenMM's package looks for CUDA's libraries beside itself, but they are with the other packages.
    LD_LIBRARY_PATH=$("$base" - << 'END'
import glob
import os
import sys

names = ("libnvrtc.so.*", "libcufft.so.*")
folders = [place for path in sys.path for place in glob.glob(f"{path}/nvidia/**/lib", recursive=True)]
found = [place for place in folders if any(glob.glob(f"{place}/{name}") for name in names)]
print(":".join([*found, *filter(None, [os.environ.get("LD_LIBRARY_PATH")])]))
END
    )
    export LD_LIBRARY_PATH
elif has_project .venv/bin/python && [ -z "$wheel" ]; then
    python=.venv/bin/python
    [ "$platform" != CUDA ] || part environment 120 "$python" -m pip -q install "$(openmm)"
else
    python=out/device-venv/bin/python
    if [ -z "$wheel" ]; then
        for file in dist/*.whl; do [ ! -e "$file" ] || wheel=$file; done
    fi
    export -f install_project openmm
    export base python platform cuda wheel
    part environment 240 bash -c install_project
fi
if ! has_project "$python"; then
    note environment "no Python with the project and its tests"
    "$python" -c 'import openmmhelfrich, pytest, hypothesis' 2>&1 | tail -n 1 | tee -a "$out/log.txt"
    exit 1
fi

# Which platforms start and on what, and why others do not.
cat > "$scratch/facts.py" << 'END'
import json
import sys
from pathlib import Path

import openmm
import openmmhelfrich as helfrich
from openmmhelfrich import _benchmark

found = {"devices": {}, "failures": list(openmm.Platform.getPluginLoadFailures())}
for name in ("CUDA", "HIP", "OpenCL"):
    starting, failed = _benchmark.targets([name])
    found["failures"] += [f"{name}: {reason}" for reason in failed.values()]
    if starting:
        system = openmm.System()
        system.addParticle(1)
        platform = openmm.Platform.getPlatformByName(name)
        context = openmm.Context(system, openmm.VerletIntegrator(1), platform)
        found["devices"][name] = platform.getPropertyValue(context, "DeviceName")
adapters = [adapter for adapter in helfrich.adapters() if adapter.kind != "software"]
found["wgpu"] = f"{adapters[0].name}, {adapters[0].driver}" if adapters else None
found["machine"], found["versions"] = _benchmark.machine(), _benchmark.versions()
scratch = Path(sys.argv[1])
(scratch / "facts.json").write_text(json.dumps(found), encoding="utf-8")
# The shell asks whether these files are there.
for name, there in (("opencl", "OpenCL" in found["devices"]), ("wgpu", found["wgpu"])):
    if there:
        (scratch / f"has-{name}").touch()
print(json.dumps(found, indent=1))
if sys.argv[2] not in found["devices"]:
    sys.exit(f"the platform {sys.argv[2]} does not start")
END
part devices 60 "$python" "$scratch/facts.py" "$scratch" "$platform"

# --- correctness ---------------------------------------------------------------------------------

workers=$(nproc)
[ "$workers" -le 8 ] || workers=8
tests=("$python" -m pytest -q -n "$workers" --dist load -p no:cacheprovider)
only=native
[ -z "$quick" ] || only='native and not many'
export HELFRICH_NATIVE_PLATFORM=$platform
part "correctness, $platform" 160 "${tests[@]}" -k "$only" --junitxml="$scratch/native.xml" \
    tests/python/test_gpu.py tests/python/test_native*.py

# --- speed ---------------------------------------------------------------------------------------

steps=("$python" benches/native_steps.py --platform "$platform" --patience 15
    --output "$scratch/steps.md" --json "$scratch/steps.json")
if [ -n "$quick" ]; then steps+=(--quick); else steps+=(--repeats 4 --seconds 0.1); fi
part steps 140 "${steps[@]}"

table3=(env HELFRICH_BACKEND=native "$python" benches/table3.py --platform "$platform" --precision mixed)
extrapolated=(--quick --output "$scratch/table3.md" --json "$scratch/table3.json")
if [ -n "$quick" ]; then
    part "Table III, extrapolated" 40 "${table3[@]}" "${extrapolated[@]}" --sizes 252 1002
else
    part "Table III, extrapolated" 60 "${table3[@]}" "${extrapolated[@]}"
    part "Table III in full" 100 "${table3[@]}" --sizes 252 1002 \
        --output "$scratch/table3-full.md" --json "$scratch/table3-full.json"
fi

# --- other ways to the card ----------------------------------------------------------------------

if [ "$platform" = OpenCL ]; then
    :
elif [ -e "$scratch/has-opencl" ]; then
    HELFRICH_NATIVE_PLATFORM=OpenCL part "correctness, OpenCL" 60 "${tests[@]}" -k "native and every_row" \
        --junitxml="$scratch/opencl.xml" tests/python/test_gpu.py
else
    note "correctness, OpenCL" "not run: no OpenCL here"
fi
if [ -e "$scratch/has-wgpu" ]; then
    HELFRICH_REQUIRE_GPU=1 part "correctness, wgpu" 60 "${tests[@]}" -k "GPU and every_row" \
        --junitxml="$scratch/wgpu.xml" tests/python/test_gpu.py
else
    note "correctness, wgpu" "not run: no adapter that is no processor (Vulkan)"
fi

# --- the report ----------------------------------------------------------------------------------

cat > "$scratch/report.py" << 'END'
import datetime
import json
import sys
import xml.etree.ElementTree as tree
from pathlib import Path

scratch, out, card, platform = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3], sys.argv[4]


def loaded(name):
    path = scratch / name
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


facts = loaded("facts.json") or {}
parts = [line.split("\t") for line in (scratch / "parts.tsv").read_text().splitlines()]
tests = {}
for path in sorted(scratch.glob("*.xml")):
    suite = tree.parse(path).find("testsuite")
    bad = [case.get("name") for case in suite if case.find("failure") is not None]
    bad += [case.get("name") for case in suite if case.find("error") is not None]
    skipped = int(suite.get("skipped"))
    passed = int(suite.get("tests")) - skipped - len(bad)
    tests[path.stem] = {"passed": passed, "skipped": skipped, "failed": bad}
found = {
    "card": card, "date": datetime.date.today().isoformat(), "platform": platform, **facts,
    "parts": [dict(zip(("part", "result", "seconds"), part)) for part in parts], "tests": tests,
    "steps": loaded("steps.json"), "table3": loaded("table3.json"), "table3, in full": loaded("table3-full.json"),
}
title = card or facts.get("devices", {}).get(platform) or "no GPU"
lines = [f"## {title}", "", f"By `benches/device.sh`, {found['date']}."]
if not card:
    lines.append(f"No NVIDIA card; platform {platform} on {facts.get('devices', {}).get(platform)}.")
lines += ["", "| part | result | s |", "| --- | --- | ---: |"]
lines += [f"| {' | '.join(part)} |" for part in parts]
for name, result in tests.items():
    which = {"native": platform, "opencl": "OpenCL"}.get(name, name)
    lines += ["", f"Tests on {which}: {result['passed']} passed, {result['skipped']} skipped, {len(result['failed'])} failed."]
    lines += [f"- {name}" for name in result["failed"][:20]]
for name in ("steps.md", "table3.md", "table3-full.md"):
    if (scratch / name).exists():
        lines += ["", (scratch / name).read_text(encoding="utf-8").replace("# Table", "### Table", 1).rstrip()]
(out / "device.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
(out / "device.json").write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
END
"$python" "$scratch/report.py" "$scratch" "$out" "$card" "$platform" || failed=1
say "== $SECONDS s in all; $out/device.md, device.json and log.txt"
exit "$failed"
