// Saving what a view shows as a PNG with its title and the names of its materials.

import { notify } from "../core/session";
import { onView } from "./data";

export const captures = new Map<string, { title: string; canvas(): HTMLCanvasElement | undefined }>();

export function download(name: string, content: Blob | string): void {
  const url = URL.createObjectURL(typeof content === "string" ? new Blob([content], { type: "text/plain" }) : content);
  const anchor = document.createElement("a");
  anchor.href = url;
  anchor.download = name;
  anchor.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/// The view's canvas below its title, above the legend, on the page's ground.
export function composed(id: string): HTMLCanvasElement | undefined {
  const capture = captures.get(id);
  const source = capture?.canvas();
  if (!capture || !source?.width) return undefined;
  const em = 16 * Math.max(1, devicePixelRatio);
  const style = getComputedStyle(document.documentElement);
  const result = document.createElement("canvas");
  result.width = source.width;
  result.height = source.height + Math.round(3.4 * em);
  const c = result.getContext("2d")!;
  c.fillStyle = style.getPropertyValue("--panel").trim();
  c.fillRect(0, 0, result.width, result.height);
  c.drawImage(source, 0, Math.round(1.8 * em));
  const family = getComputedStyle(document.body).fontFamily;
  c.textBaseline = "middle";
  c.fillStyle = style.getPropertyValue("--text").trim();
  c.font = `600 ${0.9 * em}px ${family}`;
  c.fillText(capture.title, 0.6 * em, 0.95 * em);
  c.font = `${0.75 * em}px ${family}`;
  let x = 0.6 * em;
  const y = result.height - 0.8 * em;
  for (const { name, color } of onView()) {
    c.fillStyle = color;
    c.fillRect(x, y - 0.3 * em, 0.6 * em, 0.6 * em);
    c.fillStyle = style.getPropertyValue("--text").trim();
    c.fillText(name, x + 0.85 * em, y);
    x += 1.7 * em + c.measureText(name).width;
  }
  return result;
}

export function saveView(id: string): void {
  const canvas = composed(id);
  if (!canvas) return notify("this view has nothing to save yet", "note");
  canvas.toBlob((blob) => blob && download(`nacre-${id}.png`, blob), "image/png");
}
