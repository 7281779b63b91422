# `make` says what can be made. Each target prepares the clone by itself: a virtual environment in .venv with the
# versions of constraints.txt, made again when they or pyproject.toml change. Requires Python 3.11.

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
DEMO := demo/courtyard
FORMATS := step dxf glb usdz usda json png
ARGS :=
# A file of tests goes to one process, in the order of names, by which no long one comes last.
PROCESSES := --numprocesses auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder
DATASETS := data/test data/test4k
WORKERS := 2
SECONDS := 10

# Tests start linecad in many processes, and without kept bytecode each of these compiles all of it again.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help demo test test-all lint check results clean

help:
	@echo 'make demo    reconstruct the sample photo of a courtyard: CAD files and a picture in demo/'
	@echo 'make test    the everyday tests, minutes (some: make test ARGS="tests/solver -k gap"; in one process: PROCESSES=)'
	@echo 'make test-all  all tests, with more examples each: what the CI runs'
	@echo 'make lint    ruff and mypy'
	@echo 'make check   lint and test, what every change must pass'
	@echo 'make results measure datasets (DATASETS="folders", WORKERS=2): docs/results/tables/, and more in results/'
	@echo 'make clean   remove what was made, except .venv'
	@echo
	@echo 'Each prepares .venv on its first run: about 2 GB, a minute or two.'

demo: $(READY)
	@mkdir -p $(dir $(DEMO))
	$(BIN)/linecad convert samples/courtyard.jpg --camera samples/courtyard.json $(FORMATS:%=-o $(DEMO).%)
	@echo 'Made:' && ls -lh $(FORMATS:%=$(DEMO).%)

test: $(READY)
	$(BIN)/python -m pytest $(PROCESSES) $(ARGS)

test-all: $(READY)
	$(BIN)/python -m pytest $(PROCESSES) --thorough $(ARGS)

lint: $(READY)
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

check: lint test

# Tables as Markdown into docs/results/tables/, everything else into results/.
results: $(READY)
	@mkdir -p results docs/results/tables
	@set -e; for dataset in $(DATASETS); do \
	    name=$$(basename $$dataset)-junctions; echo "$$dataset, weights by junction"; \
	    $(BIN)/linecad evaluate $$dataset --option weights=junctions --workers $(WORKERS) --time-limit $(SECONDS) \
	        --markdown docs/results/tables/$$name.md --json results/$$name.json --report results/$$name.html $(ARGS); \
	    $(BIN)/python tests/benchmarks/paired.py results/$$name.json \
	        > docs/results/tables/$$(basename $$dataset)-paired.md; \
	    $(BIN)/python tests/benchmarks/fakes.py $$dataset > docs/results/tables/$$(basename $$dataset)-fakes.md; \
	done

clean:
	rm -rf demo results build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find linecad exporters solver tests samples -name __pycache__ -type d -prune -exec rm -rf {} +

# PYTHON names the interpreter to use; otherwise the first one that is new enough is taken.
$(READY): pyproject.toml constraints.txt
	@if ! $(BIN)/python -c 'import pip' 2>/dev/null; then \
	    for python in $(PYTHON) python3 python3.14 python3.13 python3.12 python3.11 none; do \
	        "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && break; \
	    done; \
	    if [ "$$python" = none ]; then \
	        echo 'No Python 3.11 or newer was found; install one, or name it: make PYTHON=/path/to/python3' >&2; exit 1; \
	    fi; \
	    if ! "$$python" -c 'import ensurepip, venv' 2>/dev/null; then \
	        echo "$$python cannot make virtual environments; on Debian and Ubuntu: apt-get install python3-venv" >&2; exit 1; \
	    fi; \
	    echo "Making $(VENV) with $$("$$python" --version)"; \
	    rm -rf $(VENV) && "$$python" -m venv $(VENV); \
	fi
	@echo 'Installing linecad and the libraries of constraints.txt (a minute or two)'
	@$(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt -e '.[dev]'
	@if ! said=$$($(BIN)/python -c 'import cv2, OCP.STEPControl, pxr.Usd, pyscipopt' 2>&1); then \
	    printf '%s\n' "$$said" | tail -n 1 >&2; \
	    echo 'A library of the system is missing; on Debian and Ubuntu: apt-get install libgl1 libexpat1' >&2; exit 1; \
	fi
	@touch $@
