import assert from "node:assert/strict";
import { test } from "node:test";
import { decode, decodeBinary, encodeBinary } from "../../src/protocol";

const frame = () =>
  encodeBinary(
    { id: 7, ok: true },
    { x: { shape: [3], data: Float32Array.of(0, 45, 90) }, y: { shape: [1, 3, 2], data: Float32Array.of(1, 2, 3, 4, 5, NaN) } },
  );

test("arrays of a frame come back with their shapes", () => {
  const message = decode(frame());
  assert.equal(message.id, 7);
  assert.deepEqual(message.arrays.y.shape, [1, 3, 2]);
  assert.deepEqual([...message.arrays.x.data], [0, 45, 90]);
  assert.ok(Number.isNaN(message.arrays.y.data[5]));
});

test("arrays begin at a multiple of four, whatever the header's length", () => {
  for (let pad = 0; pad < 8; ++pad) {
    const message = decode(encodeBinary({ id: 1, pad: "x".repeat(pad) }, { v: { shape: [1], data: Float32Array.of(pad) } }));
    assert.equal(message.arrays.v.data[0], pad);
  }
});

test("the layout is the document's: little-endian length, header, zeros, floats", () => {
  const header = new TextEncoder().encode('{"id":3,"arrays":[{"name":"a","shape":[2]}]}');
  const start = 4 * Math.ceil((4 + header.length) / 4);
  const buffer = new ArrayBuffer(start + 8);
  const view = new DataView(buffer);
  view.setUint32(0, header.length, true);
  new Uint8Array(buffer).set(header, 4);
  view.setFloat32(start, 1.5, true);
  view.setFloat32(start + 4, -2, true);
  assert.deepEqual([...decodeBinary(buffer).arrays.a.data], [1.5, -2]);
});

test("a header with characters outside ASCII is measured in bytes", () => {
  const message = decode(encodeBinary({ id: 1, name: "θ" }, { a: { shape: [1], data: Float32Array.of(4) } }));
  assert.equal((message as unknown as { name: string }).name, "θ");
  assert.equal(message.arrays.a.data[0], 4);
});

test("an empty array is no error", () => {
  assert.equal(decode(encodeBinary({ id: 1 }, { a: { shape: [0, 3], data: new Float32Array() } })).arrays.a.data.length, 0);
});

test("frames that are cut or lie about their length are refused", () => {
  const whole = frame();
  assert.throws(() => decodeBinary(whole.slice(0, 2)), /no header/);
  assert.throws(() => decodeBinary(whole.slice(0, 20)), /the header says/);
  assert.throws(() => decodeBinary(whole.slice(0, whole.byteLength - 4)), /array 'y' wants 24 bytes, 20 are left/);
});

test("a text message has no arrays", () => {
  assert.deepEqual(decode('{"id":4,"ok":true,"samples":8}'), { id: 4, ok: true, samples: 8, arrays: {} });
});
