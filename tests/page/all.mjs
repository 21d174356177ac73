// All tests of pages, with one browser: node all.mjs RAYWATT NODE_MODULES
import { after } from "node:test";
import { close } from "./surroundings.mjs";
import "./model.mjs";
import "./run_page.mjs";
import "./diff_page.mjs";
import "./sweep_page.mjs";
import "./search_page.mjs";
import "./hostile_page.mjs";
import "./access_page.mjs";

after(close);
