// A canvas that fills its place at the screen's own resolution and is drawn once a frame at most.

import { useEffect, useRef } from "preact/hooks";
import { useSignalEffect, useSignal } from "@preact/signals";
import { nextFrame } from "../core/frame";
import { theme } from "../core/store";

export interface Surface {
  context: CanvasRenderingContext2D;
  width: number;
  height: number;
  /// Height of the page's text, in the same CSS pixels.
  em: number;
  color(name: string): string;
}

export function Canvas(props: {
  draw(surface: Surface): void;
  /// Reads the signals that the drawing depends on.
  depends(): void;
  register?(canvas: () => HTMLCanvasElement | undefined): void;
  class?: string;
  pointer?(event: PointerEvent, x: number, y: number): void;
  title?: string;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const size = useSignal({ width: 0, height: 0 });
  const owner = useRef({});
  useEffect(() => {
    props.register?.(() => canvas.current ?? undefined);
    const box = canvas.current!.parentElement!;
    const observer = new ResizeObserver(() => (size.value = { width: box.clientWidth, height: box.clientHeight }));
    observer.observe(box);
    return () => observer.disconnect();
  }, []);
  const draw = useRef(props.draw);
  draw.current = props.draw;
  useSignalEffect(() => {
    const { width, height } = size.value;
    theme.value;
    props.depends();
    if (width < 8 || height < 8) return;
    nextFrame(owner.current, () => {
      const element = canvas.current;
      if (!element) return;
      const ratio = devicePixelRatio;
      const w = Math.round(width * ratio);
      const h = Math.round(height * ratio);
      if (element.width !== w || element.height !== h) {
        element.width = w;
        element.height = h;
      }
      const context = element.getContext("2d")!;
      const style = getComputedStyle(document.documentElement);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, width, height);
      const em = parseFloat(style.fontSize);
      context.font = `${0.78 * em}px ${getComputedStyle(document.body).fontFamily}`;
      draw.current({ context, width, height, em, color: (name) => style.getPropertyValue(name).trim() });
    });
  });
  const pointer = (e: PointerEvent) => {
    const box = canvas.current!.getBoundingClientRect();
    props.pointer!(e, e.clientX - box.left, e.clientY - box.top);
  };
  const down = (e: PointerEvent) => {
    canvas.current!.setPointerCapture(e.pointerId);
    pointer(e);
  };
  return (
    <div class={`canvas ${props.class ?? ""}`} title={props.title}>
      <canvas ref={canvas} {...(props.pointer ? { onPointerDown: down, onPointerMove: pointer, onPointerUp: pointer, onPointerLeave: pointer } : {})} />
    </div>
  );
}
