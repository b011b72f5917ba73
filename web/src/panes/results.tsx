// The table of fits: sorted by any error, shown, kept, exported.

import { useSignal } from "@preact/signals";
import { complain, core, hello, notify } from "../core/session";
import { state } from "../core/store";
import { type ExportFormat, type FitResult, choiceName } from "../protocol";
import { Icon, Popover } from "../ui/controls";
import { tidy } from "../ui/scale";
import { download } from "../views/capture";
import { choose, chosen, keep } from "./fit";

export function Results({ results: all }: { results: FitResult[] }) {
  const failed = all.filter((r) => r.failed);
  const results = all.filter((r) => !r.failed);
  const metrics = Object.keys(results[0]?.errors ?? {});
  const wanted = state.value.fit.metric || choiceName(hello.value?.metrics[0] ?? "");
  const by = useSignal({ column: metrics.includes(wanted) ? wanted : "model", up: true });
  const value = (r: FitResult, column: string): number | string =>
    column === "model" ? r.model : column === "parameters" ? r.parameters.length : column === "s" ? r.seconds : r.errors[column];
  const sorted = [...results].sort((a, b) => {
    const x = value(a, by.value.column);
    const y = value(b, by.value.column);
    return (x < y ? -1 : x > y ? 1 : 0) * (by.value.up ? 1 : -1);
  });
  const least = Object.fromEntries(metrics.map((m) => [m, Math.min(...results.map((r) => r.errors[m]))]));
  const columns = ["model", "parameters", ...metrics, "s"];
  return (
    <>
      <table class="sortable" data-testid="fit-results">
        <thead>
          <tr>
            {columns.map((c) => (
              <th key={c} aria-sort={by.value.column === c ? (by.value.up ? "ascending" : "descending") : "none"}>
                <button class="quiet" onClick={() => (by.value = { column: c, up: by.value.column === c ? !by.value.up : true })}>
                  {c}
                  {by.value.column === c ? (by.value.up ? " ↑" : " ↓") : ""}
                </button>
              </th>
            ))}
            <th />
          </tr>
        </thead>
        <tbody>
          {sorted.map((r) => (
            <tr key={r.model} class={chosen.value === r ? "selected" : ""} onClick={() => choose(r)}>
              <td>{r.model}</td>
              <td>{r.parameters.length}</td>
              {metrics.map((m) => (
                <td key={m} class={r.errors[m] === least[m] ? "best" : ""}>
                  {tidy(r.errors[m])}
                </td>
              ))}
              <td>{r.seconds.toFixed(1)}</td>
              <td class="actions">
                <button class="quiet" title="add to the materials" onClick={(e) => (e.stopPropagation(), keep(r))}>
                  <Icon name="plus" />
                </button>
                <Export result={r} />
              </td>
            </tr>
          ))}
          {failed.map((r) => (
            <tr key={r.model}>
              <td>{r.model}</td>
              <td class="warn" colSpan={columns.length}>
                {r.failed}
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      {chosen.value && <ParameterTable result={chosen.value} />}
    </>
  );
}

function Export({ result }: { result: FitResult }) {
  const formats = hello.value?.formats ?? [];
  const save = async ({ name, ending }: ExportFormat) => {
    try {
      const { text, remark } = await core.ask("export", { material: result.material, format: name });
      download(`${result.model.replace(/\W+/g, "_")}${ending}`, text);
      if (remark) notify(`${name}: ${remark}`, "note");
    } catch (error) {
      complain(error);
    }
  };
  return (
    <Popover title="export" id={`export-of-${result.model}`} button={<Icon name="save" />} align="right">
      {(close) => (
        <div class="menu">
          {formats.map((f) => (
            <button key={f.name} class="row" data-testid={`export-${f.name}`} onClick={() => (save(f), close())}>
              <b>{f.ending}</b>
              <small>{f.summary}</small>
            </button>
          ))}
        </div>
      )}
    </Popover>
  );
}

function ParameterTable({ result }: { result: FitResult }) {
  return (
    <table class="parameters-table">
      <tbody>
        {result.parameters.map((p, i) => (
          <tr key={i}>
            <td>{p.lobe ? `${p.lobe}.${p.name}` : p.name}</td>
            <td>{typeof p.value === "number" ? tidy(p.value) : p.value.map(tidy).join(" / ")}</td>
            <td>{p.error === null ? "" : `± ${tidy(p.error)}`}</td>
            <td class="warn">{p.at_bound ? "at its bound" : ""}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
