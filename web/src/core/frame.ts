// Drawing once a frame, and knowing when nothing is left to draw or to wait for.

const jobs = new Map<object, () => void>();
let requested = false;

/// Runs `draw` in the next frame; a second call for the same owner replaces the first.
export function nextFrame(owner: object, draw: () => void): void {
  jobs.set(owner, draw);
  if (requested) return;
  requested = true;
  requestAnimationFrame(() => {
    requested = false;
    const now = [...jobs.values()];
    jobs.clear();
    for (const job of now) job();
  });
}

export const drawingsLeft = (): number => jobs.size;

/// Resolves when `outstanding` has been 0 and nothing was left to draw for three frames. What a change of the page asks
/// for begins after the frame that shows it, in a task of its own.
export async function settled(outstanding: () => number): Promise<void> {
  for (let quiet = 0; quiet < 3; ) {
    await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
    quiet = outstanding() === 0 && jobs.size === 0 ? quiet + 1 : 0;
  }
}
