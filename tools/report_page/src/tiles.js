// Metrics of tiles as rows of a table. Metrics with another tile size than the first are left out.

const where = [{ field: "x", title: "tile x", show: "number" }, { field: "y", title: "tile y", show: "number" }];

/** Returns a table with a row per tile. `columnsOf(grid)` returns the columns of a metric, each with its `values`. */
export function tileRows(grids, width, columnsOf) {
  const tiled = grids.filter((g) => g.tile);
  if (tiled.length === 0) return null;
  const same = tiled.filter((g) => g.tile === tiled[0].tile);
  const columns = same.flatMap(columnsOf);
  const across = Math.ceil(width / tiled[0].tile);
  return {
    columns: [...where, ...columns.map(({ values, ...column }) => ({ show: "number", ...column }))],
    rows: same[0].values.map((_, i) => [i % across, Math.floor(i / across), ...columns.map((c) => c.values[i] ?? null)]),
  };
}

/** Returns a text that names the tile of a pixel. */
export const tileAt = (x, y, side) => `tile ${Math.floor(x / side)}, ${Math.floor(y / side)}`;
