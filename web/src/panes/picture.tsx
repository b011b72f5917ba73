// A progressive picture: one long request at a time, restarted when what it shows changes.

import { type Signal, effect, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { ConnectionLost, type Task } from "../connection";
import { nextFrame } from "../core/frame";
import { core } from "../core/session";
import type { Answer, FloatArray, Requests } from "../protocol";

type PictureKind = "object" | "render";

/// Cancels what runs before it begins what is newest; never more than one under way.
export class ProgressivePicture<T extends PictureKind> {
  readonly image = signal<FloatArray | null>(null);
  readonly header = signal<Answer<T> | null>(null);
  readonly running = signal(false);
  readonly error = signal("");
  /// The request the picture belongs to: what `inspect`, `display` and `save` ask about.
  readonly id = signal(0);
  private task?: Task<T>;
  private next?: Requests[T];
  private key = "";

  constructor(private readonly type: T) {}

  show(body: Requests[T]): void {
    const key = `${core.generation.peek()} ${JSON.stringify(body)}`;
    if (key === this.key) return;
    this.key = key;
    this.next = body;
    if (this.task) this.task.cancel();
    else this.begin();
  }

  stop(): void {
    this.next = undefined;
    this.key = "";
    this.task?.cancel();
  }

  private begin(): void {
    const body = this.next;
    this.next = undefined;
    if (!body) {
      this.running.value = false;
      return;
    }
    this.running.value = true;
    const got = (answer: Answer<T>) => {
      if (this.next) return;
      this.id.value = task.id;
      this.error.value = "";
      if (answer.arrays.image) this.image.value = answer.arrays.image;
      this.header.value = { ...this.header.peek(), ...answer };
    };
    const task = core.begin(this.type, body, got);
    this.task = task;
    task.answer
      .then(got, (problem: Error) => {
        if (problem instanceof ConnectionLost) this.key = "";
        else this.error.value = problem.message;
      })
      .finally(() => {
        this.task = undefined;
        this.begin();
      });
  }
}

/// Draws a float image as it is converted to pixels by `convert`; answers pixel coordinates under the pointer.
export function PictureCanvas(props: {
  image: Signal<FloatArray | null>;
  depends(): void;
  convert(image: FloatArray, out: ImageData): void;
  setUp?(canvas: HTMLCanvasElement): void | (() => void);
  register?(canvas: () => HTMLCanvasElement | undefined): void;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const convert = useRef(props.convert);
  convert.current = props.convert;
  useEffect(() => {
    props.register?.(() => canvas.current ?? undefined);
    return props.setUp?.(canvas.current!);
  }, []);
  useEffect(() => drawWhenChanged(canvas, props.image, props.depends, convert), []);
  return <canvas ref={canvas} />;
}

function drawWhenChanged(
  canvas: { current: HTMLCanvasElement | null },
  image: Signal<FloatArray | null>,
  depends: () => void,
  convert: { current(image: FloatArray, out: ImageData): void },
): () => void {
  const owner = {};
  let pixels: ImageData | undefined;
  return effect(() => {
    const picture = image.value;
    depends();
    nextFrame(owner, () => {
      const element = canvas.current;
      if (!element || !picture) return;
      const [height, width] = picture.shape;
      if (element.width !== width || element.height !== height) {
        element.width = width;
        element.height = height;
      }
      if (pixels?.width !== width || pixels.height !== height) pixels = new ImageData(width, height);
      convert.current(picture, pixels);
      element.getContext("2d")!.putImageData(pixels, 0, 0);
    });
  });
}
