// Number formats: at most four digits, metric prefixes, units.

const PREFIXES = [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"]];
const SMALLER = [[1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"]];

const trimmed = (text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);

/** Formats a number with four digits: 1234, 12.34, 0.001234. */
export function digits(value) {
  if (!Number.isFinite(value)) return String(value);
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return value.toExponential(3).replace(/\.?0+e/, "e");
  if (size >= 1000) return String(Math.round(value));
  return trimmed(value.toPrecision(4).includes("e") ? value.toFixed(6) : value.toPrecision(4));
}

export function si(value, unit = "") {
  const size = Math.abs(value);
  if (unit === "nJ") return value === 0 ? "0 J" : joules(1e-9 * value);
  for (const [scale, prefix] of PREFIXES) {
    if (size >= scale * 0.99995) return `${digits(value / scale)} ${prefix}${unit}`;
  }
  return unit ? `${digits(value)} ${unit}` : digits(value);
}

function joules(value) {
  const [scale, prefix] = SMALLER.find(([least]) => Math.abs(value) >= least * 0.99995) ?? SMALLER.at(-1);
  return `${digits(value / scale)} ${prefix}J`;
}

/** Formats a difference with its sign; the minus is as wide as a plus. */
export const signed = (value, unit = "") => (value > 0 ? "+" : value < 0 ? "−" : "") + si(Math.abs(value), unit);

export function percent(share) {
  const value = 100 * share;
  return `${value.toFixed(Math.abs(value) < 9.995 ? 2 : 1)} %`;
}

const METRIC = ["f", "p", "n", "u", "m", "", "k", "M", "G", "T", "P"], NO_PREFIX = 5;

/** Formats three digits with a metric prefix: "12.3 M", "950", "4.56 mJ". A ratio below 1 has no prefix. */
export function short(value, unit = "") {
  const withUnit = (text, prefix) => (prefix || unit ? `${text} ${prefix}${unit}` : text);
  if (!Number.isFinite(value) || (Number.isInteger(value) && Math.abs(value) < 1000)) return withUnit(String(value), "");
  if (!unit && Math.abs(value) < 1 && Math.abs(value) >= 1e-3) return value.toPrecision(3);
  const exponent = Number(value.toExponential(2).split("e")[1]);
  const group = Math.max(-NO_PREFIX, Math.min(NO_PREFIX, Math.floor(exponent / 3)));
  const decimals = Math.max(0, Math.min(2, 2 - (exponent - 3 * group)));
  return withUnit((value / 10 ** (3 * group)).toFixed(decimals), METRIC[group + NO_PREFIX]);
}

/** Formats a count with its noun: "1 core", "4 cores", "31.9 k triangles". */
export const counted = (count, one) => `${short(count)} ${one}${count === 1 ? "" : "s"}`;

/** Formats a value as its column requires; a missing value is a dash. */
export function shown(value, { show, unit = "" } = {}, withUnit = true) {
  if (value === null || value === undefined || value === "") return "–";
  if (typeof value !== "number") return withMinus(String(value));
  return withMinus(numberText(value, show, unit, withUnit));
}

/** Replaces a hyphen by a minus, which is as wide as a plus. */
const withMinus = (text) => text.replace(/^-(?=\d)/, "−");

function numberText(value, show, unit, withUnit) {
  if (show === "percent") return percent(value);
  if (show === "si") return si(value, withUnit ? unit : "");
  if (show === "number" && Math.abs(value) >= 9999.5) return withUnit && unit ? `${si(value)} ${unit}` : si(value);
  if (show === "number") return withUnit && unit ? `${digits(value)} ${unit}` : digits(value);
  return String(value);
}
