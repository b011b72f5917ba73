// A parameter's range on a slider: linear, or logarithmic where it spans more than three decades.

export interface Scale {
  toValue(t: number): number;
  toPosition(value: number): number;
}

const finite = (x: number | null, fallback: number) => (x === null || !Number.isFinite(x) ? fallback : x);

export function sliderScale(lo: number, hi: number): Scale {
  const a = finite(lo, -100);
  const b = finite(hi, 100);
  if (a > 0 && b / a > 1000.5) {
    const ratio = Math.log(b / a);
    return { toValue: (t) => a * Math.exp(t * ratio), toPosition: (v) => Math.log(Math.max(v, a) / a) / ratio };
  }
  return { toValue: (t) => a + t * (b - a), toPosition: (v) => (b > a ? (v - a) / (b - a) : 0) };
}

/// Four significant digits, without trailing zeros.
export function tidy(value: number): string {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "–" : value > 0 ? "∞" : "-∞";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-4)) return value.toExponential(2).replace("e+", "e");
  return String(Number(value.toPrecision(4)));
}

/// A slider's values are shown short, so they are made short: to a thousandth of the range.
export function snapped(value: number, lo: number, hi: number): number {
  const span = Math.abs(finite(hi, 100) - finite(lo, -100)) || 1;
  const nearby = Math.min(span, Math.abs(value) || span);
  const digits = Math.max(0, Math.min(8, 3 - Math.floor(Math.log10(nearby))));
  return Math.min(finite(hi, Infinity), Math.max(finite(lo, -Infinity), Number(value.toFixed(digits))));
}
