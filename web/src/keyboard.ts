// Single keys for what is done often; none while text is typed.

import { signal } from "@preact/signals";
import { duplicateMaterial, editMaterial, removeMaterial, type Channel, type ViewId } from "./core/state";
import { change, look, maximised, redo, selected, set, setTheme, state, theme, undo } from "./core/store";
import { panes, saveSession } from "./app";
import { saveView } from "./views/capture";

export const help = signal(false);

const viewUnderPointer = (): string | undefined =>
  (document.querySelector(".view:hover") ?? document.activeElement?.closest(".view"))?.getAttribute("data-view") ?? undefined;

const channels: Record<string, Channel> = { y: "luminance", r: "r", g: "g", b: "b" };

function selectNeighbour(step: number): void {
  const { materials, selected: id } = state.value;
  const index = materials.findIndex((m) => m.id === id);
  const next = materials[Math.min(materials.length - 1, Math.max(0, index + step))];
  if (next) look({ selected: next.id });
}

function moveLight(dTheta: number, dPhi: number): void {
  const { theta_i, phi_i } = state.value.directions;
  set("directions", { theta_i: Math.min(90, Math.max(0, theta_i + dTheta)), phi_i: (phi_i + dPhi + 360) % 360 }, "keys light");
}

const withControl: Record<string, (shift: boolean) => void> = {
  z: (shift) => (shift ? redo() : undo()),
  y: () => redo(),
  s: () => saveSession(),
};

const withShift: Record<string, () => void> = {
  ArrowUp: () => moveLight(-1, 0),
  ArrowDown: () => moveLight(1, 0),
  ArrowLeft: () => moveLight(0, -2),
  ArrowRight: () => moveLight(0, 2),
};

const plain: Record<string, () => void> = {
  ArrowUp: () => selectNeighbour(-1),
  ArrowDown: () => selectNeighbour(1),
  a: () => document.querySelector<HTMLElement>("[data-testid=add-material]")?.click(),
  d: () => selected.value && change((s) => duplicateMaterial(s, selected.value!.id)),
  Delete: () => selected.value && change((s) => removeMaterial(s, selected.value!.id)),
  s: () => change((s) => ({ ...s, solo: s.solo === s.selected ? null : s.selected })),
  v: () => selected.value && change((s) => editMaterial(s, selected.value!.id, (m) => ({ ...m, visible: !m.visible }))),
  F2: () =>
    document.querySelector(".material.selected [data-rename]")?.dispatchEvent(new MouseEvent("dblclick", { bubbles: true })),
  l: () => set("display", { log: !state.value.display.log }),
  c: () => set("display", { cosine: !state.value.display.cosine }),
  "[": () => set("display", { exposure: state.value.display.exposure - 0.5 }, "keys exposure"),
  "]": () => set("display", { exposure: state.value.display.exposure + 0.5 }, "keys exposure"),
  m: () => look({ maximised: maximised.value ? null : ((viewUnderPointer() ?? null) as ViewId | null) }),
  i: () => {
    const view = viewUnderPointer();
    if (view) saveView(view);
  },
  t: () => setTheme(theme.value === "dark" ? "light" : "dark"),
  "?": () => (help.value = !help.value),
  Escape: () => (help.value ? (help.value = false) : look({ maximised: null })),
};

export function listenToKeys(): void {
  addEventListener("keydown", (e) => {
    const target = e.target as HTMLElement;
    const typing = target.closest("input:not([type=range]):not([type=checkbox]):not([type=color]), textarea, select, .cm-editor");
    const action =
      e.ctrlKey || e.metaKey
        ? withControl[e.key.toLowerCase()] && !(typing && e.key.toLowerCase() !== "s") && (() => withControl[e.key.toLowerCase()](e.shiftKey))
        : typing || e.altKey
          ? undefined
          : e.shiftKey && withShift[e.key]
            ? withShift[e.key]
            : keyAction(e, target);
    if (!action) return;
    e.preventDefault();
    action();
  });
}

function keyAction(e: KeyboardEvent, target: HTMLElement): (() => void) | undefined {
  // A slider keeps its arrows.
  if (e.key.startsWith("Arrow") && target.closest("input, [role=separator], button")) return undefined;
  const digit = Number(e.key);
  if (digit >= 1 && digit <= panes.length) return () => look({ pane: panes[digit - 1].id, maximised: null });
  if (channels[e.key]) return () => set("display", { channel: channels[e.key] });
  return plain[e.key];
}
