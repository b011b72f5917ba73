// Measured, fitted, and where the two lit spheres differ: red where the fit is brighter, blue where darker.

import { type Signal, useSignal, useSignalEffect } from "@preact/signals";
import { useRef } from "preact/hooks";
import { diverging, luminance, toPixels } from "../core/color";
import { nextFrame } from "../core/frame";
import { complain, core } from "../core/session";
import { directions, display, state } from "../core/store";
import type { FloatArray, MaterialRequest } from "../protocol";
import { tidy } from "../ui/scale";

const size = 192;

export function Difference({ measured, fit }: { measured: string; fit: MaterialRequest }) {
  const pair = useSignal<{ a: FloatArray; b: FloatArray } | null>(null);
  const fitted = useSignal(fit);
  fitted.value = fit;
  useSignalEffect(() => {
    const { theta_i, phi_i } = directions.value;
    const { double: double_theta, cosine } = state.value.sphere;
    const ask = (slot: string, material: MaterialRequest) =>
      core.latest(`difference ${slot}`, "sphere", { material, size, theta_i, phi_i, double_theta, cosine });
    Promise.all([ask("measured", { file: measured }), ask("fit", fitted.value)])
      .then(([a, b]) => {
        if (a && b) pair.value = { a: a.arrays.image, b: b.arrays.image };
      })
      .catch(complain);
  });
  const scale = pair.value ? largestDifference(pair.value.a.data, pair.value.b.data) : 1;
  return (
    <div class="difference">
      <Sphere image={pair} pick={(p, out) => toPixels(p.a.data, size, out, display.peek().exposure, display.peek().gamma)} name="measured" />
      <Sphere image={pair} pick={(p, out) => toPixels(p.b.data, size, out, display.peek().exposure, display.peek().gamma)} name="fit" />
      <Sphere image={pair} pick={(p, out) => differencePixels(p.a.data, p.b.data, scale, out)} name={`difference, full colour at ±${tidy(scale)}`} />
    </div>
  );
}

const difference = (a: Float32Array, b: Float32Array, i: number) =>
  luminance(b[i] - a[i], b[i + 1] - a[i + 1], b[i + 2] - a[i + 2]);

/// The 99th percentile: one peak must not hide all else.
function largestDifference(a: Float32Array, b: Float32Array): number {
  const all: number[] = [];
  for (let i = 0; i < a.length; i += 3) {
    const d = Math.abs(difference(a, b, i));
    if (d > 0) all.push(d);
  }
  all.sort((x, y) => x - y);
  return all[Math.floor(0.99 * (all.length - 1))] || 1;
}

function differencePixels(a: Float32Array, b: Float32Array, scale: number, out: Uint8ClampedArray): void {
  for (let i = 0, o = 0; i < a.length; i += 3, o += 4) {
    const [r, g, blue] = diverging(difference(a, b, i) / scale);
    out[o] = r;
    out[o + 1] = g;
    out[o + 2] = blue;
    out[o + 3] = 255;
  }
}

interface Pair {
  a: FloatArray;
  b: FloatArray;
}

function Sphere(props: { image: Signal<Pair | null>; pick(pair: Pair, out: Uint8ClampedArray): void; name: string }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const owner = useRef({});
  const pick = useRef(props.pick);
  pick.current = props.pick;
  useSignalEffect(() => {
    const pair = props.image.value;
    display.value;
    if (!pair) return;
    nextFrame(owner.current, () => {
      const context = canvas.current?.getContext("2d");
      if (!context) return;
      const pixels = new ImageData(size, size);
      pick.current(pair, pixels.data);
      context.putImageData(pixels, 0, 0);
    });
  });
  return (
    <figure>
      <canvas ref={canvas} width={size} height={size} />
      <figcaption>{props.name}</figcaption>
    </figure>
  );
}
