// node test/core/run.mjs: the tests of the page on the program. 77: they cannot run here.

import { spawnSync } from "node:child_process";
import { readdirSync } from "node:fs";

const folder = new URL(".", import.meta.url).pathname;
const { hindrance } = await import("./nacre.mjs").catch((error) => ({ hindrance: () => error.message }));
const why = hindrance();
if (why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}
const tests = readdirSync(folder).filter((name) => name.endsWith(".test.mjs"));
const { status } = spawnSync(process.execPath, ["--test", ...tests.map((name) => folder + name)], { stdio: "inherit" });
process.exit(status ?? 1);
