// The materials: colour, name, visible, solo, duplicate, remove, drag onto a scene.

import { materials, change, look, selectedId, solo } from "../core/store";
import { type Material, duplicateMaterial, editMaterial, removeMaterial } from "../core/state";
import { EditableText, Icon } from "../ui/controls";
import { AddMaterial } from "./add";
import { Parameters } from "./parameters";

export const dragType = "application/x-nacre-material";

export function MaterialPanel() {
  return (
    <aside class="materials" aria-label="Materials">
      <header class="panel-title">
        <h2>Materials</h2>
        <AddMaterial />
      </header>
      <ul class="material-list" role="listbox" aria-label="Materials">
        {materials.value.map((m) => (
          <Row key={m.id} material={m} />
        ))}
      </ul>
      <div class="parameters">
        <Parameters />
      </div>
    </aside>
  );
}

const kindOf = (m: Material) => ("file" in m.source ? "measured" : "brdf" in m.source ? ".brdf" : "");

function Row({ material: m }: { material: Material }) {
  const isSolo = solo.value === m.id;
  const dimmed = solo.value !== null ? !isSolo : !m.visible;
  const classes = `material${selectedId.value === m.id ? " selected" : ""}${dimmed ? " dimmed" : ""}`;
  const edit = (change_: (m: Material) => Material, gesture?: string) => change((s) => editMaterial(s, m.id, change_), gesture);
  return (
    <li
      class={classes}
      role="option"
      aria-selected={selectedId.value === m.id}
      data-testid={`material-${m.id}`}
      draggable
      onDragStart={(e) => {
        e.dataTransfer?.setData(dragType, String(m.id));
        e.dataTransfer!.effectAllowed = "copy";
      }}
      onPointerDown={() => look({ selected: m.id })}
    >
      <input
        type="color"
        aria-label={`colour of ${m.name}`}
        title="colour of its curves"
        value={m.color}
        onInput={(e) => edit((x) => ({ ...x, color: e.currentTarget.value }), `colour ${m.id}`)}
      />
      <EditableText value={m.name} title={`${m.name}\ndouble click to rename`} change={(name) => edit((x) => ({ ...x, name }))} />
      <small>{kindOf(m)}</small>
      <span class="tools">
        <button class="quiet" title="duplicate (d)" aria-label={`duplicate ${m.name}`} onClick={() => change((s) => duplicateMaterial(s, m.id))}>
          <Icon name="copy" />
        </button>
        <button class="quiet" title="remove (Delete)" aria-label={`remove ${m.name}`} onClick={() => change((s) => removeMaterial(s, m.id))}>
          <Icon name="close" />
        </button>
      </span>
      <button class={`quiet solo${isSolo ? " on" : ""}`} title="solo (s)" aria-pressed={isSolo} aria-label={`solo ${m.name}`} onClick={() => change((s) => ({ ...s, solo: isSolo ? null : m.id }))}>
        S
      </button>
      <button class="quiet" title="visible (v)" aria-pressed={m.visible} aria-label={`show ${m.name}`} onClick={() => edit((x) => ({ ...x, visible: !x.visible }))}>
        <Icon name={m.visible ? "eye" : "hidden"} />
      </button>
    </li>
  );
}
