export function FitPane() { return <p class="hint">FitPane</p>; }
