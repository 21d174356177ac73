"""Explores a sweep: its best points, the effect of each axis, and the Pareto front of speed and energy.

    raywatt sweep run trv-cores -o out/trv-cores
    python3 explore_sweep.py out/trv-cores

Cells begin with `# %%`, so Jupyter and editors can also open it as a notebook.
"""
# %% Finished points
import sys

import raywatt

points = raywatt.load_sweep(sys.argv[1] if len(sys.argv) == 2 else "out/trv-cores").query("status == 'done'")
speed, energy = "totals.perf.fps", "totals.energy_mj.nominal"
before_totals = list(points.columns).index(next(name for name in points.columns if name.startswith("totals.")))
axes = [name for name in points.columns[:before_totals] if name not in ("id", "status") and points[name].nunique() > 1]

# %% The ten fastest
print(points.nlargest(10, speed)[[*axes, speed, energy]].to_string())

# %% Effect of an axis: mean of all points with that value
for axis in axes:
    print(points.groupby(axis, sort=False)[[speed, energy]].mean().to_string())

# %% The front: sorted by speed, each point that uses less energy than all faster ones
by_speed = points.sort_values([speed, energy], ascending=[False, True])
front = by_speed[by_speed[energy] < by_speed[energy].cummin().shift(fill_value=float("inf"))]
print(front[[*axes, speed, energy]].to_string())
