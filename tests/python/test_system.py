"""`_system` alone calls what other systems than Linux lack; its other branches work here too."""

import ast
import sys
from pathlib import Path

import pytest
from openmmhelfrich import _core, _system

PACKAGE = Path(_core.__file__).parent
SOURCES = PACKAGE.parents[1]
#: Modules, and functions of `os`, that are not everywhere.
MODULES = {"fcntl", "resource", "pwd", "grp", "termios", "posix", "msvcrt", "winreg", "syslog"}
FUNCTIONS = {"fork", "memfd_create", "pread", "getuid", "sched_getaffinity", "mkfifo", "uname"}
FUNCTIONS |= {"killpg", "setsid", "wait", "waitpid", "posix_spawn", "splice", "sendfile"}


def foreign(path):
    """What a module uses of these."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names if name.name in MODULES)
        elif isinstance(node, ast.ImportFrom) and node.module in MODULES:
            yield node.module
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id == "os" and node.attr in FUNCTIONS:
                yield f"os.{node.attr}"
            if (node.value.id, node.attr) == ("sys", "platform"):
                yield "sys.platform"


def test_no_other_module_asks_for_the_system():
    found = {path.name: sorted(set(foreign(path))) for path in sorted(PACKAGE.rglob("*.py"))}
    assert set(found.pop("_system.py")) > {"fcntl", "resource", "os.memfd_create"}
    assert not {name: uses for name, uses in found.items() if uses}


def test_rust_and_cpp_do_not_either():
    rust = "\n".join(p.read_text(encoding="utf-8") for p in (SOURCES.parent / "src").rglob("*.rs"))
    assert "libc::" not in rust and "std::os::" not in rust
    for path in sorted((SOURCES.parent / "wrappers").rglob("*.[hc]*")):
        text = path.read_text(encoding="utf-8")
        of_one = [name for name in ("<unistd.h>", "<dlfcn.h>", "<sys/", "_l(") if name in text]
        assert not of_one or path.name == "SystemCalls.h", (path, of_one)


def test_a_file_is_locked_once(tmp_path):
    path = tmp_path / "lock"
    with path.open("wb") as first, path.open("wb") as second:
        _system.lock(first)
        with pytest.raises(BlockingIOError):
            _system.lock(second)
        first.close()
        _system.lock(second)


@pytest.mark.parametrize("platform", ["linux", "darwin"])
def test_what_a_function_writes(platform, monkeypatch):
    monkeypatch.setattr(sys, "platform", platform)

    def write(name):
        Path(name).write_bytes(b"a frame")

    def fail(name):
        write(name)
        raise OSError(28, "No space left on device")

    assert _system.written(write) == (b"a frame", None)
    data, error = _system.written(fail)
    assert data == b"a frame" and error.errno == 28


def test_windows_has_neither_limits_nor_folders_to_open(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "platform", "win32")
    assert _system.file_size_limit() is None
    assert _system.sync_folder(tmp_path / "nowhere") is None


def test_the_library_has_the_name_of_the_system():
    assert _core.LIBRARY_PATH.name == _system.LIBRARY == "libOpenMMHelfrich.so"


@pytest.mark.parametrize("links", [True, False])
def test_files_of_any_name_have_one_of_ascii(links, tmp_path, monkeypatch):
    def refuse(*names):
        raise OSError(1314, "A required privilege is not held by the client")

    if not links:
        monkeypatch.setattr("os.symlink", refuse)
    monkeypatch.chdir(tmp_path)
    path = Path("ü")
    path.write_bytes(b"a frame")
    with _system.ascii_name(path) as name:
        assert name.isascii() and Path(name).read_bytes() == b"a frame"
    assert not Path(name).exists() and path.read_bytes() == b"a frame"
    path.rename("u")
    with _system.ascii_name(Path("u")) as name:
        assert name == "u"
