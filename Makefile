# Two commands: `make demo` plans the paper's mission, `make test` checks everything; `make test-all`
# with larger sets of random cases, which takes an hour.
# They need Python 3.11 or later and make, and install into .venv.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin

# Compiled modules are kept: tests start hundreds of processes, and each would compile the package anew.
export PYTHONDONTWRITEBYTECODE =

.PHONY: demo test test-all lint types unit figure schema notebooks docs clean

demo: $(VENV)/.installed
	@mkdir -p out
	$(BIN)/msmrta plan instances/paper.json --json out/paper-plan.json --figure out/paper.png

test: lint types unit

lint: $(VENV)/.installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.installed
	$(BIN)/mypy

test-all: lint types $(VENV)/.installed-docs
	$(BIN)/python -m pytest -n auto --dist worksteal -m "slow or not slow" --timeout 7200

unit: $(VENV)/.installed
	$(BIN)/python -m pytest -n auto --dist worksteal

# The README's pictures, and the published schema.
figure: demo
	cp out/paper.png docs/paper.png
	$(BIN)/msmrta replay out/paper-plan.json --gif docs/replay.gif

schema: $(VENV)/.installed
	$(BIN)/msmrta schema > msmrta_opt/mission/instance.schema.json
	$(BIN)/msmrta schema scenario > msmrta_opt/mission/scenario.schema.json

# The notebooks with their outputs.
notebooks: $(VENV)/.installed
	$(BIN)/python notebooks/refresh.py

# The documentation site, into a folder that opens without a network; a warning is an error.
docs: $(VENV)/.installed-docs
	$(BIN)/python -m sphinx -c docs -b html --fail-on-warning --keep-going . out/site
	@echo "open out/site/index.html"

# Sphinx and its kin are for the site alone: the quick tests, and who only plans, go without them.
$(VENV)/.installed-docs: $(VENV)/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[docs]'
	@touch $@

$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dask,dev,notebooks,parquet,solvers]'
	@touch $@

clean:
	rm -rf $(VENV) out build dist *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis
