"""Reads the intervals of a run from their file, specified in docs/intervals.md."""
import numpy
import pandas

FILE = "intervals.bin.zst"
MAGIC = b"raywatt-intervals/1\n"
PEAK = 1
CHUNK_BYTES = 1 << 12  # packed bytes read at once; limits the bytes that one call unpacks
MAX_VARINT_BYTES = 10  # a 64-bit value, 7 bits a byte
MAX_ROWS = 1 << 24  # rows of all frames together: below 1 GiB as a pandas frame
MAX_BYTES = 8 * MAX_ROWS  # bytes of all blocks, unpacked
MAX_INTERVALS, MAX_UNITS, MAX_COUNTERS, MAX_NAME_BYTES = 2048, 65536, 1024, 256
COLUMNS = ["frame", "interval", "begin_us", "end_us", "unit", "kind", "name", "value"]


def load(folder, units):
    """Returns the rows of all frames; the value of a peak is the maximum since the frame's beginning.

    `units`: values of the run's report, to which all intervals must sum.
    """
    file = folder / FILE
    if not file.exists():
        raise ValueError(f"{file}: is not there; those of whole frames have it, unless --intervals is off")
    names, *frames = _blocks(file)
    if not names.startswith(MAGIC):
        raise ValueError(f"{file}: is no file of {MAGIC.decode().strip()}")
    try:
        values = _values_of(names)
        numbers = [_numbers(frame) for frame in frames]
        _check_size(numbers, values)
        rows = pandas.concat([_rows(of_frame, values) for of_frame in numbers], ignore_index=True)
    except (ValueError, IndexError) as problem:
        raise ValueError(f"{file}: is damaged ({problem})") from None
    _check_sums(file, rows, units, values)
    return rows


def _check_size(frames, values):
    """Raises ValueError for more intervals or rows than the format allows."""
    intervals = [int(numbers[3]) for numbers in frames]
    if max(intervals, default=0) > MAX_INTERVALS or sum(intervals) * len(values) > MAX_ROWS:
        raise ValueError(f"over {MAX_INTERVALS} intervals in a frame or over {MAX_ROWS} rows")


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
    blocks, left = [], MAX_BYTES
    with file.open("rb") as packed:
        chunk = packed.read(CHUNK_BYTES)
        while chunk:
            block, parts = zstandard.ZstdDecompressor().decompressobj(), []
            while not block.eof:
                try:
                    parts.append(block.decompress(chunk))
                except zstandard.ZstdError as problem:
                    raise ValueError(f"{file}: is damaged ({problem})") from None
                left -= len(parts[-1])
                if left < 0:
                    raise ValueError(f"{file}: unpacks to over {MAX_BYTES >> 20} MiB; nothing this large is read")
                if not block.eof:
                    chunk = packed.read(CHUNK_BYTES)
                    if not chunk:
                        raise ValueError(f"{file}: is damaged (it ends within a block)")
            blocks.append(b"".join(parts))
            chunk = block.unused_data or packed.read(CHUNK_BYTES)
    return blocks


def _numbers(block):
    """Returns all varints of a block: 7 bits a byte, lowest first."""
    digits = numpy.frombuffer(block, numpy.uint8)
    ends = numpy.flatnonzero(digits < 128)
    begins = numpy.concatenate(([0], ends[:-1] + 1))
    sizes = ends - begins + 1
    if len(ends) == 0 or sizes.max() > MAX_VARINT_BYTES:
        raise ValueError("a number of no byte or of over 64 bits")
    numbers = numpy.zeros(len(ends), numpy.uint64)
    for byte in range(int(sizes.max())):
        has_byte = sizes > byte
        digit = (digits[begins[has_byte] + byte] & 127).astype(numpy.uint64)
        numbers[has_byte] |= digit << numpy.uint64(7 * byte)
    return numbers


def _values_of(block):
    """Returns the values named in the first block, in order, as (unit, kind, name, is a peak)."""
    at = len(MAGIC)

    def number(limit):
        nonlocal at
        value = 0
        for byte in range(MAX_VARINT_BYTES):
            digit = block[at]
            at += 1
            value |= (digit & 127) << 7 * byte
            if digit < 128:
                break
        if digit >= 128 or value > limit:
            raise ValueError(f"a number over {limit}")
        return value

    def name():
        nonlocal at
        size = number(MAX_NAME_BYTES)
        at += size
        return block[at - size:at].decode()

    values = []
    number(MAX_ROWS)  # skips the number of frames
    for _ in range(number(MAX_UNITS)):
        unit = name()
        values += [(unit, "why", name(), False) for _ in range(number(MAX_COUNTERS))]
        values += [(unit, "counter", name(), number(2) == PEAK) for _ in range(number(MAX_COUNTERS))]
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
