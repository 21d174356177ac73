// The link between picture and time: which tile is pointed at, and which tiles a brushed time lights.

let pointed = [], lit = [];
let times = null, span = null;

/** When tiles were in flight: {begin_us, end_us}. */
export const know = (of) => (times = of);
export const spanOf = (tile) => (times && tile !== null && times.begin_us[tile] !== null ? [times.begin_us[tile], times.end_us[tile]] : null);

export const listenPointed = (listener) => pointed.push(listener);
export const listenLit = (listener) => lit.push(listener);

/** A tile, or null. */
export const point = (tile) => pointed.forEach((listener) => listener(tile));

/** Lights the tiles that were in flight in a stretch of time; null: all. */
export function brush(next) {
  if (!times || String(next) === String(span)) return;
  span = next;
  const tiles = span && new Set(times.begin_us.flatMap((begin, i) => (begin !== null && begin < span[1] && times.end_us[i] > span[0] ? [i] : [])));
  lit.forEach((listener) => listener(tiles));
}
