// Pictures stand behind the page's script, so that what needs none of them is painted before they are read.

const parsed = new Promise((resolve) => {
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", resolve);
  else resolve();
});
const pictures = parsed.then(() => JSON.parse(document.getElementById("picture-data").textContent));

/** The data: URL of a picture that data call "picture:3". */
export async function urlOf(name) {
  return (await pictures)[Number(name.split(":")[1])];
}

export async function showIn(image, name) {
  image.src = await urlOf(name);
}
