"""The studies of tools/study."""
