"""Intervals of a run as docs/intervals.md describes their file."""
import numpy
import pandas

FILE = "intervals.bin.zst"
MAGIC = b"raywatt-intervals/1\n"
PEAK = 1
COLUMNS = ["frame", "interval", "begin_us", "end_us", "unit", "kind", "name", "value"]


def load(folder, units):
    """Rows of all frames; of a peak the value is the most since the frame's beginning.

    `units`: those of the report beside the file, to whose values all intervals must come.
    """
    file = folder / FILE
    if not file.exists():
        raise ValueError(f"{file}: is not there; runs with --intervals off or --tile-sampling have none")
    names, *frames = _blocks(file)
    if not names.startswith(MAGIC):
        raise ValueError(f"{file}: is no file of {MAGIC.decode().strip()}")
    try:
        values = _values_of(names)
        rows = pandas.concat([_rows(numbers, values) for numbers in map(_numbers, frames)], ignore_index=True)
    except (ValueError, IndexError) as problem:
        raise ValueError(f"{file}: is damaged ({problem})") from None
    _check_sums(file, rows, units, values)
    return rows


def _check_sums(file, rows, units, values):
    grouped = rows.groupby(["unit", "kind", "name"], observed=True)["value"]
    sums, most = grouped.sum(), grouped.max()
    reported = units.set_index(["unit", "kind", "name"])["value"]
    for unit, kind, name, is_peak in values:
        key = (unit, kind, name)
        if key not in reported.index or (most if is_peak else sums)[key] != reported[key]:
            raise ValueError(f"{file}: does not add up to the report beside it: {unit}, {name}")


def _blocks(file):
    try:
        import zstandard
    except ImportError:
        raise ImportError(f"{file}: reading it needs zstandard (Debian's python3-zstandard)") from None
    packed, blocks = file.read_bytes(), []
    while packed:
        block = zstandard.ZstdDecompressor().decompressobj()
        try:
            blocks.append(block.decompress(packed))
        except zstandard.ZstdError as problem:
            raise ValueError(f"{file}: is damaged ({problem})") from None
        if not block.eof:
            raise ValueError(f"{file}: is damaged (it ends within a block)")
        packed = block.unused_data
    return blocks


def _numbers(block):
    """All varints of a block: 7 bits a byte, lowest first."""
    digits = numpy.frombuffer(block, numpy.uint8)
    begins = numpy.concatenate(([0], numpy.flatnonzero(digits < 128)[:-1] + 1))
    places = numpy.arange(len(digits)) - numpy.repeat(begins, numpy.diff(numpy.append(begins, len(digits))))
    return numpy.add.reduceat((digits & 127).astype(numpy.uint64) << (7 * places).astype(numpy.uint64), begins)


def _values_of(block):
    """The first block's values in their order, as (unit, kind, name, is a peak)."""
    at = len(MAGIC)

    def number():
        nonlocal at
        value = shift = 0
        while True:
            digit = block[at]
            at += 1
            value |= (digit & 127) << shift
            shift += 7
            if digit < 128:
                return value

    def name():
        nonlocal at
        size = number()
        at += size
        return block[at - size:at].decode()

    values = []
    number()  # of frames
    for _ in range(number()):
        unit = name()
        values += [(unit, "why", name(), False) for _ in range(number())]
        values += [(unit, "counter", name(), number() == PEAK) for _ in range(number())]
    return values


def _rows(numbers, values):
    frame, length, end, intervals = (int(number) for number in numbers[:4])
    came = numpy.zeros((len(values), intervals), numpy.uint64)
    at = 4
    for column, (_, _, _, is_peak) in enumerate(values):
        if numbers[at] != 0:
            came[column] = numbers[at + 1:at + 1 + intervals]
            at += intervals
        if is_peak:
            came[column] = came[column].cumsum()
        at += 1
    edges = numpy.minimum(numpy.arange(intervals + 1, dtype=float) * length, end) / 1e9
    rows = {"frame": frame, "interval": numpy.tile(numpy.arange(intervals), len(values)),
            "begin_us": numpy.tile(edges[:-1], len(values)), "end_us": numpy.tile(edges[1:], len(values))}
    for column, texts in zip(("unit", "kind", "name"), list(zip(*values))[:3]):
        codes, categories = pandas.factorize(pandas.Series(texts))
        rows[column] = pandas.Categorical.from_codes(numpy.repeat(codes, intervals), categories)
    return pandas.DataFrame(rows | {"value": came.ravel().astype(numpy.int64)}, columns=COLUMNS)
