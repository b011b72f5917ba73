// One number: a bar to drag, a field to type into, the way back to its default.

import { useMemo, useRef } from "preact/hooks";
import { endGesture } from "../core/store";
import { Icon } from "./controls";
import { sliderScale, snapped, tidy } from "./scale";

interface SliderProps {
  label: string;
  value: number;
  lo: number;
  hi: number;
  unit?: string;
  title?: string;
  initial?: number;
  tint?: string;
  id?: string;
  whole?: boolean;
  /// Every change of one drag carries the same gesture.
  change(value: number, gesture: string): void;
}

let gestures = 0;

export function Slider(props: SliderProps) {
  const { lo, hi, value } = props;
  const scale = useMemo(() => sliderScale(lo, hi), [lo, hi]);
  const gesture = useRef("");
  const field = useRef<HTMLInputElement>(null);
  const edited = useRef(false);
  const position = Math.min(1, Math.max(0, scale.toPosition(value)));
  const unit = props.unit && props.unit !== "1" ? props.unit : "";
  const begin = () => {
    gesture.current = `slider ${++gestures}`;
  };
  const slide = (t: number) => {
    if (!gesture.current) begin();
    const next = scale.toValue(t);
    props.change(props.whole ? Math.round(next) : snapped(next, lo, hi), gesture.current);
  };
  const end = () => {
    gesture.current = "";
    endGesture();
  };
  const type = () => {
    const input = field.current!;
    // What was not typed is no wish: the value may have changed meanwhile by another way.
    if (!edited.current) return;
    edited.current = false;
    const typed = Number(input.value.replace(",", "."));
    if (Number.isFinite(typed) && input.value.trim()) {
      const next = Math.min(hi ?? Infinity, Math.max(lo ?? -Infinity, typed));
      if (next !== value) props.change(next, `typed ${++gestures}`);
    }
    input.value = tidy(value);
    end();
  };
  const changed = props.initial !== undefined && Math.abs(props.initial - value) > 1e-9;
  return (
    <div class="slider" title={props.title} style={props.tint ? { "--tint": props.tint } : undefined} data-testid={props.id}>
      <span class="name">{props.label}</span>
      <input
        type="range"
        aria-label={props.label}
        min={0}
        max={1}
        step={0.001}
        value={position}
        style={{ "--t": position }}
        onPointerDown={begin}
        onInput={(e) => slide(Number(e.currentTarget.value))}
        onChange={end}
        onDblClick={() => props.initial !== undefined && props.change(props.initial, `reset ${++gestures}`)}
      />
      <input
        ref={field}
        class="number"
        inputMode="decimal"
        aria-label={`${props.label}, typed`}
        value={tidy(value)}
        onFocus={(e) => e.currentTarget.select()}
        onInput={() => (edited.current = true)}
        onBlur={type}
        onKeyDown={(e) => {
          e.stopPropagation();
          if (e.key === "Enter") type();
          if (e.key === "Escape") {
            edited.current = false;
            e.currentTarget.value = tidy(value);
            e.currentTarget.blur();
          }
        }}
      />
      <span class="unit">{unit === "deg" ? "°" : unit}</span>
      {props.initial !== undefined && (
        <button
          class={`quiet reset${changed ? "" : " unused"}`}
          tabIndex={changed ? 0 : -1}
          title={`back to ${tidy(props.initial)}`}
          onClick={() => {
            props.change(props.initial!, `reset ${++gestures}`);
            endGesture();
          }}
        >
          <Icon name="reset" />
        </button>
      )}
    </div>
  );
}
