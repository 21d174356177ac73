// A picture with a layer of values on top, and a probe that the pointer or the arrow keys move.
import { h } from "./dom.js";
import { colourMap, shareOf } from "./colours.js";
import { showIn, urlOf } from "./pictures.js";

/** Returns the pixels of an image after it is decoded. */
async function pixelsOf(picture) {
  const image = new Image();
  image.src = await urlOf(picture);
  await image.decode();
  const canvas = h("canvas", { width: image.naturalWidth, height: image.naturalHeight });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  return { width: canvas.width, height: canvas.height, data: context.getImageData(0, 0, canvas.width, canvas.height).data };
}

/** Returns a grid of tiles: columns, rows, and the value at a pixel. */
export function gridOf(layer, width, height) {
  const columns = Math.ceil(width / layer.tile), rows = Math.ceil(height / layer.tile);
  return { columns, rows, at: (x, y) => layer.values[Math.floor(y / layer.tile) * columns + Math.floor(x / layer.tile)] };
}

function drawGrid(layer, grid, canvas, map) {
  canvas.width = grid.columns;
  canvas.height = grid.rows;
  const context = canvas.getContext("2d");
  const pixels = context.createImageData(grid.columns, grid.rows);
  layer.values.forEach((value, i) => {
    if (value === null || i >= grid.columns * grid.rows) return;
    pixels.data.set([...map(shareOf(value, layer)), 255], 4 * i);
  });
  context.putImageData(pixels, 0, 0);
}

/** Draws values of pixels, stored as an image: red and green are the high and low byte of a number of steps. */
async function drawValues(layer, canvas, map) {
  const { width, height, data } = await pixelsOf(layer.pixels);
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d");
  const pixels = context.createImageData(width, height);
  const valueOf = (i) => (256 * data[4 * i] + data[4 * i + 1]) * layer.step;
  for (let i = 0; i < width * height; ++i) pixels.data.set([...map(shareOf(valueOf(i), layer)), 255], 4 * i);
  context.putImageData(pixels, 0, 0);
  return (x, y, wide, high) => valueOf(Math.floor((y * height) / high) * width + Math.floor((x * width) / wide));
}

/**
 * Returns the element of a picture with a probe. `probed(x, y, value)` is called for the pixel under the pointer, with
 * null after the pointer has left; `chosen(x, y)` is called for a click.
 */
export function stage({ width, height, picture, about }, { probed, chosen }) {
  const image = h("img", { alt: about, width, height, hidden: !picture, decoding: "async" });
  const over = h("canvas", { class: "over", "aria-hidden": "true" });
  const cross = h("span", { class: "cross", hidden: true });
  const lit = h("canvas", { class: "over lit", "aria-hidden": "true" });
  const element = h("div", { class: "stage", tabindex: "0", role: "application", "aria-label": `${about}. Arrow keys move the probe.` },
    image, over, lit, cross);
  element.style.aspectRatio = `${width} / ${height}`;
  let at = null, read = () => null;

  /** Moves the cross to a pixel; null hides it. */
  function mark(x, y) {
    cross.hidden = x === null;
    if (x === null) return;
    cross.style.left = `${(100 * (x + 0.5)) / width}%`;
    cross.style.top = `${(100 * (y + 0.5)) / height}%`;
  }
  element.mark = mark;
  function probe(x, y) {
    at = [Math.max(0, Math.min(width - 1, Math.floor(x))), Math.max(0, Math.min(height - 1, Math.floor(y)))];
    mark(...at);
    probed(at[0], at[1], read(at[0], at[1]));
  }
  function leave() {
    mark(null);
    probed(null, null, null);
  }
  const place = (event) => {
    const box = element.getBoundingClientRect();
    return [((event.clientX - box.left) / box.width) * width, ((event.clientY - box.top) / box.height) * height];
  };
  element.addEventListener("pointermove", (event) => probe(...place(event)));
  element.addEventListener("pointerleave", () => document.activeElement !== element && leave());
  element.addEventListener("click", (event) => { probe(...place(event)); chosen?.(...at); });
  element.addEventListener("blur", leave);
  element.addEventListener("keydown", (event) => {
    const step = event.shiftKey ? 16 : 1;
    const move = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
    const from = at ?? [width / 2, height / 2];
    if (move) {
      event.preventDefault();
      probe(from[0] + move[0], from[1] + move[1]);
    } else if (event.key === "Enter" && at) {
      chosen?.(...at);
    }
  });

  /** Shows a layer: tiles (`tile`, a list of values), pixels (`pixels`, an image), a picture, or none. */
  element.show = async (layer, opacity) => {
    if (picture) await showIn(image, layer?.picture ?? picture);
    over.hidden = !layer || Boolean(layer.picture);
    over.style.opacity = opacity;
    read = () => null;
    if (!layer || layer.picture) return null;
    const map = await colourMap(layer);
    if (layer.tile) {
      const grid = gridOf(layer, width, height);
      drawGrid(layer, grid, over, map);
      over.style.width = `${(100 * grid.columns * layer.tile) / width}%`;
      over.style.height = `${(100 * grid.rows * layer.tile) / height}%`;
      read = grid.at;
    } else {
      const at = await drawValues(layer, over, map);
      over.style.width = over.style.height = "100%";
      read = (x, y) => at(x, y, width, height);
    }
    return map;
  };
  element.fade = (opacity) => (over.style.opacity = opacity);
  /** Dims the tiles of a grid that are not in the set; null dims none. */
  element.light = (tiles, tile) => {
    lit.hidden = !tiles;
    if (!tiles) return;
    const columns = Math.ceil(width / tile), rows = Math.ceil(height / tile);
    lit.width = columns;
    lit.height = rows;
    lit.style.width = `${(100 * columns * tile) / width}%`;
    lit.style.height = `${(100 * rows * tile) / height}%`;
    const context = lit.getContext("2d");
    context.clearRect(0, 0, columns, rows);
    context.fillStyle = "rgba(12, 18, 24, 0.72)";
    for (let i = 0; i < columns * rows; ++i) if (!tiles.has(i)) context.fillRect(i % columns, Math.floor(i / columns), 1, 1);
  };
  lit.hidden = true;
  return element;
}
