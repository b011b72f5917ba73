// A plot of lines over one x, drawn by uPlot once a frame at most.

import type { Signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import { nextFrame } from "../core/frame";
import { theme } from "../core/store";
import { tidy } from "./scale";

export interface Line {
  label: string;
  color: string;
  y: ArrayLike<number>;
  dashed?: boolean;
}

export interface PlotData {
  x: ArrayLike<number>;
  lines: Line[];
  log?: boolean;
  xLabel: string;
  yLabel?: string;
  /// A vertical line at this x.
  mark?: number | null;
  yMin?: number;
  /// The axis ends here although some values are larger.
  yMax?: number;
}

const cssColor = (name: string) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const fontSize = () => parseFloat(getComputedStyle(document.documentElement).fontSize);

/// uPlot leaves out null, not NaN; a logarithmic axis has no place for zero.
export function plottable(y: ArrayLike<number>, log: boolean): (number | null)[] {
  const result: (number | null)[] = new Array(y.length);
  for (let i = 0; i < y.length; ++i) result[i] = Number.isFinite(y[i]) && (!log || y[i] > 0) ? y[i] : null;
  return result;
}

const decades = 6;
function range(log: boolean, live: Signal<PlotData | null>) {
  return (_: uPlot, lo: number | null, highest: number | null): uPlot.Range.MinMax => {
    if (lo === null || highest === null) return log ? [0.01, 1] : [0, 1];
    const { yMin, yMax } = live.peek() ?? {};
    const hi = yMax !== undefined && yMax > lo ? Math.min(highest, yMax) : highest;
    if (log) {
      const top = Math.ceil(Math.log10(hi) * 4) / 4;
      const bottom = Math.max(Math.floor(Math.log10(lo) * 4) / 4, top - decades);
      return [10 ** Math.min(bottom, top - 1), 10 ** top];
    }
    const low = Math.min(yMin ?? 0, lo);
    return [low, hi > low ? hi + 0.06 * (hi - low) : low + 1];
  };
}

export function Plot(props: { data: Signal<PlotData | null>; register?(canvas: () => HTMLCanvasElement | undefined): void }) {
  const box = useRef<HTMLDivElement>(null);
  const readout = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const element = box.current!;
    const owner = {};
    let plot: uPlot | undefined;
    let made = "";
    props.register?.(() => plot?.ctx.canvas);
    const draw = () => {
      const data = props.data.peek();
      const width = element.clientWidth;
      const height = element.clientHeight;
      if (!data || width < 40 || height < 40) return;
      const log = data.log ?? false;
      const key = `${theme.peek()} ${log} ${fontSize()} ${data.xLabel} ${data.yLabel} ${data.lines.map((l) => l.color + l.dashed + l.label).join()} ${devicePixelRatio}`;
      const values = [Array.from(data.x), ...data.lines.map((l) => plottable(l.y, log))] as uPlot.AlignedData;
      if (plot && key === made) {
        if (plot.width !== width || plot.height !== height) plot.setSize({ width, height });
        plot.setData(values);
        return;
      }
      plot?.destroy();
      plot = new uPlot(options(data, width, height, log, props.data, readout.current!), values, element);
      made = key;
    };
    const request = () => nextFrame(owner, draw);
    const stopData = props.data.subscribe(request);
    const stopTheme = theme.subscribe(request);
    const observer = new ResizeObserver(request);
    observer.observe(element);
    return () => {
      stopData();
      stopTheme();
      observer.disconnect();
      nextFrame(owner, () => {});
      plot?.destroy();
    };
  }, []);
  return (
    <div class="plot" ref={box}>
      <div class="readout" ref={readout} />
    </div>
  );
}

function options(
  data: PlotData,
  width: number,
  height: number,
  log: boolean,
  live: Signal<PlotData | null>,
  readout: HTMLElement,
): uPlot.Options {
  const size = fontSize();
  const font = `${Math.round(0.78 * size)}px ${getComputedStyle(document.body).fontFamily}`;
  const axis: uPlot.Axis = {
    stroke: cssColor("--dim"),
    font,
    labelFont: font,
    labelSize: 1.35 * size,
    grid: { stroke: cssColor("--grid"), width: 1 },
    ticks: { show: false },
  };
  const powers = (_: uPlot, ticks: number[]) =>
    ticks.map((v) => (v === null ? "" : log ? (Math.abs(Math.log10(v) % 1) < 1e-6 ? tidy(v) : "") : tidy(v)));
  return {
    width,
    height,
    legend: { show: false },
    padding: [0.6 * size, 0.8 * size, 0, 0],
    cursor: { drag: { x: false, y: false }, points: { size: 6 }, y: false },
    scales: { x: { time: false }, y: { distr: log ? 3 : 1, range: range(log, live) } },
    series: [
      {},
      ...data.lines.map(
        (line): uPlot.Series => ({
          label: line.label,
          stroke: line.color,
          width: size / 8,
          dash: line.dashed ? [6, 4] : undefined,
          points: { show: false },
          spanGaps: false,
        }),
      ),
    ],
    axes: [
      { ...axis, label: data.xLabel, size: 1.5 * size, gap: 3, space: 3.2 * size, labelGap: -1 },
      { ...axis, label: data.yLabel, size: (_, ticks) => Math.max(2, ...(ticks ?? []).map((t) => t.length)) * 0.5 * size + 0.7 * size, values: powers, gap: 4, space: 2.2 * size, labelGap: 0 },
    ],
    hooks: {
      draw: [
        (u) => {
          const mark = live.peek()?.mark;
          if (mark === null || mark === undefined) return;
          const x = u.valToPos(mark, "x", true);
          if (x < u.bbox.left - 1 || x > u.bbox.left + u.bbox.width + 1) return;
          u.ctx.save();
          u.ctx.strokeStyle = cssColor("--mark");
          u.ctx.setLineDash([4, 4]);
          u.ctx.beginPath();
          u.ctx.moveTo(x, u.bbox.top);
          u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
          u.ctx.stroke();
          u.ctx.restore();
        },
      ],
      setCursor: [
        (u) => {
          const i = u.cursor.idx;
          const shown = live.peek();
          if (i === null || i === undefined || !shown || u.cursor.left! < 0) {
            readout.textContent = "";
            return;
          }
          readout.replaceChildren(
            span(tidy(u.data[0][i]), "var(--dim)"),
            ...shown.lines.slice(0, 8).map((l, s) => span(u.data[s + 1]?.[i] == null ? "–" : tidy(u.data[s + 1][i]!), l.color)),
          );
        },
      ],
    },
  };
}

function span(text: string, color: string): HTMLSpanElement {
  const element = document.createElement("span");
  element.textContent = text;
  element.style.color = color;
  return element;
}
