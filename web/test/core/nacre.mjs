// The program that is tested, the folder it serves, and Chromium on its page.

import { spawn, spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { chromium } from "playwright-core";

const root = new URL("../../..", import.meta.url).pathname;
const program = resolve(process.env.NACRE ?? join(root, "build/nacre"));
const browserPath = process.env.CHROMIUM ?? "/usr/bin/chromium";

/// Why the tests cannot run here, or nothing.
export const hindrance = () =>
  !existsSync(browserPath)
    ? `${browserPath} is not there: apt-get install chromium, or name another in CHROMIUM`
    : !existsSync(program)
      ? `${program} is not there: build it, or name another in NACRE`
      : undefined;

/// What `nacre ARGUMENTS...` prints. @throws where it fails
export function nacre(args, cwd) {
  const { status, stdout, stderr } = spawnSync(program, args, { cwd, encoding: "utf8" });
  if (status !== 0) throw new Error(`nacre ${args.join(" ")}: ${stderr}`);
  return stdout;
}

export const exampleBrdf = `analytic

::begin parameters
color base 0.25 0.12 0.08
float exponent 1 500 60
bool normalised 1
::end parameters

::begin shader
const float PI = 3.14159265358979323846;

vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)
{
    float lobe = pow(max(0.0, dot(N, normalize(L + V))), exponent);
    if (normalised)
        lobe *= (exponent + 2.0) / (2.0 * PI);
    return base / PI + vec3(0.4 * lobe);
}
::end shader
`;

/// A folder with a measurement in MERL's format, a .brdf and a scene.
export function makeFolder() {
  const folder = mkdtempSync(join(tmpdir(), "nacre-page-"));
  nacre(["convert", "ggx_schlick:f0=0.9/0.6/0.3,alpha=0.3+lambert:reflectance=0.05", "gold.binary"], folder);
  writeFileSync(join(folder, "lobe.brdf"), exampleBrdf);
  copyFileSync(join(root, "docs/scenes/material.xml"), join(folder, "spheres.xml"));
  return folder;
}
export const removeFolder = (folder) => rmSync(folder, { recursive: true, force: true });

/// `nacre explore` in a folder. Its address, and its end.
export async function explore(folder, args = []) {
  const child = spawn(program, ["explore", "--no-browser", ...args], { cwd: folder, stdio: ["ignore", "pipe", "pipe"] });
  let said = "";
  child.stderr.on("data", (text) => (said += text));
  const address = await new Promise((resolve, reject) => {
    let printed = "";
    child.stdout.on("data", (text) => {
      printed += text;
      if (printed.includes("\n")) resolve(printed.trim());
    });
    child.on("exit", (code) => reject(new Error(`nacre explore ended with ${code}: ${said}`)));
  });
  const ended = new Promise((resolve) => child.on("exit", resolve));
  return {
    address,
    alive: () => child.exitCode === null && child.signalCode === null,
    stop: () => {
      child.kill("SIGINT");
      return ended;
    },
  };
}

export const launch = () =>
  chromium.launch({
    executablePath: browserPath,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
  });

/// A page on the address, settled. What it throws, says as an error or asks of others goes into `problems`.
export async function openPage(browser, address, { problems = [], size = { width: 1366, height: 768 }, scheme = "dark", scale = 1 } = {}) {
  const page = await browser.newPage({ viewport: size, colorScheme: scheme, deviceScaleFactor: scale, acceptDownloads: true });
  page.setDefaultTimeout(60_000);
  page.on("pageerror", (error) => problems.push(error.message));
  page.on("console", (m) => m.type() === "error" && problems.push(m.text()));
  page.on("request", (r) => /^(http:\/\/127\.0\.0\.1:|data:|blob:)/.test(r.url()) || problems.push(`asked ${r.url()}`));
  await page.goto(address);
  await page.waitForSelector(".material");
  await settled(page);
  return page;
}

/// Waits until `look`, run in the page with `about`, is true. The page's own policy forbids what Playwright does for this.
export async function until(page, look, about, seconds = 60) {
  for (const end = Date.now() + 1000 * seconds; !(await page.evaluate(look, about)); await page.waitForTimeout(50))
    if (Date.now() > end) throw new Error(`waited in vain for ${look}`);
}
/// How many samples a progressive picture says it has.
export const samplesOf = (view) => Number(document.querySelector(`[data-testid=view-${view}] .count`)?.textContent.match(/^[\d.]+/)?.[0] ?? 0);

export const settled = (page) => page.evaluate(() => window.nacre.settled());
export const plot = (page, id) => page.evaluate((name) => window.nacre.plots()[name], id);
export const stateOf = (page) => page.evaluate(() => JSON.parse(JSON.stringify(window.nacre.state)));
