"""Write the licences of what Rust links into the library, which copies of it have to come with.

    python licenses.py FOLDER

FOLDER gets LICENSE-CRATES.txt, of the crates of the project in the working directory, and
LICENSE-RUST.html, of Rust's standard library.
"""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

NAMES = re.compile(r"(LICEN[CS]E|COPYING|COPYRIGHT|NOTICE)\b.*", re.IGNORECASE)


def output(*command) -> str:
    """What a command says."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def is_macro(crate: dict) -> bool:
    """Whether a crate runs in the compiler only."""
    return any("proc-macro" in target["kind"] for target in crate["targets"])


def linked_crates() -> list[dict]:
    """The crates that are part of the library: not those of the build, of tests or of macros."""
    host = re.search(r"host: (.*)", output("rustc", "-vV"))[1]
    command = ["cargo", "metadata", "-q", "--locked", "--format-version", "1"]
    metadata = json.loads(output(*command, "--filter-platform", host))
    crates = {crate["id"]: crate for crate in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    root = metadata["resolve"]["root"]
    found, waiting = {root}, [root]
    while waiting:
        for needed in nodes[waiting.pop()]["deps"]:
            name = needed["pkg"]
            linked = any(kind["kind"] is None for kind in needed["dep_kinds"])
            if linked and name not in found and not is_macro(crates[name]):
                found.add(name)
                waiting.append(name)
    found.remove(root)
    return sorted((crates[name] for name in found), key=lambda c: (c["name"], c["version"]))


def license_texts(crate: dict) -> list[str]:
    """What a crate has in files that are named like licences."""
    files = sorted(Path(crate["manifest_path"]).parent.iterdir())
    named = [file for file in files if file.is_file() and NAMES.fullmatch(file.name)]
    return [file.read_text(encoding="utf-8").strip() for file in named]


def notices(crates: list[dict]) -> str:
    """A list of the crates, and then every text of a licence once."""
    numbers = {}
    lines = [
        "The library of openmm-helfrich contains the Rust crates below, under their licences.",
        "Numbers are those of the texts that the crates come with, which follow.",
        "",
    ]
    for crate in crates:
        own = [str(numbers.setdefault(text, len(numbers) + 1)) for text in license_texts(crate)]
        source = f"[{', '.join(own)}]"
        if not own:
            authors = ", ".join(crate["authors"]) or "its contributors"
            source = f"by {authors}, without a text of it; see {crate['repository']}"
        lines.append(f"{crate['name']} {crate['version']}: {crate['license']} {source}")
    for text, number in numbers.items():
        lines += ["", "=" * 80, f"[{number}]", "", text]
    return "\n".join(lines) + "\n"


def main():
    """Write both files."""
    folder = Path(sys.argv[1])
    rust = Path(output("rustc", "--print", "sysroot").strip(), "share/doc/rust")
    library = rust / "COPYRIGHT-library.html"
    if not library.exists():
        raise SystemExit(
            f"openmm-helfrich: {library} is missing, the notices of Rust's standard library that a "
            "wheel needs; use a Rust from https://rustup.rs."
        )
    shutil.copyfile(library, folder / "LICENSE-RUST.html")
    (folder / "LICENSE-CRATES.txt").write_text(notices(linked_crates()), encoding="utf-8")


if __name__ == "__main__":
    main()
