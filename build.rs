//! Finds OpenMM, compiles the C++ shim against it, and generates bindings to its C API.
//!
//! OpenMM is looked for in `$OPENMM_DIR` (a folder with `include` and `lib`), else in the Python that
//! `$PYTHON` names, else in `.venv` here, else in `python3`: the wheel from PyPI carries all that is needed.

#[path = "src/potentials/codes.rs"]
#[allow(dead_code, reason = "the crate uses the rest")]
mod codes;
#[path = "shaders/compose.rs"]
mod compose;
#[path = "shaders/constants.rs"]
mod constants;
#[path = "wrappers/declarations.rs"]
mod declarations;
#[path = "shaders/dialect/mod.rs"]
mod dialect;
#[path = "wrappers/codes.rs"]
mod headers;
#[path = "src/evaluator/gpu/interface.rs"]
#[allow(dead_code, reason = "the crate uses the rest")]
mod interface;

/// Where the included files look for them.
mod potentials {
    pub use crate::codes::{CONSTANTS, MAX_PARAMETERS, Needs};
}

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::{Command, exit};
use std::{env, fs};

fn main() {
    for variable in ["OPENMM_DIR", "PYTHON", "LIBCLANG_PATH", "HELFRICH_PACKAGE"] {
        println!("cargo:rerun-if-env-changed={variable}");
    }
    println!("cargo:rerun-if-changed=wrappers");
    println!("cargo:rerun-if-changed=shaders");
    for shared in ["potentials/codes.rs", "evaluator/gpu/interface.rs"] {
        println!("cargo:rerun-if-changed=src/{shared}");
    }
    if let Err(message) = compose::write_modules(Path::new("shaders"), &out_dir()) {
        fail(&message);
    }
    let site_packages = python_site_packages();
    let openmm = find_openmm(site_packages.as_deref());
    let include = openmm.join("include");
    let lib = openmm.join("lib");
    println!("cargo:rerun-if-changed={}", include.join("OpenMM.h").display());
    let version = openmm_version(&include, &lib);
    println!("cargo:rustc-env=HELFRICH_OPENMM_VERSION={version}");

    let mut shim = cc::Build::new();
    shim.cpp(true).std("c++17").include("wrappers/include").include("wrappers/src").warnings(true);
    // OpenMM's headers are not ours to mend: as system headers they raise no warnings.
    shim.flag("-isystem").flag(&include).flag_if_supported("-Wno-unused-parameter");
    shim.define("HELFRICH_OPENMM_VERSION", format!("\"{version}\"").as_str());
    for source in sources(Path::new("wrappers/src")) {
        shim.file(source);
    }
    fs::write(out_dir().join("NativeCodes.h"), headers::native_codes())
        .expect("OUT_DIR is writable");
    let renamed = declarations::shim_header(Path::new("wrappers"));
    fs::write(out_dir().join("CApi.h"), renamed).expect("OUT_DIR is writable");
    shim.include(out_dir());
    let comparison = out_dir().join("codes.cpp");
    fs::write(&comparison, headers::comparison()).expect("OUT_DIR is writable");
    // An enumerator that Rust does not know is missing in a switch there.
    shim.file(comparison).flag_if_supported("-Werror=switch");
    shim.flag_if_supported("-Werror=unused-result");
    // Nothing in Rust refers to most of the shim, so the linker must be told to keep all of it.
    shim.link_lib_modifier("+whole-archive").compile("helfrich_shim");

    println!("cargo:rustc-link-search=native={}", lib.display());
    println!("cargo:rustc-link-lib=dylib=OpenMM");
    if target("OS") == "linux" {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libOpenMMHelfrich.so");
        // From openmmhelfrich/lib to the wheel's libraries, and from OpenMM's plugin folder up.
        println!("cargo:rustc-cdylib-link-arg=-Wl,-rpath,$ORIGIN/../../OpenMM.libs/lib:$ORIGIN/..");
        if target("ENV") == "gnu" && target("ARCH") == "x86_64" {
            // See wrappers/src/OldHypot.cpp.
            println!("cargo:rustc-cdylib-link-arg=-Wl,--wrap=hypot,--wrap=hypotf");
        }
        // Tests and benches run where they were built; a package must not know that place.
        if env::var_os("HELFRICH_PACKAGE").is_none() {
            println!("cargo:rustc-link-arg=-Wl,-rpath,{}", lib.display());
        }
    }
    if target("OS") == "macos" {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libOpenMMHelfrich.dylib");
        for folder in ["@loader_path/../../OpenMM.libs/lib", "@loader_path/.."] {
            println!("cargo:rustc-cdylib-link-arg=-Wl,-rpath,{folder}");
        }
    }
    println!("cargo:lib_dir={}", lib.display());
    find_libclang(site_packages.as_deref());
    let openmm = bindgen::Builder::default()
        .header(include.join("OpenMMCWrapper.h").display().to_string())
        .allowlist_item("OpenMM_.*");
    fs::write(out_dir().join("openmm.rs"), bindings(openmm)).expect("OUT_DIR is writable");
    let folders = ["wrappers/include".into(), "wrappers/src".into(), include, out_dir()];
    declarations::write(&folders, &out_dir(), bindings).expect("OUT_DIR is writable");
}

/// Stop with a message that a user can act on.
fn fail(message: &str) -> ! {
    for line in message.lines() {
        println!("cargo:warning={line}");
    }
    eprintln!("{message}");
    exit(1);
}

fn out_dir() -> PathBuf {
    PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"))
}

/// What cargo says of the machine that the library is for.
fn target(what: &str) -> String {
    env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default()
}

/// Where the chosen Python keeps its packages, if it has OpenMM.
fn python_site_packages() -> Option<PathBuf> {
    let local = Path::new(".venv/bin/python");
    let python = env::var_os("PYTHON").map(PathBuf::from).unwrap_or_else(|| {
        if local.exists() { local.to_owned() } else { PathBuf::from("python3") }
    });
    // Finding the package is enough; importing OpenMM would load its plugins.
    let script = "import importlib.util as u, pathlib as p\n\
                  s = u.find_spec('openmm')\n\
                  print(p.Path(s.origin).parent.parent if s else '')";
    let output = Command::new(python).args(["-c", script]).output().ok()?;
    let path = String::from_utf8(output.stdout).ok()?;
    (!path.trim().is_empty()).then(|| PathBuf::from(path.trim()))
}

fn find_openmm(site_packages: Option<&Path>) -> PathBuf {
    let candidates = [
        env::var_os("OPENMM_DIR").map(PathBuf::from),
        site_packages.map(|p| p.join("OpenMM.libs")),
    ];
    for candidate in candidates.into_iter().flatten() {
        if candidate.join("include/OpenMM.h").exists() && candidate.join("lib").exists() {
            return candidate;
        }
    }
    fail(
        "OpenMM was not found. Run `make build`, or `pip install openmm==8.6.1` and name that Python \
         in $PYTHON, or set $OPENMM_DIR to a folder with OpenMM's include and lib.",
    )
}

/// Ask the library itself: the headers do not say.
fn openmm_version(include: &Path, lib: &Path) -> String {
    let out = out_dir();
    let (source, program) = (out.join("version.cpp"), out.join("version"));
    let code = "#include <OpenMM.h>\n#include <iostream>\n\
                int main() { std::cout << OpenMM::Platform::getOpenMMVersion(); }\n";
    fs::write(&source, code).expect("OUT_DIR is writable");
    // It runs here, also where the library is for another machine.
    let host = env::var("HOST").expect("cargo sets HOST");
    let mut build = cc::Build::new();
    let compiler = build.cpp(true).std("c++17").target(&host).include(include).get_compiler();
    let mut command = compiler.to_command();
    command.arg(&source).arg("-o").arg(&program).arg("-L").arg(lib);
    command.arg("-lOpenMM").arg(format!("-Wl,-rpath,{}", lib.display()));
    match command.output() {
        Err(error) => fail(&format!(
            "No C++ compiler could be started ({error}). Install g++ or clang++, or name one in $CXX."
        )),
        Ok(result) if !result.status.success() => fail(&format!(
            "A program of three lines does not build against OpenMM in {}:\n{}",
            include.display(),
            String::from_utf8_lossy(&result.stderr)
        )),
        Ok(_) => {}
    }
    let output = Command::new(&program).output();
    let version = output.ok().and_then(|output| String::from_utf8(output.stdout).ok());
    version.filter(|text| !text.is_empty()).unwrap_or_else(|| {
        fail(&format!("OpenMM in {} does not run on this machine.", lib.display()))
    })
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("the wrappers are part of the project");
    let mut files: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "cpp"));
    files.sort();
    files
}

/// The wheel from PyPI has it where bindgen does not look.
fn find_libclang(site_packages: Option<&Path>) {
    let wheel = site_packages.map(|path| path.join("clang/native"));
    if let Some(folder) = wheel.filter(|folder| folder.exists())
        && env::var_os("LIBCLANG_PATH").is_none()
    {
        // SAFETY: a build script has one thread.
        unsafe { env::set_var("LIBCLANG_PATH", folder) };
    }
}

fn bindings(builder: bindgen::Builder) -> String {
    match catch_unwind(AssertUnwindSafe(|| builder.generate())) {
        Ok(Ok(bindings)) => bindings.to_string(),
        Ok(Err(error)) => fail(&format!("bindgen cannot read the headers: {error}")),
        Err(_) => fail(
            "bindgen needs libclang: `pip install libclang` into the Python of this build, or set \
             $LIBCLANG_PATH.",
        ),
    }
}
