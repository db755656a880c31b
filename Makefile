# meshonet: make demo, make test, make lint, make train, make bench, make docs, make site, make wheel
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip install --disable-pip-version-check --quiet --constraint constraints.txt
KERNELS := $(shell find kernels -name '*.py*' -o -name '*.pxi' -o -name '*.h' -o -name '*.c' ! -name _native.c)

.PHONY: help demo format check test test-fast test-clients same sanitize fuzz kills lint train train-airfoils train-quads train-holes paper paper-quick bench docs text pictures tutorials gallery site wheel dist man clean

help:
	@echo 'make demo    an 800x800 grid around a shipped airfoil: demo/grid.vts, demo/grid.png'
	@echo 'make check   before each commit, a minute: lint, and the nodes of small grids are where they were'
	@echo 'make test    the test suite; make test-fast: its core, in a minute'
	@echo 'make test-clients  files read by cgnscheck and OpenFOAM, tutorials with them, torch with a C++ compiler: minutes'
	@echo 'make same    commands as other processors would run them: the same bits everywhere'
	@echo 'make fuzz    every reader and command against hostile files and options, MINUTES=10 each; make kills: commands stopped at random'
	@echo 'make sanitize  kernels compiled to notice what they must not do, and the tests that run them'
	@echo 'make lint    style, types, import contracts and spelling'
	@echo 'make format  imports sorted, lines broken at 110 columns'
	@echo 'make train   the shipped models again, from random shapes (resumable; about three hours on one core)'
	@echo 'make paper   the MeshONet paper again: docs/benchmarks/paper (hours, resumable); make paper-quick: ten minutes, in build'
	@echo 'make bench   the benchmarks, and their pages in docs/benchmarks'
	@echo 'make text    the generated pages of docs/, in seconds; make pictures: what is drawn; make docs: both'
	@echo 'make site    the documentation site: build/site/index.html'
	@echo 'make tutorials  every page of docs/tutorials, compared with what it prints, and its pictures (needs OpenFOAM)'
	@echo 'make gallery  docs/gallery/domains.md: the blocks of thirty domains, with pictures'
	@echo 'make dist    what is uploaded: wheel and source distribution, checked, and the manual page'
	@echo 'make wheel   dist/meshonet-*.whl for this platform, and the source distribution'

# --- environments: a stamp stands for what is installed in $(VENV)
$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: $(BIN)/python pyproject.toml setup.py constraints.txt $(KERNELS)
	$(PIP) --editable .
	@$(BIN)/python -m compileall -q kernels geometry formats solvers meshonet_cli meshonet
	@touch $@

$(VENV)/.developing: $(BIN)/python pyproject.toml setup.py constraints.txt $(KERNELS)
	$(PIP) --editable '.[train,test,lint]'
	@$(BIN)/python -m compileall -q kernels geometry formats solvers meshonet_cli meshonet
	@touch $(VENV)/.installed $@

# --- the main job
demo: $(VENV)/.installed
	@mkdir -p demo
	$(BIN)/meshonet infer examples/naca2412.dat --res 800 -o demo/grid.vts
	$(BIN)/meshonet plot demo/grid.vts --zoom -0.5,1.5,-0.7,0.7 -o demo/grid.png
	$(BIN)/meshonet quality demo/grid.vts
	@echo
	@echo 'demo/grid.vts opens in ParaView; demo/grid.png is its picture. Next, try:'
	@echo '  $(BIN)/meshonet infer YOUR.dat --res 400x200 -o grid.vts     any airfoil file'
	@echo '  $(BIN)/meshonet solve-pde naca:23012 -o grid.vts             the elliptic solver on a designation'
	@echo '  $(BIN)/meshonet --help'

# --- checks
# half of what it takes to collect tests is to rewrite their assertions: what comes of it is kept for the next run, even
# where Python is told to keep nothing compiled
PYTEST := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest

# without what runs programs that are not from PyPI, for minutes: make test-clients
test: $(VENV)/.developing
	$(PYTEST) -n 2 --dist worksteal -m 'not client' $(TESTS)

# the core of it, in less than a minute beside other work; one process, since each of several reads all tests first
FAST := tests/geometry tests/test_api.py tests/test_architecture.py tests/solvers/test_tfi.py tests/solvers/test_multigrid.py \
  tests/solvers/test_march.py tests/solvers/test_pipeline.py tests/solvers/test_guard.py tests/formats/test_hdf5.py \
  tests/formats/test_vts.py tests/cli/test_cli_infer.py
test-fast: $(VENV)/.developing
	$(PYTEST) -m 'not slow' $(FAST)

# programs that read what is written here, from Debian: needs to be root, or them installed
test-clients: $(VENV)/.developing
	{ command -v cgnscheck && command -v checkMesh && command -v simpleFoam; } >/dev/null || \
	  { apt-get update -qq && apt-get install -y -qq --no-install-recommends cgns-convert openfoam; }
	MESHONET_CLIENTS=1 $(PYTEST) -n 2 -m client tests/formats tests/test_tutorials.py tests/test_bench_gpu.py

# the same nodes, counts and reports with other kernels of BLAS, functions of NumPy, numbers of cores, and on emulated
# processors where qemu-user is installed or can be from Debian
same: $(VENV)/.developing
	command -v qemu-x86_64 >/dev/null || \
	  { test "$$(id -u)" = 0 && apt-get update -qq && apt-get install -y -qq --no-install-recommends qemu-user; } || true
	$(BIN)/python benchmarks/same.py --emulated

# kernels that report what they do outside of arrays or what C leaves undefined (GCC, Linux), for the Python of this
# tree; nothing goes into a compiler's cache. Their rounding is another one: what tests compare is not judged here
SANITIZED := $(abspath build/sanitize)
SANITIZERS := -g -fno-omit-frame-pointer -fsanitize=address,undefined,float-cast-overflow
SANITIZE_TESTS ?= tests/geometry tests/solvers tests/formats
# with the runtime of C++: the sanitizer's finds it only when it is there as early
PRELOAD = $(foreach name,libasan.so libstdc++.so.6,$(shell $(CC) -print-file-name=$(name)))

$(SANITIZED)/.built: $(VENV)/.developing $(KERNELS)
	$(PIP) --upgrade --target $(SANITIZED)/tools cython setuptools
	mkdir -p $(SANITIZED)/meshonet/kernels
	ln -sfn $(abspath kernels/__init__.py) $(SANITIZED)/meshonet/kernels/__init__.py
	for each in meshonet/__init__.py meshonet/api formats geometry solvers; do \
	  ln -sfn $(CURDIR)/$$each $(SANITIZED)/meshonet/$${each#meshonet/}; done
	CCACHE_DISABLE=1 CFLAGS='$(SANITIZERS)' LDFLAGS='$(SANITIZERS)' PYTHONPATH=$(SANITIZED)/tools \
	  $(BIN)/python setup.py --quiet build_ext --force --build-lib $(SANITIZED) --build-temp $(SANITIZED)/objects
	@touch $@

# what sanitizers print goes past pytest, which would drop it where a test passes
sanitize: $(SANITIZED)/.built
	PYTHONPATH=$(SANITIZED) PYTHONMALLOC=malloc LD_PRELOAD='$(PRELOAD)' UBSAN_OPTIONS=print_stacktrace=1 \
	  ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 $(BIN)/pytest -n 2 --capture=sys \
	  -m 'not client and not solver and not browser' $(SANITIZE_TESTS) 2>$(SANITIZED)/report || test $$? -eq 1
	@if grep -E -A 12 'runtime error: |AddressSanitizer' $(SANITIZED)/report; then exit 1; fi
	@echo 'the sanitizers found nothing'

# hostile files for MINUTES a reader, JOBS readers at a time, and hostile options and TOML for as long; commands
# killed COUNT times
MINUTES ?= 10
JOBS ?= 1
COUNT ?= 200
fuzz: $(VENV)/.developing
	$(BIN)/python benchmarks/fuzz.py --minutes $(MINUTES) --jobs $(JOBS)
	$(BIN)/python benchmarks/fuzz_commands.py --minutes $(MINUTES)

kills: $(VENV)/.developing
	$(BIN)/python benchmarks/kills.py --count $(COUNT)

format: $(VENV)/.developing
	$(BIN)/ruff check --fix --exit-zero .
	$(BIN)/ruff format .

lint: $(VENV)/.developing
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/codespell README.md CHANGELOG.md CONTRIBUTING.md docs examples meshonet_cli meshonet/api

# a minute; after a change of the environment mypy reads everything again, which takes one more
check: lint
	$(BIN)/python benchmarks/same.py --small --machine 'this one'

# --- the shipped models: the recipes are in their headers and in docs/reference/models.md
MODELS := solvers/neural/pretrained
train: train-airfoils train-quads train-holes

train-airfoils: $(VENV)/.developing
	@mkdir -p train
	test -f train/airfoils.h5 || \
	  $(BIN)/meshonet sample-boundary --family procedural --count 6000 --seed 1 --res 257x5 -o train/airfoils.h5
	$(BIN)/meshonet train train/airfoils.h5 --model strip -o train/airfoil-o.safetensors --epochs 24 --seed 0 --resume \
	  --log-csv train/airfoil-o.csv
	cp train/airfoil-o.safetensors $(MODELS)
	cp train/airfoil-o.csv docs/benchmarks/curves

# the same domains by both methods; Winslow's with twice the nodes, of which every other one is kept.
# Exit code 3 tells that a few domains have no valid grid: they are left out
# Winslow's equations have no valid grid for every third one: what the guard would make of these teaches nothing
BARE := --no-repair --allow-invalid --tol 1e-6
SEEDED := sample-boundary --family four-sided --count 36000 --seed 1
# a second, short run, in which folds count more, goes on from the first
train-quads: train/quad-first.safetensors
	$(BIN)/meshonet train train/variational.h5 train/winslow.h5 --model quad --initial train/quad-first.safetensors \
	  -o train/quad-general.safetensors --set angles=3 --set folds=3 \
	  --epochs 6 --rate 0.001 --seed 0 --resume --log-csv train/quad-general.csv
	cp train/quad-general.safetensors $(MODELS)
	cp train/quad-first.csv train/quad-general.csv docs/benchmarks/curves

train/quad-first.safetensors: train/winslow.h5 train/variational.h5
	$(BIN)/meshonet train train/variational.h5 train/winslow.h5 --model quad -o $@ \
	  --epochs 20 --seed 0 --resume --log-csv train/quad-first.csv

train/winslow.h5: | $(VENV)/.developing
	@mkdir -p train
	$(BIN)/meshonet $(SEEDED) --res 65 -q -o train/quads-65.h5
	$(BIN)/meshonet solve-pde train/quads-65.h5 $(BARE) -q -o train/winslow-65.h5 || test $$? -eq 3
	$(BIN)/meshonet convert train/winslow-65.h5 --coarsen 2 -q -o $@
	rm train/winslow-65.h5 train/quads-65.h5

train/variational.h5: | $(VENV)/.developing
	@mkdir -p train
	$(BIN)/meshonet $(SEEDED) --res 33 -q -o train/quads-33.h5
	$(BIN)/meshonet solve-pde train/quads-33.h5 --method variational -q -o $@ || test $$? -eq 3
	rm train/quads-33.h5

# the quad network taught on, around bodies; Winslow's grids again with twice the nodes
train-holes: train/holes/winslow.h5 train/holes/variational.h5
	$(BIN)/meshonet train train/holes/variational.h5 train/holes/winslow.h5 --model quad --initial quad-general \
	  -o train/hole-o.safetensors --set angles=3 --set folds=3 --epochs 6 --batch 16 --rate 0.001 --held-out 60 \
	  --seed 0 --resume --log-csv train/hole-o.csv
	cp train/hole-o.safetensors $(MODELS)
	cp train/hole-o.csv docs/benchmarks/curves

train/holes/winslow.h5: | $(VENV)/.developing
	@mkdir -p train/holes
	$(BIN)/meshonet sample-boundary --family bodies --count 6000 --seed 1 --res 129x65 -q -o train/holes/bodies.h5
	$(BIN)/meshonet solve-pde train/holes/bodies.h5 $(BARE) -q -o train/holes/fine.h5 || test $$? -eq 3
	$(BIN)/meshonet convert train/holes/fine.h5 --coarsen 2 -q -o $@
	rm train/holes/bodies.h5 train/holes/fine.h5

train/holes/variational.h5: train/holes/winslow.h5
	$(BIN)/meshonet solve-pde $< --method variational -q -o $@ || test $$? -eq 3

# --- the MeshONet paper from its families to docs/benchmarks/paper: hours (it goes on where it stopped), or minutes
PAPER = $(MAKE) -C examples/paper MESHONET=$(abspath $(BIN))/meshonet PYTHON=$(abspath $(BIN))/python
paper: $(VENV)/.developing
	$(PAPER) OUT=$(abspath paper) PAGES=$(abspath docs/benchmarks/paper)
	$(BIN)/python docs/reduce_pictures.py --width 560 docs/benchmarks/paper/*.*.png

# every family, model and rule, but not every model on every case: half of a short training is the start of torch
QUICK := COUNT=12 RES=41 EPOCHS=60 EPOCHS_COMPARED=20 EPOCHS_SHELF=5 EPOCHS_PHYSICS=60 EPOCHS_MODES=60 SEEDS='0 1' SIZES='100 200' \
  SPLITS_hexagon=extrapolation SPLITS_wrench=interpolation SPLITS_semicircle=random SPLITS_airfoil=interpolation \
  SEEDS_SHELF=0 CASES_SHELF='arch.interpolation wrench.interpolation hole.random'
paper-quick: $(VENV)/.developing
	$(PAPER) OUT=$(abspath build/paper) PAGES=$(abspath build/paper/pages) $(QUICK)

# ROW: Rotor 37 as a TOML file. FILES: a folder of airfoil .dat files; finished rows are kept in build/bench, and a run goes on from them
bench: $(VENV)/.developing
	$(BIN)/python benchmarks/bench_operator.py $(if $(FILES),--files $(FILES)) --keep build/bench --page docs/benchmarks/o-grids.md
	$(BIN)/python benchmarks/bench_elliptic.py --largest 3200 --page docs/benchmarks/elliptic.md
	$(BIN)/python benchmarks/bench_quads.py --page docs/benchmarks/quad-operator.md
	$(BIN)/python benchmarks/bench_bodies.py --page docs/benchmarks/body-operator.md
	$(BIN)/python benchmarks/bench_confidence.py --page docs/benchmarks/confidence.md
	$(BIN)/python benchmarks/bench_layers.py --page docs/benchmarks/layers.md
	$(BIN)/python benchmarks/yardstick entries build/yardstick --page docs/benchmarks/yardstick.md
	$(BIN)/python benchmarks/bench_variational.py --page docs/benchmarks/variational.md
	$(BIN)/python benchmarks/bench_hyperbolic.py $(if $(FILES),--files $(FILES)) --page docs/benchmarks/marching.md
	$(BIN)/python benchmarks/bench_tfi.py
	$(BIN)/python benchmarks/bench_volumes.py --page docs/benchmarks/volumes.md
	$(if $(FILES),$(BIN)/python benchmarks/bench_engines.py --airfoils $(FILES) --page docs/benchmarks/engines.md)
	$(if $(FILES),$(BIN)/python benchmarks/bench_wings.py --airfoils $(FILES) --page docs/benchmarks/wings.md)
	$(if $(FILES),$(BIN)/python benchmarks/bench_aircraft.py --airfoils $(FILES) --page docs/benchmarks/aircraft.md)
	$(if $(ROW),$(BIN)/python benchmarks/bench_rows.py --row $(ROW) --airfoils $(FILES) --page docs/benchmarks/rows.md)

docs: text pictures

text: $(VENV)/.developing
	$(BIN)/python docs/make_pages.py

pictures: $(VENV)/.developing
	$(BIN)/python docs/make_pictures.py
	$(BIN)/python docs/make_drawings.py
	$(BIN)/python docs/make_volume_pictures.py

tutorials: $(VENV)/.developing
	$(BIN)/python docs/tutorials/run_tutorials.py --pictures

gallery: $(VENV)/.developing
	$(BIN)/python docs/make_gallery.py

# pages, gallery, references of Python; no network is needed
SITE := build/site
$(VENV)/.documenting: $(VENV)/.installed
	$(PIP) --editable '.[docs]'
	@touch $@

site: $(VENV)/.documenting
	$(BIN)/python -m sphinx --builder html --fail-on-warning --keep-going -q docs $(SITE)
	@echo '$(SITE)/index.html'

# for an index, wheels of the usual platforms: docs/development/wheels.md
wheel: $(BIN)/python
	$(PIP) build
	$(BIN)/python -m build --outdir dist

dist: wheel man
	$(PIP) twine
	$(BIN)/python -m twine check --strict dist/*.whl dist/*.tar.gz

man: $(VENV)/.installed
	@mkdir -p dist
	$(BIN)/python docs/command_pages.py > dist/meshonet.1

clean:
	rm -rf build demo *.egg-info $(VENV)/.installed $(VENV)/.developing $(VENV)/.documenting
	rm -rf docs/reference/api docs/gallery/python
	rm -f kernels/_native.c kernels/*.so
