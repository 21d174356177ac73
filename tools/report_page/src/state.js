// The state of the page is the fragment of its address, so that a link or bookmark restores it.

const listeners = new Map();
let state = read();
let isDrawn = false;  // true: listeners added from now on belong to the drawn view

/** Reads the state from the fragment. A malformed one ("#%") gives the default state. */
function read() {
  const fragment = location.hash.slice(1);
  try {
    const text = decodeURIComponent(fragment);
    return text.includes("=") ? new URLSearchParams(fragment) : new URLSearchParams(text ? { at: text } : {});
  } catch {
    return new URLSearchParams();
  }
}

export const get = (key, otherwise = "") => state.get(key) ?? otherwise;

/** Sets keys of the state and notifies listeners except `from`; an empty value removes its key. */
export function set(changes, from) {
  for (const [key, value] of Object.entries(changes)) {
    if (value === "" || value === null || value === undefined) state.delete(key);
    else state.set(key, value);
  }
  history.replaceState(null, "", "#" + state.toString());
  for (const key of Object.keys(changes)) notify(key, from);
}

function notify(key, from) {
  for (const { listener } of [...(listeners.get(key) ?? [])]) if (listener !== from) listener(get(key));
}

export function listen(key, listener) {
  if (!listeners.has(key)) listeners.set(key, []);
  listeners.get(key).push({ listener, drawn: isDrawn });
}

/** Removes the listeners of the previous view, before another view is drawn. */
export function freshView() {
  for (const [key, all] of listeners) listeners.set(key, all.filter((each) => !each.drawn));
  isDrawn = true;
}

window.addEventListener("hashchange", () => {
  const before = state;
  state = read();
  for (const key of new Set([...before.keys(), ...state.keys()])) {
    if (before.get(key) !== state.get(key)) notify(key);
  }
});
