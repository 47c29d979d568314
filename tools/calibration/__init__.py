"""Constants of the sand law from a user's own tests: tools/calibrate."""
