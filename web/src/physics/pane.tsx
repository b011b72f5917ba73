export function PhysicsPane() { return <p class="hint">Physics</p>; }
