// The libraries, once they are there: the page is painted before they are read.

let arrived;
export const libraries = new Promise((resolve) => (arrived = resolve));

function read() {
  globalThis.raywattLibraries = arrived;
  const script = document.createElement("script");
  script.textContent = document.getElementById("libraries").textContent;
  document.head.append(script);
}

/** Reads them when the page as it is has been painted. */
export function readLibraries() {
  const soon = () => requestAnimationFrame(() => setTimeout(read));
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", soon);
  else soon();
}
