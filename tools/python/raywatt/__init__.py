"""Results of the Raywatt simulator as pandas frames.

    import raywatt
    run = raywatt.load("out/demo")
    run.totals["energy_mj.nominal"]
    run.units.query("kind == 'why'").groupby("name")["value"].sum()

Names are those of the files (docs/report.md); nested names are joined by dots, as in results.csv of a sweep. Figures
may also be named as on the command line: run.totals["fps"], points["perf.fps"].
"""
import dataclasses
import functools
import json
import pathlib
import subprocess

import pandas

from . import _intervals
from ._figures import FigureFrame, FigureSeries

__all__ = ["Run", "load", "load_reproduce", "load_search", "load_sweep", "load_trace_info"]


@dataclasses.dataclass(frozen=True)
class Run:
    """Content of a report.json.

    totals   figures of all frames together: a series by path, without kernels
    frames   the same figures per frame: one row per frame
    units    a row for each cycle reason and counter of each unit: unit, kind (elapsed, why or counter), name, value
    kernels  one row per kernel, by name
    tiles    a row for each entry of a frame's tile list: frame, then the columns of tiles.json; .attrs["rest"] has each
             frame's figures without a tile; None if the run has no tiles.json
    report   the whole file as dictionaries and lists
    folder   folder of the report

    Read from a second file on first use:
    intervals  increase of each reason and counter in each interval of simulated time (docs/intervals.md): a row for each
               frame, interval, unit and name, with begin_us and end_us of the interval, kind and value. Needs zstandard
               (Debian's python3-zstandard); a whole run has millions of rows.
    """

    totals: pandas.Series
    frames: pandas.DataFrame
    units: pandas.DataFrame
    kernels: pandas.DataFrame
    report: dict
    folder: pathlib.Path
    tiles: pandas.DataFrame = None

    @functools.cached_property
    def intervals(self):
        return _intervals.load(self.folder, self.units)

    def __repr__(self):
        return (f"Run({str(self.folder)!r}: {self.report.get('program')}, {len(self.frames)} frames, "
                f"{len(self.units)} values of units)")


def load(folder):
    """Loads the run in a folder of `raywatt run` or `raywatt trace replay`, given as the folder or as its report.json."""
    folder = pathlib.Path(folder)
    if folder.name == "report.json" and not folder.is_dir():
        folder = folder.parent
    if not (folder / "report.json").exists():
        raise ValueError(_no_run(folder))
    report = _read(folder / "report.json", "raywatt-report/1")
    return Run(
        totals=FigureSeries(_flat(_without_kernels(report["totals"])), dtype=object, name=str(folder)),
        frames=pandas.DataFrame([_flat(_without_kernels(frame)) for frame in report["frames"]]).set_index("frame"),
        units=pandas.DataFrame(_unit_rows(report["units"]), columns=["unit", "kind", "name", "value"]),
        kernels=pandas.DataFrame.from_dict(report["totals"].get("kernels", {}), orient="index"),
        report=report,
        folder=folder,
        tiles=_tiles(folder / "tiles.json"),
    )


def load_sweep(folder, machines=False):
    """Loads the results of a sweep: one row per point, by its number, with id, status, axes and values of its totals.

    Axis values with a unit are text, as in the sweep's file. `raywatt sweep collect` updates the results.
    `machines`: one row per machine of a sweep over several workloads, with the aggregates of the main figures and all
    values per workload: machines["worst(perf.fps)"], machines["on(chess, perf.fps)"].
    """
    file = pathlib.Path(folder, "machines.csv" if machines else "results.csv")
    if machines and pathlib.Path(folder, "results.csv").exists() and not file.exists():
        raise ValueError(f"{file}: is not there; allowed: a sweep over several workloads, or machines=False")
    if not file.exists():
        raise ValueError(f"{file}: is not there; `raywatt sweep collect {folder}` writes it for a sweep or a search")
    # "NA" and "null" are values of axes; an empty cell is a missing value.
    return FigureFrame(pandas.read_csv(file, index_col="machine" if machines else "n", float_precision="round_trip",
                                       keep_default_na=False, na_values=[""]))


def load_search(folder):
    """Loads the points of a `raywatt optimise` folder in search order: one row per point, nested names joined by dots."""
    file = pathlib.Path(folder, "history.jsonl")
    if not file.exists():
        raise ValueError(f"{file}: is not there; allowed: a folder that `raywatt optimise -o` has written")
    try:
        points = [json.loads(line) for line in file.read_text().splitlines()]
    except json.JSONDecodeError as problem:
        raise ValueError(f"{file}: is no JSON ({problem})") from None
    return FigureFrame(pandas.DataFrame([_flat(point) for point in points]))


def load_reproduce(folder):
    """Loads the rows of `raywatt reproduce`; the published figure or range is in published_low and published_high."""
    rows = _read(pathlib.Path(folder, "reproduce.json"), "raywatt-reproduce/1")["rows"]
    frame = pandas.DataFrame(rows)
    bounds = [row["published"] if isinstance(row["published"], list) else [row["published"]] * 2 for row in rows]
    frame["published_low"], frame["published_high"] = (
        pandas.Series([bound[end] for bound in bounds], dtype=float) for end in (0, 1))
    frame["measured"] = frame["measured"].astype(float)
    return frame.drop(columns="published")


def load_trace_info(file, program="raywatt"):
    """Returns the output of `raywatt trace info` as a series by path. `program`: the raywatt to run."""
    asked = subprocess.run([program, "trace", "info", str(file), "--json"], capture_output=True, text=True)
    if asked.returncode != 0:
        raise ValueError(asked.stderr.strip())
    return pandas.Series(_flat(json.loads(asked.stdout)), dtype=object, name=str(file))


def _no_run(folder):
    """Returns the error for a folder without report.json; it names the function that reads the folder."""
    readers = {"history.jsonl": "load_search", "sweep.json": "load_sweep", "reproduce.json": "load_reproduce"}
    for name, reader in readers.items():
        if (folder / name).exists():
            return f"{folder}: has {name} and no report.json; use raywatt.{reader}({str(folder)!r})"
    return f"{folder}: has no report.json; allowed: a folder that `raywatt run` or `raywatt trace replay` has written"


def _tiles(file):
    if not file.exists():
        return None
    frames = _read(file, "raywatt-tiles/1")["frames"]
    tiles = pandas.concat([pandas.DataFrame({"frame": frame["frame"], **frame["columns"]}) for frame in frames],
                          ignore_index=True)
    tiles.attrs["rest"] = [frame["rest"] for frame in frames]
    return tiles


def _read(file, schema):
    try:
        content = json.loads(file.read_text())
    except json.JSONDecodeError as problem:
        raise ValueError(f"{file}: is no JSON ({problem})") from None
    if content.get("schema") != schema:
        raise ValueError(f"{file}: schema {content.get('schema')!r}; this reads {schema!r}")
    return content


def _without_kernels(figures):
    return {name: value for name, value in figures.items() if name != "kernels"}


def _flat(tree, prefix=""):
    """Returns the leaves of a JSON tree by path: values, and lists of values. Groups in a list are numbered."""
    if not isinstance(tree, dict) and not (isinstance(tree, list) and any(isinstance(part, dict) for part in tree)):
        return {prefix: tree}
    leaves = {}
    for name, value in tree.items() if isinstance(tree, dict) else enumerate(tree):
        leaves |= _flat(value, f"{prefix}.{name}" if prefix else str(name))
    return leaves


def _unit_rows(tree, path=""):
    """Returns the rows of all units in the JSON tree `units` of a report; a unit is a node with elapsed cycles."""
    if "elapsed" not in tree:
        return [row for name, part in tree.items() for row in _unit_rows(part, f"{path}.{name}" if path else name)]
    rows = [(path, "elapsed", "elapsed", tree["elapsed"])]
    rows += [(path, "why", name, value) for name, value in tree["why"].items()]
    rows += [(path, "counter", name, value) for name, value in tree["counters"].items()]
    return rows
