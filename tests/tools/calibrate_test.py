"""calibrate_test.py PROGRAM: tools/calibrate finds constants again from tests made with them."""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
try:
    import scipy  # noqa: F401
except ImportError:
    print("SciPy is missing: tools/setup --calibrate")
    sys.exit(SKIPPED)

sys.path.insert(0, str(ROOT / "tools"))
from calibration import element, tables  # noqa: E402

PROGRAM = sys.argv.pop(1)
TRUE = {"d0": 0.5, "m": 3.6, "eps_r": 0.05}
# Name, kPa, void ratio.
TESTS = (("A", 50, 0.50), ("B", 100, 0.62), ("C", 200, 0.56), ("D", 400, 0.70))
COARSE = ["--increments", "50", "--strain-end", "0.1", "--strains", "logarithmic"]


def answer(mode, sigma3_kPa, void_ratio):
    """What the program says with the true constants."""
    program = element.Program(PROGRAM, 1, 0.1, 50)
    test = tables.Test("made", mode, 1000.0 * sigma3_kPa, void_ratio, None, None, None, (), ())
    sand = {f"sand_{name}": value for name, value in TRUE.items()}
    return program.responses([sand], [test])[0][0]


def noise(k):
    """Deterministic, of mean square 1/2."""
    return math.sin(7.3 * k + 1.0)


def write_tests(path, tests, mode="triaxial_compression"):
    """Tests with 0.1 degrees of noise, and the responses they come from."""
    responses = {}
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["test", "mode", "sigma3_kPa", "void_ratio", "phi_peak_deg"])
        for k, (name, pressure, void_ratio) in enumerate(tests):
            responses[name] = answer(mode, pressure, void_ratio)
            angle = responses[name].peak()[0] + 0.15 * noise(k)
            writer.writerow([name, mode, pressure, void_ratio, f"{angle:.3f}"])
    return responses


def write_curves(path, responses):
    """Every fifth row with noise of 0.5 % and 0.0003; a cell is empty now and then."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["test", "axial_strain", "stress_ratio", "volumetric_strain"])
        for name, response in responses.items():
            for k in range(5, len(response.strain), 5):
                ratio = response.ratio[k] * (1.0 + 0.007 * noise(k))
                volume = response.volume[k] + 0.0004 * noise(k + 3)
                writer.writerow([name, f"{response.strain[k]:.6f}", f"{ratio:.4f}",
                                 "" if k % 15 == 0 else f"{volume:.6f}"])


def calibrate(*arguments):
    command = [sys.executable, str(ROOT / "tools/calibrate"), *map(str, arguments)]
    return subprocess.run(command + ["--program", PROGRAM], capture_output=True, text=True,
                          check=False)


class InDirectory(unittest.TestCase):
    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.directory = pathlib.Path(made.name)

    def path(self, name, text=None):
        if text is not None:
            (self.directory / name).write_text(text, encoding="utf-8")
        return self.directory / name


class Constants(InDirectory):
    def test_known_constants_come_back_and_a_prediction_is_right(self):
        responses = write_tests(self.path("tests.csv"), TESTS)
        write_curves(self.path("curves.csv"), {name: responses[name] for name in "ABD"})
        write_tests(self.path("other.csv"), [("P", 100, 0.56)], "plane_strain")
        done = calibrate(self.path("tests.csv"), "--curves", self.path("curves.csv"),
                         "--predict", self.path("other.csv"), "--out", self.path("out"), *COARSE,
                         "--set", "c=sand")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(self.path("out/calibration.json").read_text(encoding="utf-8"))
        for name, value in TRUE.items():
            constant = found["constants"][name]
            self.assertLessEqual(constant["low_95"], value, name)
            self.assertGreaterEqual(constant["high_95"], value, name)
            self.assertLess(abs(constant["value"] / value - 1.0), 0.04, name)
        self.assertLess(found["errors_of_fitted"]["phi_rms_deg"], 0.2)
        self.assertLess(abs(found["predicted"][0]["phi_error_deg"]), 0.3)
        self.assertEqual(found["warnings"], [])
        self.check_files()

    def check_files(self):
        self.assertGreater(self.path("out/calibration.png").stat().st_size, 10000)
        done = subprocess.run([PROGRAM, "-scene", "material_point", "-increments", "20",
                               "-options_file", str(self.path("out/sand.opts")),
                               "-output_dir", str(self.path("again"))],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        used = json.loads(self.path("again/summary.json").read_text(encoding="utf-8"))
        self.assertAlmostEqual(used["option_sand_d0"], TRUE["d0"], delta=0.02)

    def test_what_the_tests_do_not_tell_is_said(self):
        write_tests(self.path("tests.csv"), TESTS)
        done = calibrate(self.path("tests.csv"), "--fit", "d0,c", "--out", self.path("out"),
                         *COARSE)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("c has no effect on these tests", done.stdout)


class Refusals(InDirectory):
    HEADER = "test,mode,sigma3_kPa,void_ratio,phi_peak_deg\n"
    ROW = "A,triaxial_compression,100,0.6,40\n"

    def refused(self, words, tests, *arguments):
        done = calibrate(self.path("tests.csv", tests), "--out", self.path("out"), *arguments)
        self.assertEqual(done.returncode, 2, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_a_bad_cell_is_named_with_file_line_column_and_what_is_allowed(self):
        self.refused(["tests.csv", "line 3", "column mode", "'drained'", "plane_strain"],
                     self.HEADER + self.ROW + "B,drained,100,0.6,40\n")
        self.refused(["line 2", "column void_ratio", "'60'", "0.2 to 2"],
                     self.HEADER + "A,triaxial_compression,100,60,40\n")
        self.refused(["line 1", "column e:", "void_ratio"], "test,mode,sigma3_kPa,e\n" + self.ROW)
        self.refused(["line 3", "'A'"], self.HEADER + 2 * self.ROW)

    def test_curves_belong_to_tests(self):
        curves = self.path("curves.csv", "test,axial_strain,stress_ratio,volumetric_strain\n"
                                         "A,0.01,2,\nZ,0.01,2,\n")
        self.refused(["curves.csv", "line 3", "'Z'"], self.HEADER + self.ROW, "--curves", curves)

    def test_bad_constants_are_refused(self):
        tests = self.HEADER + self.ROW
        self.refused(["'d1'", "eps_r"], tests, "--fit", "d0,d1")
        self.refused(["sand_bulk"], tests, "--set", "bulk=soft")
        self.refused(["--bounds", "LOW:HIGH"], tests, "--bounds", "m=4")
        self.refused(["xi", "--set xi="], tests, "--fit", "xi")
        self.refused(["1 readings", "3 constants"], tests)


if __name__ == "__main__":
    unittest.main()
