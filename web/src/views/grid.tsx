// The views side by side, in as many columns as keep them near a good shape; or one of them alone.

import { useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { look, maximised, state } from "../core/store";
import type { ViewId } from "../core/state";
import { Check, Icon, Popover } from "../ui/controls";
import { CurveView } from "./curves";
import { SliceView, SphereView } from "./images";
import { Lobe3dView } from "./lobe3d";
import { PolarView } from "./polar";

export const viewNames: Record<ViewId, string> = {
  lobe3d: "3-D lobe",
  polar: "Polar plot",
  theta_h: "θh: half angle",
  theta_d: "θd: difference angle",
  theta_i: "θi: light's angle",
  theta_o: "θo: viewer's angle",
  phi: "φo: around the normal",
  albedo: "Albedo",
  sphere: "Lit sphere",
  slice: "Image slice",
  D: "D: facet normals",
  G1: "G1: masking",
};
export const viewIds = Object.keys(viewNames) as ViewId[];

export function View({ id }: { id: ViewId }) {
  switch (id) {
    case "lobe3d":
      return <Lobe3dView />;
    case "polar":
      return <PolarView />;
    case "sphere":
      return <SphereView />;
    case "slice":
      return <SliceView />;
    default:
      return <CurveView kind={id} />;
  }
}

/// Columns for `count` tiles whose shape comes nearest to 1.25 : 1.
export function columnsFor(count: number, width: number, height: number): number {
  let best = 1;
  let least = Infinity;
  for (let columns = 1; columns <= count; ++columns) {
    const rows = Math.ceil(count / columns);
    const empty = columns * rows - count;
    const shape = Math.abs(Math.log(width / columns / (height / rows) / 1.25));
    const cost = shape + (0.25 * empty) / count;
    if (cost < least) {
      least = cost;
      best = columns;
    }
  }
  return best;
}

export function ViewGrid(props: { views?: ViewId[] }) {
  const box = useRef<HTMLDivElement>(null);
  const size = useSignal({ width: 1000, height: 700 });
  useEffect(() => {
    const element = box.current!;
    const observer = new ResizeObserver(() => (size.value = { width: element.clientWidth, height: element.clientHeight }));
    observer.observe(element);
    return () => observer.disconnect();
  }, []);
  const one = maximised.value;
  const views = one ? [one] : props.views ?? state.value.views;
  const columns = columnsFor(views.length, size.value.width, size.value.height);
  const rows = Math.ceil(views.length / columns);
  const style = { gridTemplateColumns: `repeat(${columns}, minmax(0, 1fr))`, gridTemplateRows: `repeat(${rows}, minmax(0, 1fr))` };
  return (
    <div class="view-grid" ref={box} style={style}>
      {views.map((id) => (
        <View key={id} id={id} />
      ))}
      {views.length === 0 && <p class="hint">All views are hidden: choose some under Views.</p>}
    </div>
  );
}

export function ViewChooser() {
  const views = state.value.views;
  const toggle = (id: ViewId, on: boolean) =>
    look({ views: on ? viewIds.filter((v) => v === id || views.includes(v)) : views.filter((v) => v !== id), maximised: null });
  return (
    <Popover title="which views are shown" button={<><Icon name="grid" /> Views</>} align="right" id="choose-views">
      {() => (
        <div class="view-list">
          {viewIds.map((id) => (
            <Check key={id} on={views.includes(id)} label={viewNames[id]} change={(on) => toggle(id, on)} />
          ))}
          <div class="segments">
            <button onClick={() => look({ views: ["lobe3d", "polar", "theta_h", "theta_d", "sphere", "slice"] })}>Six</button>
            <button onClick={() => look({ views: viewIds })}>All</button>
          </div>
        </div>
      )}
    </Popover>
  );
}
