// Turning a camera around a target by dragging, nearing by the wheel, moving by dragging with Shift.

export interface Orbit {
  azimuth: number;
  elevation: number;
  distance: number;
  target?: [number, number, number];
}

const degrees = 180 / Math.PI;

/// Where the camera is, seen from its target; degrees, z up.
export function orbitOffset({ azimuth, elevation, distance }: Orbit): [number, number, number] {
  const a = azimuth / degrees;
  const e = elevation / degrees;
  return [distance * Math.cos(e) * Math.cos(a), distance * Math.cos(e) * Math.sin(a), distance * Math.sin(e)];
}

export function turned<T extends Orbit>(camera: T, dx: number, dy: number): T {
  return {
    ...camera,
    azimuth: (((camera.azimuth - 0.4 * dx) % 360) + 360) % 360,
    elevation: Math.min(89.9, Math.max(-89.9, camera.elevation + 0.4 * dy)),
  };
}

export function neared<T extends Orbit>(camera: T, wheel: number): T {
  return { ...camera, distance: Math.min(1e4, Math.max(1e-3, camera.distance * Math.exp(0.0012 * wheel))) };
}

/// Moves the target in the plane of the picture; dx and dy are shares of the picture's height.
export function moved<T extends Orbit>(camera: T, dx: number, dy: number, fov = 35): T {
  if (!camera.target) return camera;
  const a = camera.azimuth / degrees;
  const e = camera.elevation / degrees;
  const scale = 2 * camera.distance * Math.tan(fov / 2 / degrees);
  const right = [-Math.sin(a), Math.cos(a), 0];
  const up = [-Math.sin(e) * Math.cos(a), -Math.sin(e) * Math.sin(a), Math.cos(e)];
  const target = camera.target.map((t, i) => t + scale * (dy * up[i] - dx * right[i])) as [number, number, number];
  return { ...camera, target };
}

/// Follows pointer and wheel on an element; answers how to stop.
export function orbitControls<T extends Orbit>(
  element: HTMLElement,
  camera: () => T,
  put: (camera: T, dragging: boolean) => void,
  claim: (event: PointerEvent) => boolean = () => false,
): () => void {
  let last: { x: number; y: number } | null = null;
  let settle: ReturnType<typeof setTimeout> | undefined;
  const down = (e: PointerEvent) => {
    if (claim(e)) return;
    last = { x: e.clientX, y: e.clientY };
    element.setPointerCapture(e.pointerId);
  };
  const move = (e: PointerEvent) => {
    if (!last) return;
    const dx = e.clientX - last.x;
    const dy = e.clientY - last.y;
    last = { x: e.clientX, y: e.clientY };
    const height = element.clientHeight || 1;
    const moves = e.shiftKey || (e.buttons & 4) !== 0;
    put(moves ? moved(camera(), dx / height, dy / height) : turned(camera(), dx, dy), true);
  };
  const up = () => {
    if (last) put(camera(), false);
    last = null;
  };
  const wheel = (e: WheelEvent) => {
    e.preventDefault();
    put(neared(camera(), e.deltaY), true);
    clearTimeout(settle);
    settle = setTimeout(() => put(camera(), false), 160);
  };
  element.addEventListener("pointerdown", down);
  element.addEventListener("pointermove", move);
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", up);
  element.addEventListener("wheel", wheel, { passive: false });
  return () => {
    clearTimeout(settle);
    element.removeEventListener("pointerdown", down);
    element.removeEventListener("pointermove", move);
    element.removeEventListener("pointerup", up);
    element.removeEventListener("pointercancel", up);
    element.removeEventListener("wheel", wheel);
  };
}
