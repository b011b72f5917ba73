// Pictures of the page on the program.
//   node test/core/pictures.mjs FOLDER           those of docs/explorer.md
//   node test/core/pictures.mjs FOLDER NAME...   some of them
//   node test/core/pictures.mjs FOLDER --every   every pane and view, dark and light, on a laptop's screen and on 4K
// 77: they cannot be made here.

import { mkdirSync } from "node:fs";
import { join } from "node:path";
import { exampleBrdf, explore, hindrance, launch, makeFolder, openPage, removeFolder, settled, until } from "./nacre.mjs";

const why = hindrance();
if (why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}
const [out, ...names] = process.argv.slice(2);
if (!out) throw new Error("expected a folder for the pictures");
mkdirSync(out, { recursive: true });

const pause = (page, ms) => page.waitForTimeout(ms);
const samples = (page, view, count) =>
  until(page, ([id, n]) => Number(document.querySelector(`[data-testid=view-${id}] .count`)?.textContent.match(/^[\d.]+/)?.[0]) >= n, [view, count], 240);
const edited = (page, source) =>
  page.evaluate((text) => {
    const { editor } = document.querySelector("[data-testid=code]");
    editor.dispatch({ changes: { from: 0, to: editor.state.doc.length, insert: text } });
  }, source);

const acts = {
  explore: async () => {},
  views: async (p) => {
    await p.click("[data-testid=choose-views]");
    await p.click(".view-list button:last-child");
    await p.keyboard.press("Escape");
    await p.keyboard.press("l");
  },
  add: (p) => p.click("[data-testid=add-material]"),
  files: async (p) => {
    await p.click("[data-testid=add-material]");
    await p.click("[data-testid=tab-files]");
    await p.waitForSelector("[data-testid='file-gold.binary']");
  },
  object: async (p) => {
    await p.click("[data-testid=pane-object]");
    await samples(p, "object", 24);
  },
  render: async (p) => {
    await p.click("[data-testid=pane-render]");
    await p.click("[data-testid='file-spheres.xml']");
    await samples(p, "render", 64);
    await p.click("text=Keep as B");
    await p.dragAndDrop("[data-testid=material-1]", ".swaps li >> nth=0");
    await until(p, () => Object.keys(window.nacre.state.render.swap).length === 1);
    await pause(p, 500);
    await samples(p, "render", 128);
    await p.click(".fitted > canvas", { position: { x: 250, y: 220 } });
    await p.waitForSelector(".spectrum canvas");
    await pause(p, 500);
  },
  edit: async (p) => {
    await p.click("[data-testid=material-3]");
    await p.click("[data-testid=pane-edit]");
    await p.waitForSelector("text=/compiled in/");
  },
  error: async (p) => {
    await acts.edit(p);
    await edited(p, exampleBrdf.replace("* lobe);", "* lobes);"));
    await p.waitForSelector("[data-testid=verdict].bad");
  },
  fit: async (p) => {
    await p.click("[data-testid=pane-fit]");
    await p.click("[data-testid=choose-measured]");
    await p.click("[data-testid='file-gold.binary']");
    for (const model of ["ggx_schlick", "ward", "lambert"]) await p.click(`[data-testid=fit-model-${model}]`).catch(() => {});
    await p.fill(".model-choice input", "beckmann_conductor+lambert");
    await p.press(".model-choice input", "Enter");
    await p.click("[data-testid=fit-start]");
    await p.waitForSelector("[data-testid=fit-start]", { timeout: 120_000 });
    await pause(p, 3600);
  },
  validate: async (p) => {
    await p.click("[data-testid=material-3]");
    await p.click("[data-testid=pane-validate]");
    await p.click("[data-testid=validate-start]");
    await p.waitForSelector("[data-testid=validate-start]", { timeout: 120_000 });
    await p.click("[data-testid=map-energy_map]");
    await p.click("[data-testid=laws] tr.violated");
  },
  keys: (p) => p.keyboard.press("?"),
  session: (p) => p.click("[data-testid=session]"),
};
const topics = ["snell", "fresnel", "lambert", "inverse_square", "solid_angle", "radiance", "ndf", "visible_normals", "masking", "projected_area", "multiple_bounces", "furnace"];
for (const topic of topics)
  acts[`physics-${topic}`] = async (p) => {
    await p.click("[data-testid=pane-physics]");
    await p.click(`[data-testid=topic-${topic}]`);
  };

const laptop = { width: 1366, height: 768 };
const large = { width: 3840, height: 2160 };
const ofDocs = [
  { name: "explorer", act: "explore" },
  { name: "explorer-views", act: "views", scheme: "light", type: "jpeg" },
  { name: "explorer-object", act: "object", type: "jpeg" },
  { name: "explorer-render", act: "render", type: "jpeg" },
  { name: "explorer-edit", act: "error" },
  { name: "explorer-fit", act: "fit", scheme: "light", type: "jpeg" },
  { name: "explorer-validate", act: "validate" },
  { name: "explorer-masking", act: "physics-masking" },
  { name: "explorer-fresnel", act: "physics-fresnel", scheme: "light" },
];
const all = Object.keys(acts).flatMap((act) =>
  ["dark", "light"].flatMap((scheme) => [
    { name: `${act}-${scheme}`, act, scheme },
    ...(scheme === "dark" && !act.startsWith("physics-") ? [{ name: `${act}-4k`, act, size: large }] : []),
  ]),
);
const wanted = names.includes("--every") ? all : names.length ? [...ofDocs, ...all].filter((shot) => names.includes(shot.name)) : ofDocs;

const folder = makeFolder();
const server = await explore(folder, ["gold.binary", "ggx_conductor:metal=Cu,alpha_x=0.15,alpha_y=0.35", "lobe.brdf"]);
const browser = await launch();
const problems = [];
for (const { name, act, scheme = "dark", size = laptop, type = "png" } of wanted) {
  const page = await openPage(browser, server.address, { problems, size, scheme });
  try {
    await acts[act](page);
    // A picture that is sampled without end never settles.
    await Promise.race([settled(page).catch(() => {}), pause(page, 8000)]);
  } catch (error) {
    problems.push(`${name}: ${error.message}`);
  }
  await page.mouse.move(0, 0);
  await pause(page, 200);
  const path = join(out, `${name}.${type === "jpeg" ? "jpg" : "png"}`);
  await page.screenshot(type === "jpeg" ? { path, type, quality: 82 } : { path });
  await page.close();
}
await browser.close();
await server.stop();
removeFolder(folder);
for (const problem of problems) console.error(problem);
process.exit(problems.length ? 1 : 0);
