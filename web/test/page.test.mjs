// The page in Chromium on the mock core: node --test test/page.test.mjs, after a build.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";
import { serve } from "./mock/serve.mjs";

let server;
let browser;
let address;
const problems = [];

before(async () => {
  server = await serve();
  address = `http://127.0.0.1:${server.address().port}/?token=mock`;
  browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });
});
after(async () => {
  await browser.close();
  server.closeAllConnections();
  server.close();
});

async function open(url = address) {
  const page = await browser.newPage({ viewport: { width: 1366, height: 768 } });
  page.setDefaultTimeout(20_000);
  page.on("pageerror", (error) => problems.push(error.message));
  await page.goto(url);
  await page.waitForSelector(".material");
  await settled(page);
  return page;
}
const settled = (page) => page.evaluate(() => window.nacre.settled());
const plot = (page, id) => page.evaluate((name) => window.nacre.plots()[name], id);
const state = (page) => page.evaluate(() => JSON.parse(JSON.stringify(window.nacre.state)));

async function drag(page, selector, from, to) {
  const box = await page.locator(selector).boundingBox();
  const at = ([u, v]) => [box.x + u * box.width, box.y + v * box.height];
  await page.mouse.move(...at(from));
  await page.mouse.down();
  for (let k = 1; k <= 8; ++k)
    await page.mouse.move(...at([from[0] + ((to[0] - from[0]) * k) / 8, from[1] + ((to[1] - from[1]) * k) / 8]));
  await page.mouse.up();
}

test("dragging a slider changes the plot, and one undo takes the whole drag back", async () => {
  const page = await open();
  const before_ = await plot(page, "theta_h");
  await drag(page, "[data-testid=parameter-alpha] input[type=range]", [0.26, 0.5], [0.8, 0.5]);
  await settled(page);
  const changed = await plot(page, "theta_h");
  assert.ok(changed.series[0].y[0] < before_.series[0].y[0] / 2);
  assert.deepEqual(changed.series[1].y, before_.series[1].y);
  await page.click("[data-testid=undo]");
  await settled(page);
  assert.deepEqual((await plot(page, "theta_h")).series[0].y, before_.series[0].y);
  await page.close();
});

test("a typed value is taken, and clamped to its range", async () => {
  const page = await open();
  const field = page.locator("[data-testid=parameter-alpha] input.number");
  await field.fill("0.5");
  await field.press("Enter");
  assert.equal((await state(page)).materials[0].source.lobes[0].parameters.alpha, 0.5);
  await field.fill("7");
  await field.press("Enter");
  assert.equal((await state(page)).materials[0].source.lobes[0].parameters.alpha, 1);
  await page.close();
});

test("the light is dragged in the polar plot and on the sphere", async () => {
  const page = await open();
  await drag(page, "[data-testid=view-polar] canvas", [0.25, 0.5], [0.45, 0.3]);
  const { theta_i } = (await state(page)).directions;
  assert.ok(theta_i < 30, `${theta_i}`);
  await drag(page, "[data-testid=sphere-1] canvas", [0.5, 0.5], [0.5, 0.2]);
  const after_ = (await state(page)).directions;
  assert.ok(Math.abs(after_.phi_i - 90) < 3, `${after_.phi_i}`);
  await page.close();
});

test("solo, duplicate and remove decide what is plotted", async () => {
  const page = await open();
  await page.keyboard.press("s");
  await settled(page);
  assert.equal((await plot(page, "theta_h")).series.length, 1);
  await page.keyboard.press("s");
  await page.keyboard.press("d");
  await settled(page);
  assert.equal((await plot(page, "theta_h")).series.length, 4);
  await page.keyboard.press("Delete");
  await settled(page);
  assert.equal((await plot(page, "theta_h")).series.length, 3);
  await page.close();
});

test("the address brings the same page back", async () => {
  const page = await open();
  await page.keyboard.press("l");
  await page.keyboard.press("d");
  await page.waitForTimeout(400);
  const first = await state(page);
  const second = await open(page.url());
  assert.deepEqual(await state(second), first);
  await page.close();
  await second.close();
});

test("a material is typed as on the command line", async () => {
  const page = await open();
  await page.keyboard.press("a");
  await page.fill("[data-testid=material-text]", "ggx_conductor:alpha_x=0.3+lambert");
  await page.keyboard.press("Enter");
  await page.waitForSelector("[data-testid=material-4]");
  assert.equal((await state(page)).materials[3].source.lobes.length, 2);
  await page.close();
});

test("code with an error says its line, and mends", async () => {
  const page = await open();
  await page.click("[data-testid=pane-edit]");
  await page.click("[data-testid=new-brdf]");
  await page.click("[data-testid=code] .cm-content");
  await page.keyboard.press("Control+Home");
  await page.keyboard.type("oops");
  await page.waitForSelector("[data-testid=verdict].bad");
  assert.match(await page.textContent("[data-testid=verdict]"), /^1: 'oops'/);
  assert.equal(await page.locator(".cm-lint-marker-error").count(), 1);
  for (let k = 0; k < 4; ++k) await page.keyboard.press("Backspace");
  await page.waitForSelector("[data-testid=verdict].ok");
  await page.close();
});

test("a fit ends in a table, and its best is shown", async () => {
  const page = await open();
  await page.click("[data-testid=pane-fit]");
  await page.click("[data-testid=choose-measured]");
  await page.click("[data-testid='file-gold.binary']");
  await page.click("[data-testid=fit-model-ggx_schlick]");
  await page.click("[data-testid=fit-model-lambert]");
  await page.click("[data-testid=fit-start]");
  await page.waitForSelector("[data-testid=fit-results]");
  await settled(page);
  assert.equal(await page.locator("[data-testid=fit-results] tbody tr").count(), 2);
  assert.deepEqual((await plot(page, "theta_h")).series.map((s) => s.name), ["gold.binary", "ggx_schlick"]);
  await page.close();
});

test("a violation sends every view to its directions", async () => {
  const page = await open();
  await page.click("[data-testid=pane-validate]");
  await page.click("[data-testid=validate-start]");
  await page.click("[data-testid=laws] tr.violated");
  const { theta_i, theta_o, phi_o } = (await state(page)).directions;
  assert.deepEqual({ theta_i, theta_o, phi_o }, { theta_i: 70, theta_o: 12, phi_o: 140 });
  await page.close();
});

test("a scene is rendered, kept as B, and a pixel inspected", async () => {
  const page = await open();
  await page.click("[data-testid=pane-render]");
  await page.click("[data-testid='file-room.xml']");
  await page.waitForSelector("text=/\\d+ samples, /");
  await page.click("text=Keep as B");
  await page.waitForSelector(".split");
  await page.click(".fitted > canvas", { position: { x: 60, y: 60 } });
  await page.waitForSelector(".spectrum canvas");
  await page.selectOption("[data-testid=select-operator]", "reinhard");
  await settled(page);
  await page.close();
});

test("each idea of physics draws its curves", async () => {
  const page = await open();
  await page.click("[data-testid=pane-physics]");
  for (const id of await page.locator("[data-testid^=topic-]").evaluateAll((all) => all.map((b) => b.dataset.testid))) {
    await page.click(`[data-testid=${id}]`);
    await settled(page);
    assert.ok((await plot(page, id.replace("topic-", "physics "))).series.length > 0, id);
  }
  await page.close();
});

test("dragging with eight materials, the median frame of the page takes less than a sixtieth of a second", async () => {
  const page = await open();
  for (let k = 0; k < 5; ++k) await page.keyboard.press("d");
  await settled(page);
  await page.evaluate(() => {
    window.spent = [];
    const frame = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (job) =>
      frame((t) => {
        const begun = performance.now();
        job(t);
        window.spent.push(performance.now() - begun);
      });
  });
  await drag(page, "[data-testid=angle-theta_i] input[type=range]", [0.5, 0.5], [0.9, 0.5]);
  await settled(page);
  const spent = (await page.evaluate(() => window.spent)).sort((a, b) => a - b);
  assert.ok(spent[spent.length >> 1] < 1000 / 60);
  console.log(`frames ${spent.length}, median ${spent[spent.length >> 1].toFixed(1)} ms, longest ${spent.at(-1).toFixed(1)} ms`);
  await page.close();
});

test("a core that vanishes and comes back is asked again", async () => {
  const own = await serve();
  const { port } = own.address();
  const page = await open(`http://127.0.0.1:${port}/?token=mock`);
  own.closeAllConnections();
  own.sockets.clients.forEach((socket) => socket.terminate());
  await new Promise((resolve) => own.close(resolve));
  await page.waitForSelector(".status.lost");
  await page.keyboard.press("Shift+ArrowDown");
  const again = await serve(port);
  await page.waitForSelector(".status", { state: "detached" });
  await settled(page);
  const { series, x } = await plot(page, "polar");
  const other = await open(page.url().replace(/#.*/, "") + "#" + page.url().split("#")[1]);
  assert.deepEqual((await plot(other, "polar")).series, series);
  assert.equal(x.length, series[0].y.length);
  await other.close();
  await page.close();
  again.closeAllConnections();
  again.close();
});

test("no page threw", () => assert.deepEqual(problems, []));
