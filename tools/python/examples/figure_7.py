"""Figure 7 of Lee et al. 2016, redrawn: time, power and performance per watt of the T&I units, measured and published.

    raywatt reproduce lee2016 -o out/lee2016
    python3 figure_7.py out/lee2016 figure-7.svg

Cells begin with `# %%`, so Jupyter and editors can also open it as a notebook.
"""
# %% Measured figures
import sys

import matplotlib

import raywatt

folder, picture = sys.argv[1:] if len(sys.argv) == 3 else ("out/lee2016", "figure-7.svg")
rows = raywatt.load_reproduce(folder).query("experiment == 'figure 7'")
figures = {"time_ratio": "time", "tni_power": "power", "tni_perf_per_watt": "performance per watt"}
table = rows[rows["figure"].isin(figures)].pivot(index=["setting", "scene"], columns="figure",
                                                 values=["measured", "published_low", "published_high"])
print(table.to_string())

# %% The figure: one panel per setting, one group of bars per scene; black lines are the published ranges
matplotlib.use("svg" if picture.endswith(".svg") else "agg")
from matplotlib import pyplot

settings = table.index.unique("setting")
drawing, panels = pyplot.subplots(1, len(settings), figsize=(5 * len(settings), 3.5), sharey=True, squeeze=False)
for panel, setting in zip(panels[0], settings):
    scenes = table.loc[setting]
    for place, (figure, label) in enumerate(figures.items()):
        x = [at + 0.27 * (place - 1) for at in range(len(scenes))]
        panel.bar(x, scenes["measured"][figure], width=0.25, label=label)
        for at, low, high in zip(x, scenes["published_low"][figure], scenes["published_high"][figure]):
            if low == low:
                panel.vlines(at, low, high, color="black", linewidth=2)
    panel.axhline(1, color="grey", linewidth=0.5)
    panel.set_xticks(range(len(scenes)), scenes.index)
    panel.set_title(setting)
panels[0][0].set_ylabel("relative to every sample traced")
panels[0][0].legend()
drawing.tight_layout()
drawing.savefig(picture)
