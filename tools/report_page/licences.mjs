// Licences of the packages that are bundled, from their own files.
import fs from "node:fs";
import path from "node:path";

/** A package in `folder`: name, version, who holds the copyright, the licence and its text. */
export function licenceOf(folder) {
  const { name, version, license, author } = JSON.parse(fs.readFileSync(path.join(folder, "package.json"), "utf8"));
  const file = fs.readdirSync(folder).find((each) => /^licen[sc]e/i.test(each));
  const lines = file ? fs.readFileSync(path.join(folder, file), "utf8").trim().split(/\r?\n/) : [];
  const notice = /^\s*copyright\b.*\d{4}/i;
  const holders = lines.filter((line) => notice.test(line)).map((line) => line.replace(/^\s*copyright( \(c\))?,? */i, "").trim());
  if (holders.length === 0) holders.push(author?.name ?? author);
  if (!license || !holders[0]) throw new Error(`${folder} does not say whose it is and under which licence`);
  const terms = lines.filter((line) => !notice.test(line) && !/^all rights reserved/i.test(line)).join("\n").trim();
  return { folder, name, version, license, holders, terms, text: lines.join("\n") };
}

export const asText = (packages) => packages.map((p) => `${p.name} ${p.version} (${p.license})\n\n${p.text}\n`).join("\n----\n\n");

/** Paragraphs of a Debian copyright file: packages of equal terms share one. */
export function asCopyright(packages) {
  const together = new Map();
  for (const p of packages) {
    const terms = p.terms || packages.find((q) => q.terms && q.license === p.license && q.holders[0].includes(p.holders[0]))?.terms;
    if (!terms) throw new Error(`${p.folder} has no text of its licence`);
    const key = `${p.license}\n${terms}`;
    together.set(key, [...together.get(key) ?? [], p]);
  }
  const list = (name, values) => `${name}:\n${[...new Set(values)].map((v) => ` ${v}\n`).join("")}`;
  return [...together].map(([key, group]) => list("Files", group.map((p) => `${p.folder}/*`)) +
    list("Comment", group.map((p) => `${p.name} ${p.version}`)) +
    list("Copyright", group.flatMap((p) => p.holders)) +
    `License: ${key.split("\n").map((line, i) => (i === 0 ? line : ` ${line.trimEnd() || "."}`)).join("\n")}\n`).join("\n");
}
