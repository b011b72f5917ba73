// The messages of docs/explorer-protocol.md, typed, and the decoding of binary answers.

export type Rgb = [number, number, number];
export type ParameterValue = number | Rgb;

export interface Declaration {
  name: string;
  unit: string;
  meaning: string;
  lo: number;
  hi: number;
  initial: ParameterValue;
  is_color: boolean;
  is_switch: boolean;
  value?: ParameterValue;
}

export interface Model {
  name: string;
  summary: string;
  source: string;
  laws: unknown;
  parameters: Declaration[];
}

export interface ResolvedLobe {
  model: string;
  weight: ParameterValue;
  parameters: Record<string, ParameterValue>;
}

export type MaterialRequest =
  | { text: string }
  | { file: string }
  | { brdf: BrdfSource; values?: Record<string, ParameterValue> }
  | { name: string; lobes: ResolvedLobe[] };

export interface BrdfSource {
  name: string;
  source: string;
}

export interface Choice {
  name: string;
  summary?: string;
  parameters?: Declaration[];
}

export interface ExportFormat {
  name: string;
  summary: string;
  ending: string;
}

export interface Camera {
  target: Rgb;
  distance: number;
  azimuth: number;
  elevation: number;
  fov: number;
}

export type CurveKind = "theta_h" | "theta_d" | "theta_i" | "theta_o" | "phi" | "polar" | "albedo" | "D" | "G1";

export type EntryKind = "measured" | "brdf" | "json" | "scene" | "environment" | "mesh" | "image";

export interface FileEntry {
  name: string;
  is_folder: boolean;
  kind?: EntryKind;
  size: number;
  modified: number;
}

export interface Law {
  name: string;
  verdict: string;
  worst: number | null;
  tolerance: number | null;
  where?: { theta_i?: number; phi_i?: number; theta_o?: number; phi_o?: number } | null;
  command?: string;
}

export interface FitResult {
  model: string;
  material: MaterialRequest & { lobes?: ResolvedLobe[] };
  parameters: { lobe?: string; name: string; value: ParameterValue; error: number | null; at_bound?: boolean }[];
  errors: Record<string, number>;
  seconds: number;
  /// Why this model could not be fitted; the rest is missing then.
  failed?: string;
}

interface CurvesBody {
  materials: MaterialRequest[];
  kind: CurveKind;
  theta_i: number;
  phi_i: number;
  theta_d: number;
  phi_o: number;
  points: number;
}

/// What is asked, by the request's type.
export interface Requests {
  hello: object;
  files: { folder: string };
  watch: { files: string[] };
  read: { file: string };
  write: { file: string; text: string };
  material: { material: MaterialRequest };
  curves: CurvesBody;
  lobe3d: { material: MaterialRequest; theta_i: number; phi_i: number; n_theta: number; n_phi: number };
  slice: { material: MaterialRequest; size: number; phi_d: number; sqrt_theta_h: boolean; double_theta: boolean };
  sphere: {
    material: MaterialRequest;
    size: number;
    theta_i: number;
    phi_i: number;
    double_theta: boolean;
    cosine: boolean;
  };
  furnace: { material: MaterialRequest; size: number; parameter?: string };
  object: {
    material: MaterialRequest;
    mesh: string;
    environment: string;
    width: number;
    height: number;
    camera: Camera;
    sampling: string;
    samples: number;
    turn: number;
  };
  render: {
    scene: string;
    definitions: Record<string, string>;
    integrator: string;
    camera?: Camera;
    swap: Record<string, MaterialRequest>;
    samples: number;
    scale: number;
  };
  inspect: { of: number; x: number; y: number };
  display: { of: number; operator: string; exposure: number; parameters: Record<string, number> };
  save: { of: number; file: string; operator?: string; exposure?: number; parameters?: Record<string, number> };
  fit: { measured: string; models: string[]; metric: string; starts: number };
  validate: { material: MaterialRequest; samples: number };
  compile: { brdf: BrdfSource };
  physics: { topic: string; [parameter: string]: unknown };
  export: { material: MaterialRequest; format: string };
}

/// Arrays of a binary answer, by name.
export interface FloatArray {
  shape: number[];
  data: Float32Array;
}

export interface Message {
  id: number;
  ok?: boolean;
  error?: { message: string; line?: number; column?: number };
  progress?: number;
  cancelled?: boolean;
  arrays: Record<string, FloatArray>;
}

/// What is answered beside the arrays, by the request's type.
export interface Answers {
  hello: {
    version: string;
    root: string;
    models: Model[];
    start: (MaterialRequest & { name?: string })[];
    metrics: (string | Choice)[];
    integrators: (string | Choice)[];
    operators: (string | Choice)[];
    formats?: ExportFormat[];
    scene?: string;
  };
  files: { entries: FileEntry[] };
  watch: { changed?: string };
  read: { text: string };
  write: object;
  material: {
    name: string;
    kind: "model" | "measured" | "user";
    lobes?: { model: string; weight: ParameterValue; parameters: Declaration[] }[];
    facts?: Record<string, unknown> | string[];
    holes?: number;
    is_isotropic: boolean;
  };
  curves: object;
  lobe3d: { theta_max?: number };
  slice: object;
  sphere: object;
  furnace: object;
  object: { samples: number; seconds?: number };
  render: { samples: number; seconds?: number; materials?: string[]; integrator?: string; camera?: Camera };
  inspect: {
    rgb: Rgb;
    xyz: Rgb;
    samples: number;
    variance: number | Rgb;
    material?: string | null;
    spectrum?: { wavelength_nm: number[]; radiance: number[] };
  };
  display: object;
  save: object;
  fit: { model?: string; material?: FitResult["material"]; best_error?: number; iteration?: number; results?: FitResult[] };
  validate: { laws: Law[] };
  compile: { parameters?: Declaration[]; errors?: { line: number; column: number; message: string }[] };
  physics: {
    x_label?: string;
    y_label?: string;
    series?: string[];
    values?: Record<string, number | null>;
    metals?: string[];
    formula?: string;
    source?: string;
  };
  export: { text: string; remark?: string };
}

export type RequestType = keyof Requests;
export type Answer<T extends RequestType> = Message & Answers[T];

interface ArrayHeader {
  name: string;
  shape: number[];
}

/// A message as it came: JSON text, or a binary frame with arrays.
export function decode(data: string | ArrayBuffer): Message {
  return typeof data === "string" ? { ...JSON.parse(data), arrays: {} } : decodeBinary(data);
}

export function decodeBinary(buffer: ArrayBuffer): Message {
  if (buffer.byteLength < 4) throw new Error(`a binary message of ${buffer.byteLength} bytes has no header`);
  const length = new DataView(buffer).getUint32(0, true);
  if (4 + length > buffer.byteLength)
    throw new Error(`the header says ${length} bytes, the message has ${buffer.byteLength - 4}`);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const arrays: Record<string, FloatArray> = {};
  let offset = 4 * Math.ceil((4 + length) / 4);
  for (const { name, shape } of (header.arrays ?? []) as ArrayHeader[]) {
    const count = shape.reduce((product, n) => product * n, 1);
    if (offset + 4 * count > buffer.byteLength)
      throw new Error(`array '${name}' wants ${4 * count} bytes, ${buffer.byteLength - offset} are left`);
    arrays[name] = { shape, data: new Float32Array(buffer, offset, count) };
    offset += 4 * count;
  }
  return { ...header, arrays };
}

/// The same frame, made: for tests and a core inside a worker.
export function encodeBinary(header: object, arrays: Record<string, FloatArray>): ArrayBuffer {
  const list = Object.entries(arrays);
  const text = new TextEncoder().encode(
    JSON.stringify({ ...header, arrays: list.map(([name, { shape }]) => ({ name, shape })) }),
  );
  const start = 4 * Math.ceil((4 + text.length) / 4);
  const total = list.reduce((sum, [, { data }]) => sum + data.byteLength, start);
  const buffer = new ArrayBuffer(total);
  new DataView(buffer).setUint32(0, text.length, true);
  new Uint8Array(buffer).set(text, 4);
  let offset = start;
  for (const [, { data }] of list) {
    new Float32Array(buffer, offset, data.length).set(data);
    offset += data.byteLength;
  }
  return buffer;
}

export const choiceName = (choice: string | Choice): string => (typeof choice === "string" ? choice : choice.name);
