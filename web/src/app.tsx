// The page: top bar, materials, and the pane that is chosen.

import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { core, dismiss, hello, notices, notify } from "./core/session";
import type { PaneId } from "./core/state";
import { change, look, pane, redo, setTheme, state, theme, undo, undoable, writeAddressNow } from "./core/store";
import { sessionText } from "./core/url";
import { help } from "./keyboard";
import { acceptDrops, takeFiles } from "./materials/drop";
import { MaterialPanel } from "./materials/list";
import { EditPane } from "./panes/edit";
import { FitPane } from "./panes/fit";
import { ObjectPane } from "./panes/object";
import { RenderPane } from "./panes/render";
import { ValidatePane } from "./panes/validate";
import { PhysicsPane } from "./physics/pane";
import { Icon, Popover } from "./ui/controls";
import { Bar } from "./views/bar";
import { download } from "./views/capture";
import { ViewChooser, ViewGrid } from "./views/grid";

export const panes: { id: PaneId; label: string; title: string }[] = [
  { id: "explore", label: "Explore", title: "plots and pictures of the materials" },
  { id: "object", label: "Object", title: "an object under an environment" },
  { id: "render", label: "Render", title: "scenes, path traced" },
  { id: "edit", label: "Edit", title: "write a .brdf" },
  { id: "fit", label: "Fit", title: "fit models to a measurement" },
  { id: "validate", label: "Validate", title: "the laws of reflectance" },
  { id: "physics", label: "Physics", title: "the ideas, to be touched" },
];

export function App() {
  const page = useRef<HTMLDivElement>(null);
  useEffect(() => acceptDrops(page.current!), []);
  return (
    <div class="app" ref={page}>
      <TopBar />
      <MaterialPanel />
      <PanelEdge />
      <main>
        <Pane />
      </main>
      <Notices />
      {help.value && <Help />}
    </div>
  );
}

function Pane() {
  switch (pane.value) {
    case "object":
      return <ObjectPane />;
    case "render":
      return <RenderPane />;
    case "physics":
      return <PhysicsPane />;
    default:
      return (
        <>
          <Bar />
          <div class={`work ${pane.value}`}>
            {pane.value === "edit" && <EditPane />}
            {pane.value === "fit" && <FitPane />}
            {pane.value === "validate" && <ValidatePane />}
            <ViewGrid views={pane.value === "explore" ? undefined : ["lobe3d", "polar", "sphere", pane.value === "validate" ? "albedo" : "theta_h"]} />
          </div>
        </>
      );
  }
}

function TopBar() {
  const status = core.status.value;
  return (
    <header class="top">
      <h1>
        <span class="pearl" />
        Nacre
      </h1>
      <nav aria-label="Panes">
        {panes.map(({ id, label, title }, i) => (
          <button key={id} class={pane.value === id ? "on" : ""} title={`${title} (${i + 1})`} aria-current={pane.value === id} data-testid={`pane-${id}`} onClick={() => look({ pane: id, maximised: null })}>
            {label}
          </button>
        ))}
      </nav>
      <span class="grow" />
      {status !== "open" && (
        <span class={`status ${status}`} role="status">
          {status === "lost" ? "The core does not answer; trying again" : "Connecting"}
        </span>
      )}
      <button class="quiet" title="undo (Ctrl Z)" disabled={!undoable.value.undo} data-testid="undo" onClick={undo}>
        <Icon name="undo" />
      </button>
      <button class="quiet" title="redo (Ctrl Shift Z)" disabled={!undoable.value.redo} data-testid="redo" onClick={redo}>
        <Icon name="redo" />
      </button>
      {pane.value === "explore" && <ViewChooser />}
      <SessionMenu />
      <button class="quiet" title="dark or light (t)" data-testid="theme" onClick={() => setTheme(theme.value === "dark" ? "light" : "dark")}>
        <Icon name={theme.value === "dark" ? "sun" : "moon"} />
      </button>
      <button class="quiet" title="keys (?)" onClick={() => (help.value = true)}>
        <Icon name="help" />
      </button>
    </header>
  );
}

export const saveSession = (): void => download("nacre-session.json", sessionText(state.value));

export async function copyLink(): Promise<void> {
  writeAddressNow();
  try {
    await navigator.clipboard.writeText(location.href);
    notify("The address, with all of the state, is in the clipboard.", "note");
  } catch {
    notify("The address of this page holds all of the state.", "note");
  }
}

function SessionMenu() {
  return (
    <Popover title="save, open, share" button={<><Icon name="link" /> Session</>} align="right" id="session">
      {(close) => (
        <div class="menu">
          <button class="row" onClick={() => (copyLink(), close())}>
            Copy link
          </button>
          <button class="row" data-testid="save-session" onClick={() => (saveSession(), close())}>
            Save as JSON
          </button>
          <label class="row">
            Open…
            <input type="file" accept=".json" hidden data-testid="open-session" onChange={(e) => (takeFiles([...(e.currentTarget.files ?? [])]), close())} />
          </label>
          <button class="row" onClick={() => (change((s) => ({ ...s, materials: [], selected: null, solo: null })), close())}>
            Remove all materials
          </button>
          {hello.value && <small>Nacre {hello.value.version}, folder {hello.value.root}</small>}
        </div>
      )}
    </Popover>
  );
}

/// The edge between the materials and the pane: drag it, or use the arrow keys.
function PanelEdge() {
  const dragging = useSignal(false);
  const put = (px: number) => {
    const width = Math.min(560, Math.max(190, px));
    document.documentElement.style.setProperty("--panel-width", `${width}px`);
    localStorage.setItem("nacre.panel", String(width));
  };
  useEffect(() => {
    const saved = Number(localStorage.getItem("nacre.panel"));
    if (saved) put(saved);
  }, []);
  return (
    <div
      class="edge"
      role="separator"
      aria-orientation="vertical"
      tabIndex={0}
      onPointerDown={(e) => {
        e.currentTarget.setPointerCapture(e.pointerId);
        dragging.value = true;
      }}
      onPointerMove={(e) => dragging.value && put(e.clientX)}
      onPointerUp={() => (dragging.value = false)}
      onKeyDown={(e) => {
        const width = e.currentTarget.offsetLeft;
        if (e.key === "ArrowLeft") put(width - 20);
        if (e.key === "ArrowRight") put(width + 20);
      }}
    />
  );
}

function Notices() {
  return (
    <div class="notices" role="log" aria-live="polite">
      {notices.value.map(({ key, text, kind }) => (
        <p key={key} class={kind} onClick={() => dismiss(key)}>
          {text}
        </p>
      ))}
    </div>
  );
}

const keys: [string, string][] = [
  ["1 … 7", "panes"],
  ["↑ ↓", "select a material"],
  ["a", "add a material"],
  ["d, Delete", "duplicate, remove it"],
  ["s, v", "solo, visible"],
  ["F2", "rename it"],
  ["y r g b", "luminance, red, green, blue"],
  ["l, c", "logarithm, times cosine"],
  ["[ ]", "exposure"],
  ["Shift ← → ↑ ↓", "move the light"],
  ["m, Esc", "maximise the view under the pointer, and back"],
  ["i", "save that view as an image"],
  ["t", "dark or light"],
  ["Ctrl Z, Ctrl Shift Z", "undo, redo"],
  ["Ctrl S", "save the session"],
];

function Help() {
  return (
    <div class="overlay" onClick={() => (help.value = false)}>
      <dl class="keys">
        {keys.map(([key, meaning]) => (
          <>
            <dt>{key}</dt>
            <dd>{meaning}</dd>
          </>
        ))}
      </dl>
    </div>
  );
}
