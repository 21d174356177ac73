// Views as the page's scripts build them, without a browser.
import assert from "node:assert/strict";
import { test } from "node:test";
import { changeText, diffVerdict, waterfall } from "../../tools/report_page/src/diff.js";
import { counted, short } from "../../tools/report_page/src/format.js";
import { unitSums } from "../../tools/report_page/src/run.js";

/** The first column of a waterfall between two totals. */
const partsBetween = (a, changes, b) => waterfall("before", a, changes, "after", b, "").rows.map(([name]) => name);

test("a waterfall names a single small part and counts several", () => {
  const one = [{ name: "switches", a: 0, b: 100 }, { name: "banks", a: 1, b: 0 }];
  assert.deepEqual(partsBetween(1000, one, 1099), ["before", "switches", "banks", "after"]);
  const two = [...one, { name: "transfers", a: 1, b: 0 }];
  assert.deepEqual(partsBetween(1000, two, 1098), ["before", "switches", "2 others", "after"]);
});

test("counts are singular for one", () => {
  assert.deepEqual([counted(1, "core"), counted(0, "light"), counted(4, "traversal unit"), counted(31900, "triangle")],
    ["1 core", "0 lights", "4 traversal units", "31.9 k triangles"]);
});

test("three digits have a metric prefix, and whole numbers below 1000 stay whole", () => {
  const texts = [short(950), short(0.335), short(12345678), short(999.9), short(0.00456, "J"), short(256, "B"), short(5.4e9, "B/s"), short(0)];
  assert.deepEqual(texts, ["950", "0.335", "12.3 M", "1.00 k", "4.56 mJ", "256 B", "5.40 GB/s", "0"]);
});

test("changes are percentages, factors, or words", () => {
  const pairs = [[100, 101.4], [100, 99.5], [100, 208], [0, 5], [5, 0], [5, 5]];
  assert.deepEqual(pairs.map(([a, b]) => changeText({ a, b })), ["+1.4 %", "-0.50 %", "x2.08", "new", "gone", "="]);
});

test("the verdict of two runs says of cycles and of energy whether noise explains the difference", () => {
  const [within, outside] = [{ outside: false, half_width: 0.03 }, { outside: true, half_width: 0.01 }];
  const verdict = (cycles, energy) => diffVerdict({ picture: { why_not: "there are none" },
    figures: { cycles: { a: 100, b: 98, noise: cycles }, energy_mj: { a: 100, b: 98, noise: energy } } }, "base", "other");
  const mixed = verdict(outside, within), other = verdict(within, outside);
  assert.equal(mixed.sentence, "other takes 2.0 % fewer cycles than base, which is outside the noise.");
  assert.equal(mixed.more, "Energy −2.0 %, which is within the noise. The pictures are not compared: there are none.");
  assert.equal(other.sentence, "other takes 2.0 % fewer cycles than base, which is within the noise.");
  assert.equal(other.more, "Energy −2.0 %, which is outside the noise. The pictures are not compared: there are none.");
});

test("sums over units are by kind; a unit whose name ends in a digit is its own kind", () => {
  const unit = (hits) => ({ elapsed: 10, counters: { hits } });
  const sum = unitSums({ core0: { trv0: unit(1), trv1: unit(2) }, core1: { trv0: unit(4), trv1: unit(8) }, l2: { bank0: unit(16) } });
  assert.deepEqual(["core.trv.counters.hits", "core.trv.units", "l2.bank.counters.hits", "l2.bank.units", "none"].map(sum), [15, 4, 16, 1, 0]);
});
