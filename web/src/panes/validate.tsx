// The laws, measured: verdicts, maps over both angles, and the way from a violation to all views.

import { signal } from "@preact/signals";
import { ConnectionLost, type Task } from "../connection";
import { complain, core, notify } from "../core/session";
import type { State } from "../core/state";
import { directions, selected, set, state } from "../core/store";
import type { Answer, Law } from "../protocol";
import { Icon, Progress, Segments } from "../ui/controls";
import { Slider } from "../ui/slider";
import { tidy } from "../ui/scale";
import { requestFor } from "../views/data";
import { HeatMap } from "./heat_map";

interface Report {
  name: string;
  answer: Answer<"validate"> | null;
  progress: number;
  task: Task<"validate"> | null;
}

const reports = signal(new Map<number, Report>());
const put = (id: number, report: Report) => (reports.value = new Map(reports.value).set(id, report));

/// The maps come before the verdicts.
const gathered = (before: Answer<"validate"> | null | undefined, now: Answer<"validate">): Answer<"validate"> => ({
  ...now,
  laws: now.laws ?? before?.laws ?? [],
  arrays: { ...before?.arrays, ...now.arrays },
});

async function start(): Promise<void> {
  const material = selected.value;
  if (!material) return;
  const { id, name } = material;
  const task = core.begin("validate", { material: requestFor(material), samples: state.value.validate.samples }, (m) =>
    put(id, { ...reports.value.get(id)!, progress: m.progress ?? 0, answer: gathered(reports.value.get(id)?.answer, m) }),
  );
  put(id, { name, answer: null, progress: 0, task });
  try {
    put(id, { name, answer: gathered(reports.value.get(id)?.answer, await task.answer), progress: 1, task: null });
  } catch (error) {
    put(id, { name, answer: null, progress: 0, task: null });
    if (!(error instanceof ConnectionLost)) complain(error);
  }
}

const edit = (part: Partial<State["validate"]>, gesture?: string) => set("validate", part, gesture);

export function ValidatePane() {
  const material = selected.value;
  const report = material ? reports.value.get(material.id) : undefined;
  const { samples, map } = state.value.validate;
  const answer = report?.answer;
  const field = answer?.arrays[map];
  return (
    <section class="pane validate">
      <header>
        <h2>{material ? `Laws of ${material.name}` : "Validate"}</h2>
        <Slider id="validate-samples" label="samples" value={samples} lo={1000} hi={1e6} whole initial={4096} change={(v, g) => edit({ samples: v }, g)} />
        {report?.task ? (
          <button data-testid="validate-stop" onClick={() => report.task?.cancel()}>Stop</button>
        ) : (
          <button class="primary" disabled={!material} data-testid="validate-start" onClick={start}>
            Validate
          </button>
        )}
      </header>
      {report?.task && <Progress value={report.progress || undefined} />}
      <div class="scroll">
        {!answer && !report?.task && <p class="hint">Measures reciprocity, energy, sampling and the other laws of the selected material.</p>}
        {answer && (
          <>
            {answer.laws.length > 0 && <Laws laws={answer.laws} />}
            {field && (
              <>
                <Segments
                  label="map"
                  value={map}
                  choices={[
                    { value: "reciprocity_map", label: "Reciprocity" },
                    { value: "energy_map", label: "Energy" },
                  ]}
                  change={(value) => edit({ map: value })}
                />
                <HeatMap field={field} marks={directions.value} pick={(theta_i, theta_o) => set("directions", { theta_i, theta_o })} />
              </>
            )}
          </>
        )}
      </div>
    </section>
  );
}

const violated = (law: Law) => /violat|fail/i.test(law.verdict);

/// Sends every view to the directions of a law's worst case.
function go(law: Law): void {
  const where = law.where;
  if (!where) return;
  const known = Object.fromEntries(Object.entries(where).filter(([, v]) => typeof v === "number")) as Partial<State["directions"]>;
  // A law of one direction is about what leaves along it; every view has the light in that place.
  if (known.theta_o !== undefined && known.theta_i === undefined) known.theta_i = known.theta_o;
  set("directions", known);
}

function Laws({ laws }: { laws: Law[] }) {
  const sorted = [...laws].sort((a, b) => Number(violated(b)) - Number(violated(a)));
  return (
    <table class="laws" data-testid="laws">
      <thead>
        <tr>
          <th>law</th>
          <th>verdict</th>
          <th>worst</th>
          <th>tolerance</th>
          <th>where</th>
          <th />
        </tr>
      </thead>
      <tbody>
        {sorted.map((law) => (
          <tr key={law.name} class={`${violated(law) ? "violated" : ""} ${law.where ? "goes" : ""}`} onClick={() => go(law)} title={law.where ? "show these directions in every view" : undefined}>
            <td>{law.name}</td>
            <td class={violated(law) ? "bad" : /holds/.test(law.verdict) ? "good" : ""}>{law.verdict}</td>
            <td>{law.worst === null ? "" : tidy(law.worst)}</td>
            <td>{law.tolerance === null ? "" : tidy(law.tolerance)}</td>
            <td>{whereText(law)}</td>
            <td>
              {law.command && (
                <button
                  class="quiet"
                  title={`copy: ${law.command}`}
                  onClick={(e) => {
                    e.stopPropagation();
                    navigator.clipboard?.writeText(law.command!).then(() => notify("command copied", "note"));
                  }}
                >
                  <Icon name="copy" />
                </button>
              )}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

const symbols: Record<string, string> = { theta_i: "θi", phi_i: "φi", theta_o: "θo", phi_o: "φo" };
const whereText = ({ where }: Law) =>
  Object.entries(where ?? {})
    .filter(([key, v]) => symbols[key] && typeof v === "number")
    .map(([key, v]) => `${symbols[key]} ${tidy(v as number)}`)
    .join("  ");
