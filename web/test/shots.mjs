// Screenshots of the page on the mock core, to be looked at: node test/shots.mjs [name...]

import { mkdir } from "node:fs/promises";
import { chromium } from "playwright-core";
import { serve } from "./mock/serve.mjs";

const laptop = { width: 1366, height: 768 };
const shots = {
  explore: {},
  light: { scheme: "light" },
  log: { act: (p) => p.keyboard.press("l") },
  all: { act: async (p) => (await p.click("[data-testid=choose-views]"), await p.click(".view-list button:last-child"), await p.keyboard.press("Escape")) },
  large: { size: { width: 3840, height: 2160 } },
  add: { act: (p) => p.click("[data-testid=add-material]") },
  object: { act: (p) => p.click("[data-testid=pane-object]"), wait: 1500 },
  render: { act: async (p) => (await p.click("[data-testid=pane-render]"), await p.click("[data-testid=choose-scene]"), await p.click("[data-testid='file-room.xml']")), wait: 1500 },
  edit: { act: async (p) => (await p.click('[data-testid=pane-edit]'), await p.click('[data-testid=new-brdf]')), wait: 600 },
  fit: { act: async (p) => (await p.click("[data-testid=pane-fit]"), await p.click("[data-testid=choose-measured]"), await p.click("[data-testid='file-gold.binary']"), await p.click('[data-testid=fit-model-ggx_schlick]'), await p.click('[data-testid=fit-model-lambert]'), await p.click('[data-testid=fit-start]')), wait: 2500 },
  validate: { act: async (p) => (await p.click("[data-testid=pane-validate]"), await p.click("[data-testid=validate-start]")), wait: 800 },
  masking: { act: async (p) => (await p.click("[data-testid=pane-physics]"), await p.click("[data-testid=topic-masking]")), wait: 500 },
  physics: { act: (p) => p.click("[data-testid=pane-physics]"), wait: 500 },
};

const wanted = process.argv.slice(2);
await mkdir("shots", { recursive: true });
const server = await serve();
const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
for (const [name, shot] of Object.entries(shots)) {
  if (wanted.length && !wanted.includes(name)) continue;
  const page = await browser.newPage({ viewport: shot.size ?? laptop, colorScheme: shot.scheme ?? "dark" });
  page.on("pageerror", (error) => console.log(`${name}: ${error.message}`));
  page.on("console", (m) => m.type() === "error" && console.log(`${name}: ${m.text()}`));
  await page.goto(`http://127.0.0.1:${server.address().port}/?token=mock`);
  await page.waitForSelector(".material");
  await page.evaluate(() => window.nacre.settled());
  if (shot.act) await shot.act(page).catch((e) => console.log(`${name}: ${e.message.split("\n")[0]}`));
  if (shot.wait) await page.waitForTimeout(shot.wait);
  await Promise.race([page.evaluate(() => window.nacre.settled()), page.waitForTimeout(3000)]);
  await page.screenshot({ path: `shots/${name}.png` });
  await page.close();
}
await browser.close();
server.close();
