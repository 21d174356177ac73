"""Frames and series whose keys may be short, as on the command line: "perf.fps" means "totals.perf.fps"."""
import pandas

PREFIX = "totals."


class FigureSeries(pandas.Series):
    """A series by path that also takes the names that `raywatt` takes."""

    @property
    def _constructor(self):
        return FigureSeries

    def __getitem__(self, key):
        return super().__getitem__(resolve(key, self.index))


class FigureFrame(pandas.DataFrame):
    """A frame whose columns may be named as on the command line."""

    @property
    def _constructor(self):
        return FigureFrame

    def __getitem__(self, key):
        return super().__getitem__(resolve(key, self.columns))


def resolve(key, paths):
    """Returns the path that a name means, or the key itself if it is a path or no text.

    A name means the path that equals it, with or without "totals."; else the only path that ends in it at a dot, where
    figures of totals come first. A figure with a band means its nominal value.
    """
    if not isinstance(key, str) or key in paths:
        return key
    texts = [path for path in paths if isinstance(path, str)]
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
