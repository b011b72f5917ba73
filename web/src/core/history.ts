// Undo and redo over whole states. Changes of one gesture, such as the drag of a slider, are one step.

export class History<S> {
  private past: S[] = [];
  private future: S[] = [];
  private gesture?: string;

  constructor(private readonly limit = 200) {}

  /// Call before a change: `current` is what undo comes back to.
  record(current: S, gesture?: string): void {
    if (gesture !== undefined && gesture === this.gesture) return;
    this.gesture = gesture;
    this.past.push(current);
    if (this.past.length > this.limit) this.past.shift();
    this.future = [];
  }

  /// The next change starts a new step, whatever its gesture.
  endGesture(): void {
    this.gesture = undefined;
  }

  undo(current: S): S | undefined {
    return this.step(this.past, this.future, current);
  }

  redo(current: S): S | undefined {
    return this.step(this.future, this.past, current);
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  private step(from: S[], to: S[], current: S): S | undefined {
    this.endGesture();
    const state = from.pop();
    if (state !== undefined) to.push(current);
    return state;
  }
}
