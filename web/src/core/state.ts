// The whole state of the page as plain data: what the URL, a saved session and undo hold.

import type { BrdfSource, Camera, MaterialRequest, ParameterValue, ResolvedLobe } from "../protocol";

export type Source =
  | { lobes: ResolvedLobe[] }
  | { file: string }
  | { brdf: BrdfSource; values: Record<string, ParameterValue> };

export interface Material {
  id: number;
  name: string;
  color: string;
  visible: boolean;
  source: Source;
}

export type Channel = "luminance" | "r" | "g" | "b";
export type PaneId = "explore" | "object" | "render" | "edit" | "fit" | "validate" | "physics";
export type ViewId =
  | "lobe3d"
  | "polar"
  | "theta_h"
  | "theta_d"
  | "theta_i"
  | "theta_o"
  | "phi"
  | "albedo"
  | "slice"
  | "sphere"
  | "D"
  | "G1";

export interface State {
  materials: Material[];
  selected: number | null;
  solo: number | null;
  /// Degrees; theta_o and phi_o are the viewer's, marked in the views that have one.
  directions: { theta_i: number; phi_i: number; theta_o: number; phi_o: number; theta_d: number; phi_d: number };
  display: { channel: Channel; log: boolean; cosine: boolean; exposure: number; gamma: number };
  slice: { sqrt: boolean; double: boolean };
  sphere: { double: boolean; cosine: boolean };
  images: { all: boolean };
  lobeCamera: { azimuth: number; elevation: number; distance: number };
  object: { mesh: string; environment: string; sampling: string; keep: boolean; turn: number; camera: Camera };
  render: {
    scene: string;
    integrator: string;
    swap: Record<string, { name: string; source: Source }>;
    camera: Camera | null;
    samples: number;
    scale: number;
    operator: string;
    exposure: number;
    parameters: Record<string, number>;
    split: number;
  };
  fit: { measured: string; models: string[]; metric: string; starts: number };
  validate: { samples: number; map: "reciprocity_map" | "energy_map" };
  physics: { topic: string; values: Record<string, Record<string, number | string>> };
  pane: PaneId;
  views: ViewId[];
  maximised: ViewId | null;
}

export const initialState: State = {
  materials: [],
  selected: null,
  solo: null,
  directions: { theta_i: 45, phi_i: 0, theta_o: 45, phi_o: 180, theta_d: 0, phi_d: 90 },
  display: { channel: "luminance", log: false, cosine: false, exposure: 0, gamma: 2.2 },
  slice: { sqrt: true, double: false },
  sphere: { double: false, cosine: true },
  images: { all: true },
  lobeCamera: { azimuth: 115, elevation: 20, distance: 3.5 },
  object: {
    mesh: "teapot",
    environment: "sky",
    sampling: "mis",
    keep: true,
    turn: 0,
    camera: { target: [0, 0, 0], distance: 3.4, azimuth: 30, elevation: 20, fov: 35 },
  },
  render: {
    scene: "",
    integrator: "path",
    swap: {},
    camera: null,
    samples: 256,
    scale: 1,
    operator: "",
    exposure: 0,
    parameters: {},
    split: 0.5,
  },
  fit: { measured: "", models: [], metric: "", starts: 8 },
  validate: { samples: 4096, map: "reciprocity_map" },
  physics: { topic: "fresnel", values: {} },
  pane: "explore",
  views: ["lobe3d", "polar", "theta_h", "theta_d", "sphere", "slice"],
  maximised: null,
};

/// Distinguishable on dark and on light ground; the first eight differ in hue and lightness.
export const palette = ["#e8a33d", "#4aa3df", "#58b368", "#e0607e", "#a984e0", "#2fb5a8", "#c9b458", "#d97b3f"];

export function nextColor(materials: Material[]): string {
  const uses = (color: string) => materials.filter((m) => m.color === color).length;
  return palette.reduce((best, color) => (uses(color) < uses(best) ? color : best));
}

export const nextId = (materials: Material[]): number => Math.max(0, ...materials.map((m) => m.id)) + 1;

/// What the views show: the solo material, or all that are visible.
export function shownMaterials(state: Pick<State, "materials" | "solo">): Material[] {
  const solo = state.materials.find((m) => m.id === state.solo);
  return solo ? [solo] : state.materials.filter((m) => m.visible);
}

export function toRequest(material: { name: string; source: Source }): MaterialRequest {
  const { name, source } = material;
  return "lobes" in source ? { name, lobes: source.lobes } : source;
}

export function addMaterial(state: State, name: string, source: Source): State {
  const id = nextId(state.materials);
  const color = nextColor(state.materials);
  return {
    ...state,
    materials: [...state.materials, { id, name, color, visible: true, source }],
    selected: id,
  };
}

export function editMaterial(state: State, id: number, edit: (material: Material) => Material): State {
  return { ...state, materials: state.materials.map((m) => (m.id === id ? edit(m) : m)) };
}

export function removeMaterial(state: State, id: number): State {
  const index = state.materials.findIndex((m) => m.id === id);
  const materials = state.materials.filter((m) => m.id !== id);
  const neighbour = materials[Math.min(index, materials.length - 1)]?.id ?? null;
  return {
    ...state,
    materials,
    selected: state.selected === id ? neighbour : state.selected,
    solo: state.solo === id ? null : state.solo,
  };
}

export function duplicateMaterial(state: State, id: number): State {
  const original = state.materials.find((m) => m.id === id);
  if (!original) return state;
  const copy: Material = {
    ...original,
    id: nextId(state.materials),
    name: freshName(state.materials, original.name),
    color: nextColor(state.materials),
  };
  const index = state.materials.indexOf(original);
  const materials = [...state.materials];
  materials.splice(index + 1, 0, copy);
  return { ...state, materials, selected: copy.id };
}

/// "gold" -> "gold 2" -> "gold 3"
export function freshName(materials: { name: string }[], name: string): string {
  const base = name.replace(/ \d+$/, "");
  const taken = new Set(materials.map((m) => m.name));
  if (!taken.has(name)) return name;
  for (let i = 2; ; ++i) if (!taken.has(`${base} ${i}`)) return `${base} ${i}`;
}

/// Sets a parameter of a lobe (or of a .brdf, whose lobe is 0).
export function setParameter(source: Source, lobe: number, name: string, value: ParameterValue): Source {
  if ("lobes" in source)
    return {
      lobes: source.lobes.map((l, i) =>
        i !== lobe
          ? l
          : name === "weight"
            ? { ...l, weight: value }
            : { ...l, parameters: { ...l.parameters, [name]: value } },
      ),
    };
  return "brdf" in source ? { ...source, values: { ...source.values, [name]: value } } : source;
}
