export function ValidatePane() { return <p class="hint">ValidatePane</p>; }
