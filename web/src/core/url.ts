// The state as text: what differs from the initial state, deflated, in characters an address may have.

import { deflateSync, inflateSync, strFromU8, strToU8 } from "fflate";
import { type State, initialState } from "./state";

type Json = null | boolean | number | string | Json[] | { [key: string]: Json };

const isObject = (value: unknown): value is { [key: string]: Json } =>
  typeof value === "object" && value !== null && !Array.isArray(value);

/// What of `value` differs from `base`; undefined if nothing does. Arrays are kept whole.
export function difference(value: Json, base: Json | undefined): Json | undefined {
  if (isObject(value) && isObject(base)) {
    const result: { [key: string]: Json } = {};
    for (const [key, item] of Object.entries(value)) {
      const d = difference(item, base[key]);
      if (d !== undefined) result[key] = d;
    }
    return Object.keys(result).length ? result : undefined;
  }
  return JSON.stringify(value) === JSON.stringify(base) ? undefined : value;
}

/// Puts a difference back onto its base. A value of another type than the base's is ignored: a link from another
/// version must not break the page.
export function merge<T>(base: T, change: unknown): T {
  if (change === undefined) return base;
  if (isObject(base)) {
    if (!isObject(change)) return base;
    const result: { [key: string]: unknown } = { ...base };
    for (const [key, item] of Object.entries(change)) result[key] = key in base ? merge(base[key], item) : item;
    return result as T;
  }
  if (base !== null && change !== null && typeof base !== typeof change) return base;
  if (Array.isArray(base) !== Array.isArray(change) && base !== null) return base;
  return change as T;
}

/// Numbers are shortened to six digits: no slider shows more.
const shorten = (_: string, value: unknown) => (typeof value === "number" ? Number(value.toPrecision(6)) : value);

export function sessionText(state: State): string {
  const change = difference(JSON.parse(JSON.stringify(state, shorten)), initialState as unknown as Json);
  return JSON.stringify({ nacre: 1, ...((change as object) ?? {}) }, null, 1);
}

export function readSession(text: string): State {
  const parsed = JSON.parse(text);
  if (!isObject(parsed) || parsed.nacre !== 1) throw new Error("not a session of the explorer");
  const { nacre: _, ...change } = parsed;
  return checked(merge(initialState, change));
}

export function encodeHash(state: State): string {
  const text = JSON.stringify(difference(JSON.parse(JSON.stringify(state, shorten)), initialState as unknown as Json));
  if (text === undefined) return "";
  const bytes = deflateSync(strToU8(text), { level: 9 });
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return "1" + btoa(binary).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}

/// The state of an address, or undefined if it holds none that can be read.
export function decodeHash(hash: string): State | undefined {
  const text = hash.replace(/^#/, "");
  if (!text.startsWith("1")) return undefined;
  try {
    const binary = atob(text.slice(1).replace(/-/g, "+").replace(/_/g, "/"));
    const bytes = Uint8Array.from(binary, (c) => c.charCodeAt(0));
    return checked(merge(initialState, JSON.parse(strFromU8(inflateSync(bytes)))));
  } catch {
    return undefined;
  }
}

/// Materials without a source, doubled ids and selections of nothing would break every view.
function checked(state: State): State {
  const seen = new Set<number>();
  const materials = state.materials.filter((m) => {
    const whole =
      isObject(m) && typeof m.id === "number" && !seen.has(m.id) && typeof m.name === "string" && isObject(m.source);
    if (whole) seen.add(m.id);
    return whole;
  });
  const known = (id: number | null) => (id !== null && seen.has(id) ? id : null);
  return { ...state, materials, selected: known(state.selected) ?? materials[0]?.id ?? null, solo: known(state.solo) };
}
