// Answers of the protocol for looking at the page: each returns a header and arrays.

import { albedo, direction, evaluate, fromHalf, ggxD, lobesOf, parameters, smithG1 } from "./brdf.mjs";

const rad = Math.PI / 180;
const array = (shape) => ({ shape, data: new Float32Array(shape.reduce((a, b) => a * b, 1)) });

export const hello = () => ({
  version: "mock",
  root: "mock",
  models: Object.entries(parameters).map(([name, list]) => ({
    name,
    summary: { lambert: "ideal diffuse reflection", ggx_schlick: "rough reflection with a colour at normal incidence" }[name] ?? "a model of the mock",
    source: "mock",
    laws: {},
    parameters: list,
  })),
  start: [],
  metrics: ["cosine", "log"],
  integrators: [{ name: "path" }, { name: "direct" }],
  operators: [{ name: "reinhard", parameters: [{ name: "white", unit: "1", meaning: "what becomes white", lo: 0.1, hi: 20, initial: 4, is_color: false, is_switch: false }] }, { name: "narkowicz" }],
  formats: [{ name: "json", summary: "Nacre", ending: ".json" }, { name: "pbrt", summary: "pbrt-v4", ending: ".pbrt" }],
});

export const files = () => ({
  entries: [
    { name: "measured", is_folder: true, size: 0, modified: 0 },
    { name: "gold.binary", is_folder: false, kind: "measured", size: 34992012, modified: 0 },
    { name: "d_ggx.brdf", is_folder: false, kind: "brdf", size: 1000, modified: 0 },
    { name: "room.xml", is_folder: false, kind: "scene", size: 4000, modified: 0 },
    { name: "studio.exr", is_folder: false, kind: "environment", size: 3e6, modified: 0 },
  ],
});

export const material = ({ material: m }) =>
  m.file
    ? { name: m.file, kind: "measured", is_isotropic: true, holes: 12, facts: { kind: "MERL table", resolution: "90 x 90 x 180" } }
    : {
        name: m.name ?? m.text?.split(":")[0] ?? "material",
        kind: "model",
        is_isotropic: true,
        lobes: lobesOf(m).map((l) => ({
          model: l.model,
          weight: l.weight,
          parameters: parameters[l.model].map((p) => ({ ...p, value: l.parameters[p.name] })),
        })),
      };

export function curves({ materials, kind, theta_i, phi_i, theta_d, phi_o, points: n }) {
  const x = array([n]);
  const cosine = array([n]);
  const y = array([materials.length, n, 3]);
  const [from, to] = kind === "polar" ? [-90, 90] : kind === "phi" ? [0, 360] : [0, 90];
  const all = materials.map(lobesOf);
  for (let i = 0; i < n; ++i) {
    const a = (x.data[i] = from + ((to - from) * i) / (n - 1));
    let wi = direction(theta_i, phi_i);
    let wo = direction(a, phi_i + 180);
    if (kind === "theta_h") [wi, wo] = fromHalf(a, theta_d, 90);
    if (kind === "theta_d") [wi, wo] = fromHalf(0, a, 90);
    if (kind === "theta_i") [wi, wo] = [direction(a, phi_i), direction(theta_i, phi_i + 180)];
    if (kind === "theta_o") wo = direction(a, phi_i + phi_o);
    if (kind === "phi") wo = direction(theta_i, phi_i + a);
    cosine.data[i] = ["albedo", "G1"].includes(kind) ? 1 : kind.startsWith("theta_") && kind !== "theta_o" ? wi[2] : Math.max(0, wo[2]);
    all.forEach((lobes, m) => {
      const o = 3 * (m * n + i);
      const facet = lobes.find((l) => l.model.startsWith("ggx"));
      const alpha = facet?.parameters.alpha ?? facet?.parameters.alpha_x;
      if (kind === "albedo") {
        if (i % 6 === 0 || i === n - 1) albedo(lobes, a, y.data, o);
        else for (let c = 0; c < 3; ++c) y.data[o + c] = y.data[o + c - 3];
      } else if (kind === "D" || kind === "G1") {
        const v = facet ? (kind === "D" ? ggxD(Math.cos(a * rad), alpha) : smithG1(Math.cos(a * rad), alpha)) : NaN;
        y.data.fill(v, o, o + 3);
      } else evaluate(lobes, wi, wo, y.data, o);
    });
  }
  return [{}, { x, y, cosine }];
}

export function lobe3d({ material: m, theta_i, phi_i, n_theta, n_phi }) {
  const f = array([n_theta, n_phi, 3]);
  const lobes = lobesOf(m);
  const wi = direction(theta_i, phi_i);
  for (let t = 0, o = 0; t < n_theta; ++t)
    for (let p = 0; p < n_phi; ++p, o += 3) evaluate(lobes, wi, direction((90 * t) / (n_theta - 1), (360 * p) / (n_phi - 1)), f.data, o);
  return [{ theta_max: 90 }, { f }];
}

export function slice({ material: m, size, phi_d, sqrt_theta_h }) {
  const image = array([size, size, 3]);
  const lobes = lobesOf(m);
  for (let y = 0, o = 0; y < size; ++y)
    for (let x = 0; x < size; ++x, o += 3) {
      const u = (x + 0.5) / size;
      const [wi, wo] = fromHalf(90 * (sqrt_theta_h ? u * u : u), 90 * (1 - (y + 0.5) / size), phi_d);
      evaluate(lobes, wi, wo, image.data, o);
      if (wi[2] <= 0 || wo[2] <= 0) image.data.fill(0, o, o + 3);
    }
  return [{}, { image }];
}

export function shade(lobes, width, height, scale, at, light, cosine = true) {
  const image = array([height, width, 3]);
  for (let y = 0, o = 0; y < height; ++y)
    for (let x = 0; x < width; ++x, o += 3) {
      const u = ((2 * (x + 0.5) - width) / height) * scale - at[0];
      const v = -((2 * (y + 0.5)) / height - 1) * scale - at[1];
      const r2 = u * u + v * v;
      if (r2 >= 1) continue;
      const n = [u, v, Math.sqrt(1 - r2)];
      const t = Math.abs(n[2]) > 0.999 ? [1, 0, 0] : norm([n[1], -n[0], 0]);
      const b = cross(n, t);
      const local = (w) => [dot(w, t), dot(w, b), dot(w, n)];
      const wi = local(light);
      evaluate(lobes, wi, local([0, 0, 1]), image.data, o);
      for (let c = 0; c < 3; ++c) image.data[o + c] *= Math.PI * (cosine ? Math.max(0, wi[2]) : 1);
    }
  return image;
}
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => a.map((x) => x / Math.hypot(...a));

export const sphere = ({ material: m, size, theta_i, phi_i, cosine }) => [
  {},
  { image: shade(lobesOf(m), size, size, 1, [0, 0], direction(theta_i, phi_i), cosine) },
];

export function validate({ material: m }) {
  const n = 32;
  const reciprocity_map = array([n, n]);
  const energy_map = array([n, n]);
  for (let i = 0; i < n; ++i)
    for (let j = 0; j < n; ++j) {
      reciprocity_map.data[i * n + j] = Math.abs(i - j) ** 2 * 1e-5 * (i > 24 ? 20 : 1);
      energy_map.data[i * n + j] = Math.exp(-((i - 20) ** 2 + (j - 20) ** 2) / 40);
    }
  const a = array([10, 3]);
  for (let i = 0; i < 10; ++i) albedo(lobesOf(m), i * 10, a.data, 3 * i);
  const law = (name, verdict, worst, tolerance, where) => ({ name, verdict, worst, tolerance, where, command: `nacre eval ggx_schlick --theta-i ${where?.theta_i ?? 0}` });
  return [
    {
      laws: [
        law("finiteness", "holds", 0, 0),
        law("positivity", "holds", 0, 0),
        law("reciprocity", "violated", 0.0131, 1e-6, { theta_i: 70, phi_i: 0, theta_o: 12, phi_o: 140 }),
        law("energy conservation", "holds", -0.63, 0.001, { theta_o: 89 }),
        law("chi-square of directions", "holds", 0.07, 0.00126, { theta_o: 85 }),
        law("pdf normalisation", "not applicable", null, 0.002),
      ],
    },
    { reciprocity_map, energy_map, albedo: a },
  ];
}

export function compile({ brdf }) {
  const lines = brdf.source.split("\n");
  const errors = [];
  lines.forEach((text, i) => {
    const c = text.indexOf("oops");
    if (c >= 0) errors.push({ line: i + 1, column: c + 1, message: "'oops' : undeclared identifier" });
  });
  if (errors.length) return { errors };
  const list = [...brdf.source.matchAll(/^\s*(float|color|bool)\s+(\w+)\s+([\d. ]+)$/gm)].map(([, type, name, numbers]) => {
    const v = numbers.trim().split(/\s+/).map(Number);
    const common = { name, unit: "1", meaning: name, lo: 0, hi: 1, initial: v[0], is_color: false, is_switch: false };
    if (type === "float") return { ...common, lo: v[0], hi: v[1], initial: v[2] };
    return type === "color" ? { ...common, initial: v, is_color: true } : { ...common, is_switch: true };
  });
  return { parameters: list };
}

export function physics({ topic, ...given }) {
  const n = 91;
  const x = array([n]);
  const names = { snell: ["theta_t"], fresnel: ["R_s", "R_p", "R"], lambert: ["irradiance", "radiance"] }[topic] ?? ["first", "second"];
  const y = array([names.length, n]);
  for (let i = 0; i < n; ++i) {
    x.data[i] = i;
    names.forEach((_, s) => (y.data[s * n + i] = Math.cos(i * rad) ** (s + 1)));
  }
  const arrays = { x, y };
  if (topic === "ndf" || topic === "masking") {
    const m = 240;
    arrays.profile = array([2, m]);
    arrays.visible = array([m]);
    for (let i = 0; i < m; ++i) {
      arrays.profile.data[i] = i / m;
      arrays.profile.data[m + i] = 0.05 * (given.alpha ?? 0.3) * (Math.sin(i * 0.21) + Math.sin(i * 0.53 + 1));
      arrays.visible.data[i] = Math.cos(i * 0.21) > -0.3 ? 1 : 0;
    }
  }
  if (topic === "furnace") arrays.image = shade(lobesOf(given.material ?? { text: "lambert" }), 128, 128, 1, [0, 0], [0, 0, 1]);
  const values = { theta_t: 28.1, critical: null, brewster: 56.3, reflectance: 0.05, r: 0.9, g: 0.7, b: 0.4, irradiance: 0.7, radiance: 0.22, solid_angle: 1, projected: 0.8, integral: 1, g1: 0.9, lost: 0.07 };
  return [{ x_label: "degrees", y_label: "", series: names, values, metals: ["Ag", "Al", "Au", "Cu"], source: "mock" }, arrays];
}
