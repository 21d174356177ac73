// Third-party libraries, loaded after the first paint.

let arrived;
export const libraries = new Promise((resolve) => (arrived = resolve));

function read() {
  globalThis.raywattLibraries = arrived;
  const script = document.createElement("script");
  script.textContent = document.getElementById("libraries").textContent;
  document.head.append(script);
}

/** Loads the libraries after the next paint. */
export function readLibraries() {
  const soon = () => requestAnimationFrame(() => setTimeout(read));
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", soon);
  else soon();
}
