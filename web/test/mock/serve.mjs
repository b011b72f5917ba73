// A stand-in for the core: serves dist/ and answers the protocol with simple analytic data.
//   node test/mock/serve.mjs [port]

import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { WebSocketServer } from "ws";
import * as answers from "./answers.mjs";
import { lobesOf, direction } from "./brdf.mjs";

const dist = new URL("../../dist", import.meta.url).pathname;
const types = { html: "text/html", js: "text/javascript", css: "text/css", txt: "text/plain" };

function frame(header, arrays) {
  const list = Object.entries(arrays);
  const text = Buffer.from(JSON.stringify({ ...header, arrays: list.map(([name, { shape }]) => ({ name, shape })) }));
  const length = Buffer.alloc(4);
  length.writeUInt32LE(text.length);
  const padding = Buffer.alloc((4 - ((4 + text.length) % 4)) % 4);
  const data = list.map(([, { data: d }]) => Buffer.from(d.buffer, d.byteOffset, d.byteLength));
  return Buffer.concat([length, text, padding, ...data]);
}

const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const brdfText = `analytic

::begin parameters
float alpha 0.001 1 .1
::end parameters

::begin shader
const float PI = 3.14159265358979323846;

float sqr(float x) { return x * x; }

float GGX(float alpha, float cosThetaM)
{
    float CosSquared = cosThetaM * cosThetaM;
    float TanSquared = (1 - CosSquared) / CosSquared;
    return (1.0 / PI) * sqr(alpha / (CosSquared * (alpha * alpha + TanSquared)));
}

vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)
{
    vec3 H = normalize(L + V);
    return vec3(GGX(alpha, dot(N, H)));
}
::end shader
`;

async function* long(type, body, cancelled) {
  if (type === "watch") {
    while (!cancelled()) await sleep(100);
    return [{ cancelled: true }, {}];
  }
  if (type === "fit") {
    for (let i = 1; i <= 12 && !cancelled(); ++i) {
      await sleep(120);
      yield [{ model: body.models[0], material: fitted(0.8 / i + 0.25), best_error: 0.3 / i, iteration: i }, {}, i / 12];
    }
    const results = body.models.map((model, i) => ({
      model,
      material: fitted(0.25 + 0.1 * i),
      parameters: [
        { name: "alpha", value: 0.25 + 0.1 * i, error: 0.0004 },
        { name: "f0", value: [0.4, 0.25, 0.08], error: 0.0003, at_bound: i > 0 },
      ],
      errors: { cosine: 0.0158 * (i + 1), log: 0.0121 * (3 - i) },
      seconds: 1.6 + i,
    }));
    return [{ results, cancelled: cancelled() }, {}];
  }
  const scale = body.scale ?? 1;
  const width = body.width ?? Math.round(640 * scale);
  const height = body.height ?? Math.round(400 * scale);
  const swap = Object.values(body.swap ?? {})[0];
  const lobes = lobesOf(body.material ?? swap ?? { text: "ggx_plastic" });
  const camera = body.camera ?? { azimuth: 30, elevation: 20 };
  const clean = answers.shade(lobes, width, height, 1.6, [0, 0], direction(60 - camera.elevation / 2, camera.azimuth));
  for (let i = 0, o = 0; o < clean.data.length; ++i, o += 3) if (!clean.data[o]) clean.data.set([0.18, 0.2, 0.24], o);
  let samples = 0;
  const picture = () => {
    const noise = 0.8 / Math.sqrt(samples);
    return { shape: clean.shape, data: clean.data.map((v) => Math.max(0, v * (1 + noise * (Math.random() * 2 - 1)))) };
  };
  const goal = body.samples || 4096;
  while (samples < goal && !cancelled()) {
    await sleep(samples < 8 ? 30 : 250);
    samples = Math.min(goal, samples ? samples * 2 : 1);
    yield [{ samples, materials: ["floor", "sphere", "walls"], integrator: "path", camera: { target: [0, 0, 0], distance: 4, azimuth: 30, elevation: 20, fov: 35, ...body.camera } }, { image: picture() }, samples / goal];
  }
  return [{ samples, seconds: 1.5, cancelled: cancelled() }, { image: picture() }];
}
const fitted = (alpha) => ({ name: "fit", lobes: [{ model: "ggx_schlick", weight: 1, parameters: { f0: [0.4, 0.25, 0.08], alpha } }] });

const pictures = new Map();

function short(type, body) {
  if (type === "read") return { text: brdfText };
  if (type === "write" || type === "save") return {};
  if (type === "export") return { text: JSON.stringify(body.material, null, 1), remark: "exact" };
  if (type === "inspect") {
    const nm = Array.from({ length: 41 }, (_, i) => 380 + i * 10);
    return { rgb: [0.4, 0.3, 0.2], xyz: [0.3, 0.3, 0.2], samples: 64, variance: 0.001, material: "sphere", spectrum: { wavelength_nm: nm, radiance: nm.map((l) => 1 + Math.sin(l / 60)) } };
  }
  if (type === "display") {
    const image = pictures.get(body.of);
    if (!image) throw new Error("no such picture");
    const k = 2 ** body.exposure;
    return [{}, { image: { shape: image.shape, data: image.data.map((v) => Math.min(1, ((v * k) / (1 + (v * k) / 4)) ** (1 / 2.2))) } }];
  }
  if (!answers[type]) throw new Error(`unknown type '${type}'`);
  return answers[type](body);
}

export function serve(port = 0) {
  const server = createServer(async (request, response) => {
    const url = new URL(request.url, "http://localhost");
    if (request.method === "POST") {
      request.resume();
      return response.end(JSON.stringify({ file: url.searchParams.get("name") }));
    }
    const path = url.pathname === "/" ? "/index.html" : url.pathname;
    try {
      const body = await readFile(dist + path);
      response.setHeader("content-type", types[path.split(".").pop()] ?? "application/octet-stream");
      response.end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  const sockets = new WebSocketServer({ server, path: "/ws" });
  server.sockets = sockets;
  sockets.on("connection", (socket) => {
    const cancelled = new Set();
    socket.on("close", () => cancelled.add("all"));
    const send = (id, header, arrays = {}) =>
      socket.send(Object.keys(arrays).length ? frame({ id, ok: true, ...header }, arrays) : JSON.stringify({ id, ok: true, ...header }));
    socket.on("message", async (text) => {
      const { id, type, ...body } = JSON.parse(text);
      try {
        if (type === "cancel") return cancelled.add(body.of);
        if (["watch", "object", "render", "fit"].includes(type)) {
          const work = long(type, body, () => cancelled.has(id) || cancelled.has("all"));
          for (;;) {
            const { value, done } = await work.next();
            const [header, arrays, progress] = value;
            if (arrays.image) pictures.set(id, arrays.image);
            send(id, done ? header : { ...header, progress }, arrays);
            if (done) return;
          }
        }
        const answer = short(type, body);
        if (Array.isArray(answer)) send(id, ...answer);
        else send(id, answer);
      } catch (error) {
        socket.send(JSON.stringify({ id, error: { message: error.message } }));
      }
    });
  });
  return new Promise((resolve) => server.listen(port, "127.0.0.1", () => resolve(server)));
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  const server = await serve(Number(process.argv[2] ?? 8123));
  console.log(`http://127.0.0.1:${server.address().port}/?token=mock`);
}
