"""Charts of docs/trees.md: energy per ray and time per frame against the width of the tree, by kind of ray.

    raywatt sweep run tree-formats -o out/trees
    python3 tree_charts.py out/trees trees-energy.svg trees-time.svg

Values are of T&I units with four box testers, relative to the binary tree with floats. Energy is that of T&I units,
L2, interconnect and memory. A shadow or occlusion ray's energy and time are the difference between frames with and
without these rays. Lines are geometric means over the scenes, bands span all scenes. Cells begin with `# %%`, so Jupyter
and editors can also open this file as a notebook.
"""
# %% Energy and time of primary, shadow and occlusion rays, relative to the binary tree
import sys

import matplotlib

import raywatt

folder, energy_chart, time_chart = (sys.argv[1:] if len(sys.argv) == 4
                                    else ("out/trees", "trees-energy.svg", "trees-time.svg"))
COSTS = {"energy": "energy", "time": "totals.cycles"}
BLOCKS = ["tni", "l2", "interconnect", "dram"]  # parts of the machine that read the tree
FORMATS = {"float boxes": ["2 fp32", "4 fp32", "8 fp32"], "8-bit boxes": ["4 q8", "6 q8", "8 q8"],
           "8-bit boxes, pairs of triangles": ["8 q8 pairs"], "12-bit boxes, blocks of triangles": ["8 q12 full blocks"],
           "CWBVH": ["8 cw80"]}
points = raywatt.load_sweep(folder)
points = points[points["tni.trv.box_testers"].astype(int) == 4]
parts = [f"totals.energy_by_block_mj.{block}.nominal" for block in BLOCKS]
points["energy"] = points[parts].astype(float).sum(axis=1)
frames = points.set_index(["workload", "tree", "rays"])[list(COSTS.values())].astype(float)
costs = frames.unstack("rays")
by_kind = {"primary": costs.xs("primary", axis=1, level="rays")}
for kind in ("shadow", "occlusion"):
    by_kind[kind] = costs.xs(kind, axis=1, level="rays") - by_kind["primary"]
relative = {kind: table / table.xs("2 fp32", level="tree") for kind, table in by_kind.items()}

# %% One chart per cost, one panel per kind of ray
matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "raywatt"
from matplotlib import pyplot


def draw(cost, label, picture):
    drawing, panels = pyplot.subplots(1, 3, figsize=(11, 3.6), sharey=True)
    for panel, (kind, table) in zip(panels, relative.items()):
        for name, trees in FORMATS.items():
            widths = [int(tree.split()[0]) for tree in trees]
            values = [table.xs(tree, level="tree")[COSTS[cost]] for tree in trees]
            means = [value.prod() ** (1 / len(value)) for value in values]
            line, = panel.plot(widths, means, marker="o", label=name)
            if len(trees) > 1:
                panel.fill_between(widths, [v.min() for v in values], [v.max() for v in values], alpha=0.15,
                                   color=line.get_color())
        panel.axhline(1, color="grey", linewidth=0.5)
        panel.set_title(f"{kind} rays")
        panel.set_xlabel("children per node")
        panel.set_xticks([2, 4, 6, 8])
    panels[0].set_ylim(bottom=0)
    panels[0].set_ylabel(label)
    panels[-1].legend(fontsize="small")
    drawing.tight_layout()
    drawing.savefig(picture, metadata={"Date": None})


draw("energy", "energy of T&I units, L2 and memory,\nrelative to width 2", energy_chart)
draw("time", "frame time, relative to width 2", time_chart)

# %% Most frugal and fastest tree of each scene and kind of ray
for kind, table in by_kind.items():
    for cost, column in COSTS.items():
        best = table[column].unstack("tree").idxmin(axis=1)
        print(f"{kind}, least {cost}: " + ", ".join(f"{scene}: {tree}" for scene, tree in best.items()))
