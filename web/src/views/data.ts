// What the views show, fetched when something it depends on changed, and kept for tests to read.

import { type Signal, signal, useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { ConnectionLost } from "../connection";
import { core, fileVersion, hello } from "../core/session";
import { type Material, toRequest } from "../core/state";
import { shown } from "../core/store";
import type { Answer, MaterialRequest, RequestType, Requests } from "../protocol";

/// Materials shown instead of the user's own: a measurement and its fit under way.
export const guests = signal<Material[]>([]);
export const onView = (): Material[] => (guests.value.length ? guests.value : shown.value);

const requestOf = new WeakMap<object, MaterialRequest>();
/// The same object for the same source and name.
export function requestFor(material: Material): MaterialRequest {
  let request = requestOf.get(material);
  if (!request) requestOf.set(material, (request = toRequest(material)));
  return request;
}

/// A request's body, and what the page must remember of it until the answer.
export interface Question<T extends RequestType, About> {
  body: Requests[T];
  about: About;
}

/// Asks in the slot whenever the question's text changed; `got` has the newest answer.
/// @param question  reads the signals it depends on; null: nothing to ask
export function useLatest<T extends RequestType, About>(
  slot: string,
  type: T,
  question: () => Question<T, About> | null,
  got: (answer: Answer<T>, about: About) => void,
): Signal<string> {
  const error = useSignal("");
  const last = useRef("");
  const alive = useRef(true);
  useEffect(() => {
    alive.current = true;
    return () => {
      alive.current = false;
    };
  }, []);
  useSignalEffect(() => {
    const generation = core.generation.value;
    const version = fileVersion.value;
    const asked = question();
    if (!hello.value || !asked) return;
    const { body, about } = asked;
    const key = `${generation} ${version} ${JSON.stringify(body)}`;
    if (key === last.current) return;
    last.current = key;
    core.latest(slot, type, body).then(
      (answer) => {
        if (!answer || !alive.current) return;
        if (error.peek()) error.value = "";
        got(answer, about);
      },
      (problem: Error) => {
        if (!alive.current) return;
        if (problem instanceof ConnectionLost) last.current = "";
        else error.value = problem.message;
      },
    );
  });
  return error;
}

export interface ShownSeries {
  material: number;
  name: string;
  y: ArrayLike<number | null>;
}

/// The numbers behind each plot, as drawn.
export const plotted = new Map<string, { x: ArrayLike<number>; series: ShownSeries[] }>();
/// The pictures of the image views, as they came.
export const pictured = new Map<string, { material: number; width: number; height: number; rgb: Float32Array }>();
