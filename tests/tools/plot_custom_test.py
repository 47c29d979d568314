"""plot_custom_test.py LAUNCHER PROGRAM: tools/plot draws what a scene put together by options has
done, on a line, in the plane and in space."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
try:
    import h5py  # noqa: F401
    import matplotlib.image
    import numpy as np
except ImportError as missing:
    print(missing)
    sys.exit(SKIPPED)

sys.path.insert(0, str(ROOT / "tools"))
from matplotlib.path import Path  # noqa: E402
from plotting import custom_bodies, custom_curves, custom_fields  # noqa: E402
from plotting.run import Run  # noqa: E402

PROGRAM = sys.argv.pop()
LAUNCHER = sys.argv.pop()

PLANE = """
-dimension 2
-domain -2,-1.25,2,0.75
-cell_size 0.125
-walls roller,roller,fixed,free
-regions low,high
-region_low_layer -1.25,0
-region_low_material von_mises
-region_high_layer -0.5,0
-region_high_material von_mises
-bodies plough,stone
-body_plough_polygon -1,-0.3,-0.7,0.5,-1.2,0.5
-body_plough_motion MOTION
-body_stone_ball 0.7,-0.6,0.2
-stages push
-stage_push_until 0.1
-watch 0,-0.1
"""
MOTION = "0 0.5 0 -0.5\n1 0.5 0 -0.5\n"  # m/s and rad/s, which begin at once
LINE = """
-dimension 1
-domain 0,2.4
-cell_size 0.1
-walls fixed,free
-regions low,high
-region_low_box 0,1
-region_low_material elastic
-region_high_box 1,2
-region_high_material elastic
-bodies plate
-body_plate_plane 2,-1
-body_plate_velocity -0.5
-stages push
-stage_push_until plate:0.02
-watch 1.5
"""
SPACE = """
-dimension 3
-domain 0,-0.4,0,0.6,0.2,0.6
-cell_size 0.1
-walls symmetry,roller,fixed,free,symmetry,roller
-regions clay
-region_clay_layer -0.4,0
-region_clay_material von_mises
-bodies ball
-body_ball_ball 0,0.1,0,0.1
-body_ball_velocity 0,-1,0
-stages push
-stage_push_until ball:0.02
"""


def made_body(kind, numbers, dimension, position, angle=0.0):
    return custom_bodies.Body("made", kind, np.array(numbers, dtype=float), dimension,
                              np.array(position, dtype=float), angle, 10.0)


def is_blank(picture):
    pixels = matplotlib.image.imread(picture)[..., :3]
    return np.mean(pixels.min(axis=2) < 0.9) < 0.01


class Runs(unittest.TestCase):
    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.directory = pathlib.Path(made.name)

    def run_scene(self, options):
        motion, file = self.directory / "motion.txt", self.directory / "scene.opts"
        motion.write_text(MOTION, encoding="utf-8")
        file.write_text("-scene custom\n" + options.replace("MOTION", str(motion)),
                        encoding="utf-8")
        command = [LAUNCHER, "2", PROGRAM, "-options_file", file, "-progress", "off",
                   "-output_dir", self.directory / "out"]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return Run(str(self.directory / "out"))

    def plot(self, run):
        done = subprocess.run([sys.executable, str(ROOT / "tools/plot"), run.directory],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")
        for name in ("curves.png", "fields.png"):
            self.assertFalse(is_blank(run.path(name)), name)

    def test_plane(self):
        run = self.run_scene(PLANE)
        self.plot(run)
        self.check_outlines(run)
        self.check_curves(run)
        pathlib.Path(run.path("summary.json")).unlink()
        self.plot(Run(run.directory))  # as of a run that is not over

    def check_outlines(self, run):
        """The last output: both bodies are where they have moved, and the ground is beside them."""
        frame = custom_fields.Frame(run, run.outputs()[-1], None)
        time = frame.output.time
        stone, plough = frame.outlines["stone"], frame.outlines["plough"]
        np.testing.assert_allclose(np.linalg.norm(stone - [0.7, -0.6], axis=1), 0.2)
        start = np.array([[-1, -0.3], [-0.7, 0.5], [-1.2, 0.5]])
        middle, angle = start.mean(axis=0), -0.5 * time
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        expected = (start - middle) @ turn.T + middle + [0.5 * time, 0]
        np.testing.assert_allclose(plough, expected, atol=1e-6)
        for corners in (stone, plough):
            inner = corners.mean(axis=0) + 0.7 * (corners - corners.mean(axis=0))
            self.assertFalse(Path(inner).contains_points(frame.points).any())

    def check_curves(self, run):
        history = custom_curves.History(run)
        titles = [title for title, _, _ in custom_curves.panels_of(run, history)]
        self.assertEqual(titles, ["plough", "plough: moment", "stone, stands still",
                                  "Watched points"])
        direction, way = custom_curves.way_of(history.position("plough"))
        np.testing.assert_allclose(direction, [1, 0], atol=1e-6)
        self.assertAlmostEqual(way[-1], 0.05, delta=0.001)
        self.assertGreater(np.mean(-history.force("plough") @ direction), 0.0)

    def test_line(self):
        self.plot(self.run_scene(LINE))

    def test_space(self):
        run = self.run_scene(SPACE)
        self.plot(run)
        history = custom_curves.History(run)
        self.assertEqual(custom_curves.part_of(run, history, "ball"), " (modelled quarter)")


class Outlines(unittest.TestCase):
    def test_box_turns_about_its_middle(self):
        corners = made_body("box", [0, 0, 4, 2], 2, [1, 5], np.pi / 2).outline()
        np.testing.assert_allclose(corners.min(axis=0), [0, 3], atol=1e-12)
        np.testing.assert_allclose(corners.max(axis=0), [2, 7])

    def test_plane_fills_what_is_behind_it(self):
        half = Path(made_body("plane", [0, 2, 0, -1], 2, [0, 1.5]).outline())
        self.assertTrue(half.contains_point([3, 1.6]))
        self.assertFalse(half.contains_point([3, 1.4]))

    def test_layer_lies_between_its_heights(self):
        corners = made_body("layer", [-1, 3], 2, [0, 2]).outline()
        self.assertEqual(sorted(set(corners[:, 1])), [0, 4])

    def test_centre_of_an_l(self):
        corners = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
        np.testing.assert_allclose(custom_bodies.centroid(corners), [5 / 6, 5 / 6])
        np.testing.assert_allclose(custom_bodies.centroid(corners[::-1]), [5 / 6, 5 / 6])

    def test_slices(self):
        ball = made_body("ball", [0, 0, 0, 5], 3, [1, 1, 2])
        np.testing.assert_allclose(np.linalg.norm(ball.outline(5) - 1, axis=1), 4)
        self.assertIsNone(ball.outline(8))
        box = made_body("box", [0, 0, 0, 2, 2, 2], 3, [1, 1, 1])
        self.assertEqual(box.outline(1.5).max(), 2)
        self.assertIsNone(box.outline(2.5))
        slope = Path(made_body("plane", [0, 0, 0, 0, 1, 1], 3, [0, 0, 0]).outline(1))
        self.assertTrue(slope.contains_point([0, -1.1]))
        self.assertFalse(slope.contains_point([0, -0.9]))

    def test_ends_on_a_line(self):
        np.testing.assert_allclose(made_body("ball", [0, 2], 1, [5]).outline(), [3, 7])
        np.testing.assert_allclose(made_body("plane", [2, -1], 1, [2]).outline(), [2, 12])


class Ways(unittest.TestCase):
    def test_to_and_fro_has_signs(self):
        x = np.array([0, 1, 2, 1, -1, 0.0])
        direction, way = custom_curves.way_of(np.column_stack([3 - x, 0 * x]))
        np.testing.assert_allclose(direction, [-1, 0])
        np.testing.assert_allclose(way, x)

    def test_a_curved_way_has_no_direction(self):
        turn = np.linspace(0, 2, 20)
        direction, way = custom_curves.way_of(np.column_stack([np.cos(turn), np.sin(turn)]))
        self.assertIsNone(direction)
        self.assertAlmostEqual(way[-1], 2 * np.sin(1))

    def test_time_goes_on_where_the_clock_begins_anew(self):
        time, restarts = custom_curves.running_on(np.array([1, 2, 3, 0.5, 1.5]))
        np.testing.assert_allclose(time, [1, 2, 3, 3.5, 4.5])
        np.testing.assert_allclose(restarts, [3])


if __name__ == "__main__":
    unittest.main()
