// The lobes in space, one surface a material; dragging the light's handle sets the incident direction.

import { useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { channelValue } from "../core/color";
import { nextFrame } from "../core/frame";
import type { Material } from "../core/state";
import { directions, display, endGesture, look, set, state, theme } from "../core/store";
import type { FloatArray } from "../protocol";
import { orbitControls } from "../ui/orbit";
import { tidy } from "../ui/scale";
import { currentColor } from "./curves";
import { onView, requestFor, useLatest } from "./data";
import { useRegister, ViewFrame } from "./frame";
import { LobeScene, type LobeShape } from "./lobe_scene";
import { radius } from "./radial";

interface Lobe {
  material: Material;
  f: FloatArray;
  thetaMax: number;
}

export function Lobe3dView() {
  const lobes = useSignal(new Map<number, Lobe>());
  const largest = useSignal(0);
  const list = onView();
  return (
    <ViewFrame id="lobe3d" title="3-D lobe" hint="drag the light, or turn the view">
      {list.map((m) => (
        <Ask key={m.id} id={m.id} lobes={lobes} />
      ))}
      <Body lobes={lobes} largest={largest} />
      <span class="corner">{largest.value > 0 && `1 = ${tidy(largest.value)}${display.value.cosine ? "" : " /sr"}`}</span>
    </ViewFrame>
  );
}

type Lobes = ReturnType<typeof useSignal<Map<number, Lobe>>>;

function Ask({ id, lobes }: { id: number; lobes: Lobes }) {
  const error = useLatest(
    `lobe3d ${id}`,
    "lobe3d",
    () => {
      const list = onView();
      const material = list.find((m) => m.id === id);
      if (!material) return null;
      const { theta_i, phi_i } = directions.value;
      const fine = list.length <= 3;
      return {
        body: { material: requestFor(material), theta_i, phi_i, n_theta: fine ? 91 : 61, n_phi: fine ? 181 : 121 },
        about: material,
      };
    },
    (answer, material) => {
      const f = answer.arrays.f;
      lobes.value = new Map(lobes.peek()).set(id, { material, f, thetaMax: answer.theta_max ?? 90 });
    },
  );
  return error.value ? <p class="view-error">{error.value}</p> : null;
}

function Body({ lobes, largest }: { lobes: Lobes; largest: { value: number; peek(): number } }) {
  const box = useRef<HTMLDivElement>(null);
  const scene = useRef<LobeScene | null>(null);
  const failed = useSignal(false);
  const size = useSignal({ width: 0, height: 0 });
  const owner = useRef({});
  const register = useRegister();

  useEffect(() => {
    const element = box.current!;
    const canvas = element.querySelector("canvas")!;
    let made: LobeScene;
    try {
      made = scene.current = new LobeScene(canvas);
    } catch {
      failed.value = true;
      return;
    }
    register(() => canvas);
    const observer = new ResizeObserver(() => (size.value = { width: element.clientWidth, height: element.clientHeight }));
    observer.observe(element);
    let dragging = false;
    const at = (e: PointerEvent): [number, number] => {
      const r = canvas.getBoundingClientRect();
      return [(2 * (e.clientX - r.left)) / r.width - 1, 1 - (2 * (e.clientY - r.top)) / r.height];
    };
    const claim = (e: PointerEvent) => {
      if (!made.onHandle(...at(e))) return false;
      dragging = true;
      canvas.setPointerCapture(e.pointerId);
      return true;
    };
    const stop = orbitControls(canvas, () => state.peek().lobeCamera, (c) => look({ lobeCamera: c }), claim);
    const move = (e: PointerEvent) => {
      if (dragging) set("directions", made.lightAt(...at(e)), "drag light");
      else canvas.style.cursor = made.onHandle(...at(e)) ? "grab" : "";
    };
    const up = () => {
      if (dragging) endGesture();
      dragging = false;
    };
    canvas.addEventListener("pointermove", move);
    canvas.addEventListener("pointerup", up);
    canvas.addEventListener("pointercancel", up);
    return () => {
      stop();
      observer.disconnect();
      nextFrame(owner.current, () => {});
      scene.current = null;
      made.dispose();
    };
  }, []);

  useSignalEffect(() => {
    const { channel, log, cosine } = display.value;
    const { theta_i, phi_i, theta_o, phi_o } = directions.value;
    const camera = state.value.lobeCamera;
    const { width, height } = size.value;
    const all = lobes.value;
    theme.value;
    const list = onView().flatMap((m) => all!.get(m.id) ?? []);
    const colors = list.map(({ material }) => currentColor(material));
    if (width < 8 || height < 8) return;
    nextFrame(owner.current, () => {
      const view = scene.current;
      if (!view) return;
      const style = getComputedStyle(document.documentElement);
      view.colors(...(["--grid3d", "--light", "--mark"].map((c) => style.getPropertyValue(c).trim()) as [string, string, string]));
      const { shapes, top } = lobeShapes(list, colors, channel, log, cosine);
      if (largest.peek() !== top) largest.value = top;
      view.show(shapes);
      view.directions(theta_i, phi_i, theta_o, phi_o);
      view.size(width, height);
      view.look(camera);
      view.render();
    });
  });
  return (
    <div class="canvas three" ref={box}>
      <canvas />
      {failed.value && <p class="view-note">This browser gives no WebGL.</p>}
    </div>
  );
}

function lobeShapes(list: Lobe[], colors: string[], channel: Parameters<typeof channelValue>[2], log: boolean, cosine: boolean) {
  let top = 0;
  const values = list.map(({ f, thetaMax }) => {
    const [nTheta, nPhi] = f.shape;
    const result = new Float32Array(nTheta * nPhi);
    for (let t = 0, i = 0; t < nTheta; ++t) {
      const cos = Math.abs(Math.cos((thetaMax * Math.PI * t) / 180 / (nTheta - 1)));
      const factor = cosine ? cos : 1;
      for (let p = 0; p < nPhi; ++p, ++i) {
        const v = factor * channelValue(f.data, 3 * i, channel);
        result[i] = v;
        if (v > top && cos > 0.02) top = v;
      }
    }
    return result;
  });
  const shapes = list.map(({ material, f, thetaMax }, i): LobeShape => {
    const radii = values[i];
    for (let k = 0; k < radii.length; ++k) radii[k] = radius(radii[k], top, log);
    return { id: material.id, color: colors[i], radii, nTheta: f.shape[0], nPhi: f.shape[1], thetaMax };
  });
  return { shapes, top };
}
