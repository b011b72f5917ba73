// An object under an environment, path traced while it is looked at.

import { useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import { toPixels } from "../core/color";
import { core, fileVersion, hello } from "../core/session";
import { type State, initialState } from "../core/state";
import { display, look, selected, set, state } from "../core/store";
import { FileList } from "../materials/add";
import { Check, Labelled, Popover, Segments, Select } from "../ui/controls";
import { orbitControls } from "../ui/orbit";
import { Slider } from "../ui/slider";
import { requestFor } from "../views/data";
import { ViewFrame, useRegister } from "../views/frame";
import { PictureCanvas, ProgressivePicture } from "./picture";

const meshes = ["teapot", "sphere", "plane"];
const environments = ["sky", "white"];
const samplings = [
  { value: "mis", label: "MIS", title: "both, weighed by the balance heuristic" },
  { value: "bsdf", label: "BRDF", title: "directions drawn from the material" },
  { value: "light", label: "Light", title: "directions drawn from the environment, by importance" },
];
const fewSamples = 64;

export function ObjectPane() {
  const picture = useRef<ProgressivePicture<"object">>();
  picture.current ??= new ProgressivePicture("object");
  const size = useSignal({ width: 0, height: 0 });
  const dragging = useSignal(false);
  useEffect(() => () => picture.current!.stop(), []);
  useSignalEffect(() => {
    const { mesh, environment, sampling, keep, turn, camera } = state.value.object;
    const material = selected.value;
    const { width, height } = size.value;
    core.generation.value;
    fileVersion.value;
    if (!hello.value || !material || width < 16 || height < 16) return;
    const coarse = dragging.value ? 3 : 1;
    picture.current!.show({
      material: requestFor(material),
      mesh,
      environment,
      sampling,
      turn,
      camera,
      width: Math.round(width / coarse),
      height: Math.round(height / coarse),
      samples: keep ? 0 : fewSamples,
    });
  });
  const { header, error, running } = picture.current;
  return (
    <>
      <ObjectBar />
      <div class="work single">
        <ViewFrame id="object" title={selected.value ? `Object of ${selected.value.name}` : "Object"} hint="drag to turn, wheel to near, Shift to move" error={error.value} canMaximise={false} options={<span class="count">{header.value ? `${header.value.samples} samples${running.value ? "" : ", done"}` : ""}</span>}>
          <ObjectBody picture={picture.current} size={size} dragging={dragging} />
          {!selected.value && <p class="view-note">Select a material.</p>}
        </ViewFrame>
      </div>
    </>
  );
}

const edit = (change: Partial<State["object"]>, gesture?: string) => set("object", change, gesture);
const options = (known: string[], value: string) => [...known, ...(known.includes(value) ? [] : [value])].map((v) => ({ value: v }));

function ObjectBar() {
  const o = state.value.object;
  const { exposure, gamma } = display.value;
  return (
    <div class="bar" role="toolbar" aria-label="Object">
      <Labelled label="mesh">
        <Select label="mesh" value={o.mesh} choices={options(meshes, o.mesh)} change={(mesh) => edit({ mesh })} />
        <Popover title="a mesh of the folder" button="…">
          {(close) => <FileList kinds={["mesh"]} pick={(mesh) => (edit({ mesh }), close())} />}
        </Popover>
      </Labelled>
      <Labelled label="light">
        <Select label="environment" value={o.environment} choices={options(environments, o.environment)} change={(environment) => edit({ environment })} />
        <Popover title="an environment of the folder" button="…">
          {(close) => <FileList kinds={["environment", "image"]} pick={(environment) => (edit({ environment }), close())} />}
        </Popover>
      </Labelled>
      <Slider label="turn" value={o.turn} lo={0} hi={360} unit="deg" title="turns the environment" change={(turn, g) => edit({ turn }, g)} />
      <Segments label="sampling" value={o.sampling} choices={samplings} change={(sampling) => edit({ sampling })} />
      <Check on={o.keep} label="keep sampling" title={`off: ${fewSamples} samples`} change={(keep) => edit({ keep })} />
      <Slider label="EV" value={exposure} lo={-6} hi={6} initial={0} change={(v, g) => set("display", { exposure: v }, g)} />
      <Slider label="γ" value={gamma} lo={1} hi={3} initial={2.2} change={(v, g) => set("display", { gamma: v }, g)} />
      <button onClick={() => edit({ camera: initialState.object.camera })}>Reset camera</button>
    </div>
  );
}

function ObjectBody(props: {
  picture: ProgressivePicture<"object">;
  size: { value: { width: number; height: number } };
  dragging: { value: boolean };
}) {
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const observer = new ResizeObserver(([entry]) => {
      const { width, height } = entry.contentRect;
      const shrink = Math.min(1, Math.sqrt(9e5 / Math.max(1, width * height)));
      props.size.value = { width: Math.round(width * shrink), height: Math.round(height * shrink) };
    });
    observer.observe(box.current!);
    return () => observer.disconnect();
  }, []);
  return (
    <div class="canvas stretched" ref={box}>
      <PictureCanvas
        image={props.picture.image}
        depends={() => display.value}
        convert={(image, out) => toPixels(image.data, image.shape[1], out.data, display.peek().exposure, display.peek().gamma)}
        register={useRegister()}
        setUp={(canvas) =>
          orbitControls(
            canvas,
            () => state.peek().object.camera,
            (camera, dragging) => {
              props.dragging.value = dragging;
              look({ object: { ...state.peek().object, camera } });
            },
          )
        }
      />
    </div>
  );
}

