"""Arguments of tools/calibrate and the order of its work."""

import argparse
import dataclasses
import os
import pathlib

from . import constants, report, residuals, tables
from .element import Failed, Program

HELP = """
TESTS.csv, one row a test:
  test                 a name
  mode                 triaxial_compression, triaxial_extension or plane_strain
  sigma3_kPa           stress that is held, in extension the lateral one
  void_ratio           at that stress, before shearing
  phi_peak_deg         peak friction angle, may be empty where there is a curve
  strain_at_peak       (column may be missing) size of the axial strain there
  phi_sd_deg           (column may be missing) standard deviation of this angle
CURVES.csv, one row a reading; cells may be empty:
  test, axial_strain, stress_ratio (sigma1/sigma3), volumetric_strain
Strains are fractions, compression positive, negative axial strain in extension. '#' begins a
comment line. A test of --predict may have a curve, too; it is compared and drawn, never fitted.

Each difference counts over its standard deviation: 0.5 degrees in peak angle (unless the test
has its own), 0.25 in ln(strain at peak), 0.05 in ln(stress ratio), 0.003 in volumetric strain.
The last two are about three times what a laboratory can read, since the law has its own shape
of curve. A curve counts like 8 readings, however many it has.

The start is the value of --set, or else that of the sand (--sand). c, the ratio of extension to
compression, has no effect on triaxial compression and is not fitted unless named: --set c=peak (the
default) gives extension the mean peak angle of the compression tests, c=formula the critical
friction angle, c=sand leaves it as the sand has it, c=NUMBER sets it.
"""


@dataclasses.dataclass
class Answer:
    """All that is reported."""

    tests_file: str
    fit: object
    constants: constants.Constants
    options: dict
    deviations: residuals.Deviations
    warnings: list
    fitted_pairs: list
    predicted_pairs: list

    @property
    def fitted(self):
        return [residuals.comparison(*pair) for pair in self.fitted_pairs]

    @property
    def predicted(self):
        return [residuals.comparison(*pair) for pair in self.predicted_pairs]


def parser(root):
    made = argparse.ArgumentParser(
        prog="tools/calibrate", epilog=HELP, formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Constants of the sand law from element tests, by least squares over runs of "
                    "the program.")
    made.add_argument("tests", metavar="TESTS.csv", help="tests that are fitted")
    made.add_argument("--curves", metavar="CURVES.csv", help="curves of some of the tests")
    made.add_argument("--predict", metavar="OTHER_TESTS.csv", help="tests that are not fitted")
    made.add_argument("--fit", default="d0,m,eps_r", metavar="NAMES",
                      help="constants to be fitted: " + ", ".join(constants.BOUNDS)
                           + " (default: d0,m,eps_r)")
    made.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                      help="option -sand_NAME of the program, or the start of what is fitted")
    made.add_argument("--bounds", action="append", default=[], metavar="NAME=LOW:HIGH",
                      help="bounds of a constant, in place of wide ones")
    made.add_argument("--sand", help="named sand to set out from (-sand of the program)")
    made.add_argument("--out", default="out/calibrate", metavar="DIR", help="(default: "
                      "%(default)s)")
    add_numerics(made, root)
    return made


def add_numerics(made, root):
    made.add_argument("--strains", choices=("engineering", "logarithmic"), default="engineering",
                      help="kind of the strains in the files (default: %(default)s)")
    made.add_argument("--strain-end", type=float, default=0.12, metavar="STRAIN",
                      help="each test is run to it at least (default: %(default)s)")
    made.add_argument("--increments", type=int, default=150, help="rows of a computed test "
                      "(default: %(default)s)")
    made.add_argument("--most-steps", type=int, default=30, help="of the fit (default: "
                      "%(default)s)")
    made.add_argument("-j", type=int, default=2 * (os.cpu_count() or 1),
                      help="runs at once (default: two per core)")
    made.add_argument("--program", type=pathlib.Path, help="a built program (default: "
                      f"{(root / 'build/mpmsolve').relative_to(root)}, which is built first)")


@dataclasses.dataclass
class Job:
    """What the user asks for, read and checked."""

    arguments: argparse.Namespace
    tests: list
    predicted: list
    constants: constants.Constants


def read_job(arguments):
    kind = arguments.strains
    tests = tables.read_tests(arguments.tests, kind)
    predicted = tables.read_tests(arguments.predict, kind) if arguments.predict else {}
    for name in tests.keys() & predicted.keys():
        raise tables.BadInput(f"{arguments.predict}: test {name} is in {arguments.tests}, too; a "
                              "test is either fitted or predicted")
    if arguments.curves:
        tables.read_curves(arguments.curves, tests | predicted, kind)
    tables.check_measured(tests, arguments.tests)
    check_numbers(arguments)
    return Job(arguments, list(tests.values()), list(predicted.values()),
               read_constants(arguments, tests.values()))


def check_numbers(arguments):
    if not 0.01 <= arguments.strain_end <= 2.0:
        raise tables.BadInput("--strain-end: allowed is 0.01 to 2")
    for name, low in (("increments", 20), ("most_steps", 1), ("j", 1)):
        if getattr(arguments, name) < low:
            raise tables.BadInput(f"--{name.replace('_', '-')}: allowed is {low} and more")


def read_constants(arguments, tests):
    settings = constants.parse_settings(arguments.set)
    angles = [test.phi_peak for test in tests
              if test.phi_peak is not None and test.mode == "triaxial_compression"]
    if settings.get("c") == "peak" and not angles:
        raise tables.BadInput("--set c=peak: no triaxial compression test has a peak angle")
    return constants.Constants(arguments.sand, constants.parse_names(arguments.fit), settings,
                               constants.parse_bounds(arguments.bounds),
                               sum(angles) / len(angles) if angles else None)


def calibrate(job, program_path):
    """Runs the fit and writes its answer; SciPy must be there by now."""
    from . import fit as fitting, picture

    arguments, found = job.arguments, job.constants
    program = Program(program_path, arguments.j, arguments.strain_end, arguments.increments)
    found.take_start(program.defaults(found.base_options(), job.tests[0]))
    deviations = residuals.Deviations()
    result = fitting.least_squares(program, found, job.tests, deviations, arguments.most_steps)
    options = found.options(result.values)
    responses = program.responses([options], job.tests + job.predicted)[0]
    pairs = list(zip(job.tests + job.predicted, responses))
    answer = Answer(arguments.tests, result, found, options, deviations,
                    fitting.warnings(result) + failures(pairs), pairs[:len(job.tests)],
                    pairs[len(job.tests):])
    write(answer, pathlib.Path(arguments.out), picture)
    print(report.text(answer))
    print(f"\n{program.runs} runs of the program; {arguments.out}/sand.opts has the constants, "
          f"{arguments.out}/calibration.png the picture")


def failures(pairs):
    return [str(response) for _, response in pairs if isinstance(response, Failed)]


def write(answer, directory, picture):
    directory.mkdir(parents=True, exist_ok=True)
    (directory / "sand.opts").write_text(report.options_file(answer), encoding="utf-8")
    (directory / "calibration.json").write_text(report.as_json(answer), encoding="utf-8")
    picture.draw(answer, directory / "calibration.png")
