"""What tools/bench makes of logs, measurements and tables; runs nothing else."""

import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from benchmarks import model, pages, particles, phases, tables  # noqa: E402

LOG = """Stage Name,Event Name,Rank,Count,Time,Num Messages,Message Length,Num Reductions,FLOP
Main Stage,summary,0,1,9.0,8.,7.,2.,2.
Main Stage,PetscBarrier,0,0,0.,0.,0.,0.,0.
loading,mpm: update velocities, remap,0,10,1.5e-01,0.,0.,0.,0.
loading,mpm: update velocities, remap,1,10,0.25,0.,0.,0.,0.
geostatic,mpm: update velocities, remap,1,10,0.1,0.,0.,0.,0.
Main Stage,mpm: halo sum,0,1,0.7,6.,24.,3.,0.
loading,mpm: output,0,1,0.7,6.,24.,3.,0.
loading,mpm: halo sum,0,10,0.2,6.,24.,3.,0.
loading,mpm: halo sum,1,10,0.4,6.,24.,3.,0.
loading,SFReduceEnd,0,10,0.2,6.,24.,3.,0.
"""


class Phases(unittest.TestCase):
    def test_events_are_means_over_ranks_and_sums_over_stages(self):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "log.csv"
            path.write_text(LOG, encoding="utf-8")
            events = phases.read_events(path)
        shares = phases.shares_of(events, 0.5)
        self.assertAlmostEqual(shares["update velocities, remap"], 0.5)
        self.assertAlmostEqual(shares["halo sum"], 0.6)
        self.assertAlmostEqual(shares["all exchange"], 0.6)
        self.assertAlmostEqual(shares["star forests"], 0.2)
        self.assertNotIn("output", shares)

    def test_a_log_without_phases_has_star_forests_only(self):
        self.assertEqual(list(phases.shares_of({"SFBcastEnd": 1.0}, 4.0)), ["star forests"])


class Model(unittest.TestCase):
    KNOWN = model.Costs({"elastic 2D": 2e-7}, {2: 1e-8}, 3e-6, 1e-10, model.Network(1e-6, 5e9))
    CASE = model.Case("", 2, 640, "elastic 2D")

    def test_a_line_is_found_again(self):
        start, per_byte = model.fit_line([(x, 3.0 + 0.25 * x) for x in (1.0, 5.0, 40.0)])
        self.assertAlmostEqual(start, 3.0)
        self.assertAlmostEqual(per_byte, 0.25)

    def test_ranks_are_spread_over_all_directions(self):
        self.assertEqual(model.processes(1024, 2), [32, 32])
        self.assertEqual(sorted(model.processes(32, 3)), [2, 4, 4])

    def test_a_part_in_the_middle_has_three_layers_all_around(self):
        self.assertEqual(model.halo_nodes([10, 20], [4, 4]), 16 * 26 - 200)
        self.assertEqual(model.halo_nodes([10, 20], [1, 2]), 10 * 3)

    def test_one_rank_pays_for_no_exchange(self):
        parts = model.step(self.CASE, 1, model.CLUSTER, self.KNOWN)
        self.assertEqual(parts["halo"] + parts["allreduce"] + parts["imbalance"], 0.0)
        self.assertAlmostEqual(parts["particles"], 4 * 640 * 640 * 2e-7)

    def test_four_ranks_pay_four_exchanges_with_three_neighbours(self):
        parts = model.step(self.CASE, 4, model.Network(2e-6, 1e9), self.KNOWN)
        nodes = 323 * 323 - 320 * 320
        expected = 4 * (3e-6 + 3 * 2e-6) + 8 * 13 * nodes * (1e-10 + 1e-9)
        self.assertAlmostEqual(parts["halo"], expected)

    def test_parts_too_narrow_are_refused(self):
        self.assertIsNone(model.step(model.Case("", 2, 50, "elastic 2D"), 1024, model.CLUSTER,
                                     self.KNOWN))


class Tables(unittest.TestCase):
    def test_a_slope_is_that_of_the_line(self):
        self.assertAlmostEqual(particles.slope([(1.0, 2.0), (2.0, 4.5), (4.0, 9.5)]), 2.5)

    def test_rows_are_compared_by_their_keys(self):
        table = tables.Table("", ("case",), ("time",))
        new, old = [{"case": "b", "time": "3"}, {"case": "c", "time": "1"}], \
            [{"case": "a", "time": "1"}, {"case": "b", "time": "2"}]
        self.assertEqual(list(tables.lines(table, new, old)),
                         [("b", "time", "3", "2", "1.50"), ("c", "time", "1", "-", "-")])

    def test_every_mark_of_the_pages_has_a_maker(self):
        for page in pages.PAGES:
            text = (ROOT / page).read_text(encoding="utf-8")
            names = [mark["name"] for mark in pages.MARK.finditer(text)]
            self.assertTrue(names)
            self.assertLessEqual(set(names), pages.MAKERS.keys())


if __name__ == "__main__":
    unittest.main()
