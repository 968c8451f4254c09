# Every command of this project. `make run` and `make test` are all a newcomer needs:
# each installs what is missing (scripts/deps.sh) and then does its job.
#
# GNU make exits with 2 whatever went wrong in a recipe; where fabc's own exit code
# carries a meaning, `make run` prints it. Only features that GNU make 3.81 and BSD
# make share are used here; anything longer than a line lives in scripts/.

# Runs one command with the pinned toolchain and with OpenCV where the build can find it.
WITH_ENV = sh scripts/with-env.sh

# More arguments for `fabc run`, as in: make run ARGS="--start 3"
ARGS =

.PHONY: help run test test-peers lint package bench book deps env

help:
	@echo 'make run         build fabc and run tasks/double_straight.fab; more arguments: ARGS="..."'
	@echo 'make test        the fast tests'
	@echo 'make test-peers  the tests that take long or need large foreign parts'
	@echo 'make lint        format, clippy, the build without system libraries, packages, documentation'
	@echo 'make package     pack each crate and build it from its archive alone: as long as a first build'
	@echo 'make bench       the benchmarks'
	@echo 'make book        build the book of docs/ to target/book'
	@echo 'make deps        install what a build needs and lacks; FABC_NO_INSTALL=1 only names it'
	@echo 'make env         the variables for calling cargo directly: eval "$$(make -s env)"'

run: deps
	@$(WITH_ENV) sh scripts/run.sh tasks/double_straight.fab $(ARGS)

test: deps
	@$(WITH_ENV) sh scripts/test.sh --workspace --exclude fab-arm-ros --locked --no-fail-fast

test-peers: deps
	@$(WITH_ENV) sh scripts/test-peers.sh

lint: deps
	@$(WITH_ENV) sh scripts/lint.sh

package: deps
	@$(WITH_ENV) sh scripts/package.sh

bench: deps
	$(WITH_ENV) cargo bench --locked -p fab-compiler --bench compile
	$(WITH_ENV) cargo bench --locked -p fab-sim --bench cloth
	$(WITH_ENV) sh scripts/count-instructions.sh
	$(WITH_ENV) cargo build --release --locked
	$(WITH_ENV) sh scripts/bench-snapshots.sh "$${CARGO_TARGET_DIR:-target}/release/fabc"

book:
	@$(WITH_ENV) sh scripts/book.sh

deps:
	@sh scripts/deps.sh

env:
	@sh scripts/toolchain-env.sh
	@sh scripts/opencv-env.sh
