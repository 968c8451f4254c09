# Every command of this project. A newcomer needs only `make run` and `make test`.
# Each names what is missing (scripts/deps.sh), or does its job; only `make deps` installs anything on the system.
#
# GNU make exits with 2 whatever failed in a recipe, so `make run` prints fabc's own exit
# code and its meaning. This file uses only features that GNU make 3.81 and BSD make share;
# anything longer than a line is in scripts/.

# Runs one command with the pinned toolchain.
WITH_ENV = sh scripts/with-env.sh

# More arguments for `fabc run`, for example: make run ARGS="--start 3"
ARGS =

# Features besides the defaults, for `run` and `deps`, for example: make deps FEATURES="opencv ros peers"
FEATURES =

# What `make dist` builds and `make dist-check` tests: deb, wheel, static; everything if empty.
PARTS =

.PHONY: help run test test-all test-long lint package bench book dist dist-check deps compiler opencv

help:
	@echo 'make run         build fabc and run tasks/double_straight.fab; more arguments: ARGS="...", FEATURES="..."'
	@echo 'make test        the fast tests'
	@echo 'make test-all    every test: also those that take long or need programs by others, such as OpenCV'
	@echo 'make lint        format, clippy, no system library, packages, documentation'
	@echo 'make package     pack each crate and build it from its archive alone; takes as long as a first build'
	@echo 'make bench       the benchmarks'
	@echo 'make book        build the book of docs/ to target/book'
	@echo 'make dist        a Debian package, a Python wheel and a static authoring tool, to target/dist (Linux x86-64)'
	@echo 'make dist-check  install these into clean roots, run and remove them; needs mmdebstrap; only some: PARTS="deb wheel"'
	@echo 'make deps        install what a build lacks; with FEATURES="opencv ros", also what these need'

run: compiler
	@FABC_FEATURES="$(FEATURES)" $(WITH_ENV) sh scripts/run.sh tasks/double_straight.fab $(ARGS)

test: compiler
	@$(WITH_ENV) sh scripts/test.sh

test-all: compiler opencv
	@$(WITH_ENV) sh scripts/test-long.sh --with-fast

# What `make test` leaves out, and first scripts/mission.sh, a test of each promise of this project.
test-long: compiler opencv
	@$(WITH_ENV) sh scripts/test-long.sh

lint: compiler
	@$(WITH_ENV) sh scripts/lint.sh

package: compiler
	@$(WITH_ENV) sh scripts/package.sh

bench: compiler
	$(WITH_ENV) cargo bench --locked -p fab-compiler --bench compile
	$(WITH_ENV) cargo bench --locked -p fab-sim --bench cloth
	$(WITH_ENV) sh scripts/count-instructions.sh
	$(WITH_ENV) cargo build --release --locked
	$(WITH_ENV) sh scripts/bench-snapshots.sh "$${CARGO_TARGET_DIR:-target}/release/fabc"
	$(WITH_ENV) sh scripts/bench-films.sh "$${CARGO_TARGET_DIR:-target}/release/fabc"
	$(WITH_ENV) sh scripts/bench-textbook.sh "$${CARGO_TARGET_DIR:-target}/release/fabc"

book:
	@$(WITH_ENV) sh scripts/book.sh

dist: compiler
	@$(WITH_ENV) sh scripts/dist.sh $(PARTS)

dist-check:
	@sh scripts/dist/check.sh $(PARTS)

deps:
	@$(WITH_ENV) sh scripts/deps.sh --install $(FEATURES)

compiler:
	@sh scripts/deps.sh

opencv:
	@$(WITH_ENV) sh scripts/deps.sh opencv
