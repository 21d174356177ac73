"""Reads configurations written by raywatt by PyYAML and by a JSON schema; ends with 77 if one of them is missing."""
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

for module, package in (("yaml", "python3-yaml"), ("jsonschema", "python3-jsonschema")):
    if importlib.util.find_spec(module) is None:
        print(f"skipped: no {module} (Debian's {package})")
        sys.exit(77)
import jsonschema
import yaml

PROGRAM = sys.argv.pop(1)
WORK = tempfile.TemporaryDirectory()
PRESETS = ("sgrt-2016", "sgrt-2016-tiles16", "sgrt-balanced")
# Values that YAML 1.1 and 1.2 read differently: words for booleans, numbers without a point, numbers of base 60.
ODD_VALUES = (
    "render.mip_maps=off",
    "dram.energy.refresh={low: 1e-09, nominal: 1.5e-07, high: 1e+22}",
    "energy.events.tni.box_test={low: 1e-05, nominal: 1e-05, high: 0.1}",
    "render.ray_epsilon=1e-05",
    "scene.name=1:30",
)


def run(*arguments):
    return subprocess.run((PROGRAM, *arguments), cwd=WORK.name, check=True, capture_output=True, text=True).stdout


def written():
    """Returns texts of configurations by name."""
    texts = {preset: run("config", "show", preset) for preset in PRESETS}
    for value in ODD_VALUES:
        texts[value] = run("config", "show", "--set", value)
    return texts


class Configurations(unittest.TestCase):
    def test_come_back_from_pyyaml_as_they_were(self):
        for name, text in written().items():
            with self.subTest(name):
                (pathlib.Path(WORK.name) / "again.yaml").write_text(yaml.safe_dump(yaml.safe_load(text)))
                self.assertEqual(run("config", "show", "again.yaml"), text)

    def test_satisfy_the_schema(self):
        validator = jsonschema.Draft202012Validator(json.loads(run("config", "schema")))
        for name, text in written().items():
            with self.subTest(name):
                faults = [f"{error.json_path}: {error.message}" for error in validator.iter_errors(yaml.safe_load(text))]
                self.assertEqual(faults, [])

    def test_have_numbers_where_they_have_a_small_or_large_number(self):
        text = run("config", "show", "--set", "dram.energy.refresh={low: 1e-09, nominal: 1.5e-07, high: 1e+22}")
        self.assertEqual(
            yaml.safe_load(text)["dram"]["energy"]["refresh"], {"low": 1e-09, "nominal": 1.5e-07, "high": 1e22}
        )


if __name__ == "__main__":
    unittest.main(verbosity=2)
