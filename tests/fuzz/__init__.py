"""Random runs: drawn, run, judged, made small; see CONTRIBUTING.md, `make campaign OF=fuzz`."""
