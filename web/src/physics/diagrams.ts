// Drawings of the physics pages: from the handles and from the core's numbers, to scale where a scale is meant.

import type { FloatArray } from "../protocol";
import { encodeSrgb, toPixels } from "../core/color";
import type { Surface } from "../ui/canvas";

export interface Scene {
  handles: Record<string, number>;
  values: Record<string, number | null>;
  arrays: Record<string, FloatArray>;
  /// The selected metal, or "".
  metal: string;
}
export type Diagram = (surface: Surface, scene: Scene) => void;

const rad = Math.PI / 180;

interface Pen {
  line(x0: number, y0: number, x1: number, y1: number, color: string, width?: number, dash?: number[]): void;
  arrow(x0: number, y0: number, x1: number, y1: number, color: string, width?: number): void;
  text(text: string, x: number, y: number, color?: string, align?: CanvasTextAlign): void;
}

function pen(s: Surface): Pen {
  const c = s.context;
  const line: Pen["line"] = (x0, y0, x1, y1, color, width = 1.5, dash = []) => {
    c.strokeStyle = color;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    c.moveTo(x0, y0);
    c.lineTo(x1, y1);
    c.stroke();
    c.setLineDash([]);
  };
  const arrow: Pen["arrow"] = (x0, y0, x1, y1, color, width = 2) => {
    if (width < 0.05) return;
    const a = Math.atan2(y1 - y0, x1 - x0);
    const h = 5 + width;
    line(x0, y0, x1 - h * 0.8 * Math.cos(a), y1 - h * 0.8 * Math.sin(a), color, width);
    c.fillStyle = color;
    c.beginPath();
    c.moveTo(x1, y1);
    c.lineTo(x1 - h * Math.cos(a - 0.4), y1 - h * Math.sin(a - 0.4));
    c.lineTo(x1 - h * Math.cos(a + 0.4), y1 - h * Math.sin(a + 0.4));
    c.fill();
  };
  const text: Pen["text"] = (words, x, y, color = s.color("--text"), align = "center") => {
    c.fillStyle = color;
    c.textAlign = align;
    c.textBaseline = "middle";
    c.fillText(words, x, y);
  };
  return { line, arrow, text };
}

function arc(s: Surface, x: number, y: number, r: number, from: number, to: number, color: string): void {
  s.context.strokeStyle = color;
  s.context.lineWidth = 1;
  s.context.beginPath();
  s.context.arc(x, y, r, Math.min(from, to), Math.max(from, to));
  s.context.stroke();
}

/// A ray from the origin at an angle to the normal; positive to the right, `down` below the surface.
const end = (x: number, y: number, r: number, theta: number, down = false): [number, number] => [
  x + r * Math.sin(theta * rad),
  y + (down ? 1 : -1) * r * Math.cos(theta * rad),
];

function interfaceOf(s: Surface): { x: number; y: number; r: number } {
  return { x: s.width / 2, y: s.height / 2, r: 0.42 * Math.min(s.width, s.height) };
}

export const refraction: Diagram = (s, { handles, values }) => {
  const p = pen(s);
  const { x, y, r } = interfaceOf(s);
  const shade = (top: number, height: number, eta: number) => {
    s.context.globalAlpha = 0.1 * (eta - 1) + 0.02;
    s.context.fillStyle = s.color("--mark");
    s.context.fillRect(0, top, s.width, height);
    s.context.globalAlpha = 1;
  };
  shade(0, y, handles.eta_i);
  shade(y, s.height - y, handles.eta_t);
  p.line(0, y, s.width, y, s.color("--dim"));
  p.line(x, y - r, x, y + r, s.color("--grid3d"), 1, [4, 4]);
  const reflectance = values.reflectance ?? 0;
  const light = s.color("--light");
  p.arrow(...end(x, y, r, -handles.theta_i), x, y, light, 4);
  p.arrow(x, y, ...end(x, y, r, handles.theta_i), light, 4 * reflectance);
  if (values.theta_t !== null && values.theta_t !== undefined) {
    p.arrow(x, y, ...end(x, y, r, values.theta_t, true), light, 4 * (1 - reflectance));
    arc(s, x, y, 0.35 * r, Math.PI / 2 - values.theta_t * rad, Math.PI / 2, s.color("--text"));
    p.text("θt", ...end(x, y, 0.45 * r, values.theta_t / 2, true));
  } else p.text("total reflection", x, y + 0.4 * r, s.color("--accent"));
  arc(s, x, y, 0.35 * r, -Math.PI / 2 - handles.theta_i * rad, -Math.PI / 2, s.color("--text"));
  p.text("θi", ...end(x, y, 0.45 * r, -handles.theta_i / 2));
};

export const reflection: Diagram = (s, { handles, values, arrays, metal }) => {
  const p = pen(s);
  const { x, r } = interfaceOf(s);
  const y = 0.62 * s.height;
  const color = rgbText([values.r ?? 0, values.g ?? 0, values.b ?? 0]);
  s.context.fillStyle = color;
  s.context.fillRect(0, y, s.width, 0.16 * s.height);
  p.text(`what ${metal || "the surface"} reflects of white light`, s.width / 2, y + 0.08 * s.height, contrast(values));
  p.line(x, y - r, x, y, s.color("--grid3d"), 1, [4, 4]);
  p.arrow(...end(x, y, r, -handles.theta_i), x, y, s.color("--light"), 4);
  p.arrow(x, y, ...end(x, y, r, handles.theta_i), color, 4);
  const spectrum = arrays.spectrum;
  if (spectrum) spectrumStrip(s, spectrum, 0.8 * s.height, 0.16 * s.height);
};

/// The reflectance over the wavelengths as a small curve.
function spectrumStrip(s: Surface, { shape, data }: FloatArray, y: number, height: number): void {
  const m = shape[1];
  const reflectance = data.subarray(3 * m, 4 * m);
  const c = s.context;
  c.strokeStyle = s.color("--accent");
  c.lineWidth = 1.5;
  c.beginPath();
  for (let k = 0; k < m; ++k) c.lineTo(s.width * (0.08 + (0.84 * k) / (m - 1)), y + height * (1 - reflectance[k]));
  c.stroke();
  const p = pen(s);
  p.text(`${Math.round(data[0])} nm`, 0.08 * s.width, y + height + 0.7 * s.em, s.color("--dim"), "left");
  p.text(`R over the wavelengths`, 0.5 * s.width, y + height + 0.7 * s.em, s.color("--dim"));
  p.text(`${Math.round(data[m - 1])} nm`, 0.92 * s.width, y + height + 0.7 * s.em, s.color("--dim"), "right");
}

const rgbText = (rgb: number[]) =>
  `rgb(${rgb.map((v) => Math.round(255 * encodeSrgb(Math.min(1, Math.max(0, v))))).join(" ")})`;
const contrast = (v: Scene["values"]) => ((v.r ?? 0) + (v.g ?? 0) + (v.b ?? 0) > 0.6 ? "#222" : "#eee");

export const beam: Diagram = (s, { handles, values }) => {
  const p = pen(s);
  const y = 0.72 * s.height;
  const x = s.width / 2;
  const theta = handles.theta_i * rad;
  const half = 0.07 * s.width;
  const foot = Math.min(0.46 * s.width, half / Math.max(0.05, Math.cos(theta)));
  const r = 0.6 * s.height;
  const c = s.context;
  c.fillStyle = s.color("--light");
  c.globalAlpha = 0.3;
  const dx = -Math.sin(theta) * r;
  const dy = -Math.cos(theta) * r;
  const nx = Math.cos(theta) * half;
  const ny = -Math.sin(theta) * half;
  c.beginPath();
  c.moveTo(x - foot, y);
  c.lineTo(x + dx - nx, y + dy - ny);
  c.lineTo(x + dx + nx, y + dy + ny);
  c.lineTo(x + foot, y);
  c.fill();
  c.globalAlpha = 1;
  p.arrow(x + dx, y + dy, x, y, s.color("--light"), 2);
  p.line(0, y, s.width, y, s.color("--dim"), 2);
  p.line(x - foot, y + 6, x + foot, y + 6, s.color("--accent"), 5);
  p.text(`the beam covers ${(1 / Math.max(0.017, Math.cos(theta))).toFixed(2)} of its own width`, x, y + 1.8 * s.em);
  c.globalAlpha = Math.min(1, values.radiance ?? 0);
  c.fillStyle = s.color("--accent");
  c.beginPath();
  c.arc(x + 0.28 * s.width, y, 0.11 * s.width, Math.PI, 2 * Math.PI);
  c.fill();
  c.globalAlpha = 1;
};

export const spreading: Diagram = (s, { handles }) => {
  const p = pen(s);
  const x0 = 0.12 * s.width;
  const y0 = s.height / 2;
  const reach = 0.8 * s.width;
  const c = s.context;
  for (const step of [0.25, 0.5, 0.75, 1]) {
    const x = x0 + reach * step;
    const h = 0.36 * s.height * step;
    c.strokeStyle = s.color("--grid3d");
    c.strokeRect(x - h * 0.12, y0 - h, h * 0.24, 2 * h);
    p.text(`${(step * 4) ** 2}`, x, y0 - h - 0.7 * s.em, s.color("--dim"));
  }
  p.line(x0, y0, x0 + reach, y0 - 0.36 * s.height, s.color("--light"), 1);
  p.line(x0, y0, x0 + reach, y0 + 0.36 * s.height, s.color("--light"), 1);
  c.fillStyle = s.color("--light");
  c.beginPath();
  c.arc(x0, y0, 5 + 10 * Math.min(1, handles.radius / 2), 0, 2 * Math.PI);
  c.fill();
  p.text("area that the same light covers, at 1, 2, 3, 4 times the distance", s.width / 2, s.height - s.em, s.color("--dim"));
};

export const cone: Diagram = (s, { handles, values }) => {
  const p = pen(s);
  const r = Math.min(0.44 * s.width, 0.7 * s.height);
  const x = s.width / 2;
  const y = 0.82 * s.height;
  const c = s.context;
  arc(s, x, y, r, Math.PI, 2 * Math.PI, s.color("--grid3d"));
  p.line(x - r, y, x + r, y, s.color("--dim"));
  const a = handles.half_angle * rad;
  c.fillStyle = s.color("--accent");
  c.globalAlpha = 0.25;
  c.beginPath();
  c.moveTo(x, y);
  c.arc(x, y, r, -Math.PI / 2 - a, -Math.PI / 2 + a);
  c.fill();
  c.globalAlpha = 1;
  c.strokeStyle = s.color("--accent");
  c.lineWidth = 4;
  c.beginPath();
  c.arc(x, y, r, -Math.PI / 2 - a, -Math.PI / 2 + a);
  c.stroke();
  p.line(x - r * Math.sin(a), y + 5, x + r * Math.sin(a), y + 5, s.color("--mark"), 5);
  p.text(`Ω = ${(values.solid_angle ?? 0).toFixed(3)} sr`, x, y - r - s.em, s.color("--accent"));
  p.text(`projected ${(values.projected ?? 0).toFixed(3)} sr`, x, y + 1.6 * s.em, s.color("--mark"));
};

export const lamp: Diagram = (s, { handles }) => {
  const p = pen(s);
  const scale = (0.75 * s.width) / 10;
  const x = 0.1 * s.width;
  const y = s.height / 2;
  const lx = x + handles.distance * scale;
  const h = Math.min(0.44 * s.height, handles.radius * scale * 2);
  const c = s.context;
  c.fillStyle = s.color("--light");
  c.globalAlpha = 0.22;
  c.beginPath();
  c.moveTo(x, y);
  c.lineTo(lx, y - h);
  c.lineTo(lx, y + h);
  c.fill();
  c.globalAlpha = 1;
  p.line(lx, y - h, lx, y + h, s.color("--light"), 6);
  p.line(x, y - 0.2 * s.height, x, y + 0.2 * s.height, s.color("--dim"), 3);
  p.text("surface", x, y + 0.25 * s.height, s.color("--dim"));
  p.text("lamp of constant radiance", lx, y + h + s.em, s.color("--light"));
};

/// A rough line stretched over the box; answers its points.
function profile(s: Surface, field: FloatArray | undefined): [number, number][] {
  if (!field) return [];
  const m = field.shape[1];
  const xs = field.data.subarray(0, m);
  const zs = field.data.subarray(m, 2 * m);
  const span = xs[m - 1] - xs[0] || 1;
  const scale = (0.92 * s.width) / span;
  let lo = Infinity;
  let hi = -Infinity;
  for (const z of zs) {
    lo = Math.min(lo, z);
    hi = Math.max(hi, z);
  }
  const middle = (lo + hi) / 2;
  const fit = Math.min(scale, (0.5 * s.height) / Math.max(1e-9, hi - lo));
  return Array.from(xs, (x, k) => [0.04 * s.width + (x - xs[0]) * scale, 0.65 * s.height - (zs[k] - middle) * fit]);
}

function strokeProfile(s: Surface, points: [number, number][], color: (k: number) => string): void {
  const p = pen(s);
  for (let k = 0; k + 1 < points.length; ++k) p.line(...points[k], ...points[k + 1], color(k), 2.5);
}

export const microsurface: Diagram = (s, { arrays }) => {
  const points = profile(s, arrays.profile);
  const p = pen(s);
  strokeProfile(s, points, () => s.color("--text"));
  const step = Math.max(1, Math.floor(points.length / 48));
  for (let k = step; k + 1 < points.length; k += step) {
    const dx = points[k + 1][0] - points[k - 1][0];
    const dy = points[k + 1][1] - points[k - 1][1];
    const length = Math.hypot(dx, dy) || 1;
    p.arrow(...points[k], points[k][0] + (dy / length) * 1.6 * s.em, points[k][1] - (dx / length) * 1.6 * s.em, s.color("--accent"), 1);
  }
  p.text("a cut through such a surface, and the normals of its facets", s.width / 2, s.height - s.em, s.color("--dim"));
};

export const seenFacets: Diagram = (s, { arrays, handles }) => {
  const points = profile(s, arrays.profile);
  const p = pen(s);
  const seen = arrays.visible?.data;
  strokeProfile(s, points, (k) => (seen && !seen[k] ? s.color("--grid3d") : s.color("--accent")));
  const r = 0.42 * s.height;
  const [ex, ey] = end(s.width / 2, 0.6 * s.height, r, handles.theta_o);
  if (points.length) p.arrow(s.width / 2, 0.6 * s.height, ex, ey, s.color("--mark"), 2);
  else lobe(s, handles.theta_o);
  p.text("to the viewer", ex, ey - 0.8 * s.em, s.color("--mark"));
  if (points.length) p.text("bright: seen; dark: turned away, or hidden", s.width / 2, s.height - s.em, s.color("--dim"));
};

/// Without a cut: the flat surface and the view.
function lobe(s: Surface, theta: number): void {
  const p = pen(s);
  const y = 0.6 * s.height;
  p.line(0.08 * s.width, y, 0.92 * s.width, y, s.color("--dim"), 2);
  p.arrow(s.width / 2, y, ...end(s.width / 2, y, 0.42 * s.height, theta), s.color("--mark"), 2);
  p.line(s.width / 2, y, s.width / 2, y - 0.42 * s.height, s.color("--grid3d"), 1, [4, 4]);
}

export const areas: Diagram = (s, { values }) => {
  const p = pen(s);
  const list = Object.entries(values).filter(([, v]) => v !== null) as [string, number][];
  const top = Math.max(1, ...list.map(([, v]) => v));
  const colors = [s.color("--accent"), s.color("--mark"), s.color("--red")];
  list.forEach(([name, v], k) => {
    const y = s.height * (0.2 + (0.6 * (k + 0.5)) / list.length);
    p.line(0.34 * s.width, y, s.width * (0.34 + (0.5 * v) / top), y, colors[k % 3], 0.08 * s.height);
    p.text(name.replace(/_/g, " "), 0.32 * s.width, y, s.color("--dim"), "right");
    p.text(v.toFixed(4), s.width * (0.36 + (0.5 * v) / top), y, s.color("--text"), "left");
  });
};

export const bounces: Diagram = (s, { values }) => {
  const p = pen(s);
  const c = s.context;
  const [w, h] = [s.width, s.height];
  const ground: [number, number][] = [[0.05, 0.72], [0.22, 0.42], [0.4, 0.8], [0.58, 0.38], [0.76, 0.8], [0.95, 0.5]].map(([x, y]) => [x * w, y * h]);
  c.lineJoin = "round";
  strokeProfile(s, ground, () => s.color("--text"));
  const path = (points: [number, number][], color: string) => {
    for (let k = 0; k + 1 < points.length; ++k) p.arrow(points[k][0] * w, points[k][1] * h, points[k + 1][0] * w, points[k + 1][1] * h, color, 3 - 0.7 * k);
  };
  path([[0.3, 0.06], [0.32, 0.62], [0.5, 0.57], [0.44, 0.1]], s.color("--accent"));
  path([[0.62, 0.06], [0.68, 0.61], [0.87, 0.15]], s.color("--light"));
  p.text("two bounces: lost to a model of one", 0.36 * w, 0.93 * h, s.color("--accent"));
  p.text("one bounce", 0.82 * w, 0.93 * h, s.color("--light"));
  if (typeof values.lost === "number") p.text(`lost at normal incidence: ${(100 * values.lost).toFixed(1)} %`, w / 2, 0.03 * h + s.em * 0.5, s.color("--dim"));
};

export const furnace: Diagram = (s, { arrays }) => {
  const image = arrays.image;
  if (!image) return;
  const [height, width] = image.shape;
  // Half of the display's range is the sky, so that more than the sky shows.
  const pixels = new ImageData(width, height);
  toPixels(image.data, width, pixels.data, -1, 2.2);
  const sky = Math.round(255 * 0.5 ** (1 / 2.2));
  const side = Math.min(s.width, s.height) * 0.86;
  const c = s.context;
  c.fillStyle = `rgb(${sky} ${sky} ${sky})`;
  c.fillRect(0, 0, s.width, s.height);
  const small = new OffscreenCanvas(width, height);
  small.getContext("2d")!.putImageData(pixels, 0, 0);
  c.save();
  c.beginPath();
  c.arc(s.width / 2, s.height / 2, side / 2, 0, 2 * Math.PI);
  c.clip();
  c.drawImage(small, (s.width - side) / 2, (s.height - side) / 2, side, side);
  c.restore();
};
