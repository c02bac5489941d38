"""Datasets: a folder with data.csv and dataset.toml (format: docs/datasets.md)."""
