// A field over (theta_i, theta_o) in colours; a click picks the angles.

import { useSignal } from "@preact/signals";
import { useRef } from "preact/hooks";
import { heat } from "../core/color";
import type { FloatArray } from "../protocol";
import { Canvas, type Surface } from "../ui/canvas";
import { tidy } from "../ui/scale";

export function HeatMap(props: {
  field: FloatArray;
  marks: { theta_i: number; theta_o: number };
  pick(theta_i: number, theta_o: number): void;
}) {
  const hover = useSignal<{ i: number; o: number } | null>(null);
  const now = useSignal({ field: props.field, marks: props.marks });
  if (now.peek().field !== props.field || now.peek().marks !== props.marks) now.value = { field: props.field, marks: props.marks };
  const place = useRef({ x: 0, y: 0, side: 1 });
  const draw = (s: Surface) => {
    const { context: c, em } = s;
    const { field, marks } = now.peek();
    const [ni, no] = field.shape;
    const left = 3.2 * em;
    const side = Math.min(s.width - left - 6 * em, s.height - 3 * em);
    const top = 0.6 * em;
    place.current = { x: left, y: top, side };
    let lo = Infinity;
    let hi = -Infinity;
    for (const v of field.data) {
      if (v < lo) lo = v;
      if (v > hi) hi = v;
    }
    const constant = !(hi > lo);
    if (constant) hi = lo + 1;
    const pixels = new ImageData(ni, no);
    for (let i = 0; i < ni; ++i)
      for (let o = 0; o < no; ++o) {
        const [r, g, b] = heat((field.data[i * no + o] - lo) / (hi - lo));
        pixels.data.set([r, g, b, 255], 4 * ((no - 1 - o) * ni + i));
      }
    const small = new OffscreenCanvas(ni, no);
    small.getContext("2d")!.putImageData(pixels, 0, 0);
    c.imageSmoothingEnabled = false;
    c.drawImage(small, left, top, side, side);
    c.fillStyle = s.color("--dim");
    c.textAlign = "center";
    c.textBaseline = "top";
    for (const a of [0, 30, 60, 90]) {
      c.fillText(`${a}`, left + (side * a) / 90, top + side + 0.3 * em);
      c.textAlign = "right";
      c.textBaseline = "middle";
      c.fillText(`${a}`, left - 0.4 * em, top + side * (1 - a / 90));
      c.textAlign = "center";
      c.textBaseline = "top";
    }
    c.fillText("θi", left + side / 2, top + side + 1.4 * em);
    c.fillText("θo", 0.8 * em, top + side / 2);
    const bar = left + side + 1.2 * em;
    for (let i = 0; i < 64; ++i) {
      const [r, g, b] = heat(1 - i / 63);
      c.fillStyle = `rgb(${r} ${g} ${b})`;
      c.fillRect(bar, top + (side * i) / 64, 0.8 * em, side / 64 + 1);
    }
    c.fillStyle = s.color("--dim");
    c.textAlign = "left";
    if (!constant) c.fillText(tidy(hi), bar + 1.1 * em, top);
    c.textBaseline = "bottom";
    c.fillText(tidy(lo), bar + 1.1 * em, top + side);
    const at = hover.peek();
    if (at) {
      c.textBaseline = "middle";
      c.fillStyle = s.color("--text");
      c.fillText(tidy(field.data[at.i * no + at.o]), bar + 1.1 * em, top + side / 2);
    }
    c.strokeStyle = s.color("--mark");
    c.lineWidth = 2;
    c.beginPath();
    c.arc(left + (side * marks.theta_i) / 90, top + side * (1 - marks.theta_o / 90), 0.45 * em, 0, 2 * Math.PI);
    c.stroke();
  };
  const pointer = (e: PointerEvent, x: number, y: number) => {
    const { x: x0, y: y0, side } = place.current;
    const u = (x - x0) / side;
    const v = 1 - (y - y0) / side;
    const inside = u >= 0 && u <= 1 && v >= 0 && v <= 1;
    const [ni, no] = now.peek().field.shape;
    hover.value = inside && e.type !== "pointerleave" ? { i: Math.min(ni - 1, Math.floor(u * ni)), o: Math.min(no - 1, Math.floor(v * no)) } : null;
    if (inside && e.type === "pointerdown") props.pick(Math.round(u * 900) / 10, Math.round(v * 900) / 10);
  };
  return (
    <div class="heat-map">
      <Canvas draw={draw} depends={() => (now.value, hover.value)} pointer={pointer} title="click: every view goes to these angles" />
    </div>
  );
}
