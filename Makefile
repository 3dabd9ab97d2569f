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
.PHONY: demo test test-all references compare bench against build-bench lint tidy sanitize sanitized-addresses \
    sanitized-threads elsewhere wasm page wheel site lowest write known-page campaign known-campaign core clean help

demo: $(DONE)/installed  ## build, run the textbook's case, say where its figure and summary are
	pendcore run -o out/textbook
	@echo
	@echo "figure:   out/textbook/angles.png"
	@echo "summary:  out/textbook/summary.txt"
	@echo "command:  .venv/bin/pendcore --help (or first: . .venv/bin/activate)"
	@echo "next:     .venv/bin/pendcore derive; .venv/bin/pendcore run examples/03_case_file.toml"

test: $(DONE)/installed $(DONE)/test-requirements  ## build and run the tests: every claim, long sweeps reduced to a few cases
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
	$(MAKE) sanitize SHARE=3
	$(MAKE) elsewhere wheel site CONTRACTED=--contracted
	$(PYTEST) --full tests/page/test_site.py
	$(MAKE) campaign OF=readers
	$(MAKE) campaign OF=fuzz CASES=20000

# What tests compare pendcore with. Where these are missing, such tests are skipped.
references: $(DONE)/error-requirements $(DONE)/bench-requirements

define CPP_TESTS
cmake -B $(BUILT) -DPENDCORE_TESTS=ON
cmake --build $(BUILT) --target tests/cpp/all
ctest --test-dir $(BUILT) --output-on-failure --no-tests=error
endef

compare: build-bench  ## accuracy and speed beside other solvers; ONLY="stiff chains" a part, ONLY=hard_cases what breaks simulators
	python bench/compare/compare.py $(if $(ONLY),--only $(ONLY))

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

sanitize: sanitized-addresses sanitized-threads  ## the cases of make test, and threads, under sanitizers; SHARE=3 a few of these cases

# With a share, one case of one Python test in so many, and at least one test of every file.
SWEEP = $(if $(SHARE),--values 1 --share $(SHARE))
sanitized-addresses: $(DONE)/installed $(DONE)/test-requirements
	cmake --preset sanitizer -Dpybind11_DIR=$$(pybind11-config --cmakedir)
	cmake --build --preset sanitizer
	ctest --preset sanitizer
	rm -rf $(SANITIZED) && mkdir -p $(SANITIZED) && cp -r python/pendcore $(SANITIZED)
	cmake --install build/sanitizer --prefix $(SANITIZED)/pendcore
	PYTHONPATH=$(SANITIZED) LD_PRELOAD="$(PRELOAD)" ASAN_OPTIONS=detect_leaks=0 \
	    $(PYTEST) $(SWEEP) -m "not outside_build and not unsanitized"

# Threads that share a scene.
sanitized-threads: $(DONE)/build-requirements
	@sh setup/debian_packages.sh doctest
	cmake --preset thread-sanitizer
	cmake --build --preset thread-sanitizer
	ctest --preset thread-sanitizer

MACHINES ?= aarch64 riscv64 s390x wasm32 clang
elsewhere: $(DONE)/installed $(DONE)/test-requirements  ## the same bits on other processors (MACHINES); PAGE=docs/background/elsewhere.md writes the page
	@sh setup/debian_packages.sh doctest $(MACHINES)
	python tests/elsewhere/elsewhere.py $(MACHINES) $(CONTRACTED) $(PAGE:%=--page %)
	$(if $(filter wasm32,$(MACHINES)),PENDCORE_TEST_JAVASCRIPT=1 $(PYTEST) --full tests/elsewhere)

# The core for browsers, in build/wasm/package.
wasm: $(DONE)/build-requirements
	@sh setup/debian_packages.sh eigen wasm32
	cmake -G Ninja -B build/wasm -DCMAKE_TOOLCHAIN_FILE=cpp/cmake/machines/wasm32.cmake
	cmake --build build/wasm --target pendcore_wasm

page: wasm $(DONE)/installed  ## the core for browsers: build/wasm/package, and installed, so that pages of runs hold it
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
	@sh setup/debian_packages.sh ffmpeg
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

# $(call require_one_of,TARGET,VARIABLE,WORDS) stops unless the variable is one word, and among these.
require_one_of = @$(if $(filter-out 1,$(words $($(2))))$(filter-out $(3),$($(2))),$(error make $(1) $(2)=$($(2)): $(2) is one of $(3)))true

# The programs that write tables and figures of pages, and what they need; most need what tests do.
PAGES := long_runs horizon flip_map asked_errors default_method book_speed film jacobians saddle_transport sensitivities
NEEDED_BY_book_speed := bench
NEEDED_BY_film := build
NEEDED_BY_jacobians := bench
NEEDED_BY_sensitivities := bench
write: known-page $(DONE)/installed $(DONE)/$(or $(NEEDED_BY_$(PAGE)),test)-requirements  ## a page's figures anew: PAGE=long_runs|horizon|flip_map|asked_errors|default_method|book_speed|film|jacobians|saddle_transport|sensitivities
	$(if $(filter book_speed,$(PAGE)),@sh setup/debian_packages.sh octave)
	$(if $(filter asked_errors,$(PAGE)),python docs/generators/series_work.py)
	MPLBACKEND=Agg python docs/generators/$(PAGE).py

known-page:
	$(call require_one_of,write,PAGE,$(PAGES))

# Random attacks, by the thousand.
CAMPAIGNS := fuzz readers errors mutants derivatives
NEEDED_BY_readers := fuzz
NEEDED_BY_errors := error
NEEDED_BY_mutants := mutant
campaign: known-campaign $(DONE)/installed $(DONE)/$(or $(NEEDED_BY_$(OF)),test)-requirements  ## random attacks: OF=fuzz|readers|errors|mutants|derivatives
	$(CAMPAIGN_$(OF))

known-campaign:
	$(call require_one_of,campaign,OF,$(CAMPAIGNS))

# Random cases; 100,000 and more write the page.
CASES ?= 100000
SEED ?= 1
define CAMPAIGN_fuzz
PYTHONPATH=tests:tests/models python -m fuzz.campaign --cases $(CASES) --seed $(SEED) \
    --page docs/background/fuzz.md --record docs/records/fuzz.json
endef

# Damaged files and pickles, by coverage.
SECONDS_EACH ?= 60
define CAMPAIGN_readers
for reader in case archive state scene store; do \
    PYTHONPATH=tests:tests/models python -m fuzz.guided $$reader out/fuzz/corpus -verbosity=0 \
        -max_total_time=$(SECONDS_EACH) -artifact_prefix=out/fuzz/ || exit 1; \
done
endef

# True errors against references of more digits.
SEEDS ?= 0:5000
FAMILIES ?= mixed damped chaotic stiff contact own short_links
ERROR_WORKERS ?= 2
define CAMPAIGN_errors
PYTHONPATH=tests python -m true_error.campaign --seeds $(SEEDS) $(FAMILIES:%=--family %) \
    --workers $(ERROR_WORKERS) --output out/true_error/scenes.json \
    --record $(or $(RECORD),out/true_error/record.json) $(PAGE:%=--page %)
endef

# Derivatives of hybrid runs against complex numbers, of smooth runs against forty digits; SEEDS=0:300 unless told.
RUNS ?= hybrid
define CAMPAIGN_derivatives
PYTHONPATH=tests:tests/models python -m derivatives.campaign $(RUNS) --seeds $(if $(filter file,$(origin SEEDS)),0:300,$(SEEDS))
endef

# Which small mistakes the tests notice; hours, goes on where it stopped.
PARTS ?= core package
COUNT ?= 200
define CAMPAIGN_mutants
for part in $(PARTS); do \
    PYTHONPATH=tests python -m mutants.campaign $$part --count $(COUNT) \
        $(if $(filter file,$(origin SEED)),,--seed $(SEED)) || exit 1; \
done
endef

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
	python setup/requirements.py bench symbolic control | $(PIP_INSTALL) -r /dev/stdin
	@touch $@

$(DONE)/lint-requirements: pyproject.toml | $(DONE)/venv
	python setup/requirements.py lint | $(PIP_INSTALL) -r /dev/stdin
	@touch $@
