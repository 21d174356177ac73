"""Runs adaptive frame programs and full:1, for scripts that compare them."""
import json
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
RAYWATT = str(ROOT / "build/release/tools/raywatt")


def totals_of(raywatt, scene, program, resolution, sets, config="sgrt-2016"):
    """Runs a frame on one thread, with only the scene's strongest light, and returns `totals` of its report."""
    with tempfile.TemporaryDirectory() as work:
        command = [raywatt, "run", config, "--scene", scene, "--program", program, "--reference", "full:1",
                   "--resolution", resolution, "--threads", "1", "--quiet", "-o", f"{work}/out"]
        for each in ["scene.lights.rig=strongest", *sets]:
            command += ["--set", each]
        subprocess.run(command, check=True)
        return json.loads(pathlib.Path(work, "out", "report.json").read_text())["totals"]


def full_rate(totals):
    """Returns the ray rate of full:1 in Mrays/s."""
    return totals["perf"]["mrays_per_s"] / totals["relative"]["speedup"] / totals["relative"]["rays"]
