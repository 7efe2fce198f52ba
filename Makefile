# Everything a developer does has one verb. `make run` and `make test` need only Python >= 3.11 and make.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
.DEFAULT_GOAL := help
.PHONY: help run robot-demo test test-slow lint bench suites docs clean

help:  ## Show this help
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

$(BIN)/spacevln: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "spacevln needs Python 3.11 or newer, $(PYTHON) is $$($(PYTHON) -V): run make PYTHON=python3.12 (or another)."; exit 3; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --upgrade "pip>=25.1"
	@echo "installing spacevln into $(VENV) ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

$(VENV)/.dev: $(BIN)/spacevln
	@echo "installing the development tools ..."
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --group dev
	@touch $@

run: $(BIN)/spacevln  ## Set up .venv and watch an agent follow an instruction through a furnished house
	@$(BIN)/spacevln run

robot-demo: $(BIN)/spacevln  ## Watch the agent drive a simulated ROS 2 robot in real time, over the real transport
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[robot]'
	@$(BIN)/spacevln robot demo

test: $(VENV)/.dev  ## Set up .venv and pass the default test suite
	@$(BIN)/python -m pytest -n 2

test-slow: $(VENV)/.dev  ## The tests that take minutes
	@$(BIN)/python -m pytest -n 2 -m slow

lint: $(VENV)/.dev  ## Style, types and the import contract
	@$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(BIN)/mypy && $(BIN)/lint-imports

bench: $(VENV)/.dev  ## Speed of the hot paths
	@NUMBA_NUM_THREADS=1 OMP_NUM_THREADS=1 $(BIN)/python -m pytest benchmarks --benchmark-only

suites: $(VENV)/.dev  ## Every number of the stored suites, resumable (about 80 minutes)
	@benchmarks/suites.sh runs/suites

docs: $(VENV)/.dev  ## Build the documentation into site/
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --group docs
	@$(BIN)/mkdocs build --strict

clean:  ## Remove everything that make made
	rm -rf $(VENV) site dist .mypy_cache .ruff_cache .benchmarks
