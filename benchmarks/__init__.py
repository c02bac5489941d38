"""Speed and memory, measured by `python -m benchmarks`; never part of the tests."""
