// Length of a lobe's point: the value over the largest, or its logarithm over four decades.

export const logDecades = 4;

export function radius(value: number, largest: number, log: boolean): number {
  if (!(value > 0) || !(largest > 0)) return 0;
  const share = value / largest;
  return Math.min(1, log ? Math.max(0, 1 + Math.log10(share) / logDecades) : share);
}

/// A round number not below x: 1, 2 or 5 times a power of ten.
export function roundUp(x: number): number {
  if (!(x > 0) || !Number.isFinite(x)) return 1;
  const power = 10 ** Math.floor(Math.log10(x));
  const m = x / power;
  return (m <= 1.0001 ? 1 : m <= 2.0001 ? 2 : m <= 5.0001 ? 5 : 10) * power;
}
