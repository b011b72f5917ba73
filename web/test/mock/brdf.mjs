// Reflectance simple enough to stand in for the core while the page is looked at: Lambert, Oren-Nayar's shape, GGX.

const rad = Math.PI / 180;

export const direction = (theta, phi) => [
  Math.sin(theta * rad) * Math.cos(phi * rad),
  Math.sin(theta * rad) * Math.sin(phi * rad),
  Math.cos(theta * rad),
];

export const parameters = {
  lambert: [color("reflectance", 0.5, "directional albedo")],
  oren_nayar: [color("reflectance", 0.5, "albedo of the facets"), number("sigma", 0.3, 0, 1.5, "deviation of facet slopes", "rad")],
  ggx_schlick: [color("f0", 0.04, "reflectance at normal incidence"), number("alpha", 0.2, 0.001, 1, "roughness")],
  ggx_plastic: [
    color("reflectance", 0.5, "albedo of the base"),
    number("eta", 1.5, 1, 3, "index of refraction"),
    number("alpha", 0.1, 0.001, 1, "roughness"),
    { ...number("nonlinear", 0, 0, 1, "colour shifts by inner reflections"), is_switch: true },
  ],
  ggx_conductor: [
    color("eta", 1, "real part of the index", 0.01, 20),
    color("k", 6, "imaginary part of the index", 0, 30),
    number("alpha_x", 0.2, 0.001, 1, "roughness along x"),
    number("alpha_y", 0.2, 0.001, 1, "roughness along y"),
  ],
};

function number(name, initial, lo, hi, meaning, unit = "1") {
  return { name, unit, meaning, lo, hi, initial, is_color: false, is_switch: false };
}
function color(name, initial, meaning, lo = 0, hi = 1) {
  return { ...number(name, initial, lo, hi, meaning), is_color: true };
}

const rgb = (v) => (typeof v === "number" ? [v, v, v] : v);

/// A material of the protocol as a list of lobes with all values.
export function lobesOf(material) {
  if (material.lobes) return material.lobes;
  if (material.file) return [{ model: "ggx_schlick", weight: 1, parameters: { f0: [0.4, 0.25, 0.08], alpha: 0.28 } }];
  if (material.brdf) return [{ model: "ggx_schlick", weight: 1, parameters: { f0: 0.5, alpha: material.values?.alpha ?? 0.1 } }];
  return material.text.split("+").map((text) => {
    const [model, list = ""] = text.split(":");
    if (!parameters[model]) throw new Error(`unknown model '${model}'`);
    const given = Object.fromEntries(
      list.split(",").filter(Boolean).map((pair) => {
        const [k, v] = pair.split("=");
        return [k, v.includes("/") ? v.split("/").map(Number) : Number(v)];
      }),
    );
    const values = Object.fromEntries(
      parameters[model].map((p) => [p.name, p.is_color ? rgb(given[p.name] ?? p.initial) : given[p.name] ?? p.initial]),
    );
    return { model, weight: 1, parameters: values };
  });
}

export const ggxD = (cos, a) => {
  const c2 = cos * cos;
  const t = c2 * (a * a - 1) + 1;
  return cos > 0 ? (a * a) / (Math.PI * t * t) : 0;
};
export const smithG1 = (cos, a) => {
  const t2 = (1 - cos * cos) / Math.max(1e-9, cos * cos);
  return 2 / (1 + Math.sqrt(1 + a * a * t2));
};

/// f of all lobes, added to out[o..o+2].
export function evaluate(lobes, wi, wo, out, o) {
  out[o] = out[o + 1] = out[o + 2] = 0;
  if (wi[2] <= 1e-4 || wo[2] <= 1e-4) return;
  for (const { model, weight = 1, parameters: p } of lobes) {
    if (model === "lambert" || model === "oren_nayar" || model === "ggx_plastic") {
      const r = rgb(p.reflectance ?? 0.5);
      let shape = 1;
      if (model === "oren_nayar") {
        const s2 = p.sigma * p.sigma;
        const s = wi[0] * wo[0] + wi[1] * wo[1];
        const t = s > 0 ? Math.max(wi[2], wo[2]) : 1;
        shape = 1 - (0.5 * s2) / (s2 + 0.33) + ((0.45 * s2) / (s2 + 0.09)) * (s / t) * (s > 0 ? 1 : 0);
      }
      for (let c = 0; c < 3; ++c) out[o + c] += (rgb(weight)[c] * r[c] * shape) / Math.PI;
    }
    if (model.startsWith("ggx")) {
      const h = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
      const n = Math.hypot(...h);
      const alpha = p.alpha ?? p.alpha_x ?? 0.2;
      const f0 =
        model === "ggx_plastic"
          ? rgb(((p.eta - 1) / (p.eta + 1)) ** 2)
          : model === "ggx_conductor"
            ? rgb(p.k).map((k, c) => ((rgb(p.eta)[c] - 1) ** 2 + k * k) / ((rgb(p.eta)[c] + 1) ** 2 + k * k))
            : rgb(p.f0);
      const cosD = (wi[0] * h[0] + wi[1] * h[1] + wi[2] * h[2]) / n;
      const common = (ggxD(h[2] / n, alpha) * smithG1(wi[2], alpha) * smithG1(wo[2], alpha)) / (4 * wi[2] * wo[2]);
      for (let c = 0; c < 3; ++c) out[o + c] += rgb(weight)[c] * common * (f0[c] + (1 - f0[c]) * (1 - cosD) ** 5);
    }
  }
}

/// Directional albedo by quadrature.
export function albedo(lobes, theta, out, o) {
  const wi = direction(Math.min(theta, 89), 0);
  const f = new Float32Array(3);
  out[o] = out[o + 1] = out[o + 2] = 0;
  const nt = 40;
  const np = 40;
  for (let i = 0; i < nt; ++i)
    for (let j = 0; j < np; ++j) {
      const t = ((i + 0.5) / nt) * 90;
      evaluate(lobes, wi, direction(t, ((j + 0.5) / np) * 360), f, 0);
      const w = Math.cos(t * rad) * Math.sin(t * rad) * ((90 * rad) / nt) * ((2 * Math.PI) / np);
      for (let c = 0; c < 3; ++c) out[o + c] += f[c] * w;
    }
}

const rotate = (v, k, a) => {
  const c = Math.cos(a);
  const s = Math.sin(a);
  const d = v[0] * k[0] + v[1] * k[1] + v[2] * k[2];
  const x = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
  return v.map((_, i) => v[i] * c + x[i] * s + k[i] * d * (1 - c));
};

/// Light and viewer from half and difference angles (Rusinkiewicz 1998).
export function fromHalf(thetaH, thetaD, phiD) {
  const wi = rotate(direction(thetaD, phiD), [0, 1, 0], thetaH * rad);
  const h = direction(thetaH, 0);
  const d = wi[0] * h[0] + wi[1] * h[1] + wi[2] * h[2];
  return [wi, h.map((x, i) => 2 * d * x - wi[i])];
}
