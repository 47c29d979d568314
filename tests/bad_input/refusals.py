"""What the program must refuse: exit code 2 on all ranks, one message, nothing hangs.

usage: refusals.py LAUNCHER PROGRAM RANKS
"""

import concurrent.futures
import os
import pathlib
import subprocess
import sys
import tempfile

EXIT_BAD_INPUT = 2
PREFIX = "mpmsolve: bad input: "
SECONDS = 60
AT_ONCE = 4  # the launcher sleeps for two seconds after a refusal


def point(directory, *arguments):
    """An element test with a directory of its own: cases run at the same time."""
    return ["-scene", "material_point", "-output_dir", f"OUT/{directory}", *arguments]


def path(directory, file, *arguments):
    return point(directory, "-test", "path", "-path_file", file, *arguments)


def custom(directory, *arguments):
    """A block on a fixed floor under a plate, with options of its own last."""
    return ["-scene", "custom", "-options_file", "FILES/custom.opts", "-output_dir",
            f"OUT/custom_{directory}", *arguments]


# Arguments and what the message must say. FILES/ is the directory of the files below, OUT/ one for
# results.
CASES = [
    # no scene to run
    ([], ["-scene", "missing", "mms1d"]),
    (["-scene"], ["-scene", "needs a value"]),
    (["-scene", "rotaton"], ["-scene", "rotaton", "nearest is rotation"]),
    # names
    (["-scene", "mms1d", "-curant", "0.3"], ["-curant", "0.3", "unknown", "-courant"]),
    (["-scene", "mms1d", "-contact_friction", "0.3"], ["-contact_friction", "unknown"]),
    (["-scene", "mms1d", "-cells=32"], ["-cells=32", "-cells 32"]),
    # words
    (["-scene", "mms1d", "stray"], ["stray"]),
    (["stray", "-scene", "mms1d"], ["stray"]),
    (["-scene", "mms1d", "-cells", "32", "64"], ["64", "-cells"]),
    # values
    (["-scene", "mms1d", "-cells"], ["-cells", "needs a value", "integer"]),
    (["-scene", "mms1d", "-cells", "-courant", "0.3"], ["-cells", "needs a value"]),
    (["-scene", "mms1d", "-cells", "many"], ["-cells", "many", "integer"]),
    (["-scene", "mms1d", "-cells", "32.5"], ["-cells", "32.5", "integer"]),
    (["-scene", "mms1d", "-cells", "0x20"], ["-cells", "0x20", "integer"]),
    (["-scene", "mms1d", "-cells", "2"], ["-cells", "2", "3", "100000"]),
    (["-scene", "mms1d", "-cells", "-32"], ["-cells", "-32", "3"]),
    (["-scene", "mms1d", "-cells", "99999999999"], ["-cells", "99999999999", "100000"]),
    (["-scene", "mms1d", "-cells", "99999999999999999999"], ["-cells", "99999999999999999999"]),
    (["-scene", "mms1d", "-courant", "fast"], ["-courant", "fast", "real"]),
    (["-scene", "mms1d", "-courant", "0.3x"], ["-courant", "0.3x", "real"]),
    (["-scene", "mms1d", "-courant", "2.01"], ["-courant", "2.01", "2"]),
    (["-scene", "mms1d", "-courant", "0"], ["-courant 0 ", "> 0"]),
    (["-scene", "mms1d", "-courant", "nan"], ["-courant", "nan", "real"]),
    (["-scene", "mms1d", "-courant", "-nan"], ["-courant", "-nan"]),
    (["-scene", "mms1d", "-end_time", "inf"], ["-end_time", "inf", "real"]),
    (["-scene", "mms1d", "-end_time", "-inf"], ["-end_time", "-inf"]),
    (["-scene", "mms1d", "-end_time", "1e999"], ["-end_time", "1e999"]),
    (["-scene", "column", "-height", "-50"], ["-height", "-50"]),
    (["-scene", "mms1d", "-particle_output_times", "0.1,,0.2"], ["-particle_output_times"]),
    (["-scene", "mms1d", "-basis_boundary", "mirrored"], ["-basis_boundary", "mirrored", "mirror"]),
    (["-scene", "mms1d", "-progress", "yes"], ["-progress", "yes", "auto", "on", "off"]),
    # duplicates
    (["-scene", "mms1d", "-cells", "32", "-cells", "64"], ["-cells", "32", "64"]),
    (["-options_file", "FILES/twice.opts"], ["-cells", "32", "64", "twice.opts:2", "twice.opts:4"]),
    # files
    (["-options_file", "FILES/none.opts"], ["-options_file", "none.opts", "does not exist"]),
    (["-options_file", "FILES"], ["-options_file", "is a directory"]),
    (["-options_file"], ["-options_file", "needs a value"]),
    (["-options_file", "FILES/nested.opts"], ["-options_file", "plain.opts", "nested.opts:2"]),
    (["-options_file", "FILES/binary.opts"], ["binary.opts", "not a text file"]),
    (["-options_file", "FILES/prose.txt"], ["Dear", "prose.txt:1"]),
    (["-options_file", "FILES/shared_line.opts"], ["-courant", "shared_line.opts:2"]),
    (["-options_file", "FILES/plain.opts", "-cells", "1"], ["-cells 1 (command line)"]),
    # results that cannot be written
    (["-scene", "mms1d", "-output_dir", "FILES/plain.opts/out"], ["output_dir", "plain.opts/out"]),
    (["-scene", "mms1d", "-output_dir", "FILES/plain.opts"], ["output_dir", "plain.opts"]),
    (["-scene", "mms1d", "-output_dir", ""], ["-output_dir"]),
    # sense that only a scene can see
    (["-scene", "patch", "-placement", "gauss", "-particles_per_cell_direction", "4",
      "-output_dir", "OUT/gauss"], ["4 particles", "1, 2 or 3"]),
    (["-scene", "triaxial", "-cells", "0"], ["-cells 0", "1 to 64"]),
    (["-scene", "triaxial", "-confining_pressure", "0"], ["-confining_pressure 0", "> 0"]),
    (["-scene", "triaxial", "-strain_end", "0.5"], ["-strain_end 0.5", "<= 0.4"]),
    (["-scene", "triaxial", "-triaxial_velocity", "-1"], ["-triaxial_velocity -1", "> 0"]),
    (["-scene", "triaxial", "-basis", "cubist"], ["-basis", "cubist", "nearest is cubic"]),
    (["-scene", "traction", "-cells", "3"], ["-cells 3", "4 to 100000"]),
    (["-scene", "traction", "-damping", "1"], ["-damping 1", "< 1"]),
    (["-scene", "traction", "-rest_tolerance", "0"], ["-rest_tolerance 0", "> 0"]),
    (["-scene", "traction", "-traction", "0", "-output_dir", "OUT/traction"],
     ["-traction 0", "give a pull"]),
    # element tests
    (point("point8", "-test", "path"), ["-test path", "-path_file"]),
    (point("point9", "-path_file", "FILES/leg.csv"), ["-path_file", "leg.csv", "-test path"]),
    (path("point1", "FILES/none.csv"), ["-path_file", "none.csv", "does not exist"]),
    (path("point2", "FILES"), ["-path_file", "is a directory"]),
    (path("point3", "FILES/binary.opts"), ["-path_file", "binary.opts", "not a text file"]),
    (path("point4", "FILES/no_legs.csv"), ["-path_file", "no_legs.csv", "has no legs"]),
    (path("point5", "FILES/word.csv"), ["word.csv:3", "strain_yy", "'much'", "real", "hold"]),
    (path("point6", "FILES/field.csv"), ["field.csv:2", "3 fields", "4"]),
    (path("point7", "FILES/leg.csv", "-strain_end", "0.1"), ["-strain_end 0.1", "-test path"]),
    (point("point10", "-material", "elastic", "-sand_G0", "200"),
     ["-sand_G0 200", "-material sand"]),
    (point("point11", "-material", "clay"), ["-material", "clay", "sand", "elastic"]),
    (point("point12", "-confining_pressure", "0"), ["-confining_pressure 0", "larger"]),
    # sands
    (point("sand1", "-sand", "toyora"), ["-sand toyora", "stockton_paper", "nearest is toyoura"]),
    (point("sand2", "-sand_relative_density", "0.4", "-sand_void_ratio", "0.6"),
     ["-sand_relative_density 0.4", "-sand_void_ratio 0.6", "leave one"]),
    (point("sand3", "-sand_relative_density", "40"), ["-sand_relative_density 40", "0 to 1.2"]),
    (point("sand4", "-sand_bulk", "log", "-sand_bulk_xi", "0.3"),
     ["-sand_bulk_xi 0.3", "no effect", "-sand_bulk power"]),
    (point("sand5", "-sand", "toyoura", "-sand_kappa", "0.02"),
     ["-sand_kappa 0.02", "no effect", "-sand_bulk log"]),
    (point("sand6", "-sand_d0", "1.3"), ["-sand_d0 1.3", "1.24", "-sand_Mc"]),
    (point("sand7", "-sand_poisson", "0.5"), ["-sand_poisson 0.5", "< 0.5"]),
    # softening averaged over a length
    (["-scene", "biaxial", "-regularisation_length", "0.19"],
     ["-regularisation_length 0.19", "at least 0.2 m"]),
    (["-scene", "pipe", "-pipe_velocity", "automatic"], ["-pipe_velocity automatic", "auto"]),
    (["-scene", "pipe", "-regularisation_length", "9"], ["-regularisation_length 9", "at most"]),
    (["-scene", "mms1d", "-regularisation_length", "0.5"], ["-regularisation_length 0.5", "no law"]),
    (["-scene", "biaxial", "-regularisation_length", "-0.2"], ["-regularisation_length -0.2"]),
    (["-scene", "biaxial", "-average_volume_share", "0.7"],
     ["-average_volume_share 0.7", "no effect", "-average_volume"]),
    (["-scene", "biaxial", "-average_volume", "-average_volume_share", "0"],
     ["-average_volume_share 0"]),
    (["-scene", "biaxial", "-regularisation_every", "0"], ["-regularisation_every 0"]),
    (["-scene", "biaxial", "-regularisation_every", "7"],
     ["-regularisation_every 7", "no effect", "-regularisation_length"]),
    # a problem put together by options
    (["-scene", "custom"], ["-domain", "is required"]),
    (custom(1, "-region_soil_layer", "0,1"), ["-region_soil_layer", "beside -region_soil_box"]),
    (custom(2, "-region_sand_box", "0,0,1,1"), ["-region_sand_box", "unknown", "-region_soil_box"]),
    (custom(3, "-regions", "soil,rock", "-region_rock_box", "0,0,1,0.2"),
     ["-region_rock_material", "is required"]),
    (custom(4, "-regions", "soil,soil"), ["-regions", "'soil' twice"]),
    (custom(5, "-regions", "soil,top soil"), ["-regions", "'top soil'"]),
    (custom(6, "-region_soil_box", "0,0,1"), ["-region_soil_box", "3 numbers", "x0,y0,x1,y1"]),
    (custom(7, "-region_soil_box", "0,1,1,0"), ["-region_soil_box", "not below"]),
    (custom(8, "-region_soil_box", "7,0,8,1"), ["no cell", "particle"]),
    (custom(37, "-regions", "soil,rock", "-region_rock_box", "3,0,4,1", "-region_rock_material",
            "elastic"), ["-regions", "rock holds no particle"]),
    (custom(9, "-region_soil_material", "clay"), ["-region_soil_material", "clay", "sand"]),
    (custom(10, "-region_soil_von_mises_density", "1"), ["-region_soil_von_mises", "unknown"]),
    (custom(11, "-walls", "roller,roller,fixed"), ["-walls", "3", "4", "left,right,bottom,top"]),
    (custom(12, "-walls", "roller,roller,fixed,open"), ["-walls", "'open'", "roller"]),
    (custom(13, "-walls", "roller,roller,free,free"), ["-walls", "bottom", "free"]),
    (custom(14, "-cell_size", "0.3"), ["-cell_size 0.3", "-fine_box"]),
    (custom(15, "-domain", "0,0,1"), ["-domain", "3 numbers", "4"]),
    (custom(16, "-dimension", "3"), ["-domain", "4 numbers", "6"]),
    (custom(17, "-stage_run_until", "soon"), ["-stage_run_until soon", "rest", "BODY:DISTANCE"]),
    (custom(18, "-stage_run_until", "plat:0.1"), ["-stage_run_until", "plat", "allowed are plate"]),
    (custom(19, "-stage_run_until", "plate:0.1"), ["plate:0.1", "does not move"]),
    (custom(20, "-stages", "rest,run"), ["-stage_rest_until", "is required"]),
    (custom(21, "-body_plate_velocity", "0,0,1"), ["-body_plate_velocity", "3 numbers", "2"]),
    (custom(22, "-body_plate_ramp", "0.1"), ["-body_plate_ramp", "without a velocity"]),
    (custom(23, "-body_plate_motion", "FILES/none.csv"), ["-body_plate_motion", "does not exist"]),
    (custom(24, "-body_plate_motion", "FILES/motion.csv"), ["motion.csv:2", "'fast'"]),
    (custom(25, "-body_plate_friction_law", "rough", "-body_plate_friction", "0.3"),
     ["-body_plate_friction", "no effect"]),
    (custom(26, "-loads", "snow"), ["-loads", "snow", "-load_snow_top"]),
    (custom(27, "-loads", "snow", "-load_snow_top", "1e3", "-load_snow_box", "5,5,6,6"),
     ["-load_snow_top", "no soil"]),
    (custom(28, "-loads", "snow", "-load_snow_front", "1e3"), ["-load_snow_front", "no such side"]),
    (custom(29, "-watch", "0.1,0.2,0.3"), ["-watch", "3 numbers"]),
    (custom(30, "-counted_stage", "push"), ["-counted_stage push", "run"]),
    (custom(31, "-region_soil_polygon", "0,0,1,1,1,0,0,1"), ["-region_soil_polygon"]),
    (custom(32, "-fine_box", "0,0,3,1"), ["-fine_box", "not within"]),
    (custom(33, "-lines_x", "FILES/motion.csv"), ["-lines_x", "motion.csv:2"]),
    (custom(34, "-region_soil_K0", "-1"), ["-region_soil_K0 -1"]),
    (custom(38, "-dimension", "1", "-gravity_angle", "10"), ["-gravity_angle 10", "one direction"]),
    (custom(35, "-region_soil_stress", "1,2,3"), ["-region_soil_stress", "3 numbers", "4"]),
    (custom(36, "-body_plate_contour", "0.2,0.1"), ["-body_plate_contour", "nearer"]),
    # what makes no sense together
    (["-scene", "pipe", "-pipe_diameter", "37.5"], ["-pipe_diameter 37.5", "0.001 to 20", "in m"]),
    (["-scene", "pipe", "-pipe_diameter", "1e-12"], ["-pipe_diameter 1e-12"]),
    (["-scene", "pipe", "-pipe_domain_depth_below", "2", "-pipe_end_displacement", "1.5"],
     ["-pipe_domain_depth_below 2", "0.5 D below", "-pipe_end_displacement 1.5", "deeper"]),
    (["-scene", "pipe", "-sand_void_ratio", "0.3"], ["-sand_void_ratio 0.3", "relative density"]),
    (["-scene", "pipe", "-check_reactions", "0.3,0.1"], ["-check_reactions", "0.3,0.1", "rising"]),
    # what a run goes on from: checkpoints that are of no use are in tests/parallel/checkpoint_test.cpp
    (["-scene", "mms1d", "-restart", "FILES/none.h5"], ["-restart", "none.h5", "No such file"]),
    (["-scene", "mms1d", "-restart", "FILES/plain.opts"], ["-restart", "plain.opts", "no HDF5"]),
    (["-scene", "mms1d", "-restart"], ["-restart", "needs a value"]),
    (["-scene", "mms1d", "-wall_time_limit", "0"], ["-wall_time_limit 0", "min"]),
    (["-scene", "mms1d", "-checkpoint_every", "-1"], ["-checkpoint_every -1", "steps"]),
    (point("restart", "-restart", "auto"), ["-restart", "unknown"]),
    (["-scene", "cut_cell", "-checkpoint_every", "10", "-output_dir", "OUT/cut_cell"],
     ["-checkpoint_every", "unknown"]),
]
FILES = {
    "custom.opts": b"""-domain 0,0,1,1
-cell_size 0.1
-walls roller,roller,fixed,free
-regions soil
-region_soil_box 0,0,1,0.5
-region_soil_material elastic
-bodies plate
-body_plate_box 0.2,0.6,0.8,0.7
-stage_run_until 0.01
""",
    "motion.csv": b"0 0 0\n1 fast 0\n",
    "plain.opts": b"-scene mms1d\n-cells 32\n",
    "twice.opts": b"-scene mms1d\n-cells 32\n# again\n-cells 64\n",
    "nested.opts": b"-scene mms1d\n-options_file plain.opts\n",
    "binary.opts": bytes(range(256)),
    "prose.txt": b"Dear reader,\nthis is a letter.\n",
    "leg.csv": b"increments,strain_xx,strain_yy,strain_zz\n5,0,0.1,0\n",
    "no_legs.csv": b"increments,strain_xx,strain_yy,strain_zz\n",
    "word.csv": b"increments,strain_xx,strain_yy,strain_zz\n\n5,0,much,0\n",
    "field.csv": b"increments,strain_xx,strain_yy,strain_zz\n5,0,0.1\n",
    "shared_line.opts": b"-scene mms1d\n-cells 32 -courant 0.3\n",
}
# Fits on three ranks: 4 cells and 2 of air, 9 nodes, 3 of them for each rank.
TOO_MANY_RANKS = (["-scene", "column", "-cells", "4", "-output_dir", "OUT/column"],
                  ["4 ranks", "largest", "3"])
# A single linear cell has two nodes per direction, as many as a rank needs.
ONE_CELL = (["-scene", "triaxial", "-output_dir", "OUT/triaxial"],
            ["2 ranks are too many", "largest", "is 1"])
STABILITY_ON_RANKS = (["-scene", "stability", "-output_dir", "OUT/stability"],
                      ["2 ranks", "stability", "one"])
STABILITY_WITH_RATE = (["-scene", "stability", "-flip_time", "0.1", "-output_dir", "OUT/stability"],
                       ["-flip_time", "leave it out"])


class Driver:
    def __init__(self, launcher, program, base):
        self.launcher, self.program = os.path.abspath(launcher), os.path.abspath(program)
        self.base = base
        self.failed = 0
        (base / "files").mkdir()
        for name, content in FILES.items():
            (base / "files" / name).write_bytes(content)

    def run(self, ranks, arguments, environment=None):
        places = {"FILES": str(self.base / "files"), "OUT": str(self.base / "out")}
        for key, place in places.items():
            arguments = [place + a[len(key):] if a.startswith(key) else a for a in arguments]
        return subprocess.run([self.launcher, str(ranks), self.program, *arguments],
                              cwd=self.base, timeout=SECONDS, text=True, check=False,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env={**os.environ, **(environment or {})})

    def check(self, ranks, arguments, holds):
        """holds: list of (claim, bool); prints what does not hold."""
        broken = [claim for claim, true in holds if not true]
        self.failed += bool(broken)
        print(f"{'FAIL' if broken else 'ok  '} {ranks} ranks: {' '.join(arguments)}")
        for claim in broken:
            print(f"     {claim}")

    def refuse(self, ranks, arguments, words):
        try:
            result = self.run(ranks, arguments)
        except subprocess.TimeoutExpired:
            self.check(ranks, arguments, [("it hangs", False)])
            return
        _, _, message = result.stdout.partition(PREFIX)
        message = message.partition("\n---")[0]  # what the launcher adds
        holds = [(f"exit code {result.returncode}", result.returncode == EXIT_BAD_INPUT),
                 ("not one message", result.stdout.count(PREFIX) == 1),
                 ("PETSc complains too", "PETSC ERROR" not in result.stdout),
                 ("it began to run", not (self.base / "out" / "mms1d" / "history.csv").exists())]
        holds += [(f"'{word}' is not in the message", word in message) for word in words]
        self.check(ranks, arguments, holds)
        if not all(true for _, true in holds):
            print(result.stdout)

    def accept(self, ranks, arguments, environment, words, option=None):
        """Runs to the end, prints the words, and has the option in used.opts."""
        out = self.base / "accepted"
        result = self.run(ranks, ["-scene", "mms1d", "-cells", "16", "-output_dir", str(out),
                                  *arguments], environment)
        used = [line.split()[:2] for line in
                (out / "used.opts").read_text(encoding="utf-8").splitlines()]
        holds = [(f"exit code {result.returncode}", result.returncode == 0),
                 (f"used.opts has not {option}", not option or option in used)]
        holds += [(f"'{word}' is not in the output", word in result.stdout) for word in words]
        self.check(ranks, [*arguments, *environment.values()], holds)


def main():
    launcher, program, ranks = sys.argv[1:]
    with tempfile.TemporaryDirectory() as directory:
        driver = Driver(launcher, program, pathlib.Path(directory))
        with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as pool:
            list(pool.map(lambda case: driver.refuse(int(ranks), *case), CASES))
        if int(ranks) > 1:
            driver.refuse(4, *TOO_MANY_RANKS)
            driver.refuse(2, *ONE_CELL)
            driver.refuse(2, *STABILITY_ON_RANKS)
        else:
            driver.refuse(1, *STABILITY_WITH_RATE)
        driver.accept(ranks, [], {"PETSC_OPTIONS": "-amplitude 0.1"}, [], ["-amplitude", "0.05"])
        driver.accept(ranks, ["-options_file", "files/plain.opts"], {}, [], ["-cells", "16"])
        driver.accept(ranks, ["-log_view"], {}, ["PETSc Performance Summary"])
        driver.accept(ranks, ["-cells", "16"], {}, [], ["-cells", "16"])
    return 1 if driver.failed else 0


if __name__ == "__main__":
    sys.exit(main())
