export function RenderPane() { return <p class="hint">RenderPane</p>; }
