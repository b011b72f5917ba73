// Linear RGB to what a display shows, to channels, and to colours of maps.

import type { Channel } from "./state";
import type { Rgb } from "../protocol";

/// Rec. 709 luminance, https://www.itu.int/rec/R-REC-BT.709, of linear RGB.
export const luminance = (r: number, g: number, b: number): number => 0.2126 * r + 0.7152 * g + 0.0722 * b;

export function channelValue(data: Float32Array, index: number, channel: Channel): number {
  switch (channel) {
    case "r":
      return data[index];
    case "g":
      return data[index + 1];
    case "b":
      return data[index + 2];
    default:
      return luminance(data[index], data[index + 1], data[index + 2]);
  }
}

/// sRGB transfer function, IEC 61966-2-1, of one channel in [0, 1].
export const encodeSrgb = (x: number): number => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
export const decodeSrgb = (x: number): number => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);

export function toHex(rgb: Rgb): string {
  const byte = (x: number) =>
    Math.round(255 * encodeSrgb(Math.min(1, Math.max(0, x))))
      .toString(16)
      .padStart(2, "0");
  return `#${rgb.map(byte).join("")}`;
}

export function fromHex(hex: string): Rgb {
  const channel = (i: number) => decodeSrgb(parseInt(hex.slice(1 + 2 * i, 3 + 2 * i), 16) / 255);
  return [channel(0), channel(1), channel(2)];
}

const levels = 4096;
const tables = new Map<number, Uint8Array>();
function gammaTable(gamma: number): Uint8Array {
  let table = tables.get(gamma);
  if (!table) {
    if (tables.size > 16) tables.clear();
    table = new Uint8Array(levels + 1);
    // The table is over the square root of the value, so that dark steps are fine.
    for (let i = 0; i <= levels; ++i) table[i] = Math.round(255 * ((i / levels) ** 2) ** (1 / gamma));
    tables.set(gamma, table);
  }
  return table;
}

/// Linear RGB floats to 8-bit pixels. Holes (NaN) get a hatch.
export function toPixels(
  source: Float32Array,
  width: number,
  out: Uint8ClampedArray,
  exposure: number,
  gamma: number,
): void {
  const table = gammaTable(gamma);
  const factor = 2 ** exposure;
  const count = source.length / 3;
  for (let i = 0, s = 0, o = 0; i < count; ++i, s += 3, o += 4) {
    const r = source[s];
    if (r !== r) {
      const stripe = ((i % width) + Math.floor(i / width)) & 4;
      out[o] = out[o + 2] = stripe ? 92 : 70;
      out[o + 1] = 64;
    } else {
      out[o] = table[(Math.sqrt(clamp01(r * factor)) * levels) | 0];
      out[o + 1] = table[(Math.sqrt(clamp01(source[s + 1] * factor)) * levels) | 0];
      out[o + 2] = table[(Math.sqrt(clamp01(source[s + 2] * factor)) * levels) | 0];
    }
    out[o + 3] = 255;
  }
}

/// Values that are display values already.
export function displayPixels(source: Float32Array, out: Uint8ClampedArray): void {
  for (let s = 0, o = 0; s < source.length; s += 3, o += 4) {
    out[o] = 255 * source[s] + 0.5;
    out[o + 1] = 255 * source[s + 1] + 0.5;
    out[o + 2] = 255 * source[s + 2] + 0.5;
    out[o + 3] = 255;
  }
}

const clamp01 = (x: number): number => (x < 0 ? 0 : x > 1 ? 1 : x);

/// Anchors of the map "inferno" of matplotlib (S. van der Walt and N. Smith, 2015, CC0), at equal steps.
const inferno: Rgb[] = [
  [0, 0, 4],
  [40, 11, 84],
  [101, 21, 110],
  [159, 42, 99],
  [212, 72, 66],
  [245, 125, 21],
  [250, 193, 39],
  [252, 255, 164],
];

/// A colour of the heat map for t in [0, 1]; grey for NaN.
export function heat(t: number): Rgb {
  if (!(t === t)) return [96, 96, 96];
  const x = clamp01(t) * (inferno.length - 1);
  const i = Math.min(inferno.length - 2, Math.floor(x));
  const f = x - i;
  return [0, 1, 2].map((c) => Math.round(inferno[i][c] * (1 - f) + inferno[i + 1][c] * f)) as Rgb;
}

/// Blue below zero, red above, grey at zero: for differences.
export function diverging(t: number): Rgb {
  const a = Math.min(1, Math.abs(t));
  const end: Rgb = t < 0 ? [64, 132, 230] : [228, 82, 60];
  return end.map((e) => Math.round(44 + (e - 44) * a)) as Rgb;
}
