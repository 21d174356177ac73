// All tests of pages, with one browser: node all.mjs RAYWATT NODE_MODULES
import { after } from "node:test";
import { close } from "./surroundings.mjs";

after(close);
await import("./run_page.mjs");
await import("./diff_page.mjs");
await import("./sweep_page.mjs");
await import("./hostile_page.mjs");
await import("./access_page.mjs");
