import { render } from "preact";
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { App } from "./app";
import { awaited, startSession } from "./core/session";
import { settled } from "./core/frame";
import { endGesture, followAddress, look, setTheme, state, theme } from "./core/store";
import { listenToKeys } from "./keyboard";
import { pictured, plotted } from "./views/data";

setTheme(theme.value);
if (location.hash.length < 2 && innerWidth >= 2200)
  look({ views: ["lobe3d", "polar", "sphere", "slice", "theta_h", "theta_d", "theta_i", "theta_o", "phi", "albedo", "D", "G1"] });
startSession();
followAddress();
listenToKeys();
addEventListener("pointerup", endGesture);
render(<App />, document.getElementById("page")!);

/// What tests read: the numbers behind the views, and when they are up to date.
declare global {
  interface Window {
    nacre: {
      readonly state: typeof state.value;
      plots(): Record<string, { x: number[]; series: { material: number; name: string; y: (number | null)[] }[] }>;
      images(): Record<string, { material: number; width: number; height: number; rgb: number[] }>;
      settled(): Promise<void>;
    };
  }
}
window.nacre = {
  get state() {
    return state.value;
  },
  plots: () =>
    Object.fromEntries(
      [...plotted].map(([id, { x, series }]) => [
        id,
        { x: Array.from(x), series: series.map((s) => ({ ...s, y: Array.from(s.y, (v) => (Number.isFinite(v) ? v : null)) })) },
      ]),
    ),
  images: () => Object.fromEntries([...pictured].map(([id, p]) => [id, { ...p, rgb: Array.from(p.rgb) }])),
  settled: () => settled(awaited),
};
