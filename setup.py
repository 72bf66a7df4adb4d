"""Build the Rust library, the SWIG wrapper and the extension; pyproject.toml has the rest."""

import os
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent
# What cargo calls the library.
BUILT = {"win32": "openmm_helfrich.dll", "darwin": "libopenmm_helfrich.dylib"}.get(
    sys.platform, "libopenmm_helfrich.so"
)
# Where the extension looks for the two libraries, from its own folder; Windows has no such paths.
ORIGIN = {"win32": None, "darwin": "@loader_path"}.get(sys.platform, "$ORIGIN")
# The extension keeps to the stable ABI of this Python, so that all later ones load it too.
OLDEST_PYTHON = (3, 10)


def find_openmm() -> Path:
    """The folder with OpenMM's headers and libraries: ``$OPENMM_DIR``, else the wheel's."""
    candidates = []
    if os.environ.get("OPENMM_DIR"):
        candidates.append(Path(os.environ["OPENMM_DIR"]))
    spec = find_spec("openmm")
    if spec is not None:
        candidates.append(Path(spec.origin).parent.parent / "OpenMM.libs")
    for candidate in candidates:
        if (candidate / "include" / "OpenMM.h").exists():
            return candidate
    raise SystemExit("OpenMM was not found: pip install openmm==8.6.1, or set $OPENMM_DIR.")


def module_of_package(name: str):
    """A module of the package, without the package."""
    path = ROOT / "python" / "openmmhelfrich" / f"{name}.py"
    spec = spec_from_file_location(name, path)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def find_swig() -> str:
    """SWIG of this Python's environment, else of the PATH.

    OpenMM's type table has the runtime version of SWIG 4.4: what an older one makes does not know
    OpenMM's Force.
    """
    here = str(Path(sys.executable).parent)
    swig = shutil.which("swig", path=os.pathsep.join([here, os.environ.get("PATH", "")]))
    text = subprocess.run([swig, "-version"], capture_output=True, text=True).stdout if swig else ""
    version = re.search(r"SWIG Version (\d+)\.(\d+)", text)
    if version is None or (int(version[1]), int(version[2])) < (4, 4):
        raise SystemExit("SWIG 4.4 or later is missing: pip install 'swig>=4.4'.")
    return swig


class BuildPlugin(build_ext):
    """cargo, then SWIG, then the extension."""

    def run(self):
        """Build everything into the package folder (the source's, for an editable install)."""
        if shutil.which("cargo") is None:
            raise SystemExit("Rust is missing: install it from https://rustup.rs, then try again.")
        package = ROOT / "python" if self.inplace else Path(self.build_lib)
        package /= "openmmhelfrich"
        openmm = find_openmm()
        self.build_core(package, openmm)
        self.build_wrapper(package, openmm)
        super().run()

    def build_core(self, package: Path, openmm: Path):
        """The Rust library with the C++ shim, and the headers for C++ users."""
        environment = dict(os.environ, OPENMM_DIR=str(openmm), PYTHON=sys.executable)
        if not self.inplace:
            environment["HELFRICH_PACKAGE"] = "1"
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
        # Where cargo puts what it builds for a machine that it is told by name.
        target /= os.environ.get("CARGO_BUILD_TARGET", "")
        command = ["cargo", "build", "--release", "--locked", "--lib"]
        if subprocess.call(command, cwd=ROOT, env=environment) != 0:
            raise SystemExit("The Rust library did not build; its messages are above.")
        library = package / "lib" / module_of_package("_system").LIBRARY
        library.parent.mkdir(parents=True, exist_ok=True)
        # Replacing the file instead of writing into it leaves programs that have it open in peace.
        library.unlink(missing_ok=True)
        shutil.copy2(target / "release" / BUILT, library)
        for folder in ("include", "cmake"):
            shutil.rmtree(package / folder, ignore_errors=True)
            shutil.copytree(ROOT / "wrappers" / folder, package / folder)
        module_of_package("_openmm_interface").write_record(package, openmm / "include")

    def build_wrapper(self, package: Path, openmm: Path):
        """The functions that the force classes call, which SWIG makes, and their compiler flags."""
        generated = Path(self.build_temp)
        generated.mkdir(parents=True, exist_ok=True)
        wrapper = generated / "forces_wrap.cpp"
        # Python prefers one that was made for it alone.
        for extension in package.glob("_forces*.so"):
            extension.unlink()
        includes = [str(ROOT / "wrappers" / "include"), str(openmm / "include")]
        # The disabled warnings are about OpenMM's own declarations.
        options = ["-python", "-c++", "-w314,325,453"]
        command = [find_swig(), *options, *(f"-I{path}" for path in includes)]
        # The classes that SWIG writes stay there; forces/ has ours.
        command += ["-o", str(wrapper), str(ROOT / "python" / "forces.i")]
        subprocess.check_call(command)
        extension = self.extensions[0]
        extension.sources.insert(0, str(wrapper))
        extension.include_dirs += includes
        extension.library_dirs += [str(package / "lib"), str(openmm / "lib")]


forces = Extension(
    "openmmhelfrich._forces",
    [],
    language="c++",
    libraries=["OpenMMHelfrich", "OpenMM"],
    define_macros=[("Py_LIMITED_API", "0x{:02x}{:02x}0000".format(*OLDEST_PYTHON))],
    py_limited_api=True,
    extra_compile_args=["-std=c++17", "-O2", "-g0", "-w"],
    extra_link_args=[
        f"-Wl,-rpath,{ORIGIN}/{folder}" for folder in ("lib", "../OpenMM.libs/lib") if ORIGIN
    ],
)

setup(
    ext_modules=[forces],
    cmdclass={"build_ext": BuildPlugin},
    options={"bdist_wheel": {"py_limited_api": "cp{}{}".format(*OLDEST_PYTHON)}},
)
