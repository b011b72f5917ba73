// Formulas as MathML, from a few builders: i for names, n for numbers, row, frac, sub, sup, ...

type Part = string;

export const i = (name: string): Part => `<mi>${name}</mi>`;
export const n = (number: string | number): Part => `<mn>${number}</mn>`;
export const o = (operator: string): Part => `<mo>${operator}</mo>`;
export const v = (name: string): Part => `<mi mathvariant="bold">${name}</mi>`;
export const row = (...parts: Part[]): Part => `<mrow>${parts.join("")}</mrow>`;
export const frac = (a: Part, b: Part): Part => `<mfrac>${row(a)}${row(b)}</mfrac>`;
export const sub = (a: Part, b: Part): Part => `<msub>${row(a)}${row(b)}</msub>`;
export const sup = (a: Part, b: Part): Part => `<msup>${row(a)}${row(b)}</msup>`;
export const sq = (a: Part): Part => sup(a, n(2));
const fence = `<mo fence="true" stretchy="true">|</mo>`;
export const abs = (a: Part): Part => row(fence, a, fence);
export const par = (a: Part): Part => row(o("("), a, o(")"));
export const integral = (over: Part, ...body: Part[]): Part => row(`<msub><mo>∫</mo>${row(over)}</msub>`, ...body);
export const cos = (a: Part): Part => row(i("cos"), o("&#x2061;"), a);
export const sin = (a: Part): Part => row(i("sin"), o("&#x2061;"), a);
export const tan = (a: Part): Part => row(i("tan"), o("&#x2061;"), a);
export const theta = (index: string): Part => sub(i("θ"), i(index));
export const omega = (index: string): Part => sub(v("ω"), i(index));
export const d = (a: Part): Part => row(i("d"), a);
export const dot = (a: Part, b: Part): Part => row(o("⟨"), a, o(","), b, o("⟩"));
/// Between two formulas: each stands on a line of its own.
export const next: Part = "\n";
export const math = (...parts: Part[]): string =>
  parts
    .join("")
    .split(next)
    .map((formula) => `<math display="block">${row(formula)}</math>`)
    .join("");
