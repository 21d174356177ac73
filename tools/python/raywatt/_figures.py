"""Frames and series with the short names of the command line: "perf.fps" means "totals.perf.fps"."""
import re

import pandas

FUNCTION = re.compile(r"((?:worst|mean|geomean)\(|on\(.+, )([^(),]+)\)")
PREFIX = "totals."


class FigureSeries(pandas.Series):
    """A series by path that also accepts the names of the command line."""

    @property
    def _constructor(self):
        return FigureSeries

    def __getitem__(self, key):
        return super().__getitem__(resolve(key, self.index))


class FigureFrame(pandas.DataFrame):
    """A frame whose columns also have the names of the command line."""

    @property
    def _constructor(self):
        return FigureFrame

    def __getitem__(self, key):
        return super().__getitem__(resolve(key, self.columns))


def resolve(key, paths):
    """Returns the report path that a name denotes, or the key itself if it is a path or not a text.

    A name denotes the equal path, with or without "totals."; otherwise the only path that ends with it after a dot,
    with priority for figures of totals. A figure with a band denotes its nominal value. A function over workloads may
    contain a name: "worst(fps)", "on(chess, fps)".
    """
    if not isinstance(key, str) or key in paths:
        return key
    texts = [path for path in paths if isinstance(path, str)]
    function = FUNCTION.fullmatch(key)
    if function:
        start, name = function.groups()
        inner = [path[len(start):-1] for path in texts if path.startswith(start) and path.endswith(")")]
        return f"{start}{resolve(name, inner)})"
    for name in (key, key + ".nominal"):
        short = name[len(PREFIX):] if name.startswith(PREFIX) else name
        for exact in (name, PREFIX + name, short):
            if exact in texts:
                return exact
        ends = [path for path in texts if path.endswith("." + name)]
        chosen = [path for path in ends if path.startswith(PREFIX)] or ends
        if len(chosen) > 1:
            raise KeyError(f"{key!r} may mean any of: {', '.join(chosen)}")
        if chosen:
            return chosen[0]
    return key
