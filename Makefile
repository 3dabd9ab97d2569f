# The README's two commands are `make demo` and `make test`; `make help` lists the others.
#
# Each command does its own set-up and skips what is already installed: Debian's packages where something is missing,
# a virtual environment in .venv, pip install. The files in .venv/done remember what has been done.

PYTHON ?= python3
# The whole path: once it exists, the virtual environment's python3 comes first in PATH.
override PYTHON := $(or $(shell command -v $(PYTHON)),$(PYTHON))
export PYTHON
export VIRTUAL_ENV := $(CURDIR)/.venv
export PATH := $(VIRTUAL_ENV)/bin:$(PATH)

DONE := .venv/done
PIP_INSTALL := python -m pip install --quiet --disable-pip-version-check
# Tests run on all processors; a process without tests takes over half of another's remaining ones.
PYTEST := pytest -n auto --dist worksteal
# The folder where pip builds. The C++ tests and the benchmarks are built there too: so they test the
# core that is installed, and it is compiled only once.
BUILT := build/installed
# These include folders, which change when a file is added or removed.
SOURCES := pyproject.toml CMakeLists.txt $(shell find cpp python ! -path '*__pycache__*')

.DEFAULT_GOAL := help
.PHONY: demo test test-all compare hard-cases bench against build-bench lint tidy sanitize sanitize-few \
    sanitized references threads lowest long horizon asked-errors default-method book-speed fuzz fuzz-readers \
    test-error mutants elsewhere wasm page wheel site core clean help flip-map film

demo: $(DONE)/installed  ## build, run the textbook's case, say where its figure and summary are
	pendcore run -o out/textbook
	@echo
	@echo "figure:   out/textbook/angles.png"
	@echo "summary:  out/textbook/summary.txt"
	@echo "command:  .venv/bin/pendcore --help (or first: . .venv/bin/activate)"
	@echo "next:     .venv/bin/pendcore derive; .venv/bin/pendcore run examples/03_case_file.toml"

test: $(DONE)/installed $(DONE)/test-requirements  ## build and run the tests: every claim, sweeps reduced to a few cases
	$(CPP_TESTS)
	$(PYTEST)

# Programs without which tests are skipped are installed first: those that count instructions, those
# that are compared with pendcore, the fuzzer of the readers, Octave and pandoc. As in .ci/run,
# compiler warnings are errors.
test-all: export SKBUILD_CMAKE_DEFINE = PENDCORE_WARNINGS_AS_ERRORS=ON
test-all: lint tidy build-bench page $(DONE)/test-requirements $(DONE)/fuzz-requirements  ## everything: full sweeps, sanitizers, other builds, random cases
	@sh setup/debian_packages.sh octave pandoc ffmpeg chromium
	$(CPP_TESTS)
	$(PYTEST) --full
	$(MAKE) sanitize threads elsewhere wheel site fuzz-readers fuzz CASES=20000 CONTRACTED=--contracted

# Where these are missing, tests that compare with them are skipped.
references: $(DONE)/error-requirements $(DONE)/bench-requirements  ## installs what tests compare pendcore with

define CPP_TESTS
cmake -B $(BUILT) -DPENDCORE_TESTS=ON
cmake --build $(BUILT) --target tests/cpp/all
ctest --test-dir $(BUILT) --output-on-failure --no-tests=error
endef

compare: build-bench  ## accuracy and speed beside other solvers
	python bench/compare/compare.py

hard-cases: build-bench  ## what breaks simulators, here and in other programs
	python bench/compare/compare.py --only hard_cases

bench: build-bench  ## what the parts of the core cost, in nanoseconds
	$(BUILT)/bench/pendcore_bench

OLD ?= $(error say which commit to compare with: make against OLD=COMMIT)
NEW ?= HEAD
ROUNDS ?= 30
PROCESSES ?= 8
against: $(DONE)/installed  ## is a commit slower? OLD=COMMIT and NEW=COMMIT (HEAD), the same calls in turns; ONLY="taylor chain"
	python bench/against.py $(OLD) $(NEW) --rounds $(ROUNDS) --processes $(PROCESSES) $(if $(ONLY),--only $(ONLY))

build-bench: $(DONE)/installed $(DONE)/bench-requirements
	cmake -B $(BUILT) -DPENDCORE_BENCH=ON
	cmake --build $(BUILT) --target bench/all

lint: $(DONE)/lint-requirements  ## formatting, style, types and spelling, as before a commit
	pre-commit run --all-files

tidy: $(DONE)/build-requirements $(DONE)/lint-requirements  ## clang-tidy over the core
	cmake --preset tidy
	run-clang-tidy.py -quiet -hide-progress -p build/tidy

# Sanitizers need each line of code to run once, not often: sweeps are those of `make test`, and tests
# that are slow for other reasons are marked `unsanitized` and left out. Python itself is not built
# with the sanitizers, so their libraries are loaded before it; memory that Python never frees is not
# reported.
SANITIZED := $(CURDIR)/build/sanitizer/site
PRELOAD = $(shell g++ -print-file-name=libasan.so) $(shell g++ -print-file-name=libstdc++.so)

sanitize: sanitized  ## the cases of make test under sanitizers

# One case of one Python test in three, and at least one test of every file.
sanitize-few: SWEEP = --values 1 --share 3
sanitize-few: sanitized  ## the C++ tests and a few hundred Python tests under sanitizers

sanitized: $(DONE)/installed $(DONE)/test-requirements
	cmake --preset sanitizer -Dpybind11_DIR=$$(pybind11-config --cmakedir)
	cmake --build --preset sanitizer
	ctest --preset sanitizer
	rm -rf $(SANITIZED) && mkdir -p $(SANITIZED) && cp -r python/pendcore $(SANITIZED)
	cmake --install build/sanitizer --prefix $(SANITIZED)/pendcore
	PYTHONPATH=$(SANITIZED) LD_PRELOAD="$(PRELOAD)" ASAN_OPTIONS=detect_leaks=0 \
	    $(PYTEST) $(SWEEP) -m "not outside_build and not unsanitized"

MACHINES ?= aarch64 riscv64 s390x wasm32 clang
elsewhere: $(DONE)/installed $(DONE)/test-requirements  ## the same bits on other processors (MACHINES); PAGE=docs/background/elsewhere.md writes the page
	@sh setup/debian_packages.sh doctest $(MACHINES)
	python tests/elsewhere/elsewhere.py $(MACHINES) $(CONTRACTED) $(PAGE:%=--page %)
	$(if $(filter wasm32,$(MACHINES)),PENDCORE_TEST_JAVASCRIPT=1 $(PYTEST) --full tests/elsewhere)

wasm: $(DONE)/build-requirements  ## the core for browsers: build/wasm/package, docs/how_to/webassembly.md
	@sh setup/debian_packages.sh eigen wasm32
	cmake -G Ninja -B build/wasm -DCMAKE_TOOLCHAIN_FILE=cpp/cmake/machines/wasm32.cmake
	cmake --build build/wasm --target pendcore_wasm

page: wasm $(DONE)/installed  ## the core for browsers, installed, so that pages hold it (sol.to_html)
	$(MAKE) --silent core

# The wheel is installed where nothing else of this project is, and shows there what it can do.
WHEELS := build/wheels
wheel: wasm $(DONE)/build-requirements $(DONE)/wheel-requirements  ## dist/: a wheel for Linux and the sources, installed and tried
	rm -rf $(WHEELS) dist
	python -m build --no-isolation --outdir $(WHEELS) -Ccmake.define.PENDCORE_FOR_WHEEL=ON \
	    -Ccmake.define.PENDCORE_BROWSER_CORE=$(CURDIR)/build/wasm/package/pendcore.wasm.gz .
	auditwheel repair --wheel-dir dist $(WHEELS)/pendcore-*.whl
	cp $(WHEELS)/pendcore-*.tar.gz dist
	$(PYTHON) -m venv $(WHEELS)/venv
	$(WHEELS)/venv/bin/python -m pip install --quiet --disable-pip-version-check dist/pendcore-*.whl
	cd $(WHEELS) && venv/bin/python $(CURDIR)/tests/packaging/installed.py
	ls -l dist

# The pages are built from a copy, into which the generated ones are written.
SITE := build/site
site: page $(DONE)/site-requirements  ## the documentation as a site: build/site/html/index.html
	rm -rf $(SITE)/source && mkdir -p $(SITE)/source
	cp -r docs examples cpp tests bench python setup *.md CMakeLists.txt Makefile $(SITE)/source
	cd $(SITE) && sphinx-build -W --keep-going -q -j auto -d cache -c source/docs/site source/docs html
	@echo "site:     $(SITE)/html/index.html"

# The core is compiled anew, with the lowest versions of what the build needs. What these packages need
# themselves is new, and warns of their age.
LOWEST := build/lowest
TRIED_WITH_LOWEST := tests/core/test_threads.py tests/python_api tests/ensemble tests/events tests/drawing \
    tests/derive/test_derivation.py
lowest: export PATH := $(CURDIR)/$(LOWEST)/bin:$(PATH)
lowest: $(DONE)/venv  ## the lowest versions that pyproject.toml names: installed, built and tested with
	rm -rf $(LOWEST)
	$(PYTHON) -m venv $(LOWEST)
	python setup/requirements.py --lowest build run test export store symbolic completion notebook \
	    | $(PIP_INSTALL) -r /dev/stdin
	$(PIP_INSTALL) --no-deps --no-build-isolation .
	MPLBACKEND=Agg pytest -n auto --values 1 -W ignore::DeprecationWarning $(TRIED_WITH_LOWEST)

threads: $(DONE)/build-requirements  ## threads that share a scene, under the thread sanitizer
	@sh setup/debian_packages.sh doctest
	cmake --preset thread-sanitizer
	cmake --build --preset thread-sanitizer
	ctest --preset thread-sanitizer

long: $(DONE)/installed $(DONE)/test-requirements  ## ten million steps: docs/background/long_runs.md, written anew
	python docs/generators/long_runs.py

horizon: $(DONE)/installed $(DONE)/test-requirements  ## how long runs are right: docs/background/horizon.md, written anew
	python docs/generators/horizon.py

film: $(DONE)/installed  ## the README's film: docs/figures/swing.gif, drawn anew
	MPLBACKEND=Agg python docs/generators/film.py

flip-map: $(DONE)/installed $(DONE)/test-requirements  ## when rods turn over: docs/background/flip_map.md, written anew
	python docs/generators/flip_map.py

asked-errors: $(DONE)/installed $(DONE)/test-requirements  ## docs/background/accuracy_cost.md: what simulate(error=) keeps and costs
	python docs/generators/series_work.py
	python docs/generators/asked_errors.py

default-method: $(DONE)/installed $(DONE)/test-requirements  ## docs/background/accuracy_cost.md: what simulate takes by default, and why
	python docs/generators/default_method.py

book-speed: $(DONE)/installed $(DONE)/bench-requirements  ## the book's claim of speed: docs/background/book_speed.md, written anew
	@sh setup/debian_packages.sh octave
	python docs/generators/book_speed.py

CASES ?= 100000
SEED ?= 1
fuzz: $(DONE)/installed $(DONE)/test-requirements  ## random cases (CASES, SEED); 100,000 and more write docs/background/fuzz.md
	PYTHONPATH=tests:tests/models python -m fuzz.campaign --cases $(CASES) --seed $(SEED) \
	    --page docs/background/fuzz.md --record docs/records/fuzz.json

SEEDS ?= 0:5000
FAMILIES ?= mixed damped chaotic stiff contact own short_links
ERROR_WORKERS ?= 2
test-error: $(DONE)/installed $(DONE)/error-requirements  ## true errors (SEEDS, FAMILIES) against references of more digits
	PYTHONPATH=tests python -m true_error.campaign --seeds $(SEEDS) $(FAMILIES:%=--family %) \
	    --workers $(ERROR_WORKERS) --output out/true_error/scenes.json \
	    --record $(or $(RECORD),out/true_error/record.json) $(PAGE:%=--page %)

PARTS ?= core package
COUNT ?= 200
mutants: $(DONE)/installed $(DONE)/mutant-requirements  ## which small mistakes the tests notice: COUNT in each of PARTS, drawn by SEED; hours, goes on where it stopped
	for part in $(PARTS); do \
	    PYTHONPATH=tests python -m mutants.campaign $$part --count $(COUNT) --seed $(SEED) || exit 1; \
	done

SECONDS_EACH ?= 60
fuzz-readers: $(DONE)/installed $(DONE)/fuzz-requirements  ## damaged files and pickles, by coverage
	for reader in case archive state scene store; do \
	    PYTHONPATH=tests:tests/models python -m fuzz.guided $$reader out/fuzz/corpus -verbosity=0 \
	        -max_total_time=$(SECONDS_EACH) -artifact_prefix=out/fuzz/ || exit 1; \
	done

clean:  ## remove all that was built, and the virtual environment
	rm -rf build dist out .venv

help:  ## this list
	@sed -n 's/^\([a-z-]*\):.*## /  make \1\t/p' Makefile | expand -t 22

$(DONE)/venv:
	@sh setup/debian_packages.sh python compiler also eigen doctest
	$(PYTHON) -m venv .venv
	@mkdir -p $(DONE) && touch $@

# Without pip's build isolation a rebuild compiles what has changed and nothing else.
$(DONE)/build-requirements: pyproject.toml | $(DONE)/venv
	@echo "pip installs what the build needs into .venv"
	@python setup/requirements.py build | $(PIP_INSTALL) cmake ninja -r /dev/stdin
	@touch $@

# What pendcore imports is installed while the core compiles. A source that is edited during the build
# is newer than the stamp, so the next call builds it.
$(DONE)/installed: $(SOURCES) $(DONE)/build-requirements
	@touch $@.begun
	@echo "pip compiles the core and installs it into .venv: two to three minutes on two processors the first time"
	@$(MAKE) --silent --jobs=2 $(DONE)/run-requirements core
	@mv $@.begun $@

# scikit-build-core imports the installed package: one that cannot be imported is removed first.
core:
	@python -c "import pendcore" 2>/dev/null || python -m pip uninstall --quiet --yes pendcore 2>/dev/null
	$(PIP_INSTALL) --no-deps --no-build-isolation --config-settings build-dir=$(BUILT) .

# pip would compile the packages' own tests to bytecode, too: an eighth of the installation.
$(DONE)/run-requirements: pyproject.toml | $(DONE)/build-requirements
	python setup/requirements.py run symbolic | $(PIP_INSTALL) --no-compile -r /dev/stdin
	@python -m compileall -qq -x 'site-packages/.*/tests/' $(VIRTUAL_ENV)/lib || true
	@touch $@

$(DONE)/test-requirements: pyproject.toml | $(DONE)/build-requirements
	@sh setup/debian_packages.sh doctest
	python setup/requirements.py test export store cluster symbolic completion browser notebook | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/error-requirements: pyproject.toml | $(DONE)/test-requirements
	python setup/requirements.py true-error | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/fuzz-requirements: pyproject.toml | $(DONE)/test-requirements
	python setup/requirements.py fuzz | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/mutant-requirements: pyproject.toml | $(DONE)/test-requirements
	python setup/requirements.py mutants | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/site-requirements: pyproject.toml | $(DONE)/build-requirements
	python setup/requirements.py docs run symbolic export store | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/wheel-requirements: pyproject.toml | $(DONE)/build-requirements
	python setup/requirements.py wheel | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/bench-requirements: pyproject.toml | $(DONE)/build-requirements
	@sh setup/debian_packages.sh doctest also benchmark boost sundials valgrind
	python setup/requirements.py bench symbolic | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/lint-requirements: pyproject.toml | $(DONE)/venv
	python setup/requirements.py lint | $(PIP_INSTALL) -r /dev/stdin
	@touch $@
