"""Runs adapters on the same inputs and holds their meshes, times and memory against each other; started by cases/compare."""
