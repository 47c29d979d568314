"""Studies by tools/study that are more than a list of pipe runs."""
