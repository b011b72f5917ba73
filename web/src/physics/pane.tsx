// A page for each idea: its handles, its drawing, its curves from the core, its formula and source.

import { useSignal, useSignalEffect } from "@preact/signals";
import { palette } from "../core/state";
import { selected, set, state } from "../core/store";
import type { Answer } from "../protocol";
import { Select } from "../ui/controls";
import { Canvas } from "../ui/canvas";
import { Plot, type PlotData } from "../ui/plot";
import { tidy } from "../ui/scale";
import { Slider } from "../ui/slider";
import { plotted, requestFor, useLatest } from "../views/data";
import { ViewFrame, useRegister } from "../views/frame";
import { type Topic, topics } from "./topics";

export function PhysicsPane() {
  const id = state.value.physics.topic;
  const topic = topics.find((t) => t.id === id) ?? topics[0];
  return (
    <div class="physics">
      <nav aria-label="Ideas">
        {topics.map((t) => (
          <button key={t.id} class={t.id === topic.id ? "on" : ""} data-testid={`topic-${t.id}`} onClick={() => set("physics", { topic: t.id }, "topic")}>
            {t.title}
          </button>
        ))}
      </nav>
      <Page key={topic.id} topic={topic} />
    </div>
  );
}

function valuesOf(topic: Topic): Record<string, number | string> {
  const own = state.value.physics.values[topic.id] ?? {};
  return Object.fromEntries([
    ...topic.handles.map((h) => [h.name, own[h.name] ?? h.initial]),
    ...(topic.choices ?? []).map((c) => [c.name, own[c.name] ?? c.initial]),
  ]);
}

function put(topic: Topic, name: string, value: number | string, gesture?: string): void {
  const all = state.peek().physics.values;
  set("physics", { values: { ...all, [topic.id]: { ...all[topic.id], [name]: value } } }, gesture);
}

function Page({ topic }: { topic: Topic }) {
  const answer = useSignal<Answer<"physics"> | null>(null);
  const plot = useSignal<PlotData | null>(null);
  const error = useLatest(
    `physics ${topic.id}`,
    "physics",
    () => {
      const material = selected.value;
      if (topic.usesMaterial && !material) return null;
      const extra = topic.usesMaterial ? { material: requestFor(material!), size: 256 } : {};
      return { body: { topic: topic.id, ...valuesOf(topic), ...extra }, about: null };
    },
    (got) => {
      answer.value = got;
    },
  );
  useSignalEffect(() => {
    const got = answer.value;
    const values = valuesOf(topic);
    if (!got?.arrays.x || !got.arrays.y) return;
    const x = got.arrays.x.data;
    const series = got.arrays.y.shape[0];
    const line = (s: number) => got.arrays.y.data.subarray(s * x.length, (s + 1) * x.length);
    const names = got.series ?? [];
    plotted.set(`physics ${topic.id}`, { x, series: Array.from({ length: series }, (_, s) => ({ material: s, name: names[s] ?? "", y: line(s) })) });
    plot.value = {
      x,
      lines: Array.from({ length: series }, (_, s) => ({ label: names[s] ?? "", color: colorOf(names, s), y: line(s) })),
      log: topic.log,
      xLabel: got.x_label ?? "",
      yLabel: got.y_label ?? "",
      mark: topic.mark ? Number(values[topic.mark]) : null,
    };
  });
  const values = valuesOf(topic);
  return (
    <article class="idea">
      <div class="words">
        <h2>{topic.title}</h2>
        <p>{topic.text}</p>
        <div class="formula" dangerouslySetInnerHTML={{ __html: topic.formula }} />
        <Handles topic={topic} values={values} metals={answer.value?.metals ?? []} />
        <Numbers values={answer.value?.values ?? {}} />
        {topic.usesMaterial && <p class="hint">Material: {selected.value?.name ?? "select one"}</p>}
        <p class="source">{topic.source}</p>
      </div>
      <ViewFrame id={`drawing-${topic.id}`} title="Drawing" canMaximise={false} error={error.value}>
        <Drawing topic={topic} answer={answer} />
      </ViewFrame>
      <ViewFrame id={`curves-${topic.id}`} title="Curves" canMaximise={false} options={<Legend names={answer.value?.series ?? []} />}>
        <Curves plot={plot} />
      </ViewFrame>
    </article>
  );
}

const Curves = ({ plot }: { plot: { value: PlotData | null } }) => <Plot data={plot as never} register={useRegister()} />;

/// Channels have their own colour, other curves the next one.
const channels: Record<string, string> = { R: palette[3], G: palette[2], B: palette[1] };
const colorOf = (names: string[], s: number) => (names.join() === "R,G,B" ? channels[names[s]] : palette[s % palette.length]);

function Legend({ names }: { names: string[] }) {
  return (
    <>
      {names.map((name, s) => (
        <span key={name} class="legend" style={{ color: colorOf(names, s) }}>
          {name}
        </span>
      ))}
    </>
  );
}

function Drawing({ topic, answer }: { topic: Topic; answer: { value: Answer<"physics"> | null; peek(): Answer<"physics"> | null } }) {
  return (
    <Canvas
      register={useRegister()}
      depends={() => {
        answer.value;
        valuesOf(topic);
      }}
      draw={(s) => {
        const all = valuesOf(topic);
        const handles = Object.fromEntries(Object.entries(all).filter(([, v]) => typeof v === "number")) as Record<string, number>;
        topic.diagram(s, { handles, values: answer.peek()?.values ?? {}, arrays: answer.peek()?.arrays ?? {}, metal: String(all.metal ?? "") });
      }}
    />
  );
}

function Handles(props: { topic: Topic; values: Record<string, number | string>; metals: string[] }) {
  const { topic, values } = props;
  if (!topic.handles.length && !topic.choices?.length) return null;
  return (
    <div class="handles">
      {(topic.choices ?? []).map((c) => (
        <div class="labelled" key={c.name}>
          <span>{c.name}</span>
          <Select label={c.name} value={String(values[c.name])} empty={c.options === "metals" && c.initial === "" ? "none: a dielectric" : undefined} choices={(c.options === "metals" ? props.metals : c.options).map((value) => ({ value }))} change={(v) => put(topic, c.name, v)} />
        </div>
      ))}
      {topic.handles
        .filter((h) => !(h.name === "eta" && values.metal))
        .map((h) => (
          <Slider key={h.name} id={`physics-${h.name}`} label={h.label} value={Number(values[h.name])} lo={h.lo} hi={h.hi} unit={h.unit} initial={h.initial} change={(v, g) => put(topic, h.name, v, g)} />
        ))}
    </div>
  );
}

function Numbers({ values }: { values: Record<string, number | null> }) {
  // Red, green and blue first and in this order; JSON keeps none.
  const rank = (name: string) => ["r", "g", "b"].indexOf(name) + 1 || 4;
  return (
    <dl class="facts">
      {Object.entries(values).sort(([a], [b]) => rank(a) - rank(b)).map(([name, v]) => (
        <>
          <dt>{name.replace(/_/g, " ")}</dt>
          <dd>{v === null ? "none" : tidy(v)}</dd>
        </>
      ))}
    </dl>
  );
}
