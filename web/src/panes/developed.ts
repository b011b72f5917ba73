// A picture with its tone curve: by the page for plain gamma, by the core's operators otherwise.

import { type Signal, effect, signal } from "@preact/signals";
import { complain, core } from "../core/session";
import { state } from "../core/store";
import type { FloatArray } from "../protocol";

export class Developed {
  /// Linear under plain gamma, display values under an operator.
  readonly shown = signal<FloatArray | null>(null);
  readonly stop: () => void;

  constructor(
    readonly image: Signal<FloatArray | null>,
    readonly id: Signal<number>,
    slot: string,
  ) {
    this.stop = effect(() => {
      const picture = image.value;
      const { operator, exposure, parameters } = state.value.render;
      if (!picture || !operator) {
        this.shown.value = picture;
        return;
      }
      core
        .latest(`display ${slot}`, "display", { of: id.value, operator, exposure, parameters })
        .then((answer) => {
          if (answer && state.peek().render.operator) this.shown.value = answer.arrays.image;
        })
        .catch(complain);
    });
  }

  static empty(slot: string): Developed {
    return new Developed(signal<FloatArray | null>(null), signal(0), slot);
  }

  keep(other: Developed): void {
    this.id.value = other.id.value;
    this.image.value = other.image.value;
  }

  clear(): void {
    this.image.value = null;
  }
}
