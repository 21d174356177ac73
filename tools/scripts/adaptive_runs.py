"""Runs of adaptive frame programs against full:1, for scripts that measure their gains."""
import json
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
RAYWATT = str(ROOT / "build/release/tools/raywatt")


def totals_of(raywatt, scene, program, resolution, sets, config="sgrt-2016"):
    """`totals` of the report, with the scene's strongest light, on one thread."""
    with tempfile.TemporaryDirectory() as work:
        command = [raywatt, "run", config, "--scene", scene, "--program", program, "--reference", "full:1",
                   "--resolution", resolution, "--threads", "1", "--quiet", "-o", f"{work}/out"]
        for each in ["scene.lights.rig=strongest", *sets]:
            command += ["--set", each]
        subprocess.run(command, check=True)
        return json.loads(pathlib.Path(work, "out", "report.json").read_text())["totals"]


def full_rate(totals):
    """Mrays/s of full:1."""
    return totals["perf"]["mrays_per_s"] / totals["relative"]["speedup"] / totals["relative"]["rays"]
