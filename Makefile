# `make help` lists what there is. PYTHON names the Python that .venv is made of, CXX the compiler.

PYTHON ?= python3
VENV := $(CURDIR)/.venv
SITE_PACKAGES = $(wildcard $(VENV)/lib/python3.*/site-packages)
OPENMM = $(SITE_PACKAGES)/OpenMM.libs
TARGET := $(abspath $(or $(CARGO_TARGET_DIR),target))

# The same environment as in setup.py, so that nothing is compiled twice.
CARGO = PYTHON=$(VENV)/bin/python OPENMM_DIR=$(OPENMM) cargo
# All pages are read anew, since a page that was read says its warnings no more.
SPHINX = $(VENV)/bin/sphinx-build -q -n -W -E --keep-going -j 2 -d out/docs/doctrees
PIP = $(VENV)/bin/python -m pip --disable-pip-version-check -q

# What pip builds; the Python files of the package are used in place.
SOURCES := Cargo.toml Cargo.lock build.rs setup.py python/forces.i \
           $(wildcard src/*.rs src/*/*.rs src/*/*/*.rs shaders/* shaders/*/* $(foreach any,wrappers/* wrappers/*/* wrappers/*/*/*,$(any)/*))
CPP := $(wildcard $(foreach any,wrappers/* wrappers/*/* wrappers/*/*/* tests/cpp examples,\
           $(any)/*.h $(any)/*.c $(any)/*.cpp))
# Scripts write the two that are left out.
MD := $(filter-out docs/reproduction.md docs/benchmarks.md,$(wildcard *.md docs/*.md docs/tutorials/*.md))
MDFORMAT := $(VENV)/bin/mdformat --wrap 100 --number --compact-tables
PY := $(wildcard .ci setup.py python tests examples benches docs/conf.py docs/_site)

.DEFAULT_GOAL := build
.PHONY: build test lint derived format wheel demo paper bench docs docs-links fuzz sanitize clean help check-tools test-rust \
        test-package test-python test-long FORCE

build: $(VENV)/.installed ## build everything and install it in .venv (the default)
	@echo "openmm-helfrich is installed in .venv; try: make demo"

test: lint test-rust test-python ## run all checks: lint, Rust, Python, documentation, a clean installation
	@$(MAKE) -s -j 2 --output-sync=target docs test-package

lint: $(VENV)/.requirements ## check formatting, lint Rust, C++ and Python, and check links of Rust's documentation
	@echo "== Formatting and lint"
	@cargo fmt --check
	@cargo fmt --check --manifest-path tests/loom/Cargo.toml
	@$(CARGO) clippy -q --all-targets --release --locked -- -D warnings
	@RUSTDOCFLAGS="-D warnings" $(CARGO) doc -q --no-deps --release --locked
	@$(VENV)/bin/clang-format --dry-run -Werror $(CPP)
	@$(VENV)/bin/ruff check -q $(PY)
	@$(VENV)/bin/ruff format -q --check $(PY)
	@$(MDFORMAT) --check $(MD)

derived: $(VENV)/.requirements ## write anew what follows from the potentials: their lists, the functions of C, the classes of Python
	@$(VENV)/bin/python .ci/potentials.py
	@$(VENV)/bin/python .ci/forces.py

format: $(VENV)/.requirements ## format Rust, C++, Python and Markdown in place
	@cargo fmt
	@cargo fmt --manifest-path tests/loom/Cargo.toml
	@$(VENV)/bin/clang-format -i $(CPP)
	@$(VENV)/bin/ruff check -q --fix-only $(PY)
	@$(VENV)/bin/ruff format -q $(PY)
	@$(MDFORMAT) $(MD)

# Properties are tested on the same examples each time; another number looks for others.
test-rust: export PROPTEST_RNG_SEED ?= 1
test-rust: $(VENV)/.requirements # Rust's tests
	@echo "== Rust"
	@$(CARGO) test -q --release --locked
	@cargo test -q --release --locked --manifest-path tests/loom/Cargo.toml --target-dir $(TARGET)/loom

test-package: $(VENV)/.requirements # `pip install .` where nothing else is
	@echo "== A clean installation"
	@CARGO_TARGET_DIR=$(TARGET) $(SHELL) .ci/check-package.sh $(VENV)/bin/python

wheel: $(VENV)/.requirements ## build a wheel in dist/ that installs without Rust and compilers, and try it there
	@echo "== A wheel"
	@CARGO_TARGET_DIR=$(TARGET)/wheel $(SHELL) .ci/build-wheel.sh $(VENV)/bin/python
	@$(SHELL) .ci/check-wheel.sh $(VENV)/bin/python
	@ls dist

# One more than there are processors, for tests that wait.
WORKERS := $(shell expr $$(nproc 2> /dev/null || echo 2) + 1)

test-python: build # what a user sees
	@echo "== Python"
	@$(VENV)/bin/python -m pytest -q -n $(WORKERS) --dist loadfile

test-long: build ## run the tests that `make test` leaves out, for they take long
	@$(VENV)/bin/python -m pytest -q -n $(WORKERS) --dist loadfile -m long

# Warnings are errors, and so are links within the site that lead nowhere. Rustdoc's pages are part of it.
docs: build ## make the site of the documentation in out/docs/html
	@echo "== Documentation"
	@$(CARGO) doc -q --no-deps --release --locked
	@$(SPHINX) -b html docs out/docs/html
	@rm -rf out/docs/html/rust && cp -r $(TARGET)/doc out/docs/html/rust
	@$(VENV)/bin/python docs/_site/check_links.py out/docs/html

docs-links: build ## check the links to other sites, which needs a network
	@$(SPHINX) -b linkcheck docs out/docs/links

demo: build ## simulate a vesicle and draw it with its fluctuation spectrum (about two minutes)
	@$(VENV)/bin/python examples/vesicle.py

# A script that found a number outside its tolerance exits with 3, and report.py lists these; with 4
# if it needs files that are not there. Results are stored one by one, so that what was stopped goes on.
paper: SIZE ?= quick
paper: build ## make the paper's figures in small versions, with a report, in out/paper/quick; SIZE=full takes hours
	@case "$(SIZE)" in quick|full) ;; *) echo "paper: SIZE is quick or full, not $(SIZE)" >&2; exit 2 ;; esac; \
	failed=; for script in examples/paper/fig*.py examples/paper/sm*.py examples/paper/tab*.py; do \
	    $(VENV)/bin/python $$script $(if $(filter quick,$(SIZE)),--quick); \
	    case $$? in 0|3|4) ;; *) failed="$$failed $$script" ;; esac; \
	done; \
	$(VENV)/bin/python examples/paper/report.py --results out/paper/$(SIZE) --out out/paper/$(SIZE) && \
	if [ -n "$$failed" ]; then echo "paper: failed:$$failed" >&2; exit 1; fi

bench: build ## race evaluations, time steps and the paper's Table III; BENCH=--quick is short (else half an hour)
	@$(CARGO) bench -q --locked --bench evaluate -- --output-format bencher $(if $(findstring --quick,$(BENCH)),--quick,\
	    --warm-up-time 0.5 --measurement-time 2)
	@$(CARGO) bench -q --locked --bench gpu
	@$(CARGO) bench -q --locked --bench flips
	@$(VENV)/bin/python benches/flip_steps.py $(findstring --quick,$(BENCH))
	@$(VENV)/bin/python benches/viscosity_steps.py $(findstring --quick,$(BENCH))
	@$(VENV)/bin/python benches/many_steps.py $(findstring --quick,$(BENCH))
	@$(VENV)/bin/python benches/steps.py $(BENCH)
	@$(VENV)/bin/python benches/table3.py $(findstring --quick,$(BENCH))

# Each door gets the same part of the time; what is found is in out/fuzz.
fuzz: build ## look for faults at random for MINUTES (default 10); SEED goes where it says
	@$(PIP) install atheris==3.0.0 || echo "fuzz: without atheris, inputs are changed blindly" >&2
	@PYTHON=$(VENV)/bin/python OPENMM_DIR=$(OPENMM) $(VENV)/bin/python tests/fuzz/run.py \
	    --minutes $(or $(MINUTES),10) $(if $(SEED),--seed $(SEED))

sanitize: build ## run sanitizers, Miri and loom, or PART="loom miri address leaks thread"; all take hours
	@bash tests/sanitize.sh $(PART)

clean: ## remove everything that was built, .venv too
	rm -rf $(VENV) build dist target out python/*.egg-info
	rm -rf $(addprefix python/openmmhelfrich/,lib include cmake)
	rm -rf docs/forces docs/api
	rm -f python/openmmhelfrich/forces.py python/openmmhelfrich/*.so

help: ## list these targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1~\2/p' $(firstword $(MAKEFILE_LIST)) | sed 's/~/\t/' | expand -t 16

# Says what is missing before anything starts.
check-tools:
	@PYTHON="$(PYTHON)" $(SHELL) .ci/check-tools.sh

# Made of the Python that was asked for; one that is asked for by name replaces another. Its own Python, as in a shell
# where it is active, is no other.
$(VENV)/.python: check-tools FORCE
	@folder=$$(cd "$$(dirname "$$(command -v $(firstword $(PYTHON)))")" && pwd); \
	if [ ! -x $(VENV)/bin/python ] || { [ "$$folder" != $(VENV)/bin ] && \
	    [ "$(origin PYTHON)" != file ] && [ "$(PYTHON)" != "$$(cat $@ 2>/dev/null)" ]; }; then \
	    echo "== Making .venv of $(PYTHON)"; \
	    rm -rf $(VENV) && $(PYTHON) -m venv $(VENV) && echo "$(PYTHON)" > $@; \
	elif [ ! -e $@ ]; then echo "$(PYTHON)" > $@; fi

$(VENV)/.requirements: constraints.txt $(VENV)/.python
	@echo "== Downloading what is needed (constraints.txt)"
	@$(PIP) install -r constraints.txt
	@touch $@

# pip downloads nothing any more here, but notices what constraints.txt has forgotten.
$(VENV)/.installed: $(VENV)/.requirements pyproject.toml $(SOURCES)
	@echo "== Building the library and the Python module (from nothing, about two minutes)"
	@$(PIP) install --no-index --no-build-isolation --check-build-dependencies -e '.[test,lint,paper,docs]'
	@touch $@
