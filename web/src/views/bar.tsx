// Directions and display, above all views.

import { directions, display, set } from "../core/store";
import { initialState } from "../core/state";
import { Segments, Toggle } from "../ui/controls";
import { Slider } from "../ui/slider";

const angles = [
  { name: "theta_i", label: "θi", hi: 90, title: "angle of the light to the normal" },
  { name: "phi_i", label: "φi", hi: 360, title: "azimuth of the light" },
  { name: "theta_d", label: "θd", hi: 90, title: "difference angle of the θh plot" },
  { name: "phi_d", label: "φd", hi: 180, title: "azimuth of the image slice" },
] as const;

export function Bar() {
  const d = display.value;
  return (
    <div class="bar" role="toolbar" aria-label="Directions and display">
      {angles.map(({ name, label, hi, title }) => (
        <Slider
          key={name}
          id={`angle-${name}`}
          label={label}
          value={directions.value[name]}
          lo={0}
          hi={hi}
          unit="deg"
          title={title}
          initial={initialState.directions[name]}
          change={(v, g) => set("directions", { [name]: v }, g)}
        />
      ))}
      <span class="gap" />
      <Segments
        label="channel"
        value={d.channel}
        choices={[
          { value: "luminance", label: "Y", title: "luminance (y)" },
          { value: "r", label: "R", title: "red (r)" },
          { value: "g", label: "G", title: "green (g)" },
          { value: "b", label: "B", title: "blue (b)" },
        ]}
        change={(channel) => set("display", { channel })}
      />
      <Toggle on={d.log} label="log" title="logarithmic plots (l)" id="log" change={(log) => set("display", { log })} />
      <Toggle on={d.cosine} label="× cos" title="times the cosine (c)" id="cosine" change={(cosine) => set("display", { cosine })} />
      <Slider id="exposure" label="EV" value={d.exposure} lo={-6} hi={6} title="exposure of pictures, stops ([ and ])" initial={0} change={(exposure, g) => set("display", { exposure }, g)} />
      <Slider id="gamma" label="γ" value={d.gamma} lo={1} hi={3} title="gamma of pictures" initial={2.2} change={(gamma, g) => set("display", { gamma }, g)} />
    </div>
  );
}
