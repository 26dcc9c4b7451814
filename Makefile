# `make paper` and `make test` each do everything from a fresh clone on a machine with python3 (3.11), venv, make and git.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --no-input
STAMP := $(VENV)/.installed
CHECKED := testbed vosc tests reports

.DEFAULT_GOAL := help
.PHONY: help paper paper-full verify lead-time arena arena-verify daa aircraft-table test fast fuzz kills mutants wheel wheel-test bench scale report docs gallery lock clean

help: ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 12

# Installed once, and again when what is to be installed changes. Everything comes from the lock, checked by its hash, the build
# backend included; so the project itself is built without an isolated (unlocked) environment.
$(STAMP): requirements.lock pyproject.toml
	@start=$$(date +%s); set -e; \
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV); \
	$(PIP) install --quiet --progress-bar off --no-deps --require-hashes -r requirements.lock; \
	$(PIP) install --quiet --no-deps --no-build-isolation --editable .; \
	$(PIP) check; \
	touch $@; echo "installation: $$(( $$(date +%s) - start )) s"

paper: $(STAMP) ## the verdict on the paper, 20 seeds: reports/runs/paper/index.html
	@start=$$(date +%s); set -e; \
	$(BIN)/testbed run campaigns/paper.yaml --fresh > /dev/null; \
	echo "main job: $$(( $$(date +%s) - start )) s (installation not included)"; echo reports/runs/paper/index.html

# More of everything that is drawn. What is small of it is committed in reports/paper; recordings and results.csv stay in the run.
FULL := reports/runs/paper-full
paper-full: $(STAMP) ## the verdict with 100 seeds, 1000 encounters, 500 draws; verified; page into reports/paper
	$(BIN)/testbed run campaigns/paper.yaml --fresh --out $(FULL) --set parts.turbulence.replicates=100 \
	  --set parts.population.replicates=1000 --set parts.readings_population.replicates=50 --set parts.robustness_single.replicates=501 --set parts.robustness_multi.replicates=501
	$(BIN)/python reports/verify $(FULL)
	$(BIN)/testbed audit
	$(BIN)/python reports/publish.py $(FULL) reports/paper

verify: $(STAMP) ## recompute the verdict of `make paper` from its raw columns, without the testbed's code
	$(BIN)/python reports/verify reports/runs/paper

lead-time: $(STAMP) ## the lead-time study, about half an hour: reports/lead_time
	$(BIN)/testbed run campaigns/lead_time.yaml --fresh
	mkdir -p reports/lead_time
	cp reports/runs/lead-time/index.html reports/runs/lead-time/lead_time.csv reports/lead_time/

# More encounters than two of each kind: make arena REPLICATES=10.
REPLICATES := 2
arena: $(STAMP) ## every method on the same encounters, about 25 minutes on two idle cores: reports/arena
	$(BIN)/testbed run campaigns/arena.yaml --fresh --set replicates=$(REPLICATES)
	mkdir -p reports/arena
	cp reports/runs/arena/index.html reports/runs/arena/arena.csv reports/runs/arena/arena_timings.csv reports/arena/

arena-verify: $(STAMP) ## recompute the shares and ranks of `make arena` from its raw columns, without the testbed's code
	$(BIN)/python reports/verify reports/runs/arena

# More encounters than forty: make daa ENCOUNTERS=200. Checked against its raw columns, without the testbed's code.
ENCOUNTERS := 40
daa: $(STAMP) ## what a small aircraft's sensor must do to keep well clear, 2,880 flights: reports/daa
	$(BIN)/testbed run campaigns/daa.yaml --fresh --set replicates=$(ENCOUNTERS)
	$(BIN)/python reports/verify reports/runs/daa
	$(BIN)/python reports/publish.py reports/runs/daa reports/daa --target daa

aircraft-table: $(STAMP) ## every model of the wheel made an aircraft, tuned and flown, about half an hour: docs/aircraft.md
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python docs/make_aircraft.py

# Two at a time, a file in one process, in the order of tests/conftest.py.
SUITE := $(BIN)/pytest -n 2 --dist loadfile --no-loadscope-reorder

test: $(STAMP) ## style, types, import order, all tests
	$(BIN)/ruff check $(CHECKED)
	$(BIN)/ruff format --check $(CHECKED)
	@echo "types and import order are checked beside the tests, and told at the end"; \
	said=$$(mktemp); { $(BIN)/mypy && $(BIN)/lint-imports; } > $$said 2>&1 & beside=$$!; \
	trap 'kill $$beside 2> /dev/null; rm -f $$said; exit 130' INT TERM; \
	$(SUITE); tests=$$?; wait $$beside; beside=$$?; cat $$said; rm -f $$said; test $$tests = 0 && test $$beside = 0

fast: $(STAMP) ## the tests that take no longer than a second
	$(BIN)/pytest -n auto -m "not slow and not browser and not viewer"

# What falls is told with the command that tries it again; a small form of it goes into tests/fuzz/found, which `make test` replays.
fuzz: $(STAMP) ## 26,600 mutated campaigns, settings and aircraft read, of them 3,600 flown; random draws of the property tests
	$(BIN)/python -m tests.fuzz.run
	HYPOTHESIS_PROFILE=random $(SUITE) -m "not slow and not browser and not viewer" -k "not fuzz" tests

SEED := 1
kills: $(STAMP) ## kill 100 drivers, 50 workers and 20 Dask schedulers, continue, and compare bytes (SEED=1)
	$(BIN)/python -m tests.kills.kills --drivers 100 --workers 50 --schedulers 20 --seed $(SEED)

# What draws the changes and what measures the lines are not in the lock: only this needs them.
MUTANTS ?= 210
mutants: $(STAMP) ## change 210 places of the code one by one; do the tests notice? reports/runs/mutants.csv
	test -x $(VENV)/mutants/bin/cosmic-ray || { $(PYTHON) -m venv $(VENV)/mutants; $(VENV)/mutants/bin/python -m pip install --quiet cosmic-ray; }
	$(PIP) install --quiet --no-deps coverage
	$(VENV)/mutants/bin/python tests/mutants/run.py --python $(abspath $(BIN)/python) --count $(MUTANTS)

wheel: $(STAMP) ## build the wheel into dist/
	$(BIN)/python -m hatchling build -t wheel

# For who releases: not part of `make test`, because the packages of other Pythons are not in the lock.
PYTHONS ?=
wheel-test: $(STAMP) ## install the wheel into empty environments of Python 3.11, 3.12, 3.13 (or PYTHONS="...") and fly a study there
	$(BIN)/python tests/package/on_each_python.py $(PYTHONS)

bench: $(STAMP) ## time flights of every plant and air against the physics alone: reports/bench_history.csv
	$(BIN)/testbed bench

# For an idle machine; quicker with copied flights (--copy of the script).
SCALE_FLIGHTS ?= 200000
scale: $(STAMP) ## 200,000 kinematic flights, killed half way and resumed: memory of the driver, time and size of the page
	PYTHONPATH=. $(BIN)/python tests/benchmarks/bench_scale.py --flights $(SCALE_FLIGHTS) --out reports/runs/scale

report: $(STAMP) ## write the page and tables of the paper's campaign again, without flying
	$(BIN)/testbed report reports/runs/paper

gallery: $(STAMP) ## take the pictures of docs/gallery.html again; needs Debian's chromium and a Vulkan driver
	$(BIN)/python docs/make_gallery.py

docs: $(STAMP) ## write docs/results.md again: every column and signal with its unit and definition
	$(BIN)/python docs/make_results.py

# No index and no folder of wheels is written down: the hashes say what the packages are, pip's configuration says where they are.
lock: ## choose versions again: the newest that fit pyproject.toml, for Python 3.11 on x86-64 Linux
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(PIP) install --quiet uv
	$(BIN)/uv pip compile pyproject.toml --quiet --upgrade --all-extras --generate-hashes --no-annotate --no-header \
	  --no-emit-index-url --no-emit-find-links --python-version 3.11 --python-platform x86_64-manylinux_2_28 -o requirements.lock
	@! grep -nE '://|^-' requirements.lock

clean: ## remove the environment and caches; runs stay
	rm -rf $(VENV) build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
	find testbed vosc tests reports -name __pycache__ -prune -exec rm -rf {} +
