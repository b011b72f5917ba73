// The editor of .brdf files: compiled as one types, the material follows.

import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { HighlightStyle, StreamLanguage, bracketMatching, indentOnInput, syntaxHighlighting } from "@codemirror/language";
import { shader } from "@codemirror/legacy-modes/mode/clike";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { EditorState } from "@codemirror/state";
import { EditorView, drawSelection, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import { ConnectionLost } from "../connection";
import { add, brdfParameters, complain, core, notify } from "../core/session";
import { type Material, addMaterial, editMaterial, freshName } from "../core/state";
import { change, materials, selected } from "../core/store";
import { FileList } from "../materials/add";
import { Popover } from "../ui/controls";
import { download } from "../views/capture";

const template = `analytic

# A lobe around the half vector, over a diffuse base.

::begin parameters
color base 0.25 0.12 0.08
float exponent 1 500 60
float strength 0 2 0.4
bool normalised 1
::end parameters

::begin shader
const float PI = 3.14159265358979323846;

vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)
{
    vec3 H = normalize(L + V);
    float lobe = pow(max(0.0, dot(N, H)), exponent);
    if (normalised)
        lobe *= (exponent + 2.0) / (2.0 * PI);
    return base / PI + vec3(strength * lobe);
}
::end shader
`;

/// Typing pauses this long before the core is asked: less than a frame would gain nothing.
const pause = 30;

const colors = HighlightStyle.define([
  { tag: [tags.comment, tags.meta], color: "var(--dim)", fontStyle: "italic" },
  { tag: [tags.keyword, tags.controlKeyword], color: "var(--accent)" },
  { tag: [tags.typeName, tags.standard(tags.name)], color: "var(--blue)" },
  { tag: [tags.number, tags.bool, tags.atom], color: "var(--green)" },
  { tag: tags.string, color: "var(--red)" },
]);

export function EditPane() {
  const material = selected.value;
  return (
    <section class="pane editor">
      <header>
        <h2>{material && "brdf" in material.source ? material.source.brdf.name : "Edit"}</h2>
        <button data-testid="new-brdf" onClick={newFile}>
          New
        </button>
        <Popover title="a .brdf of the folder" button="Open…" align="right">
          {(close) => <FileList kinds={["brdf"]} pick={(file) => (add({ file }), close())} />}
        </Popover>
        {material && "brdf" in material.source && (
          <>
            <button onClick={() => saveInFolder(material)} title="write it below the folder the core serves">
              Save
            </button>
            <button onClick={() => "brdf" in material.source && download(material.source.brdf.name, material.source.brdf.source)}>Download</button>
          </>
        )}
      </header>
      {material && "brdf" in material.source ? (
        <Editor key={material.id} material={material} />
      ) : (
        <div class="invite">
          <p>A .brdf is a few parameters and a function of light and viewer in GLSL. Begin a new one, or select one in the list.</p>
          <button class="primary" onClick={newFile}>
            New .brdf
          </button>
        </div>
      )}
    </section>
  );
}

function newFile(): void {
  const taken = materials.value.map((m) => ({ name: m.name.replace(/\.brdf$/, "") }));
  add({ brdf: { name: `${freshName(taken, "mine")}.brdf`, source: template } });
}

async function saveInFolder(material: Material): Promise<void> {
  if (!("brdf" in material.source)) return;
  const { name, source } = material.source.brdf;
  await core.ask("write", { file: name, text: source }).then(() => notify(`${name} saved`, "note"), complain);
}

function Editor({ material }: { material: Material }) {
  const box = useRef<HTMLDivElement>(null);
  const verdict = useSignal<{ ok: boolean; text: string }>({ ok: true, text: "" });
  useEffect(() => {
    if (!("brdf" in material.source)) return;
    const { id } = material;
    const { name } = material.source.brdf;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const view = new EditorView({
      parent: box.current!,
      state: EditorState.create({
        doc: material.source.brdf.source,
        extensions: [
          lineNumbers(),
          history(),
          drawSelection(),
          highlightActiveLine(),
          highlightActiveLineGutter(),
          indentOnInput(),
          bracketMatching(),
          highlightSelectionMatches(),
          lintGutter(),
          StreamLanguage.define(shader),
          syntaxHighlighting(colors),
          keymap.of([indentWithTab, ...defaultKeymap, ...historyKeymap, ...searchKeymap]),
          EditorView.updateListener.of((update) => {
            if (!update.docChanged) return;
            clearTimeout(timer);
            timer = setTimeout(() => compile(view, id, name, (v) => (verdict.value = v)), pause);
          }),
        ],
      }),
    });
    Object.assign(box.current!, { editor: view });
    compile(view, id, name, (v) => (verdict.value = v));
    return () => {
      clearTimeout(timer);
      view.destroy();
    };
  }, []);
  return (
    <>
      <div class="code" ref={box} data-testid="code" />
      <p class={`verdict ${verdict.value.ok ? "ok" : "bad"}`} role="status" data-testid="verdict">
        {verdict.value.text}
      </p>
    </>
  );
}

type Verdict = (verdict: { ok: boolean; text: string }) => void;

async function compile(view: EditorView, id: number, name: string, tell: Verdict): Promise<void> {
  const source = view.state.doc.toString();
  const brdf = { name, source };
  const begun = performance.now();
  try {
    const answer = await core.latest(`compile ${id}`, "compile", { brdf });
    if (!answer) return;
    const errors = answer.errors ?? [];
    view.dispatch(setDiagnostics(view.state, errors.map((e) => diagnostic(view.state, e))));
    if (errors.length) return tell({ ok: false, text: errors.map((e) => `${e.line}: ${plain(e.message)}`).join("\n") });
    brdfParameters.value = new Map([...[...brdfParameters.value].slice(-20), [source, answer.parameters ?? []]]);
    change((s) => {
      const known = s.materials.find((m) => m.id === id);
      if (!known) return addMaterial(s, name, { brdf, values: {} });
      if ("brdf" in known.source && known.source.brdf.source === source) return s;
      return editMaterial(s, id, (m) => ("brdf" in m.source ? { ...m, source: { ...m.source, brdf } } : m));
    }, `edit ${id}`);
    tell({ ok: true, text: `compiled in ${Math.round(performance.now() - begun)} ms` });
  } catch (error) {
    if (!(error instanceof ConnectionLost)) tell({ ok: false, text: (error as Error).message });
  }
}

/// A message without the place it begins with: the place is shown beside it.
const plain = (message: string): string => message.replace(/^\S+:\d+(:\d+)?: /, "");

function diagnostic(state: EditorState, e: { line: number; column: number; message: string }): Diagnostic {
  const line = state.doc.line(Math.min(state.doc.lines, Math.max(1, e.line || 1)));
  const from = e.column > 0 ? Math.min(line.to, line.from + e.column - 1) : line.from;
  return { from, to: Math.max(line.to, from), severity: "error", message: plain(e.message) };
}
