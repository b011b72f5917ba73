// What one pixel of a picture holds: colour, noise, spectrum.

import { signal, useSignal, useSignalEffect } from "@preact/signals";
import { complain, core } from "../core/session";
import type { Answer } from "../protocol";
import { Plot, type PlotData } from "../ui/plot";
import { tidy } from "../ui/scale";

export const inspection = signal<{ x: number; y: number } | null>(null);

export function Inspector({ of }: { of: number }) {
  const answer = useSignal<Answer<"inspect"> | null>(null);
  const spectrum = useSignal<PlotData | null>(null);
  const picture = useSignal(of);
  picture.value = of;
  useSignalEffect(() => {
    const at = inspection.value;
    if (!at || !picture.value) return;
    core
      .latest("inspect", "inspect", { of: picture.value, ...at })
      .then((found) => {
        if (!found) return;
        answer.value = found;
        const { wavelength_nm: x, radiance: y } = found.spectrum ?? { wavelength_nm: [], radiance: [] };
        spectrum.value = { x, lines: [{ label: "L", color: "#e8a33d", y }], xLabel: "nm", yLabel: "radiance" };
      })
      .catch(complain);
  });
  const a = answer.value;
  const list = (v: number | number[]) => (Array.isArray(v) ? v : [v]).map(tidy).join("  ");
  return (
    <section class="inspector">
      <h2>Pixel</h2>
      {!a || !inspection.value ? (
        <p class="hint">Click a pixel to see what it holds.</p>
      ) : (
        <>
          <dl class="facts">
            <dt>at</dt>
            <dd>{`${inspection.value.x}, ${inspection.value.y}`}</dd>
            {a.material && (
              <>
                <dt>material</dt>
                <dd>{a.material}</dd>
              </>
            )}
            <dt>RGB</dt>
            <dd>{list(a.rgb)}</dd>
            <dt>XYZ</dt>
            <dd>{list(a.xyz)}</dd>
            <dt>samples</dt>
            <dd>{a.samples}</dd>
            <dt>variance</dt>
            <dd>{list(a.variance)}</dd>
          </dl>
          {a.spectrum && (
            <div class="spectrum">
              <Plot data={spectrum} />
            </div>
          )}
        </>
      )}
    </section>
  );
}
