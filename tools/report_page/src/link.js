// Connects picture and time: the tile under the pointer, and the tiles in flight during the brushed time.

let pointed = [], lit = [];
let times = null, span = null;

/** Sets the time in which each tile was in flight: {begin_us, end_us}. */
export const setTimes = (of) => (times = of);
export const spanOf = (tile) => (times && tile !== null && times.begin_us[tile] !== null ? [times.begin_us[tile], times.end_us[tile]] : null);

export const listenPointed = (listener) => pointed.push(listener);
export const listenLit = (listener) => lit.push(listener);

/** Notifies listeners of the tile under the pointer; null: none. */
export const point = (tile) => pointed.forEach((listener) => listener(tile));

/** Highlights the tiles in flight during [from, to]; null: all. */
export function brush(next) {
  if (!times || String(next) === String(span)) return;
  span = next;
  const tiles = span && new Set(times.begin_us.flatMap((begin, i) => (begin !== null && begin < span[1] && times.end_us[i] > span[0] ? [i] : [])));
  lit.forEach((listener) => listener(tiles));
}
