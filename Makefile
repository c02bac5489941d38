PYTHON ?= python3
BIN := .venv/bin
# the matrices are small: threads of the linear algebra library would only wait for each other
export OPENBLAS_NUM_THREADS = 1
# modules are compiled to bytecode when they are first imported and kept, not all of them at the installation
unexport PYTHONDONTWRITEBYTECODE
PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile

.PHONY: run test golden characterise attack mutate bench docs dist lowest clean

run: .venv/installed  ## set up, run the paper's study, print its Table 5
	$(BIN)/waxstudy run studies/table5.toml

test: .venv/installed-dev  ## set up, check style, run every test; that of types and imports is one of them
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	ATTACK_SEED=$${ATTACK_SEED:-1} $(BIN)/python -m pytest --numprocesses auto --dist loadfile --no-loadscope-reorder --hypothesis-profile=landing

golden: .venv/installed-dev  ## compute the golden results, the study file's schema, the tables of judged runs and of checks again
	$(BIN)/python -m tests.golden.regenerate
	$(BIN)/python -m tests.study.regenerate_schema
	$(BIN)/python -m tests.blind_test.regenerate_tables
	$(BIN)/python -m tests.dataset.regenerate_checks
	$(BIN)/python -m tests.diagnosis.regenerate_criteria
	$(BIN)/python -m tests.effects.regenerate_list
	$(BIN)/python -m tests.rig.regenerate_bench

characterise: .venv/installed-dev  ## compare what the diagnosis says of 70 records with what is stored
	$(BIN)/python -m tests.characterisation

attack: .venv/installed-dev  ## spoil studies, records and folders, kill commands, fill disks; SEED=N for another campaign
	$(BIN)/python -m tests.attack --seed $(or $(SEED),1)

mutate: .venv/installed-mutate  ## change the code in one place after another, and see whether a test notices
	$(BIN)/python -m tests.mutation

bench: .venv/installed-dev  ## measure speed and memory
	$(BIN)/python -m benchmarks

docs: .venv/installed-dev  ## build the documentation site into build/site; a link that leads nowhere ends it
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build

dist: .venv/installed-dev  ## build the wheel and the source archive
	$(BIN)/python -m build --no-isolation --outdir dist

lowest:  ## run quick tests with the oldest dependencies that pyproject.toml allows
	$(PYTHON) -m venv build/lowest
	build/lowest/bin/python -m pip install --quiet --disable-pip-version-check "uv>=0.5"
	build/lowest/bin/uv pip install --quiet --python build/lowest/bin/python --resolution lowest-direct \
		. ./plugins/waxstudy-enthalpy "pytest>=8.3" "hypothesis>=6.115" "jsonschema>=4.23"
	build/lowest/bin/python -m pytest -m "not slow" $$(cat tests/lowest.txt)

.venv/installed: pyproject.toml
	$(PYTHON) -m venv .venv
	$(PIP_INSTALL) --editable .
	touch $@

.venv/installed-dev: pyproject.toml
	$(PYTHON) -m venv .venv
	$(PIP_INSTALL) --editable ".[dev]" --editable plugins/waxstudy-enthalpy
	touch .venv/installed $@

.venv/installed-mutate: .venv/installed-dev
	$(PIP_INSTALL) --editable ".[mutate]"
	touch $@

clean:
	rm -rf .venv
