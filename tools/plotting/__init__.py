"""Pictures and the answer of a run, from the files in its output directory."""
