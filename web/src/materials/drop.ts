// Files dropped on the page: sessions and .brdf files are read here, the rest is uploaded.

import { upload } from "../connection";
import { add, complain, notify } from "../core/session";
import { change, set, state } from "../core/store";
import { readSession } from "../core/url";

export async function takeFiles(list: File[]): Promise<void> {
  for (const file of list)
    try {
      await takeFile(file);
    } catch (error) {
      complain(error);
    }
}

async function takeFile(file: File): Promise<void> {
  const ending = file.name.toLowerCase().replace(/^.*\./, "");
  if (ending === "json" && file.size < 4e6) {
    const text = await file.text();
    if (/"nacre"\s*:\s*1\b/.test(text)) {
      const session = readSession(text);
      return change(() => session);
    }
  }
  if (ending === "brdf") return add({ brdf: { name: file.name, source: await file.text() } });
  notify(`uploading ${file.name}`, "note");
  const name = await upload(file.name, file);
  if (["exr", "hdr"].includes(ending)) {
    set("object", { environment: name });
    return notify(`${name} lights the object`, "note");
  }
  if (["obj", "ply", "gltf", "glb"].includes(ending)) {
    set("object", { mesh: name });
    return notify(`${name} is the object`, "note");
  }
  if (ending === "xml") return change(() => ({ ...state.value, pane: "render", render: { ...state.value.render, scene: name } }));
  return add({ file: name });
}

/// Lets the whole page take files.
export function acceptDrops(target: HTMLElement): void {
  const hasFiles = (e: DragEvent) => e.dataTransfer?.types.includes("Files");
  target.addEventListener("dragover", (e) => {
    if (!hasFiles(e)) return;
    e.preventDefault();
    target.classList.add("dropping");
  });
  for (const name of ["dragleave", "drop", "dragend"] as const)
    target.addEventListener(name, (e) => {
      if (name === "dragleave" && (e as DragEvent).relatedTarget) return;
      target.classList.remove("dropping");
    });
  target.addEventListener("drop", (e) => {
    if (!hasFiles(e)) return;
    e.preventDefault();
    takeFiles([...(e.dataTransfer?.files ?? [])]);
  });
}
