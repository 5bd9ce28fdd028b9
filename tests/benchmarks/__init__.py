"""What it costs: measured on demand, asserted nowhere. `python -m tests.benchmarks` runs all of it."""
