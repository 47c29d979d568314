"""The comparison of same_bits.py finds what it should, with a program that only pretends to run."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

import same_bits

# Writes a table, a summary and a particle file into its -output_dir.
PROGRAM = """
import json, pathlib, sys
import h5py
directory = pathlib.Path(sys.argv[-1])
directory.mkdir(parents=True)
(directory / "history.csv").write_text("time_s,N_d\\n0,1\\n1,%(row)s\\n")
(directory / "summary.json").write_text(json.dumps({"q_Pa": %(answer)s, "wall_s": %(seconds)s}))
with h5py.File(directory / "particles_000000.h5", "w") as file:
    file["p"] = [1.0, %(pressure)s]
    file["p"].attrs["units"] = "Pa"
    if %(more)s:
        file["q"] = [3.0]
sys.exit(%(code)s)
"""
AS_KEPT = {"row": "2.5", "answer": "4.0", "seconds": "7.0", "pressure": "2.0", "more": "False",
           "code": "0"}


class SameBits(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.program = pathlib.Path(scratch.name) / "program.py"
        launcher = pathlib.Path(scratch.name) / "launcher"
        launcher.write_text(f"#!/bin/sh\nshift\nexec {sys.executable} \"$@\"\n", encoding="utf-8")
        launcher.chmod(0o755)
        self.command = [str(launcher), str(self.program)]
        self.kept = pathlib.Path(scratch.name) / "kept"
        self.assertEqual(self.outcome(same_bits.keep, AS_KEPT, {"one": [1, ""]})[0], 0)

    def outcome(self, action, values, *more):
        self.program.write_text(PROGRAM % values, encoding="utf-8")
        with contextlib.redirect_stdout(io.StringIO()) as text:
            code = action(self.command, self.kept, *more, 1)
        return code, text.getvalue()

    def compare(self, **changed):
        return self.outcome(same_bits.compare, {**AS_KEPT, **changed})

    def test_the_same_program_gives_no_difference(self):
        self.assertEqual(self.compare(), (0, "1 of 1 runs give the same bits\n"))

    def test_times_and_what_is_written_besides_are_no_difference(self):
        self.assertEqual(self.compare(seconds="8.0", more="True")[0], 0)

    def test_a_table_is_reported_with_row_and_column(self):
        code, text = self.compare(row="2.6")
        self.assertEqual(code, 1)
        self.assertIn("FAIL one: history.csv: row 2 of N_d: 2.5, now 2.6", text)

    def test_an_answer_is_reported_with_both_values(self):
        code, text = self.compare(answer="4.1")
        self.assertEqual(code, 1)
        self.assertIn("FAIL one: summary.json: q_Pa: 4.0, now 4.1", text)

    def test_the_last_bit_of_a_particle_is_reported(self):
        code, text = self.compare(pressure="2.0000000000000004")
        self.assertEqual(code, 1)
        self.assertIn("FAIL one: particles_000000.h5: p:", text)

    def test_a_run_that_fails_is_reported(self):
        code, text = self.compare(code="3")
        self.assertEqual(code, 1)
        self.assertIn("exit code: 0, now 3", text)


if __name__ == "__main__":
    unittest.main()
