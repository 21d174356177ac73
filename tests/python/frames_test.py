"""Compares frames of tools/python/raywatt with the files they were read from; ends with 77 if pandas is missing."""
import csv
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

if importlib.util.find_spec("pandas") is None:
    print("skipped: no pandas (Debian's python3-pandas)")
    sys.exit(77)
import raywatt

PROGRAM = sys.argv.pop(1)
EXAMPLES = pathlib.Path(raywatt.__file__).parents[1] / "examples"
WORK = tempfile.TemporaryDirectory()
SWEEP = """schema: raywatt-sweep/1
scene: cornell
resolution: 16x16
axes:
  cores: [1, 2]
  tni.trv.l1.size: [4 KiB, 16 KiB]
"""
SEARCH = """schema: raywatt-optimise/1
scene: cornell
resolution: 16x16
axes:
  cores: [1, 2]
  tni.trvs: [1, 2, 4]
objectives:
  - max: perf.fps
budget: 4
"""


def run(*arguments):
    return subprocess.run(arguments, cwd=WORK.name, check=True, capture_output=True, text=True).stdout


def row(figure, measured, published, scene="chess"):
    return {"experiment": "figure 7", "scene": scene, "setting": "super", "figure": figure, "measured": measured,
            "published": published}


class Loaded(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        run(PROGRAM, "run", "--scene", "cornell", "--resolution", "16x16", "--frames", "0:1", "--program",
            "multirate:under", "--quiet", "-o", "run")
        cls.folder = pathlib.Path(WORK.name, "run")
        cls.report = json.loads((cls.folder / "report.json").read_text())
        cls.loaded = raywatt.load(cls.folder)

    def test_totals_are_those_of_the_report(self):
        totals = self.report["totals"]
        self.assertEqual(self.loaded.totals["cycles"], totals["cycles"])
        self.assertEqual(self.loaded.totals["energy_by_block_mj.dram.high"], totals["energy_by_block_mj"]["dram"]["high"])
        self.assertEqual(self.loaded.totals["top_down.cores.1.kernels"], totals["top_down"]["cores"][1]["kernels"])
        self.assertFalse([path for path in self.loaded.totals.index if path.startswith("kernels")])

    def test_frames_have_a_row_each(self):
        self.assertEqual(list(self.loaded.frames.index), [0, 1])
        self.assertEqual(self.loaded.frames["cycles"].sum(), self.report["totals"]["cycles"])
        self.assertIsInstance(self.loaded.frames["sampling.tiles.similar_ratio"][0], list)

    def test_tiles_sum_to_the_report(self):
        tiles = self.loaded.tiles
        self.assertEqual(sorted(set(tiles["frame"])), [0, 1])
        self.assertEqual(tiles["steps"].sum(), self.report["totals"]["traversal_steps"])
        self.assertTrue((tiles["finished"] > tiles["dispatched"]).all())
        rest = sum(frame["energy_mj_nominal"] for frame in tiles.attrs["rest"])
        self.assertGreater(rest, 0)
        self.assertAlmostEqual(tiles["energy_mj_nominal"].sum() + rest, self.report["totals"]["energy_mj"]["nominal"])

    def test_units_have_every_reason_and_counter(self):
        units = self.loaded.units
        self.assertEqual(list(units.columns), ["unit", "kind", "name", "value"])
        trv = self.report["units"]["core0"]["tni"]["trv0"]
        of_trv = units[units["unit"] == "core0.tni.trv0"]
        for kind, names in (("why", trv["why"]), ("counter", trv["counters"])):
            rows = of_trv[of_trv["kind"] == kind]
            self.assertEqual(dict(zip(rows["name"], rows["value"])), names)
        reasons = units[units["kind"] == "why"].groupby("unit")["value"].sum()
        elapsed = units[units["kind"] == "elapsed"].set_index("unit")["value"]
        self.assertEqual(reasons.to_dict(), elapsed.to_dict())
        self.assertGreater(len(elapsed), 10)

    def test_kernels_have_a_row_each(self):
        kernels = self.report["totals"]["kernels"]
        self.assertEqual(list(self.loaded.kernels.index), list(kernels))
        for figure in ("ii", "cycles", "share"):
            self.assertEqual(list(self.loaded.kernels[figure]), [kernel[figure] for kernel in kernels.values()])

    @unittest.skipIf(importlib.util.find_spec("zstandard") is None, "no zstandard (Debian's python3-zstandard)")
    def test_intervals_add_up_to_the_units(self):
        intervals = self.loaded.intervals
        self.assertEqual(list(intervals.columns),
                         ["frame", "interval", "begin_us", "end_us", "unit", "kind", "name", "value"])
        units = self.loaded.units[self.loaded.units["kind"] != "elapsed"].set_index(["unit", "kind", "name"])["value"]
        key = ["unit", "kind", "name"]
        summed = intervals.groupby(key, observed=True)["value"].sum()
        most = intervals.groupby(key, observed=True)["value"].max()
        self.assertEqual(len(summed), len(units))
        for unit, value in units.items():
            is_peak = unit[2] in ("slots_peak", "read_latency_max")
            self.assertEqual((most if is_peak else summed)[unit], value, unit)

    @unittest.skipIf(importlib.util.find_spec("zstandard") is None, "no zstandard (Debian's python3-zstandard)")
    def test_intervals_fill_their_frames(self):
        intervals = self.loaded.intervals
        self.assertEqual(sorted(intervals["frame"].unique()), [0, 1])
        for frame, rows in intervals.groupby("frame"):
            time_us = self.loaded.frames["time_ms"][frame] * 1e3
            self.assertAlmostEqual(rows["end_us"].max(), time_us, places=9)
            one = rows[(rows["unit"] == "core0.tni.ist") & (rows["name"] == "tests")].sort_values("interval")
            self.assertEqual(list(one["begin_us"])[1:], list(one["end_us"])[:-1])
            self.assertEqual(one["begin_us"].iloc[0], 0)
            cycles = rows[(rows["unit"] == "core0.tni.ist") & (rows["kind"] == "why")].groupby("interval")["value"].sum()
            self.assertEqual(cycles.iloc[0], round(one["end_us"].iloc[0] * 500))

    def test_intervals_of_another_run_are_refused(self):
        run(PROGRAM, "run", "--scene", "cornell", "--resolution", "16x16", "--quiet", "-o", "other")
        file = pathlib.Path(WORK.name, "other", "intervals.bin.zst")
        own = file.read_bytes()
        file.write_bytes(self.loaded.folder.joinpath("intervals.bin.zst").read_bytes())
        with self.assertRaisesRegex(ValueError, "other/intervals.bin.zst: does not add up to the report beside it"):
            raywatt.load(file.parent).intervals
        for damaged in (own[:-9], own[:30] + bytes([own[30] ^ 255]) + own[31:], b"nothing"):
            file.write_bytes(damaged)
            with self.assertRaisesRegex(ValueError, "other/intervals.bin.zst: is damaged"):
                raywatt.load(file.parent).intervals

    def test_a_run_is_named_by_its_report_too_and_says_briefly_what_it_is(self):
        self.assertEqual(raywatt.load(self.loaded.folder / "report.json").folder, self.loaded.folder)
        self.assertLess(len(repr(self.loaded)), 200)

    def test_intervals_that_are_not_there_are_said(self):
        run(PROGRAM, "run", "--scene", "cornell", "--resolution", "16x16", "--intervals", "off", "--quiet", "-o", "none")
        with self.assertRaisesRegex(ValueError, "none/intervals.bin.zst: is not there"):
            raywatt.load(pathlib.Path(WORK.name, "none")).intervals

    def test_another_schema_is_refused_by_the_name_of_the_file(self):
        other = pathlib.Path(WORK.name, "other")
        other.mkdir()
        (other / "report.json").write_text('{"schema": "raywatt-rays/1"}')
        with self.assertRaisesRegex(ValueError, "other/report.json: schema 'raywatt-rays/1'"):
            raywatt.load(other)

    def test_figures_have_the_names_of_the_command_line(self):
        totals = self.loaded.totals
        self.assertEqual(totals["fps"], totals["perf.fps"])
        self.assertEqual(totals["totals.perf.fps"], totals["perf.fps"])
        self.assertEqual(totals["power_w"], totals["power_w.nominal"])
        with self.assertRaisesRegex(KeyError, "'cycles_total'"):
            totals["cycles_total"]

    def test_another_folder_is_refused_in_one_line(self):
        folder = pathlib.Path(WORK.name, "no-run")
        folder.mkdir(exist_ok=True)
        with self.assertRaisesRegex(ValueError, "no-run: has no report.json; allowed: "):
            raywatt.load(folder)
        (folder / "sweep.json").write_text("{}")
        with self.assertRaisesRegex(ValueError, "no-run: has sweep.json and no report.json; use raywatt.load_sweep"):
            raywatt.load(folder)

    def test_trace_info_is_what_the_program_says(self):
        run(PROGRAM, "trace", "record", "--scene", "cornell", "--resolution", "16x16", "a.trace")
        file = pathlib.Path(WORK.name, "a.trace")
        info = raywatt.load_trace_info(file, PROGRAM)
        self.assertEqual(info["bytes"], file.stat().st_size)
        self.assertEqual(info["function.render.width"], "16")
        with self.assertRaisesRegex(ValueError, "is no trace"):
            raywatt.load_trace_info(self.folder / "report.json", PROGRAM)


class Sweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        pathlib.Path(WORK.name, "s.yaml").write_text(SWEEP)
        run(PROGRAM, "sweep", "run", "s.yaml", "-o", "sweep", "--store", "store")
        cls.points = raywatt.load_sweep(pathlib.Path(WORK.name, "sweep"))

    def test_points_are_the_rows_of_the_table(self):
        with open(pathlib.Path(WORK.name, "sweep", "results.csv"), newline="") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual(list(self.points.index), [0, 1, 2, 3])
        self.assertEqual(list(self.points["totals.cycles"]), [int(row["totals.cycles"]) for row in rows])
        self.assertEqual(list(self.points["tni.trv.l1.size"]), ["4 KiB", "16 KiB"] * 2)

    def test_columns_have_the_names_of_the_command_line(self):
        self.assertEqual(list(self.points["perf.fps"]), list(self.points["totals.perf.fps"]))
        self.assertEqual(list(self.points["power_w"]), list(self.points["totals.power_w.nominal"]))

    def test_values_equal_the_table_to_the_last_digit(self):
        folder = pathlib.Path(WORK.name, "digits")
        folder.mkdir()
        digits = ["0.1234567890123456", "7.656713209432834e-05", "123456789.12345679"]
        names = ["NA", "null", "nan"]
        lines = [f"{n},{name},{value}" for n, (name, value) in enumerate(zip(names, digits))]
        (folder / "results.csv").write_text("\n".join(["n,scene.camera,totals.time_ms", *lines, "3,x,"]) + "\n")
        points = raywatt.load_sweep(folder)
        self.assertEqual(list(points["totals.time_ms"][:3]), [float(value) for value in digits])
        self.assertTrue(points["totals.time_ms"].isna()[3])
        self.assertEqual(list(points["scene.camera"]), [*names, "x"])

    def test_machines_have_aggregates_and_values_per_workload(self):
        text = SWEEP.replace("scene: cornell\n", "workloads: [cornell, teapot]\n").replace("  tni.trv.l1.size: [4 KiB, 16 KiB]\n", "")
        pathlib.Path(WORK.name, "set.yaml").write_text(text)
        run(PROGRAM, "sweep", "run", "set.yaml", "-o", "set", "--store", "store")
        folder = pathlib.Path(WORK.name, "set")
        machines, points = raywatt.load_sweep(folder, machines=True), raywatt.load_sweep(folder)
        self.assertEqual(list(machines["cores"]), [1, 2])
        for machine, cores in machines["cores"].items():
            rates = points[points["cores"] == cores].set_index("workload")["totals.perf.fps"]
            self.assertEqual(machines["worst(fps)"][machine], rates.min())
            self.assertAlmostEqual(machines["mean(perf.fps)"][machine], rates.mean(), delta=1e-9 * rates.mean())
            self.assertEqual(machines["on(teapot, fps)"][machine], rates["teapot"])
        with self.assertRaisesRegex(ValueError, "machines.csv: is not there; allowed: a sweep over several workloads"):
            raywatt.load_sweep(pathlib.Path(WORK.name, "sweep"), machines=True)

    def test_a_folder_without_a_table_is_refused(self):
        with self.assertRaisesRegex(ValueError, "results.csv: is not there; `raywatt sweep collect "):
            raywatt.load_sweep(pathlib.Path(WORK.name))

    def test_the_example_tells_the_fastest_first(self):
        shown = run(sys.executable, "-B", EXAMPLES / "explore_sweep.py", "sweep").splitlines()
        fastest = self.points["totals.perf.fps"].idxmax()
        self.assertEqual(shown[2].split()[0], str(fastest))


class Search(unittest.TestCase):
    def test_points_are_those_of_the_history(self):
        pathlib.Path(WORK.name, "o.yaml").write_text(SEARCH)
        run(PROGRAM, "optimise", "o.yaml", "-o", "search", "--store", "store")
        folder = pathlib.Path(WORK.name, "search")
        history = [json.loads(line) for line in (folder / "history.jsonl").read_text().splitlines()]
        points = raywatt.load_search(folder)
        self.assertEqual(len(points), len(history))
        self.assertEqual(list(points["id"]), [point["id"] for point in history])
        with self.assertRaisesRegex(ValueError, "history.jsonl: is not there"):
            raywatt.load_search(pathlib.Path(WORK.name))


def varint(value):
    low = [value >> shift & 127 for shift in range(0, max(1, value.bit_length()), 7)]
    return bytes([digit | 128 for digit in low[:-1]] + low[-1:])


@unittest.skipIf(importlib.util.find_spec("zstandard") is None, "no zstandard (Debian's python3-zstandard)")
class HostileIntervals(unittest.TestCase):
    NAMES = b"raywatt-intervals/1\n" + b"\1\1\1u\1\1r\0"  # one frame, unit "u" with the reason "r", no counter

    def refused(self, *blocks):
        import zstandard
        file = pathlib.Path(WORK.name, "intervals.bin.zst")
        file.write_bytes(b"".join(zstandard.ZstdCompressor().compress(block) for block in blocks))
        with self.assertRaisesRegex(ValueError, "intervals.bin.zst: ") as caught:
            raywatt._intervals.load(file.parent, None)
        return str(caught.exception)

    def test_sizes_are_bounded(self):
        self.assertIn("over 64 bits", self.refused(self.NAMES, b"\xff" * 20_000_000 + b"\1"))
        self.assertIn("a number over", self.refused(self.NAMES[:20] + b"\xff" * 20_000_000))
        self.assertIn("unpacks to over 128 MiB", self.refused(self.NAMES, bytes(200_000_000)))
        frame = b"".join(map(varint, (0, 10**9, 10**15, 1_000_000, 0)))
        self.assertIn("over 2048 intervals", self.refused(self.NAMES, frame))


class Reproduced(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(WORK.name, "paper")
        cls.folder.mkdir()
        rows = [row("time_ratio", 0.5, None), row("tni_power", 1.02, [1.0, 1.09]), row("tni_perf_per_watt", 2, 1.5),
                row("time_ratio", None, None, "car"), row("tni_power", None, [1.0, 1.09], "car"),
                row("tni_perf_per_watt", None, None, "car")]
        (cls.folder / "reproduce.json").write_text(json.dumps({"schema": "raywatt-reproduce/1", "rows": rows}))

    def test_published_figures_are_ranges(self):
        rows = raywatt.load_reproduce(self.folder)
        self.assertEqual(list(rows["published_low"][1:3]), [1.0, 1.5])
        self.assertEqual(list(rows["published_high"][1:3]), [1.09, 1.5])
        self.assertTrue(rows["published_low"].isna()[0] and rows["measured"].isna()[3])

    @unittest.skipIf(importlib.util.find_spec("matplotlib") is None, "no matplotlib (Debian's python3-matplotlib)")
    def test_the_example_draws_figure_7(self):
        os.environ["MPLCONFIGDIR"] = WORK.name
        shown = run(sys.executable, "-B", EXAMPLES / "figure_7.py", "paper", "figure.svg")
        self.assertIn("1.02", shown)
        self.assertIn("<svg", pathlib.Path(WORK.name, "figure.svg").read_text())


if __name__ == "__main__":
    unittest.main()
