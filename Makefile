# The verbs of this project. `make run` and `make test` set everything up by themselves.
BIN := .venv/bin
READY := .venv/.ready
# Says that what a run needs is there: two thirds of it, without what only tests and checks use.
RUNS := .venv/.runs
# Says that all tests have been collected, which compiles them: else each process would, at the same time.
COLLECTED := .venv/.collected
# Processes of `make test`, on two cores: its tests wait, too; 0: its own only.
JOBS ?= 3
# Where no bytecode may be kept, every process would compile the harness anew; it stays out of git.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: run test golden test-jazzy test-cluster test-clients mutants lint format bench soak docs dist smoke lock audit clean setup

run: $(RUNS)  ## a rover over rocky terrain: metrics in a CSV, a page and a picture beside it
	$(BIN)/python -m harness.run --terrain rocky --page --picture $(ARGS)

test: setup $(COLLECTED)  ## the whole test suite, in random order
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal --durations=20 $(ARGS)

golden: setup  ## what a change does to whole runs, field by field; ARGS=--accept keeps it, ARGS="-k 07-" drives one of them
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal --tb=short tests/golden $(ARGS)

test-jazzy: setup  ## ROS 2 Jazzy: rover_metrics, on Python 3.10 where there is one, then what speaks ROS of the harness
	tools/test_jazzy.sh $(ARGS)

test-cluster:  ## sweeps and scenarios on a real local Ray and a real local Dask cluster: same bytes, killed workers
	tools/test_cluster.sh $(ARGS)

test-clients: setup  ## programs of others drive in lock-step and read what we record: Node.js, C, odometry, viewers
	tools/test_clients.sh $(ARGS)

mutants: setup  ## small changes of the modules that differ from main, or ARGS="--all" or files: which does no test notice?
	$(BIN)/python -m tools.mutants $(ARGS)

lint: setup  ## style, layers, types, and documents against the code, nothing is changed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-cache
	$(BIN)/python -m tools.site check
	$(BIN)/mypy
	$(BIN)/python -m pytest -q tools/repository

format: setup  ## lets ruff lay out the code
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: setup  ## tables of ratios, measured side by side
	$(BIN)/python -m benchmarks

soak: setup  ## hours of simulated driving with faults, a quarter of an hour; its table goes into benchmarks/README.md
	$(BIN)/python -m benchmarks.soak --write

docs: setup  ## the site, with strict links, into build/site: open build/site/index.html
	tools/pinned.sh docs
	$(BIN)/python -m tools.site build
	$(BIN)/python tools/tour_pictures.py build/docs/files/docs/tour
	NO_MKDOCS_2_WARNING=1 build/environments/docs/bin/mkdocs build --quiet --strict --config-file build/mkdocs.yml

dist: setup  ## wheel and sdist into build/release, their descriptions checked, and the workflows by their schemas
	tools/pinned.sh release
	tools/dist.sh

smoke:  ## drives with the wheel of `make dist` outside the checkout, on each supported Python that is there
	tools/smoke.sh

lock: setup  ## pins the newest versions that pyproject.toml allows, and the hashes of their files
	tools/lock.sh --upgrade

audit: setup  ## known vulnerabilities of everything pinned, where an index of advisories can be reached
	$(BIN)/python tools/audit.py

setup: $(READY)

$(READY): pyproject.toml requirements.txt tools/build.txt tools/setup.sh
	tools/setup.sh

$(RUNS): pyproject.toml tools/run.txt tools/build.txt tools/setup.sh
	tools/setup.sh run

$(COLLECTED): $(READY)
	-$(BIN)/python -m pytest --collect-only --quiet >/dev/null
	touch $@

clean:  ## removes the environment and everything that was built
	rm -rf .venv build install log dist
