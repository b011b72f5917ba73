export function EditPane() { return <p class="hint">EditPane</p>; }
