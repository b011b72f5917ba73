import assert from "node:assert/strict";
import { test } from "node:test";
import { History } from "../../src/core/history";
import { addMaterial, duplicateMaterial, editMaterial, freshName, initialState, removeMaterial, setParameter, shownMaterials, toRequest } from "../../src/core/state";
import { decodeHash, difference, encodeHash, merge, readSession, sessionText } from "../../src/core/url";

const lobe = (alpha: number) => ({ lobes: [{ model: "ggx_schlick", weight: 1, parameters: { alpha, f0: [0.9, 0.6, 0.3] as [number, number, number] } }] });
const two = () => addMaterial(addMaterial(initialState, "gold", lobe(0.25)), "matte", { file: "matte.binary" });

test("a material added is selected, and has a colour of its own", () => {
  const s = two();
  assert.equal(s.selected, 2);
  assert.notEqual(s.materials[0].color, s.materials[1].color);
});

test("solo shows one, else the visible are shown", () => {
  const s = editMaterial(two(), 1, (m) => ({ ...m, visible: false }));
  assert.deepEqual(shownMaterials(s).map((m) => m.name), ["matte"]);
  assert.deepEqual(shownMaterials({ ...s, solo: 1 }).map((m) => m.name), ["gold"]);
});

test("removing the selected one selects its neighbour, and ends its solo", () => {
  const s = removeMaterial({ ...two(), solo: 2 }, 2);
  assert.equal(s.selected, 1);
  assert.equal(s.solo, null);
  assert.equal(removeMaterial(s, 1).selected, null);
});

test("a duplicate stands beside its original with a fresh name and shares nothing that is edited", () => {
  const s = duplicateMaterial(two(), 1);
  assert.deepEqual(s.materials.map((m) => m.name), ["gold", "gold 2", "matte"]);
  const edited = editMaterial(s, s.materials[1].id, (m) => ({ ...m, source: setParameter(m.source, 0, "alpha", 0.5) }));
  assert.deepEqual(edited.materials[0].source, lobe(0.25));
  assert.deepEqual(edited.materials[1].source, lobe(0.5));
});

test("fresh names count on", () => {
  assert.equal(freshName([{ name: "a" }, { name: "a 2" }], "a 2"), "a 3");
  assert.equal(freshName([], "a"), "a");
});

test("requests are what the protocol asks for", () => {
  assert.deepEqual(toRequest({ name: "x", source: { file: "a.binary" } }), { file: "a.binary" });
  assert.deepEqual(Object.keys(toRequest({ name: "x", source: lobe(0.1) })), ["name", "lobes"]);
});

test("changes of one gesture are undone together", () => {
  const history = new History<number>();
  history.record(0, "drag");
  history.record(1, "drag");
  history.record(2, "drag");
  history.endGesture();
  history.record(3, "drag");
  assert.equal(history.undo(4), 3);
  assert.equal(history.undo(3), 0);
  assert.equal(history.undo(0), undefined);
  assert.equal(history.redo(0), 3);
  history.record(3);
  assert.equal(history.canRedo, false);
});

test("a state comes back from its address", () => {
  const s = { ...two(), display: { ...initialState.display, log: true, exposure: -1.5 }, pane: "fit" as const };
  assert.deepEqual(decodeHash(`#${encodeHash(s)}`), s);
});

test("the initial state needs no address", () => assert.equal(encodeHash(initialState), ""));

test("eight materials make an address below two thousand characters", () => {
  let s = initialState;
  for (let i = 0; i < 8; ++i) s = addMaterial(s, `material ${i}`, lobe(0.1 * i));
  assert.ok(encodeHash(s).length < 2000, `${encodeHash(s).length}`);
});

test("the address holds only characters that need no escape", () => {
  assert.match(encodeHash(addMaterial(initialState, "Ω θ", lobe(0.3))), /^[\w-]+$/);
});

test("a damaged address is no state", () => {
  const hash = encodeHash(two());
  assert.equal(decodeHash(hash.slice(0, hash.length / 2)), undefined);
  assert.equal(decodeHash("1%%%"), undefined);
  assert.equal(decodeHash("something else"), undefined);
  assert.equal(decodeHash(""), undefined);
});

test("values of another type than expected are ignored", () => {
  assert.deepEqual(merge({ a: 1, b: { c: "x" } }, { a: "no", b: 3 }), { a: 1, b: { c: "x" } });
  assert.deepEqual(merge({ list: [1] }, { list: "no" }), { list: [1] });
});

test("a session is read back, and a stranger's JSON is refused", () => {
  const s = two();
  assert.deepEqual(readSession(sessionText(s)), s);
  assert.throws(() => readSession('{"materials": []}'), /not a session/);
});

test("materials without a source or with a doubled id are left out of a session", () => {
  const text = JSON.stringify({ nacre: 1, materials: [{ id: 1, name: "a", source: lobe(1) }, { id: 1, name: "b", source: lobe(1) }, { id: 2, name: "c" }], selected: 2 });
  const s = readSession(text);
  assert.deepEqual(s.materials.map((m) => m.name), ["a"]);
  assert.equal(s.selected, 1);
});

test("only differences are kept", () => {
  assert.deepEqual(difference({ a: 1, b: { c: 2, d: 3 } }, { a: 1, b: { c: 2, d: 4 } }), { b: { d: 3 } });
});
