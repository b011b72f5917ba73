// Small controls: buttons, choices, toggles, text that is edited in place.

import type { ComponentChildren, JSX } from "preact";
import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";

export function Toggle(props: { on: boolean; label: ComponentChildren; title?: string; id?: string; change(on: boolean): void }) {
  return (
    <button
      class={`toggle${props.on ? " on" : ""}`}
      title={props.title}
      aria-pressed={props.on}
      data-testid={props.id}
      onClick={() => props.change(!props.on)}
    >
      {props.label}
    </button>
  );
}

export function Segments<T extends string>(props: {
  value: T;
  choices: { value: T; label: string; title?: string }[];
  change(value: T): void;
  label: string;
}) {
  return (
    <div class="segments" role="radiogroup" aria-label={props.label}>
      {props.choices.map(({ value, label, title }) => (
        <button
          key={value}
          role="radio"
          aria-checked={value === props.value}
          class={value === props.value ? "on" : ""}
          title={title}
          data-testid={`${props.label}-${value}`}
          onClick={() => props.change(value)}
        >
          {label}
        </button>
      ))}
    </div>
  );
}

export function Select(props: {
  value: string;
  choices: { value: string; label?: string; title?: string }[];
  change(value: string): void;
  label: string;
  empty?: string;
}) {
  const known = props.choices.some((c) => c.value === props.value);
  return (
    <select
      aria-label={props.label}
      title={props.label}
      data-testid={`select-${props.label}`}
      value={props.value}
      onChange={(e) => props.change(e.currentTarget.value)}
    >
      {(props.empty !== undefined || !known) && <option value={known ? "" : props.value}>{known || !props.value ? props.empty ?? "" : props.value}</option>}
      {props.choices.map(({ value, label, title }) => (
        <option key={value} value={value} title={title}>
          {label ?? value}
        </option>
      ))}
    </select>
  );
}

export function Check(props: { on: boolean; label: string; title?: string; change(on: boolean): void }) {
  return (
    <label class="check" title={props.title}>
      <input type="checkbox" checked={props.on} onChange={(e) => props.change(e.currentTarget.checked)} />
      {props.label}
    </label>
  );
}

export function Labelled(props: { label: string; children: ComponentChildren }) {
  return (
    <div class="labelled">
      <span>{props.label}</span>
      {props.children}
    </div>
  );
}

/// Text that turns into a field on a double click or F2.
export function EditableText(props: { value: string; change(value: string): void; title?: string }) {
  const [editing, setEditing] = useState(false);
  const field = useRef<HTMLInputElement>(null);
  useEffect(() => {
    if (editing) field.current?.select();
  }, [editing]);
  const done = (keep: boolean) => {
    const text = field.current?.value.trim();
    setEditing(false);
    if (keep && text && text !== props.value) props.change(text);
  };
  if (!editing)
    return (
      <span class="editable" title={props.title} onDblClick={() => setEditing(true)} data-rename onKeyDown={undefined}>
        {props.value}
      </span>
    );
  const keys = (e: JSX.TargetedKeyboardEvent<HTMLInputElement>) => {
    e.stopPropagation();
    if (e.key === "Enter") done(true);
    if (e.key === "Escape") done(false);
  };
  return <input ref={field} class="edit-text" value={props.value} onBlur={() => done(true)} onKeyDown={keys} />;
}

/// A panel below a button, closed by Escape, by a click elsewhere, or by its content.
export function Popover(props: {
  button: ComponentChildren;
  title: string;
  id?: string;
  align?: "left" | "right";
  children: (close: () => void) => ComponentChildren;
}) {
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  // At once: a listener that outlives its panel would swallow an Escape meant for something else.
  useLayoutEffect(() => {
    if (!open) return;
    const outside = (e: Event) => !box.current?.contains(e.target as Node) && setOpen(false);
    const escape = (e: KeyboardEvent) => e.key === "Escape" && (setOpen(false), e.stopPropagation());
    addEventListener("pointerdown", outside, true);
    addEventListener("keydown", escape, true);
    return () => {
      removeEventListener("pointerdown", outside, true);
      removeEventListener("keydown", escape, true);
    };
  }, [open]);
  return (
    <div class="popover" ref={box}>
      <button title={props.title} aria-expanded={open} data-testid={props.id} onClick={() => setOpen(!open)}>
        {props.button}
      </button>
      {open && <div class={`sheet ${props.align ?? "left"}`}>{props.children(() => setOpen(false))}</div>}
    </div>
  );
}

export function Progress(props: { value: number | undefined }) {
  return <progress max={1} value={props.value} />;
}

/// The bars, arrows and eyes of the page, drawn with strokes of one width.
const paths: Record<string, string> = {
  eye: "M1.5 8S4 3.5 8 3.5 14.5 8 14.5 8 12 12.5 8 12.5 1.5 8 1.5 8zM8 6a2 2 0 1 0 0 4 2 2 0 0 0 0-4z",
  hidden: "M1.5 8S4 3.5 8 3.5 14.5 8 14.5 8 12 12.5 8 12.5 1.5 8 1.5 8zM3 13.5 13 2.5",
  close: "M4 4l8 8M12 4l-8 8",
  copy: "M5.5 5.5h8v8h-8zM10.5 5.5v-3h-8v8h3",
  grow: "M9.5 2.5h4v4M13.5 2.5l-4.5 4.5M6.5 13.5h-4v-4M2.5 13.5L7 9",
  shrink: "M13.5 6.5h-4v-4M9.5 6.5l4.5-4.5M2.5 9.5h4v4M6.5 9.5L2 14",
  image: "M2.5 3.5h11v9h-11zM2.5 11l3.5-3.5 3 3 2-2 2.5 2.5M10.5 5.5v1",
  undo: "M5.5 3L2.5 6l3 3M2.5 6h7a3.5 3.5 0 0 1 0 7h-3",
  redo: "M10.5 3l3 3-3 3M13.5 6h-7a3.5 3.5 0 0 0 0 7h3",
  reset: "M3 8a5 5 0 1 0 1.7-3.8M3 2.5v3h3",
  plus: "M8 3v10M3 8h10",
  sun: "M8 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6zM8 1.5v1.5M8 13v1.5M1.5 8H3M13 8h1.5M3.4 3.4l1 1M11.6 11.6l1 1M12.6 3.4l-1 1M4.4 11.6l-1 1",
  moon: "M13 9.5A5.5 5.5 0 0 1 6.5 3 5.5 5.5 0 1 0 13 9.5z",
  down: "M3.5 6l4.5 4.5L12.5 6",
  right: "M6 3.5L10.5 8 6 12.5",
  link: "M7 9a2.5 2.5 0 0 0 3.5 0l2.3-2.3a2.5 2.5 0 0 0-3.5-3.5l-1 1M9 7a2.5 2.5 0 0 0-3.5 0L3.2 9.3a2.5 2.5 0 0 0 3.5 3.5l1-1",
  grid: "M2.5 2.5h4.5v4.5h-4.5zM9 2.5h4.5v4.5H9zM2.5 9h4.5v4.5h-4.5zM9 9h4.5v4.5H9z",
  help: "M6 6a2 2 0 1 1 2.8 1.8c-.5.3-.8.6-.8 1.4M8 11.5v.5",
  save: "M8 2.5v7M5 7l3 3 3-3M3 13.5h10",
  table: "M2.5 3.5h11v9h-11zM2.5 6.5h11M6.5 3.5v9",
};
export function Icon(props: { name: keyof typeof paths | string }) {
  return (
    <svg class="icon" viewBox="0 0 16 16" aria-hidden="true">
      <path d={paths[props.name]} />
    </svg>
  );
}
