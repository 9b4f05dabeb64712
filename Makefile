# `make demo` and `make test` do all the set-up by themselves, in .venv.

PYTHON ?= $(firstword $(shell command -v python3.11 python3))
VENV := .venv
BIN := $(VENV)/bin
OUTPUT ?= demo-output
NATIVE := build/native/libpeers.so
YARP := build/yarp
BENCH = -vv --benchmark-quiet --benchmark-json=$(RUN) --benchmark-autosave --benchmark-storage=file://build/bench/runs $(if $(QUICK),--quick)

.DEFAULT_GOAL := help
RUN := build/bench/run.json
BASELINE = $(sort $(wildcard bench/baseline/*.json))
PLANTED := build/bench/planted.json

# Where CMake finds the YARP of `make yarp`.
ifneq ($(wildcard $(YARP)/cmake/.built),)
export YARP_DIR ?= $(abspath $(YARP))/cmake
endif

# Processes that run tests: one more than processors, as some wait for compilers, peers and files.
WORKERS ?= $(shell expr `getconf _NPROCESSORS_ONLN` + 1)

# Versions of Python besides the one of $(VENV): names or paths.
PYTHONS ?= python3.12 python3.13 python3.14

.PHONY: help demo usecase test check pythons campaign conformance bench bench-check bench-planted bench-compare native peers yarp clean

help: ## show this list
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 20

demo: $(VENV)/.demo ## play the bundled recordings through compiled kernels; writes pictures to $(OUTPUT)
	$(BIN)/rosetta-jit demo --output $(OUTPUT)

usecase: $(VENV)/.test ## a component on RSB moves a simulated iCub on YARP (a real one where `make yarp` has built it); writes a page
	$(BIN)/python -m tests.usecase $(ARGS)

# Each worker reads the modules of all tests, which pytest rewrites: what comes of that is kept beside them, as is that of installed packages.
# In the order of their names, files that take long are not the last ones, for which other workers would wait.
test: export PYTHONDONTWRITEBYTECODE :=
test: check ## lint, check types, run all tests but the campaigns
	$(BIN)/python -m pytest -m "not campaign" -n $(WORKERS) --dist loadfile --no-loadscope-reorder $(ARGS)

check: $(VENV)/.test ## lint and check types alone
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/basedpyright --pythonpath $(BIN)/python

# Compiled code reads CPython's objects where they lie, which differs between versions.
pythons: ## run the tests of what runs (holders, programs, numba) with other versions of Python: PYTHONS="python3.12 ..."
	@for python in $(PYTHONS); do \
		version=$$($$python -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2> /dev/null) || { echo "$$python is not installed: left out"; continue; }; \
		$(MAKE) VENV=build/python$$version PYTHON=$$python build/python$$version/.test || exit 1; \
		build/python$$version/bin/python -m pytest -m "not campaign" -n auto --dist loadfile tests/runtime tests/api tests/in_numba $(ARGS) || exit 1; \
	done

campaign: $(VENV)/.test ## the long runs of the test programme, and the others with new random examples (hours)
	$(BIN)/python -m pytest --hypothesis-profile=default $(ARGS)

conformance: $(VENV)/.test ## protobuf's own conformance suite; CONFORMANCE_TEST_RUNNER and CONFORMANCE_PROTOS name its program and schemas
	$(BIN)/python -m pytest tests/conformance $(ARGS)

# What the report shows is in pytest-benchmark's JSON, of which each run's is kept in build/bench/runs, too.
bench: $(VENV)/.bench native ## measure everything, write build/bench/report.html and the figures of the docs; QUICK=1: a look
	mkdir -p $(dir $(RUN))
	$(BIN)/python -m pytest bench --bench-report $(if $(QUICK),,--bench-readme) $(BENCH) $(ARGS); status=$$?; $(BIN)/python -m bench.report $(if $(QUICK),,--keep) $(RUN) && exit $$status

bench-check: $(VENV)/.bench native ## the same, failing where a target is missed or, on a machine of the same kind, a ratio is 15 % worse than in bench/baseline
	mkdir -p $(dir $(RUN))
	$(BIN)/python -m pytest bench $(BENCH) $(ARGS); status=$$?; $(BIN)/python -m bench.compare --same-machine $(BASELINE) $(RUN) && exit $$status

bench-planted: $(VENV)/.bench native ## whether the benchmarks watch: with a loop planted in all compiled code, each family of rows must fail
	mkdir -p $(dir $(RUN))
	$(BIN)/python -m pytest bench --planted --quick --bench-report --benchmark-quiet --benchmark-json=$(PLANTED) $(ARGS) && $(BIN)/python -m bench.planting $(PLANTED)

bench-compare: $(VENV)/.bench ## what changed since the run in OLD, a JSON file or several; fails where a ratio with a target is 15 % worse. OLD=../CHECKOUT or AGAIN=../CHECKOUT: what seems slower is measured again by turns
	@test -n "$(OLD)" || { echo "name a run: make bench-compare OLD=build/bench/runs/..., or a checkout that has one" >&2; exit 2; }
	$(BIN)/python -m bench.compare $(OLD) $(RUN) $(if $(AGAIN),--again $(AGAIN))

clean: ## remove all that these commands made
	rm -rf $(VENV) build dist $(OUTPUT) .ruff_cache .hypothesis .benchmarks
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# A stamp a set of requirements: a second run touches no network.
$(VENV)/.demo: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[demo]'
	touch $@

# What the tests need includes what the demo needs.
$(VENV)/.test: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	touch $@ $(VENV)/.demo

$(VENV)/.bench: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[bench]'
	touch $@

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "no python3 found: install Python 3.11 or name one: make PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "$(PYTHON) is older than Python 3.11" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)

# tests/peers.txt says what each is for.
peers: ## install the programs of Debian that tests compare with (apt-get; asks sudo where it must)
	$(if $(filter-out 0,$(shell id -u)),sudo )apt-get install --yes --no-install-recommends $(shell sed 's/#.*//' tests/peers.txt)

yarp: $(YARP)/cmake/.built ## build the real YARP out of PyPI for tests and bench (minutes; needs a C++ compiler, CMake, and Debian's ycm-cmake-modules and libace-dev)

# A source distribution of 2021: newer compilers want headers that it forgets. Its libraries and two programs (`yarp`, `yarpserver`) are enough, and are used where they are built.
YARP_RELEASE := yarp_middleware-3.5.0
YARP_HEADERS := utility cstdint limits memory iterator sstream functional mutex algorithm string
YARP_WITHOUT := GUIS TESTS BINDINGS EXAMPLES libYARP_math CARRIER_PLUGINS DEVICE_PLUGINS PORTMONITOR_PLUGINS
# Where an older build lacks the programs, it is made whole.
ifeq ($(wildcard $(YARP)/cmake/bin/yarpserver),)
.PHONY: $(YARP)/cmake/.built
endif
$(YARP)/cmake/.built: | $(BIN)/python
	$(BIN)/python -m pip download --quiet --disable-pip-version-check --no-deps --no-binary yarp-middleware --dest $(YARP) $(subst _,-,$(subst -,==,$(YARP_RELEASE)))
	tar -xzf $(YARP)/$(YARP_RELEASE).tar.gz -C $(YARP)
	cmake -S $(YARP)/$(YARP_RELEASE) -B $(YARP)/cmake -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS="$(YARP_HEADERS:%=-include %)" \
		$(YARP_WITHOUT:%=-DYARP_COMPILE_%=OFF) > $(YARP)/configure.log 2>&1
	cmake --build $(YARP)/cmake --parallel 2 --target YARP_os YARP_sig YARP_init YARP_wire_rep_utils yarp yarpserver
	touch $@

native: $(VENV)/.bench ## build the native peers: YARP or the model of it, and the C++ of each framework that is installed
	$(MAKE) --directory bench/native OUTPUT=$(abspath $(NATIVE)) LCM_GEN=$(abspath $(firstword $(wildcard $(VENV)/lib/python*/site-packages/bin/lcm-gen)))
