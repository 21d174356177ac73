// Pictures are stored after the page's script, so that the first paint does not wait for them.

const parsed = new Promise((resolve) => {
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", resolve);
  else resolve();
});
const pictures = parsed.then(() => JSON.parse(document.getElementById("picture-data").textContent));

/** Returns the data: URL of "picture:3". */
export async function urlOf(name) {
  return (await pictures)[Number(name.split(":")[1])];
}

export async function showIn(image, name) {
  image.src = await urlOf(name);
}
