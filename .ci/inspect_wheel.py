"""Refuse a wheel that would not work elsewhere, or that tells where it was built.

    python inspect_wheel.py WHEEL FOLDER...

None of the folders, nor the home folder, may be named in it.
"""

import io
import re
import sys
import zipfile
from pathlib import Path

from elftools.elf.elffile import ELFFile

LICENSES = {"LICENSE", "LICENSE-CRATES.txt", "LICENSE-RUST.html"}
# The system's are those that manylinux allows, which auditwheel has checked.
OURS = {"libOpenMMHelfrich.so", "libOpenMM.so"}


def check_name(name: str):
    """One wheel for all Pythons, and for a glibc that is known."""
    if not re.fullmatch(r"openmm_helfrich-[^-]+-cp310-abi3-manylinux_2_\d+_\w+\.whl", name):
        raise SystemExit(f"{name} is not named after the stable ABI and a manylinux policy")


def check_library(name: str, content: bytes):
    """Libraries are looked for beside the package only."""
    dynamic = ELFFile(io.BytesIO(content)).get_section_by_name(".dynamic")
    for tag in dynamic.iter_tags():
        if tag.entry.d_tag in ("DT_RUNPATH", "DT_RPATH"):
            folders = getattr(tag, "runpath", None) or tag.rpath
            if not all(folder.startswith("$ORIGIN/") for folder in folders.split(":")):
                raise SystemExit(f"{name} looks for libraries in {folders}")
        if tag.entry.d_tag == "DT_NEEDED" and "OpenMM" in tag.needed and tag.needed not in OURS:
            raise SystemExit(f"{name} needs {tag.needed}")


def check_places(name: str, content: bytes, places: list[bytes]):
    """No folder of the machine that built it is named."""
    for place in places:
        at = content.find(place)
        if at >= 0:
            said = re.match(rb"[^\0\s]*", content[at : at + 200])[0].decode(errors="replace")
            raise SystemExit(f"{name} names a folder of this machine: {said}")


def main():
    """Check one wheel."""
    wheel = Path(sys.argv[1])
    folders = {Path(place).resolve() for place in [*sys.argv[2:], Path.home()]} - {Path("/")}
    places = [f"{folder}/".encode() for folder in folders]
    check_name(wheel.name)
    with zipfile.ZipFile(wheel) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    libraries = [name for name in contents if name.endswith(".so")]
    if len(libraries) != 2:
        raise SystemExit(f"{wheel.name} should have two libraries and has {libraries}")
    for name in libraries:
        check_library(name, contents[name])
    for name, content in contents.items():
        check_places(name, content, places)
    missing = LICENSES - {Path(name).name for name in contents if "/licenses/" in name}
    if missing:
        raise SystemExit(f"{wheel.name} has no {', '.join(sorted(missing))}")


if __name__ == "__main__":
    main()
