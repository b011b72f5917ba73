// The one state of the page, its changes with undo, and its copy in the address.

import { computed, signal } from "@preact/signals";
import { History } from "./history";
import { type State, initialState, shownMaterials } from "./state";
import { decodeHash, encodeHash } from "./url";

export const state = signal<State>(decodeHash(location.hash) ?? initialState);
export const cameWithState = state.value !== initialState;

const history = new History<State>();
export const undoable = signal({ undo: false, redo: false });

const refresh = () => {
  if (undoable.value.undo !== history.canUndo || undoable.value.redo !== history.canRedo)
    undoable.value = { undo: history.canUndo, redo: history.canRedo };
};

/// A change that undo takes back. Changes with the same `gesture` in a row are one step.
export function change(edit: (state: State) => State, gesture?: string): void {
  const next = edit(state.value);
  if (next === state.value) return;
  history.record(state.value, gesture);
  state.value = next;
  refresh();
}

/// A change of what is looked at (pane, maximised view, cameras): not undone.
export function look(edit: Partial<State>): void {
  state.value = { ...state.value, ...edit };
}

/// Replaces part of one section of the state.
export function set<K extends SectionKey>(section: K, edit: Partial<State[K]>, gesture?: string): void {
  change((s) => ({ ...s, [section]: { ...s[section], ...edit } }), gesture);
}
export type SectionKey = "directions" | "display" | "slice" | "sphere" | "images" | "object" | "render" | "fit" | "validate" | "physics";

export const endGesture = (): void => history.endGesture();

/// Undo keeps what is looked at.
const keepLook = (next: State): State => {
  const { pane, views, maximised, lobeCamera } = state.value;
  return { ...next, pane, views, maximised, lobeCamera };
};

export function undo(): void {
  const previous = history.undo(state.value);
  if (previous) state.value = keepLook(previous);
  refresh();
}

export function redo(): void {
  const next = history.redo(state.value);
  if (next) state.value = keepLook(next);
  refresh();
}

export const materials = computed(() => state.value.materials);
export const selectedId = computed(() => state.value.selected);
export const selected = computed(() => state.value.materials.find((m) => m.id === state.value.selected));
export const solo = computed(() => state.value.solo);
export const directions = computed(() => state.value.directions);
export const display = computed(() => state.value.display);
export const pane = computed(() => state.value.pane);
export const maximised = computed(() => state.value.maximised);
const shownList = computed(() => {
  materials.value;
  solo.value;
  return shownMaterials(state.peek());
});
export const shown = shownList;

export const theme = signal<"dark" | "light">(
  localStorage.getItem("nacre.theme") === "light" ||
    (!localStorage.getItem("nacre.theme") && matchMedia("(prefers-color-scheme: light)").matches)
    ? "light"
    : "dark",
);
export function setTheme(value: "dark" | "light"): void {
  localStorage.setItem("nacre.theme", value);
  document.documentElement.dataset.theme = value;
  theme.value = value;
}

/// Keeps the address true to the state, and the state to an address that is pasted.
export function followAddress(): void {
  let written = location.hash;
  let timer: ReturnType<typeof setTimeout> | undefined;
  state.subscribe(() => {
    clearTimeout(timer);
    timer = setTimeout(writeAddress, 250);
  });
  writeAddressNow = () => {
    clearTimeout(timer);
    writeAddress();
  };
  function writeAddress(): void {
    const hash = encodeHash(state.value);
    written = hash ? `#${hash}` : "";
    window.history.replaceState(null, "", location.pathname + location.search + written);
  }
  addEventListener("hashchange", () => {
    if (location.hash === written) return;
    const next = decodeHash(location.hash);
    if (next) change(() => next);
  });
}
export let writeAddressNow: () => void = () => {};
