// Adding a material: a model by name, a text as on the command line, a file of the folder, an upload.

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { add, addModel, complain, files, hello } from "../core/session";
import type { FileEntry } from "../protocol";
import { Icon, Popover } from "../ui/controls";
import { takeFiles } from "./drop";

export function AddMaterial() {
  return (
    <Popover title="add a material (a)" button={<><Icon name="plus" /> Add</>} id="add-material">
      {(close) => <Chooser close={close} />}
    </Popover>
  );
}

function Chooser({ close }: { close(): void }) {
  const text = useSignal("");
  const tab = useSignal<"models" | "files">("models");
  const query = text.value.trim().toLowerCase();
  const isText = /[:+*=]/.test(query);
  const found = (hello.value?.models ?? []).filter(
    (m) => m.name.includes(query.replace(/ /g, "_")) || m.summary.toLowerCase().includes(query),
  );
  const enter = () => {
    if (isText) add({ text: text.value.trim() });
    else if (found.length) addModel((found.find((m) => m.name === query) ?? found[0]).name);
    else return;
    close();
  };
  return (
    <div class="chooser">
      <input
        class="search"
        ref={(e) => e?.focus()}
        placeholder="name, or model:parameter=value+model"
        value={text.value}
        data-testid="material-text"
        onInput={(e) => (text.value = e.currentTarget.value)}
        onKeyDown={(e) => {
          e.stopPropagation();
          if (e.key === "Enter") enter();
          if (e.key === "Escape") close();
        }}
      />
      <div class="segments">
        <button class={tab.value === "models" ? "on" : ""} onClick={() => (tab.value = "models")}>
          Models
        </button>
        <button class={tab.value === "files" ? "on" : ""} data-testid="tab-files" onClick={() => (tab.value = "files")}>
          Files
        </button>
        <label class="upload">
          Upload…
          <input type="file" multiple hidden onChange={(e) => (takeFiles([...(e.currentTarget.files ?? [])]), close())} />
        </label>
      </div>
      {isText ? (
        <button class="row" onClick={enter}>
          <b>{text.value}</b>
          <small>Enter adds this material</small>
        </button>
      ) : tab.value === "models" ? (
        <div class="choices">
          {found.map((m) => (
            <button key={m.name} class="row" onClick={() => (addModel(m.name), close())} title={m.source}>
              <b>{m.name}</b>
              <small>{m.summary}</small>
            </button>
          ))}
        </div>
      ) : (
        <FileList kinds={["measured", "brdf", "json"]} query={query} pick={(file) => (add({ file }), close())} />
      )}
    </div>
  );
}

/// The served folder, entered folder by folder.
export function FileList(props: { kinds: string[]; query?: string; pick(file: string, entry: FileEntry): void }) {
  const folder = useSignal("");
  const entries = useSignal<FileEntry[] | null>(null);
  useEffect(() => {
    let stale = false;
    files(folder.value).then((list) => !stale && (entries.value = list), complain);
    return () => {
      stale = true;
    };
  }, [folder.value]);
  const path = (name: string) => (folder.value ? `${folder.value}/${name}` : name);
  const wanted = (entries.value ?? []).filter(
    (e) => (e.is_folder || props.kinds.includes(e.kind ?? "")) && e.name.toLowerCase().includes(props.query ?? ""),
  );
  return (
    <div class="choices">
      {folder.value && (
        <button class="row" onClick={() => (folder.value = folder.value.replace(/\/?[^/]*$/, ""))}>
          <b>..</b>
          <small>{folder.value}</small>
        </button>
      )}
      {wanted.map((e) => (
        <button key={e.name} class="row" data-testid={`file-${e.name}`} onClick={() => (e.is_folder ? (folder.value = path(e.name)) : props.pick(path(e.name), e))}>
          <b>{e.is_folder ? `${e.name}/` : e.name}</b>
          <small>{e.is_folder ? "" : `${e.kind}, ${sizeText(e.size)}`}</small>
        </button>
      ))}
      {entries.value && wanted.length === 0 && <p class="hint">Nothing here that fits.</p>}
    </div>
  );
}

const sizeText = (bytes: number) =>
  bytes < 1e3 ? `${bytes} B` : bytes < 1e6 ? `${Math.round(bytes / 1e3)} kB` : `${Math.round(bytes / 1e6)} MB`;
