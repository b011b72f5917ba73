// The sliders of the selected material, made from what its models declare.

import { useSignal } from "@preact/signals";
import { fromHex, toHex } from "../core/color";
import { brdfParameters, fileFacts, models } from "../core/session";
import { type Material, editMaterial, setParameter } from "../core/state";
import { change, endGesture, selected } from "../core/store";
import type { Declaration, ParameterValue, Rgb } from "../protocol";
import { Check, Icon } from "../ui/controls";
import { tidy } from "../ui/scale";
import { Slider } from "../ui/slider";

export function Parameters() {
  const material = selected.value;
  if (!material) return <p class="hint">Add a material to begin.</p>;
  const { source } = material;
  if ("file" in source) return <Facts file={source.file} />;
  if ("brdf" in source) {
    const declared = brdfParameters.value.get(source.brdf.source) ?? [];
    return (
      <section class="lobe">
        <header>{source.brdf.name}</header>
        {declared.map((d) => (
          <Parameter key={d.name} material={material} lobe={0} declaration={d} value={source.values[d.name] ?? d.initial} />
        ))}
        {declared.length === 0 && <p class="hint">No parameters.</p>}
      </section>
    );
  }
  return (
    <>
      {source.lobes.map((lobe, i) => {
        const model = models.value.get(lobe.model);
        return (
          <section class="lobe" key={`${i} ${lobe.model}`}>
            <header title={model ? `${model.summary}\n${model.source}` : undefined}>
              {lobe.model}
              {model && <small>{model.summary}</small>}
            </header>
            {source.lobes.length > 1 && (
              <Parameter material={material} lobe={i} declaration={weightDeclaration} value={lobe.weight} />
            )}
            {(model?.parameters ?? []).map((d) => (
              <Parameter key={d.name} material={material} lobe={i} declaration={d} value={lobe.parameters[d.name] ?? d.initial} />
            ))}
          </section>
        );
      })}
    </>
  );
}

const weightDeclaration: Declaration = {
  name: "weight",
  unit: "1",
  meaning: "factor on this lobe",
  lo: 0,
  hi: 1,
  initial: 1,
  is_color: false,
  is_switch: false,
};

function Facts(props: { file: string }) {
  const facts = fileFacts.value.get(props.file);
  const list = facts?.facts;
  const rows: [string, string][] = Array.isArray(list)
    ? list.map((text) => ["", String(text)])
    : Object.entries(list ?? {}).map(([k, v]) => [k, typeof v === "number" ? tidy(v) : String(v)]);
  return (
    <section class="lobe">
      <header>
        {props.file}
        <small>{facts ? (facts.is_isotropic ? "measured, isotropic" : "measured, anisotropic") : "measured"}</small>
      </header>
      <dl class="facts">
        {rows.map(([k, v]) => (
          <>
            {k && <dt>{k}</dt>}
            <dd>{v}</dd>
          </>
        ))}
        {facts?.holes ? (
          <>
            <dt>holes</dt>
            <dd>{facts.holes}</dd>
          </>
        ) : null}
      </dl>
    </section>
  );
}

interface ParameterProps {
  material: Material;
  lobe: number;
  declaration: Declaration;
  value: ParameterValue;
}

function Parameter({ material, lobe, declaration: d, value }: ParameterProps) {
  const put = (next: ParameterValue, gesture: string) =>
    change(
      (s) => editMaterial(s, material.id, (m) => ({ ...m, source: setParameter(m.source, lobe, d.name, next) })),
      `${gesture} ${material.id} ${lobe} ${d.name}`,
    );
  const range = `${d.name}: ${d.meaning}\n${tidy(d.lo)} to ${tidy(d.hi)}${d.unit === "1" ? "" : ` ${d.unit}`}, default ${
    typeof d.initial === "number" ? tidy(d.initial) : d.initial.map(tidy).join(" ")
  }`;
  if (d.is_switch && !d.is_color && typeof value === "number" && d.lo === 0 && d.hi === 1)
    return (
      <div class="slider switch" title={range} data-testid={`parameter-${d.name}`}>
        <Check on={Number(value) > 0.5} label={d.name} change={(on) => put(on ? 1 : 0, `switch ${performance.now()}`)} />
      </div>
    );
  if (d.is_color || typeof value !== "number")
    return <ColorParameter declaration={d} value={typeof value === "number" ? [value, value, value] : value} title={range} put={put} />;
  return (
    <Slider
      id={`parameter-${d.name}`}
      label={d.name}
      value={value}
      lo={d.lo}
      hi={d.hi}
      unit={d.unit}
      title={range}
      initial={typeof d.initial === "number" ? d.initial : d.initial[0]}
      change={put}
    />
  );
}

const tints = ["var(--red)", "var(--green)", "var(--blue)"];

function ColorParameter(props: {
  declaration: Declaration;
  value: Rgb;
  title: string;
  put(value: ParameterValue, gesture: string): void;
}) {
  const { declaration: d, value, put } = props;
  const open = useSignal(false);
  const largest = Math.max(...value);
  const initial = typeof d.initial === "number" ? d.initial : Math.max(...d.initial);
  const scaled = (to: number): Rgb =>
    largest > 0 ? (value.map((v) => Number(((v * to) / largest).toPrecision(5))) as Rgb) : [to, to, to];
  const unitRange = d.lo >= 0 && d.hi <= 1.0001;
  return (
    <div class={`color-parameter${open.value ? " open" : ""}`} data-testid={`parameter-${d.name}`}>
      <div class="all">
        {unitRange ? (
          <input
            type="color"
            aria-label={`${d.name}, colour`}
            value={toHex(value)}
            onInput={(e) => put(fromHex(e.currentTarget.value).map((x) => Number(x.toPrecision(4))) as Rgb, "picker")}
            onChange={endGesture}
          />
        ) : (
          <span class="swatch-place" />
        )}
        <Slider
          label={d.name}
          value={largest}
          lo={d.lo}
          hi={d.hi}
          unit={d.unit}
          title={`${props.title}\nthe bar moves all channels, keeping their proportion`}
          initial={initial}
          change={(v, g) =>
            put(g.startsWith("reset") ? (typeof d.initial === "number" ? [initial, initial, initial] : d.initial) : scaled(v), g)
          }
        />
        <button class="quiet" title="each channel" aria-expanded={open.value} onClick={() => (open.value = !open.value)} data-testid={`channels-${d.name}`}>
          <Icon name={open.value ? "down" : "right"} />
        </button>
      </div>
      {open.value &&
        value.map((v, c) => (
          <Slider
            key={c}
            id={`parameter-${d.name}-${"rgb"[c]}`}
            label={["red", "green", "blue"][c]}
            value={v}
            lo={d.lo}
            hi={d.hi}
            tint={tints[c]}
            initial={typeof d.initial === "number" ? d.initial : d.initial[c]}
            change={(next, g) => put(value.map((old, i) => (i === c ? next : old)) as Rgb, g)}
          />
        ))}
    </div>
  );
}
