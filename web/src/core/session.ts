// The connection, what the core said of itself, and messages for the user.

import { computed, signal } from "@preact/signals";
import { Connection, ConnectionLost, webSocketTransport } from "../connection";
import type { Answers, Declaration, FileEntry, MaterialRequest, Model } from "../protocol";
import { type Source, addMaterial } from "./state";
import { cameWithState, change, state } from "./store";

export const core = new Connection(webSocketTransport);
export const hello = signal<Answers["hello"] | null>(null);
/// Models of .brdf files that are lobes, as far as they were met.
const shaderModels = signal(new Map<string, Model>());
export const models = computed(
  () => new Map([...shaderModels.value, ...(hello.value?.models ?? []).map((m): [string, Model] => [m.name, m])]),
);

export interface Notice {
  text: string;
  kind: "error" | "note";
}
export const notices = signal<(Notice & { key: number })[]>([]);
let noticeKey = 0;
export function notify(text: string, kind: Notice["kind"] = "error"): void {
  if (notices.value.some((n) => n.text === text)) return;
  const key = ++noticeKey;
  notices.value = [...notices.value.slice(-3), { text, kind, key }];
  setTimeout(() => dismiss(key), kind === "error" ? 9000 : 3500);
}
export const dismiss = (key: number): void => {
  notices.value = notices.value.filter((n) => n.key !== key);
};

/// Says what failed; a lost connection is shown elsewhere and mends itself.
export function complain(error: unknown): void {
  if (!(error instanceof ConnectionLost)) notify((error as Error).message);
}

/// Raised when a file that is shown changed on disk: what depends on files asks anew.
export const fileVersion = signal(0);

/// What a .brdf declares, by its source.
export const brdfParameters = signal(new Map<string, Declaration[]>());
/// What the core says of a measured file.
export const fileFacts = signal(new Map<string, Answers["material"]>());

/// Turns a material as the core accepts it into one with editable parameters, and its name.
export async function resolve(request: MaterialRequest): Promise<{ name: string; source: Source }> {
  if ("brdf" in request) {
    await learnBrdf(request.brdf);
    return { name: request.brdf.name, source: { brdf: request.brdf, values: request.values ?? {} } };
  }
  if ("file" in request && request.file.endsWith(".brdf")) {
    const { text } = await core.ask("read", { file: request.file });
    return resolve({ brdf: { name: request.file, source: text } });
  }
  const answer = await core.ask("material", { material: request });
  if (answer.kind === "measured" && "file" in request) {
    fileFacts.value = new Map(fileFacts.value).set(request.file, answer);
    return { name: answer.name, source: { file: request.file } };
  }
  const met = (answer.lobes ?? []).filter((l) => answer.kind === "user" && !models.value.has(l.model));
  if (met.length) {
    const declared = met.map(({ model, parameters }): [string, Model] => [model, { name: model, summary: "", source: "", laws: null, parameters }]);
    shaderModels.value = new Map([...shaderModels.value, ...declared]);
  }
  const lobes = (answer.lobes ?? []).map(({ model, weight, parameters }) => ({
    model,
    weight,
    parameters: Object.fromEntries(parameters.map((p) => [p.name, p.value ?? p.initial])),
  }));
  return { name: answer.name, source: { lobes } };
}

export async function learnBrdf(brdf: { name: string; source: string }): Promise<void> {
  if (brdfParameters.value.has(brdf.source)) return;
  const answer = await core.ask("compile", { brdf });
  if (answer.errors?.length) {
    const { line, message } = answer.errors[0];
    throw new Error(`${brdf.name}:${line}: ${message}`);
  }
  const known = [...brdfParameters.value].slice(-20);
  brdfParameters.value = new Map([...known, [brdf.source, answer.parameters ?? []]]);
}

export async function add(request: MaterialRequest): Promise<void> {
  try {
    const { name, source } = await resolve(request);
    change((s) => addMaterial(s, name, source));
  } catch (error) {
    complain(error);
  }
}

/// A model with its declared defaults.
export function addModel(name: string): void {
  const model = models.value.get(name);
  if (!model) return;
  const parameters = Object.fromEntries(
    model.parameters.map((p) => [p.name, p.is_color && typeof p.initial === "number" ? triple(p.initial) : p.initial]),
  );
  change((s) => addMaterial(s, name, { lobes: [{ model: name, weight: 1, parameters }] }));
}
const triple = (x: number): [number, number, number] => [x, x, x];

export const files = async (folder: string): Promise<FileEntry[]> => (await core.ask("files", { folder })).entries;

const firstMaterials: MaterialRequest[] = [
  { text: "ggx_schlick:f0=0.95/0.64/0.37,alpha=0.25" },
  { text: "oren_nayar:reflectance=0.2/0.35/0.6,sigma=0.6" },
  { text: "ggx_plastic" },
];

async function greet(): Promise<void> {
  const first = hello.value === null;
  hello.value = await core.ask("hello", {});
  if (first && !cameWithState) {
    const start = hello.value.start?.length ? hello.value.start : firstMaterials;
    const found = await Promise.allSettled(start.map(resolve));
    state.value = found.reduce((s, result) => {
      if (result.status === "fulfilled") return addMaterial(s, result.value.name, result.value.source);
      complain(result.reason);
      return s;
    }, state.value);
    state.value = { ...state.value, selected: state.value.materials[0]?.id ?? null };
    const { scene } = hello.value;
    if (scene) state.value = { ...state.value, pane: "render", render: { ...state.value.render, scene } };
  } else {
    for (const { name, source } of state.value.materials)
      if ("lobes" in source && !source.lobes.every((l) => models.value.has(l.model))) resolve({ name, ...source }).catch(complain);
      else if ("brdf" in source) learnBrdf(source.brdf).catch(complain);
      else if ("file" in source) resolve(source).catch(complain);
  }
  watchFiles();
}

let watching: { files: string; cancel(): void } | undefined;
function watchFiles(): void {
  const names = state.value.materials.flatMap(({ source }) =>
    "file" in source ? [source.file] : "brdf" in source ? [source.brdf.name] : [],
  );
  const key = names.sort().join("\n");
  if (watching?.files === key || core.status.value !== "open") return;
  watching?.cancel();
  watching = undefined;
  if (!names.length) return;
  const task = core.begin("watch", { files: names }, ({ changed }) => changed && reload(changed));
  const own = { files: key, cancel: () => task.cancel() };
  watching = own;
  watchTasks++;
  task.answer
    .catch(() => {})
    .finally(() => {
      watchTasks--;
      if (watching === own) watching = undefined;
    });
}
let watchTasks = 0;
/// Requests that some view still waits for; before the core has said what it is, all of them.
export const awaited = (): number => core.outstanding - watchTasks + (hello.value ? 0 : 1);

/// A file was written by another program: its material follows.
async function reload(file: string): Promise<void> {
  notify(`${file} changed, reloaded`, "note");
  const users = state.value.materials.filter((m) => "brdf" in m.source && m.source.brdf.name === file);
  if (users.length) {
    try {
      const brdf = { name: file, source: (await core.ask("read", { file })).text };
      await learnBrdf(brdf);
      change((s) => ({
        ...s,
        materials: s.materials.map((m) =>
          "brdf" in m.source && m.source.brdf.name === file ? { ...m, source: { ...m.source, brdf } } : m,
        ),
      }));
    } catch (error) {
      complain(error);
    }
  }
  fileVersion.value++;
}

export function startSession(): void {
  core.onProblem = notify;
  core.generation.subscribe((generation) => {
    if (generation) greet().catch(complain);
  });
  state.subscribe(() => {
    if (hello.value) watchFiles();
  });
  core.start();
}
