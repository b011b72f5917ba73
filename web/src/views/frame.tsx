// The frame of a view: its title, its options, saving as an image, maximising.

import { createContext, type ComponentChildren } from "preact";
import { useContext, useEffect, useRef } from "preact/hooks";
import { look, maximised } from "../core/store";
import type { ViewId } from "../core/state";
import { Icon } from "../ui/controls";
import { captures, saveView } from "./capture";

export type Register = (canvas: () => HTMLCanvasElement | undefined) => void;
const RegisterContext = createContext<Register>(() => {});
export const useRegister = (): Register => useContext(RegisterContext);

export function ViewFrame(props: {
  id: string;
  title: string;
  hint?: string;
  options?: ComponentChildren;
  children: ComponentChildren;
  error?: string;
  canMaximise?: boolean;
}) {
  const canvas = useRef<() => HTMLCanvasElement | undefined>();
  useEffect(() => {
    captures.set(props.id, { title: props.title, canvas: () => canvas.current?.() });
    return () => {
      captures.delete(props.id);
    };
  }, [props.id, props.title]);
  const isMaximised = maximised.value === props.id;
  return (
    <section class="view" data-testid={`view-${props.id}`} data-view={props.id} tabIndex={0} aria-label={props.title}>
      <header>
        <h3 title={props.hint}>{props.title}</h3>
        <div class="options">{props.options}</div>
        <button class="quiet" title="save as image" aria-label={`save ${props.title} as image`} onClick={() => saveView(props.id)}>
          <Icon name="image" />
        </button>
        {props.canMaximise !== false && (
          <button class="quiet" title={isMaximised ? "back to the grid (Esc)" : "maximise (m)"} aria-label={`maximise ${props.title}`} onClick={() => look({ maximised: isMaximised ? null : (props.id as ViewId) })}>
            <Icon name={isMaximised ? "shrink" : "grow"} />
          </button>
        )}
      </header>
      <div class="body">
        <RegisterContext.Provider value={(c) => (canvas.current = c)}>{props.children}</RegisterContext.Provider>
        {props.error && <p class="view-error">{props.error}</p>}
      </div>
    </section>
  );
}
