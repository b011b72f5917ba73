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

/// Resolves when `outstanding` has been 0 and nothing was left to draw for two frames.
export async function settled(outstanding: () => number): Promise<void> {
  for (let quiet = 0; quiet < 2; ) {
    await new Promise((resolve) => requestAnimationFrame(resolve));
    quiet = outstanding() === 0 && jobs.size === 0 ? quiet + 1 : 0;
  }
}
