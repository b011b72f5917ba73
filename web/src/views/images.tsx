// Lit spheres and image slices: a picture a material, side by side.

import { type Signal, useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { toPixels } from "../core/color";
import { nextFrame } from "../core/frame";
import type { Material } from "../core/state";
import { directions, display, endGesture, selectedId, set, state } from "../core/store";
import type { FloatArray } from "../protocol";
import { Toggle } from "../ui/controls";
import { tidy } from "../ui/scale";
import { currentColor } from "./curves";
import { onView, pictured, requestFor, useLatest } from "./data";
import { useRegister, ViewFrame } from "./frame";

type Kind = "sphere" | "slice";

function shownPictures(): Material[] {
  const list = onView();
  if (state.value.images.all) return list;
  return [list.find((m) => m.id === selectedId.value) ?? list[0]].filter(Boolean);
}

const AllToggle = () => (
  <Toggle on={state.value.images.all} label="all" title="all materials, or the selected one" change={(all) => set("images", { all })} />
);

export function SphereView() {
  const { sphere } = state.value;
  return (
    <ViewFrame
      id="sphere"
      title="Lit sphere"
      hint="one distant light; drag to move it"
      options={
        <>
          <Toggle on={sphere.double} label="2θ" title="normals lean half as far, so that the mirror direction reaches grazing angles at the rim" id="sphere-double" change={(double) => set("sphere", { double })} />
          <Toggle on={sphere.cosine} label="cos" title="times the cosine at the light" id="sphere-cosine" change={(cosine) => set("sphere", { cosine })} />
          <AllToggle />
        </>
      }
    >
      <Pictures kind="sphere" />
    </ViewFrame>
  );
}

export function SliceView() {
  const { slice } = state.value;
  return (
    <ViewFrame
      id="slice"
      title="Image slice"
      hint="θh to the right, θd upwards, at φd of the bar above"
      options={
        <>
          <Toggle on={slice.sqrt} label="√θh" title="square-root axis: the peak at θh = 0 takes more room" id="slice-sqrt" change={(sqrt) => set("slice", { sqrt })} />
          <Toggle on={slice.double} label="2θ" title="θh to 45 degrees only" id="slice-double" change={(double) => set("slice", { double })} />
          <AllToggle />
        </>
      }
    >
      <Pictures kind="slice" />
    </ViewFrame>
  );
}

/// Columns and side of equal squares that fill a box best.
export function squares(count: number, width: number, height: number, gap: number): { columns: number; side: number } {
  let best = { columns: 1, side: 0 };
  for (let columns = 1; columns <= count; ++columns) {
    const rows = Math.ceil(count / columns);
    const side = Math.floor(Math.min((width - gap * (columns - 1)) / columns, (height - gap * (rows - 1)) / rows));
    if (side > best.side) best = { columns, side };
  }
  return best;
}

function Pictures({ kind }: { kind: Kind }) {
  const box = useRef<HTMLDivElement>(null);
  const size = useSignal({ width: 0, height: 0, em: 14 });
  const list = shownPictures();
  const register = useRegister();
  useEffect(() => {
    const element = box.current!;
    register(() => sideBySide(element));
    const observer = new ResizeObserver(() => {
      size.value = { width: element.clientWidth, height: element.clientHeight, em: parseFloat(getComputedStyle(element).fontSize) };
    });
    observer.observe(element);
    return () => observer.disconnect();
  }, []);
  const { width, height, em } = size.value;
  const gap = 0.4 * em;
  const { columns, side } = squares(Math.max(1, list.length), width, height, gap);
  return (
    <div class="pictures" ref={box}>
      {side > 8 && (
        <div class="squares" style={{ gridTemplateColumns: `repeat(${columns}, ${side}px)`, gap: `${gap}px` }}>
          {list.map((m) => (
            <Picture key={m.id} id={m.id} kind={kind} side={side} name={list.length > 1 ? m.name : ""} />
          ))}
        </div>
      )}
    </div>
  );
}

function sideBySide(element: HTMLElement): HTMLCanvasElement | undefined {
  const all = [...element.querySelectorAll("canvas")];
  if (!all.length) return undefined;
  const ratio = all[0].width / all[0].clientWidth || 1;
  const outer = element.getBoundingClientRect();
  const result = document.createElement("canvas");
  result.width = Math.round(outer.width * ratio);
  result.height = Math.round(outer.height * ratio);
  for (const canvas of all) {
    const r = canvas.getBoundingClientRect();
    result.getContext("2d")!.drawImage(canvas, (r.left - outer.left) * ratio, (r.top - outer.top) * ratio, r.width * ratio, r.height * ratio);
  }
  return result;
}

/// Pixels along a side: the screen's own, in steps that survive small changes of the layout.
const resolution = (side: number) => Math.max(32, Math.min(512, Math.ceil((side * devicePixelRatio) / 32) * 32));

function Picture({ id, kind, side, name }: { id: number; kind: Kind; side: number; name: string }) {
  const image = useSignal<FloatArray | null>(null);
  const px = useSignal(side);
  px.value = side;
  const current = () => onView().find((m) => m.id === id);
  const about = id;
  const got = ({ arrays }: { arrays: Record<string, FloatArray> }) => {
    image.value = arrays.image;
  };
  const slot = `${kind} ${id}`;
  const error =
    kind === "sphere"
      ? useLatest(slot, "sphere", () => {
          const material = current();
          const { theta_i, phi_i } = directions.value;
          const { double: double_theta, cosine } = state.value.sphere;
          if (!material) return null;
          return { about, body: { material: requestFor(material), size: resolution(px.value), theta_i, phi_i, double_theta, cosine } };
        }, got)
      : useLatest(slot, "slice", () => {
          const material = current();
          const { sqrt: sqrt_theta_h, double: double_theta } = state.value.slice;
          const { phi_d } = directions.value;
          if (!material) return null;
          return { about, body: { material: requestFor(material), size: resolution(px.value), phi_d, sqrt_theta_h, double_theta } };
        }, got);
  const material = current();
  return (
    <figure class={kind} style={{ width: side, height: side }} data-testid={`${kind}-${id}`}>
      <Pixels kind={kind} id={id} image={image} />
      {kind === "slice" && !name && <SliceAxes />}
      {name && material && <figcaption style={{ color: currentColor(material) }}>{name}</figcaption>}
      {error.value && <p class="view-error">{error.value}</p>}
    </figure>
  );
}

function SliceAxes() {
  const { sqrt, double } = state.value.slice;
  const end = double ? 45 : 90;
  return (
    <>
      <span class="axis bottom">{sqrt ? `√θh → ${end}°` : `θh → ${end}°`}</span>
      <span class="axis left">θd → 90°</span>
    </>
  );
}

function Pixels({ kind, id, image }: { kind: Kind; id: number; image: Signal<FloatArray | null> }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const readout = useRef<HTMLSpanElement>(null);
  const owner = useRef({});
  const buffer = useRef<ImageData | null>(null);
  useSignalEffect(() => {
    const picture = image.value;
    const { exposure, gamma } = display.value;
    if (!picture) return;
    const [height, width] = picture.shape;
    pictured.set(`${kind} ${id}`, { material: id, width, height, rgb: picture.data });
    nextFrame(owner.current, () => {
      const element = canvas.current;
      if (!element) return;
      if (element.width !== width || element.height !== height) {
        element.width = width;
        element.height = height;
      }
      if (buffer.current?.width !== width || buffer.current.height !== height) buffer.current = new ImageData(width, height);
      toPixels(picture.data, width, buffer.current.data, exposure, gamma);
      if (kind === "sphere") cutDisk(buffer.current);
      element.getContext("2d")!.putImageData(buffer.current, 0, 0);
    });
  });
  const at = (e: PointerEvent) => {
    const r = canvas.current!.getBoundingClientRect();
    return { x: (e.clientX - r.left) / r.width, y: (e.clientY - r.top) / r.height };
  };
  const light = (e: PointerEvent) => {
    const { x, y } = at(e);
    const r = Math.min(1, Math.hypot(2 * x - 1, 1 - 2 * y));
    const phi = (Math.atan2(1 - 2 * y, 2 * x - 1) * 180) / Math.PI;
    const theta = (Math.asin(r) * 180) / Math.PI;
    set("directions", { theta_i: Math.round(theta * 10) / 10, phi_i: Math.round(((phi + 360) % 360) * 10) / 10 }, "drag sphere");
  };
  const read = (e: PointerEvent) => {
    const picture = image.peek();
    if (!picture || !readout.current) return;
    const [h, w] = picture.shape;
    const { x, y } = at(e);
    const i = 3 * (Math.min(h - 1, Math.max(0, Math.floor(y * h))) * w + Math.min(w - 1, Math.max(0, Math.floor(x * w))));
    readout.current.textContent = [0, 1, 2].map((c) => tidy(picture.data[i + c])).join("  ");
  };
  return (
    <>
      <canvas
        ref={canvas}
        onPointerDown={(e) => {
          if (kind !== "sphere") return;
          canvas.current!.setPointerCapture(e.pointerId);
          light(e);
        }}
        onPointerMove={(e) => {
          if (kind === "sphere" && canvas.current!.hasPointerCapture(e.pointerId)) light(e);
          read(e);
        }}
        onPointerUp={endGesture}
        onPointerLeave={() => readout.current && (readout.current.textContent = "")}
      />
      <span class="pixel" ref={readout} />
    </>
  );
}

/// What lies outside the sphere is not part of the picture; its rim is smoothed over a pixel.
function cutDisk({ data, width, height }: ImageData): void {
  const r = width / 2;
  for (let y = 0, o = 3; y < height; ++y)
    for (let x = 0; x < width; ++x, o += 4) {
      const d = r - Math.hypot(x + 0.5 - r, y + 0.5 - height / 2);
      if (d < 1) data[o] = d <= 0 ? 0 : 255 * d;
    }
}
