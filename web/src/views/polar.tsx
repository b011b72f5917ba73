// The lobe in the plane of incidence. The light's ray can be dragged.

import { useRef } from "preact/hooks";
import { useSignal } from "@preact/signals";
import { directions, display, endGesture, set } from "../core/store";
import { Canvas, type Surface } from "../ui/canvas";
import { tidy } from "../ui/scale";
import { channelSeries, currentColor, topAwayFromGrazing, useCurves } from "./curves";
import { plotted } from "./data";
import { useRegister, ViewFrame } from "./frame";
import { logDecades, radius, roundUp } from "./radial";

const radians = Math.PI / 180;

export function PolarView() {
  const { answer, error } = useCurves("polar", 361);
  return (
    <ViewFrame id="polar" title="Polar" hint="f in the plane of incidence; drag the light" error={error.value}>
      <PolarBody answer={answer} />
    </ViewFrame>
  );
}

function PolarBody({ answer }: { answer: ReturnType<typeof useCurves>["answer"] }) {
  const hover = useSignal<{ x: number; y: number } | null>(null);
  const place = useRef({ x: 0, y: 0, r: 1 });
  const dragging = useRef(false);

  const draw = (s: Surface) => {
    const { context: c, em } = s;
    const now = answer.peek();
    const { channel, log, cosine } = display.peek();
    const whole = now ? now.x.data[now.x.data.length - 1] > 91 : false;
    const margin = 1.5 * em;
    const r = whole
      ? Math.min(s.width, s.height) / 2 - margin
      : Math.min(s.width / 2 - 2 * em, s.height - 2.4 * em - margin);
    const x0 = s.width / 2;
    const y0 = whole ? s.height / 2 : (s.height + r) / 2 - 0.1 * em;
    place.current = { x: x0, y: y0, r };
    const series = now ? channelSeries(now, channel, cosine) : [];
    plotted.set("polar", {
      x: now?.x.data ?? [],
      series: series.map(({ material, y }) => ({ material: material.id, name: material.name, y })),
    });
    const top = now ? topAwayFromGrazing(now, series) : 0;
    const largest = log ? 10 ** Math.ceil(Math.log10(top || 1)) : roundUp(top);
    drawGrid(s, x0, y0, r, whole, largest, log);
    drawRay(s, x0, y0, r);
    c.lineWidth = em / 8;
    c.lineJoin = "round";
    for (const { material, y } of series) {
      const path = new Path2D();
      let broken = true;
      for (let i = 0; i < y.length; ++i) {
        if (y[i] !== y[i]) {
          broken = true;
          continue;
        }
        const length = r * radius(y[i], largest, log);
        const angle = now!.x.data[i] * radians;
        const px = x0 + length * Math.sin(angle);
        const py = y0 - length * Math.cos(angle);
        if (broken) path.moveTo(px, py);
        else path.lineTo(px, py);
        broken = false;
      }
      const color = currentColor(material);
      c.globalAlpha = 0.1;
      c.fillStyle = color;
      c.fill(path);
      c.globalAlpha = 1;
      c.strokeStyle = color;
      c.stroke(path);
    }
    if (hover.peek() && now) drawReadout(s, hover.peek()!, now.x.data, series, x0, y0, r, largest, log);
  };

  const pointer = (e: PointerEvent, x: number, y: number) => {
    const { x: x0, y: y0 } = place.current;
    if (e.type === "pointerleave") hover.value = null;
    if (e.type === "pointerdown") dragging.current = true;
    if (dragging.current && (e.type === "pointermove" || e.type === "pointerdown")) {
      const angle = Math.atan2(x0 - x, y0 - y) / radians;
      set("directions", { theta_i: Math.round(10 * Math.min(90, Math.max(0, angle))) / 10 }, "drag polar");
    } else if (e.type === "pointermove") hover.value = { x, y };
    if (e.type === "pointerup") {
      dragging.current = false;
      endGesture();
    }
  };
  return (
    <Canvas
      draw={draw}
      depends={() => {
        answer.value;
        display.value;
        directions.value;
        hover.value;
        answer.value?.shown.forEach(currentColor);
      }}
      register={useRegister()}
      pointer={pointer}
    />
  );
}

function drawGrid(s: Surface, x0: number, y0: number, r: number, whole: boolean, largest: number, log: boolean): void {
  const { context: c, em } = s;
  c.strokeStyle = s.color("--grid");
  c.fillStyle = s.color("--dim");
  c.lineWidth = 1;
  const rings = 4;
  c.textBaseline = "top";
  c.textAlign = "center";
  for (let i = 1; i <= rings; ++i) {
    c.beginPath();
    c.arc(x0, y0, (r * i) / rings, Math.PI, whole ? 3 * Math.PI : 2 * Math.PI);
    c.stroke();
    const value = log ? largest * 10 ** (-logDecades * (1 - i / rings)) : (largest * i) / rings;
    if (!whole && (i % 2 === 0 || r > 9 * em)) c.fillText(tidy(value), x0 + (r * i) / rings, y0 + 0.3 * em);
  }
  for (let angle = whole ? -180 : -90; angle <= (whole ? 179 : 90); angle += 15) {
    const dx = Math.sin(angle * radians);
    const dy = -Math.cos(angle * radians);
    c.globalAlpha = angle % 30 ? 0.45 : 1;
    c.beginPath();
    c.moveTo(x0, y0);
    c.lineTo(x0 + r * dx, y0 + r * dy);
    c.stroke();
    c.globalAlpha = 1;
    if (angle % 30 === 0 && (whole || Math.abs(angle) < 90)) {
      c.textBaseline = "middle";
      c.fillText(`${Math.abs(angle)}°`, x0 + (r + 0.9 * em) * dx, y0 + (r + 0.75 * em) * dy);
    }
  }
  if (whole) c.fillText(`ring: ${tidy(largest)}`, x0 + r * 0.85, y0 + r * 0.98);
}

function drawRay(s: Surface, x0: number, y0: number, r: number): void {
  const { theta_i } = directions.peek();
  const { context: c, em } = s;
  const dx = -Math.sin(theta_i * radians);
  const dy = -Math.cos(theta_i * radians);
  c.strokeStyle = c.fillStyle = s.color("--light");
  c.lineWidth = 1.5;
  c.beginPath();
  c.moveTo(x0, y0);
  c.lineTo(x0 + r * dx, y0 + r * dy);
  c.stroke();
  c.beginPath();
  c.arc(x0 + r * dx, y0 + r * dy, 0.36 * em, 0, 2 * Math.PI);
  c.fill();
  // The mirror direction, thin.
  c.setLineDash([3, 4]);
  c.globalAlpha = 0.5;
  c.beginPath();
  c.moveTo(x0, y0);
  c.lineTo(x0 - r * dx, y0 + r * dy);
  c.stroke();
  c.setLineDash([]);
  c.globalAlpha = 1;
}

function drawReadout(
  s: Surface,
  at: { x: number; y: number },
  x: Float32Array,
  series: { material: Parameters<typeof currentColor>[0]; y: Float32Array }[],
  x0: number,
  y0: number,
  r: number,
  largest: number,
  log: boolean,
): void {
  const { context: c, em } = s;
  const angle = Math.atan2(at.x - x0, y0 - at.y) / radians;
  if (angle < x[0] - 2 || angle > x[x.length - 1] + 2) return;
  let i = 0;
  for (let k = 1; k < x.length; ++k) if (Math.abs(x[k] - angle) < Math.abs(x[i] - angle)) i = k;
  c.textAlign = "left";
  c.textBaseline = "top";
  c.fillStyle = s.color("--dim");
  let y = 0.4 * em;
  c.fillText(`${x[i].toFixed(1)}°`, 0.6 * em, y);
  for (const { material, y: values } of series.slice(0, 8)) {
    y += 1.1 * em;
    const color = currentColor(material);
    c.fillStyle = color;
    c.fillText(tidy(values[i]), 0.6 * em, y);
    const length = r * radius(values[i], largest, log);
    c.beginPath();
    c.arc(x0 + length * Math.sin(x[i] * radians), y0 - length * Math.cos(x[i] * radians), 3, 0, 2 * Math.PI);
    c.fill();
  }
}
