// Fitting models to a measurement, with the views following the best so far.

import { signal, useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import type { Task } from "../connection";
import { complain, core, hello, models, notify, resolve } from "../core/session";
import { type Material, type State, addMaterial, palette } from "../core/state";
import { change, set, state } from "../core/store";
import { FileList } from "../materials/add";
import { type FitResult, choiceName } from "../protocol";
import { Labelled, Popover, Progress, Select, Toggle } from "../ui/controls";
import { Plot, type PlotData } from "../ui/plot";
import { Slider } from "../ui/slider";
import { guests, plotted } from "../views/data";
import { Difference } from "./difference";
import { Results } from "./results";

interface Run {
  measured: string;
  progress: number;
  model: string;
  iteration: number;
  task: Task<"fit"> | null;
  results: FitResult[];
}

const run = signal<Run | null>(null);
export const chosen = signal<FitResult | null>(null);
const convergence = signal<PlotData | null>(null);

const edit = (part: Partial<State["fit"]>, gesture?: string) => set("fit", part, gesture);

const measuredGuest = (file: string): Material => ({ id: -1, name: file.replace(/^.*\//, ""), color: palette[1], visible: true, source: { file } });
const fitGuest = (name: string, material: FitResult["material"]): Material => ({
  id: -2,
  name,
  color: palette[0],
  visible: true,
  source: "lobes" in material && material.lobes ? { lobes: material.lobes } : { lobes: [] },
});

function show(file: string, name?: string, material?: FitResult["material"]): void {
  guests.value = material?.lobes ? [measuredGuest(file), fitGuest(name ?? "fit", material)] : [measuredGuest(file)];
}

export function choose(result: FitResult): void {
  chosen.value = result;
  if (run.value) show(run.value.measured, result.model, result.material);
}

export function keep(result: FitResult): void {
  const { lobes } = result.material;
  // Of a .brdf the core says what sliders it has.
  if (lobes?.every((l) => models.value.has(l.model))) change((s) => addMaterial(s, `${result.model} fit`, { lobes }));
  else resolve(result.material).then(({ source }) => change((s) => addMaterial(s, `${result.model} fit`, source)), complain);
}

async function start(): Promise<void> {
  const { measured, models, starts } = state.value.fit;
  const metric = state.value.fit.metric || choiceName(hello.value?.metrics[0] ?? "");
  if (!measured || !models.length) return;
  const steps: number[] = [];
  const errors: number[] = [];
  let shownModel: string | undefined;
  const now: Run = { measured, progress: 0, model: models[0], iteration: 0, task: null, results: [] };
  chosen.value = null;
  convergence.value = null;
  show(measured);
  const task = core.begin("fit", { measured, models, metric, starts }, (m) => {
    run.value = {
      ...run.value!,
      progress: m.progress ?? 0,
      model: m.model ?? run.value!.model,
      iteration: m.iteration ?? run.value!.iteration,
      results: m.results ?? run.value!.results,
    };
    if (m.best_error !== undefined) {
      // Each model begins anew.
      if (m.model !== shownModel || (m.iteration ?? 0) <= (steps.at(-1) ?? -1)) steps.length = errors.length = 0;
      shownModel = m.model;
      steps.push(m.iteration ?? steps.length);
      errors.push(m.best_error);
      convergence.value = { x: steps.slice(), lines: [{ label: m.model ?? "error", color: palette[0], y: errors.slice() }], log: true, xLabel: "steps", yLabel: `${metric} error` };
      plotted.set("convergence", { x: steps.slice(), series: [{ material: -2, name: m.model ?? "", y: errors.slice() }] });
    }
    if (m.material) show(measured, m.model, m.material);
  });
  run.value = { ...now, task };
  try {
    const answer = await task.answer;
    run.value = { ...run.value!, progress: 1, task: null, results: answer.results ?? [] };
    const best = answer.results?.find((r) => !r.failed);
    if (best) choose(best);
    if (answer.cancelled) notify("The fit was stopped.", "note");
  } catch (error) {
    run.value = { ...run.value!, task: null };
    complain(error);
  }
}

export function FitPane() {
  useEffect(() => {
    if (run.value) show(run.value.measured, chosen.value?.model, chosen.value?.material);
    return () => {
      guests.value = [];
    };
  }, []);
  const f = state.value.fit;
  const now = run.value;
  const running = now?.task;
  const metrics = hello.value?.metrics ?? [];
  const ready = f.measured !== "" && f.models.length > 0;
  return (
    <section class="pane fit">
      <header>
        <h2>Fit</h2>
        {running ? (
          <button data-testid="fit-stop" onClick={() => running.cancel()}>
            Stop
          </button>
        ) : (
          <button class="primary" disabled={!ready} data-testid="fit-start" onClick={start}>
            Fit
          </button>
        )}
      </header>
      <div class="scroll">
        <div class="form">
          <Labelled label="measured">
            <Popover title="a measured file of the folder, or a .brdf" button={f.measured || "choose a file…"} id="choose-measured">
              {(close) => <FileList kinds={["measured", "brdf"]} pick={(measured) => (edit({ measured }), show(measured), close())} />}
            </Popover>
          </Labelled>
          <Labelled label="metric">
            <Select label="metric" value={f.metric || choiceName(metrics[0] ?? "")} choices={metrics.map((m) => ({ value: choiceName(m), title: typeof m === "string" ? undefined : m.summary }))} change={(metric) => edit({ metric })} />
          </Labelled>
          <Slider label="starts" value={f.starts} lo={1} hi={64} whole title="starting points of each model" initial={8} change={(starts, g) => edit({ starts }, g)} />
        </div>
        <Models />
        {running && (
          <div class="running">
            <Progress value={now.progress} />
            <small>{`${now.model}, iteration ${now.iteration}`}</small>
          </div>
        )}
        {now && convergence.value && (
          <div class="convergence">
            <Plot data={convergence} />
          </div>
        )}
        {now && now.results.length > 0 && <Results results={now.results} />}
        {now && chosen.value?.material.lobes && <Difference measured={now.measured} fit={chosen.value.material} />}
      </div>
    </section>
  );
}

function Models() {
  const query = useSignal("");
  const chosenModels = state.value.fit.models;
  const all = (hello.value?.models ?? []).map((m) => m.name);
  const combined = chosenModels.filter((m) => !all.includes(m));
  const found = [...combined, ...all].filter((m) => m.includes(query.value) || chosenModels.includes(m));
  const toggle = (name: string, on: boolean) => edit({ models: on ? [...chosenModels, name] : chosenModels.filter((m) => m !== name) });
  const enter = () => {
    const text = query.value.trim();
    if (text && !chosenModels.includes(text)) toggle(text, true);
    query.value = "";
  };
  return (
    <div class="model-choice">
      <input
        placeholder="models: filter, or type a sum such as ggx_schlick+lambert and press Enter"
        value={query.value}
        onInput={(e) => (query.value = e.currentTarget.value)}
        onKeyDown={(e) => e.key === "Enter" && enter()}
      />
      <div class="chips">
        <Popover title="a .brdf of the folder as a model" button=".brdf…" id="fit-brdf">
          {(close) => <FileList kinds={["brdf"]} pick={(file) => (toggle(file, true), close())} />}
        </Popover>
        {found.map((m) => (
          <Toggle key={m} on={chosenModels.includes(m)} label={m} id={`fit-model-${m}`} change={(on) => toggle(m, on)} />
        ))}
      </div>
    </div>
  );
}
