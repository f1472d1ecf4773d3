# Every target sets up all that it needs; see scripts/uv.sh.
RUN := scripts/uv.sh run --frozen

.PHONY: demo test test-slow check lint types format

demo: ## One push of an unseen object: prints the outcome, writes out/demo/recording.html
	$(RUN) --no-dev keypush demo --object bumpy_toy --out out/demo

test: ## The tests that take seconds
	$(RUN) pytest -n auto --dist loadfile

test-slow: ## The tests that take minutes: the wheel, soaks, statistics
	$(RUN) pytest -m slow

check: lint types test ## What a change must pass

lint:
	$(RUN) ruff format --check .
	$(RUN) ruff check .
	$(RUN) lint-imports

types:
	$(RUN) mypy

format: ## Formats, and mends what the linter can mend
	$(RUN) ruff format .
	$(RUN) ruff check --fix .
