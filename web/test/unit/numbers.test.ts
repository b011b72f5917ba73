import assert from "node:assert/strict";
import { test } from "node:test";
import { fromHex, luminance, toHex, toPixels } from "../../src/core/color";
import { sliderScale, snapped, tidy } from "../../src/ui/scale";
import { moved, neared, orbitOffset, turned } from "../../src/ui/orbit";
import { radius, roundUp } from "../../src/views/radial";

const near = (a: number, b: number, tolerance = 1e-9) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

test("a slider's position and value are inverse to each other, linear and logarithmic", () => {
  for (const [lo, hi] of [[0, 1], [0.001, 1], [1, 1e6], [-6, 6]])
    for (const t of [0, 0.3, 1]) near(sliderScale(lo, hi).toPosition(sliderScale(lo, hi).toValue(t)), t);
  near(sliderScale(1, 1e6).toValue(0.5), 1000, 1e-6);
});

test("snapped values stay in their range and are short", () => {
  assert.equal(snapped(0.123456, 0, 1), 0.1235);
  assert.equal(snapped(44.98765, 0, 90), 44.99);
  assert.equal(snapped(1.2, 0, 1), 1);
});

test("numbers are shown with four digits", () => {
  assert.deepEqual([0.25, 1 / 3, 123456, 1e-6, 0, NaN].map(tidy), ["0.25", "0.3333", "1.23e5", "1.00e-6", "0", "–"]);
});

test("white has luminance one, and a colour survives its hexadecimal", () => {
  near(luminance(1, 1, 1), 1);
  assert.equal(toHex(fromHex("#c08040")), "#c08040");
});

test("pixels follow exposure and gamma, and holes are no colour of the picture", () => {
  const out = new Uint8ClampedArray(12);
  toPixels(Float32Array.of(0.25, 0.5, 4, NaN, NaN, NaN, 0, 0, 0), 3, out, 1, 2.2);
  near(out[0], 255 * 0.5 ** (1 / 2.2), 1);
  assert.equal(out[1], 255);
  assert.equal(out[2], 255);
  assert.ok(out[4] > out[5]);
  assert.deepEqual([...out.slice(8)], [0, 0, 0, 255]);
});

test("a lobe's radius is its share, or four decades of its logarithm", () => {
  near(radius(5, 10, false), 0.5);
  near(radius(0.1, 10, true), 0.5);
  assert.equal(radius(NaN, 10, true), 0);
  assert.deepEqual([0.7, 1, 1.2, 3, 7].map(roundUp), [1, 1, 2, 5, 10]);
});

test("an orbit keeps its distance, and does not pass over the pole", () => {
  const camera = { azimuth: 350, elevation: 80, distance: 3, target: [0, 0, 0] as [number, number, number] };
  near(Math.hypot(...orbitOffset(camera)), 3);
  assert.equal(turned(camera, -50, 100).elevation, 89.9);
  assert.equal(turned(camera, -50, 0).azimuth, 10);
  assert.ok(neared(camera, -100).distance < 3);
});

test("a camera moves in the plane of its picture", () => {
  const camera = { azimuth: 30, elevation: 20, distance: 3, target: [0, 0, 0] as [number, number, number] };
  const [x, y, z] = moved(camera, 0.1, 0.2).target;
  const toCamera = orbitOffset(camera);
  near(x * toCamera[0] + y * toCamera[1] + z * toCamera[2], 0);
});
