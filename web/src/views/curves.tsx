// Plots over one angle, and albedo, D and G1.

import { type Signal, useComputed, useSignal, useSignalEffect } from "@preact/signals";
import { channelValue } from "../core/color";
import type { Channel, Material } from "../core/state";
import { directions, display, materials } from "../core/store";
import type { CurveKind, FloatArray } from "../protocol";
import { Plot, type PlotData } from "../ui/plot";
import { guests, onView, plotted, requestFor, useLatest } from "./data";
import { useRegister, ViewFrame } from "./frame";

export interface CurveAnswer {
  shown: Material[];
  x: FloatArray;
  y: FloatArray;
  cosine?: FloatArray;
}

const points = 181;

/// The curves of one kind for all materials on view.
export function useCurves(kind: CurveKind, count = points) {
  const answer = useSignal<CurveAnswer | null>(null);
  const error = useLatest(
    `curves ${kind}`,
    "curves",
    () => {
      const list = onView();
      if (!list.length) {
        answer.value = null;
        return null;
      }
      const { theta_i, phi_i, theta_d, phi_o } = directions.value;
      const uses = dependsOn[kind];
      const body = {
        materials: list.map(requestFor),
        kind,
        theta_i: uses.includes("theta_i") ? theta_i : 0,
        phi_i: uses.includes("phi_i") ? phi_i : 0,
        theta_d: uses.includes("theta_d") ? theta_d : 0,
        phi_o: uses.includes("phi_o") ? (((phi_o - phi_i) % 360) + 360) % 360 : 180,
        points: count,
      };
      return { body, about: list };
    },
    ({ arrays: { x, y, cosine } }, list) => {
      answer.value = { shown: list, x, y, cosine };
    },
  );
  return { answer, error };
}

const dependsOn: Record<CurveKind, string[]> = {
  theta_h: ["theta_d"],
  theta_d: [],
  theta_i: ["theta_i", "phi_i"],
  theta_o: ["theta_i", "phi_i", "phi_o"],
  phi: ["theta_i", "phi_i"],
  polar: ["theta_i", "phi_i"],
  albedo: ["phi_i"],
  D: ["phi_i"],
  G1: ["phi_i"],
};

/// One channel of each material, times the cosine if asked for.
export function channelSeries(answer: CurveAnswer, channel: Channel, cosine: boolean): { material: Material; y: Float32Array }[] {
  const n = answer.x.data.length;
  const factor = cosine ? answer.cosine?.data : undefined;
  return answer.shown.map((material, m) => {
    const y = new Float32Array(n);
    for (let i = 0; i < n; ++i) y[i] = channelValue(answer.y.data, 3 * (m * n + i), channel) * (factor ? factor[i] : 1);
    return { material, y };
  });
}

/// The largest value away from grazing angles, where a division by a vanishing cosine may dwarf all else.
export function topAwayFromGrazing(answer: CurveAnswer, series: { y: Float32Array }[]): number {
  const cosine = answer.cosine?.data;
  let top = 0;
  for (const { y } of series) for (let i = 0; i < y.length; ++i) if (y[i] > top && !(cosine && cosine[i] < 0.02)) top = y[i];
  return top;
}

/// Colours are those the materials have now, not those they had when asked.
export function currentColor(material: Material): string {
  const now = materials.value.find((m) => m.id === material.id) ?? guests.value.find((m) => m.id === material.id);
  return now?.color ?? material.color;
}

interface CurveViewSpec {
  title: string;
  hint: string;
  xLabel: string;
  yLabel: string;
}

export const curveViews: Record<Exclude<CurveKind, "polar">, CurveViewSpec> = {
  theta_h: { title: "θh", hint: "over the half angle, at the θd of the bar above", xLabel: "θh, degrees", yLabel: "f, 1/sr" },
  theta_d: { title: "θd", hint: "over the difference angle, at θh = 0", xLabel: "θd, degrees", yLabel: "f, 1/sr" },
  theta_i: { title: "θi", hint: "over the light's angle; the viewer stays at the θi of the bar, on the mirror's side", xLabel: "θi, degrees", yLabel: "f, 1/sr" },
  theta_o: { title: "θo", hint: "over the viewer's angle, at azimuth φo", xLabel: "θo, degrees", yLabel: "f, 1/sr" },
  phi: { title: "φo", hint: "around the normal, at θo = θi", xLabel: "φo, degrees", yLabel: "f, 1/sr" },
  albedo: { title: "Albedo", hint: "share of light that leaves again", xLabel: "θi, degrees", yLabel: "albedo" },
  D: { title: "D", hint: "distribution of facet normals", xLabel: "θm, degrees", yLabel: "D, 1/sr" },
  G1: { title: "G1", hint: "share of facets that are seen", xLabel: "θ, degrees", yLabel: "G1" },
};

export function CurveView({ kind }: { kind: Exclude<CurveKind, "polar"> }) {
  const spec = curveViews[kind];
  const { answer, error } = useCurves(kind);
  const data = useSignal<PlotData | null>(null);
  useSignalEffect(() => {
    const now = answer.value;
    const { channel, log, cosine } = display.value;
    if (!now) {
      data.value = { x: [0, 90], lines: [], xLabel: spec.xLabel, yLabel: spec.yLabel };
      plotted.set(kind, { x: [], series: [] });
      return;
    }
    const plain = kind === "albedo" || kind === "G1";
    const series = channelSeries(now, kind === "D" || kind === "G1" ? "r" : channel, cosine && !plain);
    plotted.set(kind, { x: now.x.data, series: series.map(({ material, y }) => ({ material: material.id, name: material.name, y })) });
    const unit = cosine && !plain ? spec.yLabel.replace(/, .*/, " cos θ") : spec.yLabel;
    data.value = {
      x: now.x.data,
      lines: series.map(({ material, y }) => ({ label: material.name, color: currentColor(material), y })),
      log: log && !plain,
      xLabel: spec.xLabel,
      yLabel: unit,
      mark: markOf(kind),
      yMax: topAwayFromGrazing(now, series) || undefined,
    };
  });
  const empty = useComputed(() => {
    const lines = data.value?.lines ?? [];
    return lines.length > 0 && lines.every((l) => Array.prototype.every.call(l.y, (v: number) => !Number.isFinite(v)));
  });
  const note = empty.value ? (kind === "D" || kind === "G1" ? "No material on view has facets." : "Nothing measured here.") : "";
  return (
    <ViewFrame id={kind} title={spec.title} hint={spec.hint} error={error.value}>
      <PlotBody data={data} />
      {note && <p class="view-note">{note}</p>}
    </ViewFrame>
  );
}

function PlotBody({ data }: { data: Signal<PlotData | null> }) {
  return <Plot data={data} register={useRegister()} />;
}

/// Where the directions of the bar lie on the x axis.
function markOf(kind: CurveKind): number | null {
  const { theta_i, phi_i, theta_o, phi_o, theta_d } = directions.value;
  switch (kind) {
    case "theta_d":
      return theta_d;
    case "theta_i":
    case "albedo":
      return theta_i;
    case "theta_o":
      return theta_o;
    case "phi":
      return (((phi_o - phi_i) % 360) + 360) % 360;
    default:
      return null;
  }
}
