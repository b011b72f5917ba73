// The page on the program itself: what is on the screen against what the command line says.

import assert from "node:assert/strict";
import { existsSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import WebSocket from "ws";
import { exampleBrdf, explore, launch, makeFolder, nacre, openPage, plot, removeFolder, samplesOf, settled, stateOf, until } from "./nacre.mjs";

const metal = "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.3";
const problems = [];
let folder;
let server;
let browser;

before(async () => {
  folder = makeFolder();
  server = await explore(folder, [metal, "lambert:reflectance=0.5"]);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await server?.stop();
  if (folder) removeFolder(folder);
});

const open = (address = server.address) => openPage(browser, address, { problems });

/// A test with a page of its own.
function onPage(name, body) {
  test(name, async () => {
    const page = await open();
    try {
      await body(page);
    } finally {
      await page.close();
    }
  });
}

const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
/// f by the command line, luminance; degrees.
function evaluated(material, theta_i, theta_o, phi) {
  const args = ["eval", material, "--theta-i", theta_i, "--theta-o", theta_o, "--phi", phi, "--json"];
  return luminance(JSON.parse(nacre(args.map(String), folder)).f);
}
function near(value, expected, relative, about) {
  assert.ok(Math.abs(value - expected) <= relative * Math.abs(expected) + 1e-7, `${about}: ${value}, expected ${expected}`);
}
const someOf = (x, keep) => [...x.keys()].filter((i) => keep(x[i])).filter((_, n, all) => n % Math.ceil(all.length / 4) === 0);

/// The half-angle plot at theta_d = 0 is retro-reflection, the polar one lies in the plane of incidence. Directions are
/// float at the core, double at the command line.
async function comparePlots(page, series, material, relative = 1e-3) {
  const half = await plot(page, "theta_h");
  for (const i of someOf(half.x, (x) => x < 80)) near(half.series[series].y[i], evaluated(material, half.x[i], half.x[i], 0), relative, `theta_h ${half.x[i]}`);
  const { theta_i } = (await stateOf(page)).directions;
  const polar = await plot(page, "polar");
  for (const i of someOf(polar.x, (x) => Math.abs(x) < 80)) {
    const expected = evaluated(material, theta_i, Math.abs(polar.x[i]), polar.x[i] < 0 ? 0 : 180);
    near(polar.series[series].y[i], expected, relative, `polar ${polar.x[i]}`);
  }
}

async function drag(page, selector, from, to) {
  const box = await page.locator(selector).first().boundingBox();
  const at = ([u, v]) => [box.x + u * box.width, box.y + v * box.height];
  await page.mouse.move(...at(from));
  await page.mouse.down();
  for (let k = 1; k <= 6; ++k) await page.mouse.move(...at([from[0] + ((to[0] - from[0]) * k) / 6, from[1] + ((to[1] - from[1]) * k) / 6]));
  await page.mouse.up();
}
async function enter(page, field, value) {
  await page.fill(`[data-testid=${field}] input.number`, String(value));
  await page.press(`[data-testid=${field}] input.number`, "Enter");
}
async function type(page, field, value) {
  await enter(page, field, value);
  await settled(page);
}
/// Drops a file onto the page as a desktop would.
async function drop(page, name, bytes) {
  const transfer = await page.evaluateHandle(
    ([file, base64]) => {
      const text = atob(base64);
      const content = new Uint8Array(text.length);
      for (let i = 0; i < text.length; ++i) content[i] = text.charCodeAt(i);
      const data = new DataTransfer();
      data.items.add(new File([content], file));
      return data;
    },
    [name, Buffer.from(bytes).toString("base64")],
  );
  await page.dispatchEvent(".app", "drop", { dataTransfer: transfer });
}
async function fromList(page, name, count) {
  await page.click("[data-testid=add-material]");
  await page.click("[data-testid=tab-files]");
  await page.click(`[data-testid='file-${name}']`);
  await page.waitForSelector(`.material >> nth=${count - 1}`);
  await settled(page);
}

onPage("a dragged slider and a typed angle give what nacre eval says, and undo takes them back", async (page) => {
  const first = await plot(page, "theta_h");
  await comparePlots(page, 0, metal);
  await drag(page, "[data-testid=parameter-alpha] input[type=range]", [0.5, 0.5], [0.8, 0.5]);
  await settled(page);
  const { alpha } = (await stateOf(page)).materials[0].source.lobes[0].parameters;
  assert.ok(alpha > 0.5, `${alpha}`);
  await type(page, "angle-theta_i", 62.5);
  await comparePlots(page, 0, `ggx_schlick:f0=0.9/0.6/0.3,alpha=${alpha}`);
  await drag(page, "[data-testid=view-polar] canvas", [0.25, 0.5], [0.45, 0.3]);
  await settled(page);
  assert.ok((await stateOf(page)).directions.theta_i < 30);
  await comparePlots(page, 0, `ggx_schlick:f0=0.9/0.6/0.3,alpha=${alpha}`);
  for (let k = 0; k < 3; ++k) await page.click("[data-testid=undo]");
  await settled(page);
  assert.deepEqual(await plot(page, "theta_h"), first);
});

onPage("a measurement and a .brdf are opened from the list of files", async (page) => {
  await fromList(page, "gold.binary", 3);
  await comparePlots(page, 2, "gold.binary");
  await fromList(page, "lobe.brdf", 4);
  // The file's own formula, at its defaults.
  const { x, series } = await plot(page, "theta_h");
  const expected = (degrees) => luminance([0.25, 0.12, 0.08]) / Math.PI + (0.4 * 62 * Math.cos((degrees * Math.PI) / 180) ** 60) / (2 * Math.PI);
  for (const i of someOf(x, (v) => v < 80)) near(series[3].y[i], expected(x[i]), 1e-3, `lobe.brdf at ${x[i]}`);
  await page.click("[data-testid=parameter-normalised] input");
  await settled(page);
  near((await plot(page, "theta_h")).series[3].y[0], luminance([0.25, 0.12, 0.08]) / Math.PI + 0.4, 1e-3, "switched off");
});

onPage("files are dropped: a measurement, a .brdf, a session", async (page) => {
  await page.click(".material >> nth=1");
  await page.keyboard.press("Delete");
  await drop(page, "mine.brdf", exampleBrdf);
  await page.waitForSelector(".material >> nth=1");
  await drop(page, "dropped.binary", readFileSync(join(folder, "gold.binary")));
  await page.waitForSelector(".material >> nth=2");
  await settled(page);
  assert.deepEqual((await stateOf(page)).materials.slice(1).map((m) => m.source.file ?? m.source.brdf.name), ["mine.brdf", "upload:dropped.binary"]);
  await comparePlots(page, 2, "gold.binary");
  await drop(page, "session.json", JSON.stringify({ nacre: 1, display: { log: true }, materials: [{ id: 4, name: "kept", color: "#ffffff", visible: true, source: { lobes: [{ model: "lambert", weight: 1, parameters: { reflectance: [0.2, 0.2, 0.2] } }] } }] }));
  await page.waitForSelector("[data-testid=material-4]");
  await settled(page);
  near((await plot(page, "theta_h")).series[0].y[3], 0.2 / Math.PI, 1e-5, "the session's material");
});

onPage("a fit converges before one's eyes, ends in a table, and is exported", async (page) => {
  await page.click("[data-testid=pane-fit]");
  await page.click("[data-testid=choose-measured]");
  await page.click("[data-testid='file-gold.binary']");
  await page.evaluate(() => {
    window.seen = [];
    window.watching = setInterval(() => {
      const plots = window.nacre.plots();
      const at = plots.convergence?.series[0];
      const shown = plots.theta_h?.series[1];
      if (at?.y.length && shown) window.seen.push([at.name, at.y.length, shown.y[0]]);
    }, 10);
  });
  for (const sum of ["ggx_conductor+oren_nayar", "ggx_schlick+lambert"]) {
    await page.fill(".model-choice input", sum);
    await page.press(".model-choice input", "Enter");
  }
  await page.click("[data-testid=fit-start]");
  await page.waitForSelector("[data-testid=fit-start]");
  await settled(page);
  const seen = await page.evaluate(() => (clearInterval(window.watching), window.seen.filter(([name]) => name === "ggx_conductor+oren_nayar")));
  assert.ok(new Set(seen.map(([, steps]) => steps)).size > 2, "the error is plotted step by step");
  assert.ok(new Set(seen.map(([, , y]) => y)).size > 2, "and the curve follows");
  const rows = await page.locator("[data-testid=fit-results] tbody tr").allTextContents();
  assert.equal(rows.length, 2);
  assert.match(rows[0], /^ggx_schlick\+lambert/, "the least error first");
  const [measured, fitted] = (await plot(page, "theta_h")).series;
  near(fitted.y[0], measured.y[0], 0.02, "the fit at the peak");
  const exported = async (format) => {
    await page.click("[data-testid='export-of-ggx_schlick+lambert']");
    const waiting = page.waitForEvent("download");
    await page.click(`[data-testid=export-${format}]`);
    const file = await waiting;
    return { name: file.suggestedFilename(), text: readFileSync(await file.path(), "utf8") };
  };
  const json = await exported("json");
  writeFileSync(join(folder, "fit.json"), json.text);
  near(evaluated("fit.json", 0, 0, 0), fitted.y[0], 1e-3, "what was exported is what is shown");
  for (const [format, sign] of [["brdf", /::begin shader/], ["pbrt", /Material/], ["mtlx", /<materialx/]]) {
    const { name, text } = await exported(format);
    assert.equal(name, `ggx_schlick_lambert.${format}`);
    assert.match(text, sign);
  }
  // Many starts of a sum take long; they end when told to.
  await page.fill(".model-choice input", "ggx_schlick+ggx_schlick+oren_nayar");
  await page.press(".model-choice input", "Enter");
  await page.click("[data-testid=fit-start]");
  await page.waitForTimeout(300);
  await page.click("[data-testid=fit-stop]");
  await page.waitForSelector("[data-testid=fit-start]", { timeout: 10_000 });
});

onPage("a violation is found, and a click sends every view to its directions", async (page) => {
  await page.keyboard.press("a");
  await page.keyboard.type("ward:specular_reflectance=1+lambert:reflectance=0.9");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".material >> nth=2");
  await page.click("[data-testid=pane-validate]");
  await page.click("[data-testid=validate-start]");
  const row = page.locator("[data-testid=laws] tr.violated", { hasText: "energy" });
  await row.waitFor();
  await page.waitForSelector("[data-testid=validate-start]");
  await row.click();
  await settled(page);
  const { theta_i } = (await stateOf(page)).directions;
  assert.match(await row.textContent(), new RegExp(`θo ${theta_i}`));
  assert.ok(theta_i !== 45, "it moved");
  const { x, series } = await plot(page, "albedo");
  assert.ok(series.at(-1).y[x.findIndex((v) => v >= theta_i)] > 1, "more leaves than came");
  await page.click("[data-testid=map-energy_map]");
  await page.click("[data-testid=material-1]");
  await type(page, "validate-samples", 1e6);
  await page.click("[data-testid=validate-start]");
  await page.waitForSelector("[data-testid=laws]");
  await page.click("[data-testid=validate-stop]");
  await page.waitForSelector("[data-testid=validate-start]", { timeout: 10_000 });
});

onPage("a scene is rendered progressively, inspected, compared, swapped and saved", async (page) => {
  await page.click("[data-testid=pane-render]");
  await page.click("[data-testid='file-spheres.xml']");
  await until(page, samplesOf, "render");
  const few = await page.evaluate(samplesOf, "render");
  assert.ok(few < 256, "shown before it is done");
  await until(page, (n) => Number(document.querySelector("[data-testid=view-render] .count").textContent.match(/^[\d.]+/)?.[0]) > n, few);
  await page.click(".fitted > canvas", { position: { x: 200, y: 250 } });
  await page.waitForSelector(".spectrum canvas");
  assert.match(await page.textContent(".inspector"), /materialshown/);
  await page.click("text=Keep as B");
  await page.waitForSelector(".split");
  await drag(page, ".split", [0.5, 0.5], [60, 0.5]);
  assert.ok((await stateOf(page)).render.split > 0.5);
  // The material of the list onto the scene's.
  await page.dragAndDrop("[data-testid=material-1]", ".swaps li >> nth=0");
  assert.equal(Object.keys((await stateOf(page)).render.swap)[0], "shown");
  await until(page, samplesOf, "render");
  await page.selectOption("[data-testid=select-operator]", "hable");
  await enter(page, "render-exposure", 1); // not settled before all samples are taken
  for (const [name, magic] of [["picture.png", "\x89PNG"], ["picture.exr", "\x76\x2f\x31\x01"]]) {
    await page.click("[data-testid=save-picture]");
    await page.fill("[data-testid=save-name]", name);
    await page.press("[data-testid=save-name]", "Enter");
    await page.waitForSelector(`text=${name} saved`);
    assert.equal(readFileSync(join(folder, name)).toString("latin1", 0, 4), magic);
  }
  assert.match(nacre(["info", "picture.exr"], folder), /220/);
  await drag(page, ".fitted > canvas", [0.7, 0.8], [0.6, 0.8]);
  assert.ok((await stateOf(page)).render.camera !== null, "turned");
});

onPage("an object is lit, and another sampling is asked for", async (page) => {
  await page.click("[data-testid=pane-object]");
  await page.waitForSelector("text=/\\d+ samples/");
  await page.click("[data-testid=sampling-light]");
  await page.selectOption("[data-testid=select-environment]", "white");
  await page.selectOption("[data-testid=select-mesh]", "sphere");
  await page.waitForSelector("text=/\\d+ samples/");
  assert.equal(await page.locator(".view-error").count(), 0);
});

onPage("code with an error says so at its line, mends, and the plots follow", async (page) => {
  await fromList(page, "lobe.brdf", 3);
  await page.click("[data-testid=pane-edit]");
  const before_ = (await plot(page, "theta_h")).series[2].y[0];
  await page.waitForSelector("text=/compiled in/");
  const write = (text) => page.evaluate((source) => {
    const { editor } = document.querySelector("[data-testid=code]");
    editor.dispatch({ changes: { from: 0, to: editor.state.doc.length, insert: source } });
  }, text);
  await write(exampleBrdf.replace("* lobe);", "* lobes);"));
  await page.waitForSelector("[data-testid=verdict].bad");
  const line = exampleBrdf.split("\n").findIndex((l) => l.includes("* lobe);")) + 1;
  assert.match(await page.textContent("[data-testid=verdict]"), new RegExp(`^${line}: .*lobes`));
  assert.equal(await page.locator(".cm-lint-marker-error").count(), 1);
  assert.equal((await plot(page, "theta_h")).series[2].y[0], before_, "what compiled last is shown");
  await write(exampleBrdf.replace("0.4 * lobe", "0.8 * lobe"));
  await page.waitForSelector("[data-testid=verdict].ok");
  await settled(page);
  const base = luminance([0.25, 0.12, 0.08]) / Math.PI;
  near((await plot(page, "theta_h")).series[2].y[0] - base, 2 * (before_ - base), 1e-3, "twice the lobe");
  await write(exampleBrdf.replace("return base", "for (;;) lobe += 1.0;\n    return base"));
  await page.waitForSelector("[data-testid=verdict].bad");
  assert.match(await page.textContent("[data-testid=verdict]"), /^\d+: /, "a loop without end has its line too");
});

onPage("a file that is changed by another program is followed", async (page) => {
  writeFileSync(join(folder, "watched.brdf"), exampleBrdf);
  await fromList(page, "watched.brdf", 3);
  const before_ = (await plot(page, "theta_h")).series[2].y[0];
  writeFileSync(join(folder, "watched.brdf"), exampleBrdf.replace("0.4 * lobe", "0.1 * lobe"));
  await page.waitForSelector("text=watched.brdf changed, reloaded");
  await settled(page);
  assert.ok((await plot(page, "theta_h")).series[2].y[0] < 0.5 * before_);
});

onPage("the address brings the same page back", async (page) => {
  await page.keyboard.press("l");
  await type(page, "angle-theta_i", 33);
  await page.click("[data-testid=pane-physics]");
  await page.click("[data-testid=pane-explore]");
  await settled(page);
  await page.waitForTimeout(400); // the address follows after a moment
  const [state, curve] = [await stateOf(page), await plot(page, "polar")];
  await page.reload();
  await page.waitForSelector(".material");
  await settled(page);
  assert.deepEqual(await stateOf(page), state);
  assert.deepEqual(await plot(page, "polar"), curve);
});

onPage("two browsers at once see their own", async (page) => {
  const other = await launch();
  try {
    const second = await openPage(other, server.address, { problems });
    await Promise.all([type(page, "parameter-alpha", 0.2), type(second, "parameter-alpha", 0.6)]);
    await comparePlots(page, 0, "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.2");
    await comparePlots(second, 0, "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.6");
  } finally {
    await other.close();
  }
  await type(page, "parameter-alpha", 0.5);
  await comparePlots(page, 0, "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.5");
});

onPage("all of it is reached by keys", async (page) => {
  await page.keyboard.press("ArrowDown");
  assert.equal((await stateOf(page)).selected, 2);
  for (const key of ["s", "l", "c", "g", "]"]) await page.keyboard.press(key);
  await settled(page);
  const { solo, display } = await stateOf(page);
  assert.deepEqual({ solo, ...display }, { solo: 2, channel: "g", log: true, cosine: true, exposure: 0.5, gamma: 2.2 });
  assert.equal((await plot(page, "theta_h")).series.length, 1);
  await page.keyboard.press("Shift+ArrowUp");
  assert.equal((await stateOf(page)).directions.theta_i, 44);
  await page.keyboard.press("Control+z");
  assert.equal((await stateOf(page)).directions.theta_i, 45);
  for (let k = 1; k <= 7; ++k) {
    await page.keyboard.press(String(k));
    await page.waitForSelector("nav button.on");
  }
  assert.equal((await stateOf(page)).pane, "physics");
  await page.keyboard.press("1");
  await page.keyboard.press("a");
  await page.keyboard.type("ggx_plastic");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".material >> nth=2");
  await page.keyboard.press("?");
  await page.waitForSelector(".keys");
  await page.keyboard.press("Escape");
  await page.waitForSelector(".keys", { state: "detached", timeout: 5000 });
  // A slider is reached by Tab and moved by arrows.
  await page.focus("[data-testid=angle-theta_i] input[type=range]");
  await page.keyboard.press("ArrowRight");
  assert.ok((await stateOf(page)).directions.theta_i > 45);
});

onPage("each idea of physics has its numbers from the core", async (page) => {
  await page.click("[data-testid=pane-physics]");
  const ids = await page.locator("[data-testid^=topic-]").evaluateAll((all) => all.map((b) => b.dataset.testid));
  assert.equal(ids.length, 12);
  for (const id of ids) {
    await page.click(`[data-testid=${id}]`);
    await settled(page);
    const { x, series } = await plot(page, id.replace("topic-", "physics "));
    assert.ok(x.length > 10 && series.length > 0, id);
    for (const s of series) assert.ok(s.y.some((v) => v > 0), `${id}: ${s.name}`);
    assert.equal(await page.locator(".view-error").count(), 0, id);
  }
  await page.click("[data-testid=topic-snell]");
  await type(page, "physics-theta_i", 40);
  const { x, series } = await plot(page, "physics snell");
  const i = x.findIndex((v) => v >= 40);
  near(series[0].y[i], (180 / Math.PI) * Math.asin(Math.sin((x[i] * Math.PI) / 180) / 1.5), 1e-4, "Snell's law");
});

onPage("every view has something to show", async (page) => {
  await page.click("[data-testid=choose-views]");
  await page.click(".view-list button:last-child");
  await page.keyboard.press("Escape");
  await settled(page);
  const plots = await page.evaluate(() => window.nacre.plots());
  for (const id of ["theta_h", "theta_d", "theta_i", "theta_o", "phi", "polar", "albedo", "D", "G1"]) assert.ok(plots[id].series[0].y.some((v) => v > 0), id);
  const images = await page.evaluate(() => Object.fromEntries(Object.entries(window.nacre.images()).map(([k, v]) => [k, Math.max(...v.rgb)])));
  for (const id of ["sphere 1", "slice 1", "sphere 2", "slice 2"]) assert.ok(images[id] > 0.1, id);
  assert.equal(await page.locator(".view-error").count(), 0);
  const waiting = page.waitForEvent("download");
  await page.hover("[data-testid=view-lobe3d]");
  await page.keyboard.press("i");
  assert.equal((await waiting).suggestedFilename(), "nacre-lobe3d.png");
});

test("pages that vanish, nonsense and a file without end leave the server as it was", async () => {
  const url = new URL(server.address);
  const connect = (headers = {}) =>
    new Promise((resolve, reject) => {
      const socket = new WebSocket(`ws://${url.host}/ws${url.search}`, { headers });
      socket.on("open", () => resolve(socket));
      socket.on("error", reject);
    });
  const socket = await connect();
  const answer = () => new Promise((resolve) => socket.once("message", (data) => resolve(JSON.parse(String(data)))));
  for (const [sent, expected] of [["{", /JSON/], ['{"id": 1}', /type/], ['{"id": 2, "type": "curvs"}', /curves/], ["[".repeat(100000), /nest/]]) {
    const got = answer();
    socket.send(sent);
    assert.match((await got).error.message, expected);
  }
  socket.terminate();
  const vanishing = await connect();
  vanishing.send(JSON.stringify({ id: 1, type: "object", material: { text: "lambert" }, width: 256, height: 256, samples: 0 }));
  vanishing._socket.write(Buffer.from([0x81, 0xfe, 0xff, 0xff, 1, 2])); // a frame that never ends
  vanishing.terminate();
  await assert.rejects(connect({ origin: "http://example.org" }), /403/);
  let sent = 0;
  const endless = new ReadableStream({
    pull(controller) {
      if (sent >= 1 << 30) return controller.close();
      sent += 1 << 20;
      controller.enqueue(new Uint8Array(1 << 20));
    },
  });
  const upload = await fetch(`http://${url.host}/upload${url.search}&name=big.binary`, { method: "POST", body: endless, duplex: "half" }).catch((e) => e);
  assert.ok(upload instanceof Error || upload.status === 413, `${upload.status}`);
  assert.ok(server.alive());
  const page = await open();
  await comparePlots(page, 0, metal);
  await page.close();
});

test("no page threw, said an error or asked another server", () => assert.deepEqual(problems, []));
