export function ObjectPane() { return <p class="hint">ObjectPane</p>; }
