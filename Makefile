# Everything stepover can be asked to do. A command that needs the environment builds it first, once.

PYTHON3 ?= python3.11 python3
VENV    := .venv
PYTHON  := $(VENV)/bin/python
READY   := $(VENV)/.ready
NOTEBOOKS = $(wildcard notebooks/*.ipynb)

# The first of the candidates that is a Python 3.11, and, for the complaint, the first that runs at all.
python311 = $(shell for p in $(PYTHON3); do \
	"$$p" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null && echo "$$p" && break; done)
found = $(or $(shell for p in $(PYTHON3); do "$$p" --version 2>/dev/null && break; done),no Python)
wrong_python = this environment needs Python 3.11 (PyBullet has no wheels for later ones); found $(found); \
call make PYTHON3=/path/to/python3.11

.DEFAULT_GOAL := help
.PHONY: help env reproduce site test fuzz coverage studies frontier lab bench lint clean

help:       ## list these commands
	@sed -n 's/^\([a-z]*\): .*## \(.*\)/\1|\2/p' $(MAKEFILE_LIST) | \
		while IFS='|' read -r name does; do printf '  make %-11s %s\n' "$$name" "$$does"; done

env: $(READY)        ## set up .venv from environment.txt (the commands below do so by themselves)

reproduce: $(READY)  ## run every notebook; write every figure and claim to figures/
	@echo "Running every notebook; this takes about five minutes."
	@$(PYTHON) -m stepover reproduce

site: $(READY)       ## make build/site/: all of it as pages that need no network, links checked
	@echo "Making the site; this takes about a minute and a half, and five minutes more where notebooks are to be run."
	@$(PYTHON) -m tools.site

test: $(READY)       ## run the tests, the notebooks with quick parameters among them
	$(PYTHON) -m pytest -n auto --dist loadfile

coverage: $(READY)   ## run the tests and measure the share of the code that they run
	$(PYTHON) -m pytest -n auto --dist loadfile --cov --cov-report=term

fuzz: $(READY)       ## try 3,000 mutated inputs of each kind; the tests try a few
	FUZZ=3000 $(PYTHON) -m pytest tests/test_fuzz.py

studies: $(READY)    ## make the long tables in figures/ on all cores; goes on where it was interrupted
	$(PYTHON) -m stepover.studies

frontier: $(READY)   ## make the optimiser's tables in figures/: what it crosses, how robustly; half an hour
	$(PYTHON) -m stepover.studies.optimal

lab: $(READY)        ## open JupyterLab on the notebooks
	$(PYTHON) -m jupyterlab notebooks

bench: $(READY)      ## measure how fast planning and simulation are; adds to bench/history.json, docs/speed.md
	@mkdir -p build
	$(PYTHON) -m pytest bench --benchmark-json build/bench.json --benchmark-quiet
	$(PYTHON) -m tools.bench build/bench.json bench/history.json docs/speed.md

lint: $(READY)       ## check style, types, and that the notebooks carry no outputs
	$(PYTHON) -m ruff check
	$(PYTHON) -m ruff format --check
	$(PYTHON) -m mypy
	$(if $(NOTEBOOKS),$(PYTHON) -m nbstripout --verify $(NOTEBOOKS))

clean:      ## remove build/ and the caches; keep .venv
	rm -rf build *.egg-info .pytest_cache .mypy_cache .ruff_cache
	find . -path ./$(VENV) -prune -o \( -name __pycache__ -o -name .ipynb_checkpoints \) -prune -exec rm -rf {} +

# One thread a process: the parallelism is that of the processes, and sums come out the same on every run.
reproduce site test coverage studies frontier: export OMP_NUM_THREADS = 1
reproduce site test coverage studies frontier: export OPENBLAS_NUM_THREADS = 1
# Not for reproduce: there the notebooks' own backend, which needs no display either, keeps the figures in their pages.
test coverage: export MPLBACKEND = Agg

# The stamp goes before the first change and comes back after the last: without it .venv is built from nothing,
# so that an installation that was interrupted leaves no half-installed package behind.
$(READY): environment.txt
	$(if $(python311),,$(error $(wrong_python)))
	@echo "Setting up $(VENV) from environment.txt; this takes a minute or two and the network,"
	@echo "and 1.6 GB of disk, once."
	@test -f $@ || $(python311) -m venv --clear $(VENV)
	@rm -f $@
	@$(PYTHON) -m pip install -qq --disable-pip-version-check --requirement environment.txt
	@$(PYTHON) -m pip install -qq --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@
