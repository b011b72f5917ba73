// The scene viewer: progressive rendering of a scene file, orbit, swapped materials, two pictures side by side.

import { useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { displayPixels, toPixels } from "../core/color";
import { complain, core, fileVersion, hello, notify } from "../core/session";
import { type State, toRequest } from "../core/state";
import { change, display, look, set, state } from "../core/store";
import { FileList } from "../materials/add";
import { dragType } from "../materials/list";
import type { Camera, FloatArray } from "../protocol";
import { choiceName } from "../protocol";
import { Icon, Labelled, Popover, Select } from "../ui/controls";
import { orbitControls } from "../ui/orbit";
import { Slider } from "../ui/slider";
import { ViewFrame, useRegister } from "../views/frame";
import { Inspector, inspection } from "./inspector";
import { PictureCanvas, ProgressivePicture } from "./picture";
import { Developed } from "./developed";

const edit = (part: Partial<State["render"]>, gesture?: string) => set("render", part, gesture);

export function RenderPane() {
  const picture = useRef<ProgressivePicture<"render">>();
  picture.current ??= new ProgressivePicture("render");
  const developed = useRef<Developed>();
  developed.current ??= new Developed(picture.current.image, picture.current.id, "A");
  const kept = useRef<Developed>();
  kept.current ??= Developed.empty("B");
  const dragging = useSignal(false);
  useEffect(
    () => () => {
      picture.current!.stop();
      developed.current!.stop();
      kept.current!.stop();
    },
    [],
  );
  useSignalEffect(() => {
    const { scene, integrator, swap, camera, samples, scale } = state.value.render;
    core.generation.value;
    fileVersion.value;
    if (!hello.value || !scene) return;
    picture.current!.show({
      scene,
      definitions: {},
      integrator,
      ...(camera ? { camera } : {}),
      swap: Object.fromEntries(Object.entries(swap).map(([id, m]) => [id, toRequest(m)])),
      samples: dragging.value ? 1 : samples,
      scale: dragging.value ? scale / 3 : scale,
    });
  });
  const { header, error, running, id } = picture.current;
  const r = state.value.render;
  const keep = () => kept.current!.keep(developed.current!);
  return (
    <>
      <RenderBar picture={picture.current} keep={keep} hasB={kept.current.image.value !== null} dropB={() => kept.current!.clear()} />
      <div class="work render">
        <ViewFrame
          id="render"
          title={r.scene || "Scene"}
          hint="drag to turn, wheel to near, Shift to move, click to inspect"
          error={error.value}
          canMaximise={false}
          options={
            <span class="count">
              {header.value?.samples ? `${header.value.samples} samples${running.value ? "" : header.value.seconds ? `, ${header.value.seconds.toFixed(1)} s` : ", done"}` : ""}
            </span>
          }
        >
          {r.scene ? (
            <SceneBody picture={picture.current} a={developed.current} b={kept.current} dragging={dragging} />
          ) : (
            <div class="invite">
              <p>Choose a scene of the folder, or drop one here.</p>
              <FileList kinds={["scene"]} pick={(scene) => openScene(scene)} />
            </div>
          )}
        </ViewFrame>
        <div class="side">
          <Swaps ids={header.value?.materials ?? []} />
          <Inspector of={id.value} />
        </div>
      </div>
    </>
  );
}

const openScene = (scene: string) => edit({ scene, camera: null, swap: {} });

function RenderBar(props: { picture: ProgressivePicture<"render">; keep(): void; dropB(): void; hasB: boolean }) {
  const r = state.value.render;
  const operators = hello.value?.operators ?? [];
  const operator = operators.find((o) => choiceName(o) === r.operator);
  const parameters = typeof operator === "object" ? operator.parameters ?? [] : [];
  const file = useSignal("picture.exr");
  return (
    <div class="bar" role="toolbar" aria-label="Render">
      <Popover title="a scene of the folder" button="Scene…" id="choose-scene">
        {(close) => <FileList kinds={["scene"]} pick={(scene) => (openScene(scene), close())} />}
      </Popover>
      <Labelled label="by">
        <Select label="integrator" value={r.integrator} choices={(hello.value?.integrators ?? ["path"]).map((i) => ({ value: choiceName(i), title: typeof i === "object" ? i.summary : undefined }))} change={(integrator) => edit({ integrator })} />
      </Labelled>
      <Slider label="spp" value={r.samples} lo={1} hi={4096} whole title="samples a pixel" initial={256} change={(samples, g) => edit({ samples }, g)} />
      <Slider label="size" value={r.scale} lo={0.1} hi={2} title="scale of the film" initial={1} change={(scale, g) => edit({ scale }, g)} />
      <span class="gap" />
      <Labelled label="tone">
        <Select label="operator" value={r.operator} empty="gamma" choices={operators.map((o) => ({ value: choiceName(o), title: typeof o === "object" ? o.summary : undefined }))} change={(name) => edit({ operator: name, parameters: {} })} />
      </Labelled>
      <Slider id="render-exposure" label="EV" value={r.exposure} lo={-10} hi={10} initial={0} change={(exposure, g) => edit({ exposure }, g)} />
      {parameters.map((p) => {
        const initial = typeof p.initial === "number" ? p.initial : p.initial[0];
        return <Slider key={p.name} label={p.name} value={r.parameters[p.name] ?? initial} lo={p.lo} hi={p.hi} title={p.meaning} initial={initial} change={(v, g) => edit({ parameters: { ...r.parameters, [p.name]: v } }, g)} />;
      })}
      <span class="gap" />
      <button title="keep this picture as B, to compare what comes next with it" onClick={props.keep}>
        Keep as B
      </button>
      {props.hasB && (
        <button class="quiet" title="put B away" onClick={props.dropB}>
          <Icon name="close" />
        </button>
      )}
      <Popover title="save the picture in the folder" button="Save…" align="right" id="save-picture">
        {(close) => (
          <form
            class="line"
            onSubmit={(e) => {
              e.preventDefault();
              saveOnDisk(props.picture.id.value, file.value);
              close();
            }}
          >
            <input data-testid="save-name" value={file.value} onInput={(e) => (file.value = e.currentTarget.value)} title="ends in .exr or .png" />
            <button class="primary">Save</button>
          </form>
        )}
      </Popover>
      {r.camera && <button onClick={() => edit({ camera: null })}>Scene's camera</button>}
    </div>
  );
}

/// A .png is shown as on the page; its plain gamma is what the core calls clipping.
function saveOnDisk(of: number, file: string): void {
  const { operator, exposure, parameters } = state.value.render;
  core.ask("save", { of, file, operator: operator || "clip", exposure, parameters }).then(() => notify(`${file} saved`, "note"), complain);
}

/// The scene's materials: drop one of the list on a name, or on the picture.
function Swaps({ ids }: { ids: string[] }) {
  const { swap } = state.value.render;
  const over = useSignal("");
  if (!ids.length) return null;
  return (
    <section>
      <h2>Materials of the scene</h2>
      <p class="hint">Drag a material from the left onto one of these, or onto the picture.</p>
      <ul class="swaps">
        {ids.map((id) => (
          <li
            key={id}
            class={over.value === id ? "over" : ""}
            onDragOver={(e) => {
              if (!e.dataTransfer?.types.includes(dragType)) return;
              e.preventDefault();
              over.value = id;
            }}
            onDragLeave={() => (over.value = "")}
            onDrop={(e) => {
              e.preventDefault();
              over.value = "";
              swapMaterial(id, Number(e.dataTransfer?.getData(dragType)));
            }}
          >
            <span>{id}</span>
            <small>{swap[id]?.name ?? ""}</small>
            {swap[id] && (
              <button class="quiet" title="the scene's own again" onClick={() => edit({ swap: without(swap, id) })}>
                <Icon name="reset" />
              </button>
            )}
          </li>
        ))}
      </ul>
    </section>
  );
}

const without = <T,>(map: Record<string, T>, key: string): Record<string, T> =>
  Object.fromEntries(Object.entries(map).filter(([k]) => k !== key));

function swapMaterial(id: string, material: number): void {
  const found = state.value.materials.find((m) => m.id === material);
  if (found)
    change((s) => ({ ...s, render: { ...s.render, swap: { ...s.render.swap, [id]: { name: found.name, source: found.source } } } }));
}

function SceneBody(props: { picture: ProgressivePicture<"render">; a: Developed; b: Developed; dragging: { value: boolean } }) {
  const { a, b, picture } = props;
  const box = useRef<HTMLDivElement>(null);
  const register = useRegister();
  const convert = (image: FloatArray, out: ImageData) => {
    if (state.peek().render.operator) displayPixels(image.data, out.data);
    else toPixels(image.data, image.shape[1], out.data, state.peek().render.exposure, display.peek().gamma);
  };
  const depends = () => {
    state.value.render.exposure;
    display.value;
  };
  const setUp = (canvas: HTMLCanvasElement) => {
    const camera = (): Camera => state.peek().render.camera ?? picture.header.peek()?.camera ?? { target: [0, 0, 0], distance: 5, azimuth: 0, elevation: 20, fov: 40 };
    const stop = orbitControls(canvas, camera, (next, dragging) => {
      const now = JSON.stringify(camera());
      if (JSON.stringify(next) === now && !dragging) {
        props.dragging.value = false;
        return;
      }
      props.dragging.value = dragging;
      look({ render: { ...state.peek().render, camera: next } });
    });
    let down = { x: 0, y: 0 };
    canvas.addEventListener("pointerdown", (e) => (down = { x: e.clientX, y: e.clientY }));
    canvas.addEventListener("click", (e) => {
      if (Math.hypot(e.clientX - down.x, e.clientY - down.y) > 4) return;
      inspection.value = pixelUnder(canvas, e);
    });
    return stop;
  };
  const split = state.value.render.split;
  const shape = a.shown.value?.shape ?? [2, 3];
  return (
    <div
      class="canvas scene"
      ref={box}
      onDragOver={(e) => e.dataTransfer?.types.includes(dragType) && e.preventDefault()}
      onDrop={async (e) => {
        const material = Number(e.dataTransfer?.getData(dragType));
        if (!material) return;
        e.preventDefault();
        const pixel = pixelUnder(box.current!.querySelector("canvas")!, e);
        const seen = await core.ask("inspect", { of: picture.id.value, ...pixel });
        if (seen.material) swapMaterial(seen.material, material);
        else notify("Nothing is seen there whose material could be swapped.", "note");
      }}
    >
      <div class="fitted" style={{ "--aspect": shape[1] / shape[0] }}>
        <PictureCanvas image={a.shown} depends={depends} convert={convert} setUp={setUp} register={register} />
        {b.image.value && (
          <>
            <div class="under" style={{ clipPath: `inset(0 0 0 ${100 * split}%)` }}>
              <PictureCanvas image={b.shown} depends={depends} convert={convert} />
            </div>
            <SplitHandle split={split} />
          </>
        )}
        {inspection.value && a.shown.value && (
          <span class="cross" style={{ left: `${(100 * (inspection.value.x + 0.5)) / shape[1]}%`, top: `${(100 * (inspection.value.y + 0.5)) / shape[0]}%` }} />
        )}
      </div>
    </div>
  );
}

function pixelUnder(canvas: HTMLCanvasElement, e: MouseEvent): { x: number; y: number } {
  const r = canvas.getBoundingClientRect();
  const clamp = (v: number, n: number) => Math.min(n - 1, Math.max(0, Math.floor(v * n)));
  return { x: clamp((e.clientX - r.left) / r.width, canvas.width), y: clamp((e.clientY - r.top) / r.height, canvas.height) };
}

function SplitHandle({ split }: { split: number }) {
  const put = (x: number) => look({ render: { ...state.peek().render, split: Math.min(1, Math.max(0, x)) } });
  return (
    <div
      class="split"
      style={{ left: `${100 * split}%` }}
      role="slider"
      aria-label="between A and B"
      aria-valuenow={Math.round(100 * split)}
      tabIndex={0}
      onPointerDown={(e) => e.currentTarget.setPointerCapture(e.pointerId)}
      onPointerMove={(e) => {
        if (!e.currentTarget.hasPointerCapture(e.pointerId)) return;
        const r = e.currentTarget.parentElement!.getBoundingClientRect();
        put((e.clientX - r.left) / r.width);
      }}
      onKeyDown={(e) => {
        if (e.key === "ArrowLeft") put(split - 0.02);
        if (e.key === "ArrowRight") put(split + 0.02);
      }}
    >
      <b>A</b>
      <b>B</b>
    </div>
  );
}
