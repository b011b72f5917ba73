// The pages: what each lets one touch, its formula, its source, and how it is drawn.

import type { Diagram } from "./diagrams";
import * as draw from "./diagrams";
import { abs, cos, d, dot, frac, i, integral, math, n, next, o, omega, par, row, sin, sq, sub, sup, theta } from "./formula";

export interface Handle {
  name: string;
  label: string;
  lo: number;
  hi: number;
  initial: number;
  unit?: string;
}

export interface Topic {
  id: string;
  title: string;
  text: string;
  formula: string;
  source: string;
  handles: Handle[];
  /// Choices by name: metals come from the core.
  choices?: { name: string; options: string[] | "metals"; initial: string }[];
  usesMaterial?: boolean;
  log?: boolean;
  /// The handle that the plot marks.
  mark?: string;
  diagram: Diagram;
}

const angle = (name: string, label: string, initial: number, hi = 90): Handle => ({ name, label, lo: 0, hi, initial, unit: "deg" });
const alpha: Handle = { name: "alpha", label: "α", lo: 0.02, hi: 1, initial: 0.4 };
const distribution = { name: "distribution", options: ["ggx", "beckmann"], initial: "ggx" };
const eq = o("=");

export const topics: Topic[] = [
  {
    id: "snell",
    title: "Snell's law",
    text: "Light that enters a denser medium bends towards the normal. Going out again, beyond the critical angle, none leaves: all is reflected. At Brewster's angle the reflected and the refracted ray are perpendicular, and what is reflected is fully polarised.",
    formula: math(sub(i("η"), i("i")), sin(theta("i")), eq, sub(i("η"), i("t")), sin(theta("t"))),
    source: "Born and Wolf, Principles of Optics, section 1.5.1",
    handles: [
      { name: "eta_i", label: "η of the light's side", lo: 1, hi: 3, initial: 1 },
      { name: "eta_t", label: "η of the other side", lo: 1, hi: 3, initial: 1.5 },
      angle("theta_i", "θi", 45),
    ],
    mark: "theta_i",
    diagram: draw.refraction,
  },
  {
    id: "fresnel",
    title: "Fresnel reflectance",
    text: "How much is reflected depends on the angle and on the polarisation. A metal absorbs what enters: its index is complex, and differs over the wavelengths, which is why gold is yellow. Towards grazing everything becomes a mirror.",
    formula: math(
      sub(i("R"), i("s")), eq, sq(abs(frac(row(sub(i("η"), i("i")), cos(theta("i")), o("−"), sub(i("η"), i("t")), cos(theta("t"))), row(sub(i("η"), i("i")), cos(theta("i")), o("+"), sub(i("η"), i("t")), cos(theta("t")))))),
      next,
      i("R"), eq, frac(row(sub(i("R"), i("s")), o("+"), sub(i("R"), i("p"))), n(2)),
    ),
    source: "Born and Wolf, sections 1.5.2 and 14.2; measured indices as listed in docs/sources.md",
    handles: [{ name: "eta", label: "η", lo: 1.01, hi: 3, initial: 1.5 }, angle("theta_i", "θi", 45)],
    choices: [{ name: "metal", options: "metals", initial: "" }],
    mark: "theta_i",
    diagram: draw.reflection,
  },
  {
    id: "lambert",
    title: "Lambert's cosine law",
    text: "A beam that meets the surface at a slant spreads over a larger area, so each part of it gets less: the cosine. A matte surface looks equally bright from everywhere: what it sends into a direction falls with the cosine, and so does the area that is seen.",
    formula: math(i("E"), eq, sub(i("E"), i("⟂")), cos(theta("i")), next, sub(i("L"), i("o")), eq, frac(i("ρ"), i("π")), i("E")),
    source: "Lambert 1760, Photometria",
    handles: [{ name: "reflectance", label: "ρ", lo: 0, hi: 1, initial: 0.8 }, angle("theta_i", "θi", 30)],
    mark: "theta_i",
    diagram: draw.beam,
  },
  {
    id: "inverse_square",
    title: "Inverse square",
    text: "The same light spreads over a sphere that grows with the square of the distance. It holds for points alone: near a lamp of some size the irradiance stays finite. Five radii away, the error is a few percent.",
    formula: math(i("E"), eq, frac(row(i("I"), cos(i("θ"))), sq(i("r"))), next, sub(i("E"), i("disk")), eq, frac(row(i("π"), i("L"), sq(i("a"))), row(sq(i("r")), o("+"), sq(i("a"))))),
    source: "Kepler 1604; the disk: Foote 1915, also Siegel and Howell, configuration factors",
    handles: [
      { name: "distance", label: "distance", lo: 0.1, hi: 10, initial: 2, unit: "m" },
      { name: "radius", label: "radius of the lamp", lo: 0.05, hi: 2, initial: 0.5, unit: "m" },
      angle("theta_i", "θi", 0, 89),
    ],
    mark: "distance",
    log: true,
    diagram: draw.spreading,
  },
  {
    id: "solid_angle",
    title: "Solid angle",
    text: "The area a thing covers on the unit sphere around the eye, in steradians: a hemisphere has 2π. Projected onto the surface, each part counts with its cosine, and the hemisphere has π. That is where the π of Lambert's ρ/π comes from.",
    formula: math(i("Ω"), eq, n(2), i("π"), par(row(n(1), o("−"), cos(i("θ")))), next, sup(i("Ω"), i("⟂")), eq, i("π"), sup(i("sin"), n(2)), i("θ")),
    source: "Nicodemus et al. 1977, Geometrical considerations and nomenclature for reflectance, section II",
    handles: [angle("half_angle", "half angle", 30)],
    mark: "half_angle",
    diagram: draw.cone,
  },
  {
    id: "radiance",
    title: "Radiance",
    text: "Power through an area, from a direction: per projected area and solid angle. Along a ray in clear air it does not change, so a lamp looks equally bright from near and from far. Only the solid angle it covers shrinks, and with it the irradiance.",
    formula: math(i("L"), eq, frac(row(sup(i("d"), n(2)), i("Φ")), row(d(sup(i("A"), i("⟂"))), d(i("ω")))), next, i("E"), eq, integral(i("Ω"), i("L"), cos(i("θ")), d(i("ω")))),
    source: "Nicodemus 1963, Radiance",
    handles: [
      { name: "radius", label: "radius of the lamp", lo: 0.05, hi: 2, initial: 0.5, unit: "m" },
      { name: "distance", label: "distance", lo: 0.2, hi: 10, initial: 2, unit: "m" },
      angle("theta_i", "θi", 0, 80),
    ],
    mark: "distance",
    diagram: draw.lamp,
  },
  {
    id: "ndf",
    title: "Microsurface and normals",
    text: "A rough surface is taken for many tiny mirrors. D says how much of their area faces each direction. Seen from above, the facets together cover exactly the flat area below them: D times the cosine integrates to one.",
    formula: math(integral(i("Ω"), i("D"), par(omega("m")), cos(theta("m")), d(omega("m")), eq, n(1)), next, sub(i("D"), i("GGX")), eq, frac(sq(i("α")), row(i("π"), sq(par(row(sup(i("cos"), n(2)), theta("m"), par(row(sq(i("α")), o("−"), n(1))), o("+"), n(1))))))),
    source: "Walter et al. 2007, eq. 4 and 33",
    handles: [alpha],
    choices: [distribution],
    diagram: draw.microsurface,
  },
  {
    id: "visible_normals",
    title: "Visible normals",
    text: "From the side one sees other facets than from above: those that face the viewer. Sampling these, not all, wastes no light on facets that are hidden, which is why modern renderers do it.",
    formula: math(sub(i("D"), omega("o")), par(omega("m")), eq, frac(row(sub(i("G"), n(1)), par(omega("o")), sup(dot(omega("o"), omega("m")), o("+")), i("D"), par(omega("m"))), cos(theta("o")))),
    source: "Heitz 2014, eq. 16; Heitz and d'Eon 2014",
    handles: [alpha, angle("theta_o", "θo", 60, 89)],
    choices: [distribution],
    diagram: draw.seenFacets,
  },
  {
    id: "masking",
    title: "Masking",
    text: "G1 is the share of facets facing the viewer that no other facet hides. Smith's comes from a surface whose heights and slopes have nothing to do with each other; the V-cavity's from parallel grooves, and has a kink.",
    formula: math(sub(i("G"), n(1)), par(omega("o")), eq, frac(n(1), row(n(1), o("+"), i("Λ"), par(omega("o")))), next, sub(i("Λ"), i("GGX")), eq, frac(row(o("−"), n(1), o("+"), `<msqrt>${row(n(1), o("+"), sq(i("α")), sup(i("tan"), n(2)), theta("o"))}</msqrt>`), n(2))),
    source: "Smith 1967; Heitz 2014, eq. 43 and 72; V-cavities: Cook and Torrance 1982, eq. 3",
    handles: [alpha, angle("theta_o", "θo", 70, 89)],
    choices: [distribution],
    mark: "theta_o",
    diagram: draw.seenFacets,
  },
  {
    id: "projected_area",
    title: "Projected area is conserved",
    text: "However rough, the surface covers the same area of the view as the flat one beneath. This one condition ties masking to the distribution: a G1 that breaks it makes or loses light.",
    formula: math(integral(i("Ω"), sub(i("G"), n(1)), par(row(omega("o"), o(","), omega("m"))), sup(dot(omega("o"), omega("m")), o("+")), i("D"), par(omega("m")), d(omega("m")), eq, cos(theta("o")))),
    source: "Heitz 2014, eq. 14",
    handles: [alpha, angle("theta_o", "θo", 60, 89)],
    choices: [distribution],
    mark: "theta_o",
    diagram: draw.areas,
  },
  {
    id: "multiple_bounces",
    title: "Energy lost, and many bounces",
    text: "Light that a facet sends into another facet is lost to a model of one bounce: rough metal grows too dark. Following all bounces brings it back, and more of its colour with it, since each bounce colours again.",
    formula: math(i("E"), par(omega("o")), eq, integral(i("Ω"), i("f"), cos(theta("i")), d(omega("i"))), o("≤"), n(1)),
    source: "Heitz et al. 2016, Multiple-scattering microfacet BSDFs; Kulla and Conty 2017",
    handles: [{ ...alpha, initial: 0.8 }],
    choices: [{ name: "metal", options: "metals", initial: "Cu" }],
    diagram: draw.bounces,
  },
  {
    id: "furnace",
    title: "White furnace",
    text: "A sphere of the selected material under a uniform white sky. If it reflects all light, it cannot be seen; where it is darker it absorbs or loses light, and where it is brighter than the sky it makes some, which nothing may.",
    formula: math(sub(i("L"), i("o")), eq, integral(i("Ω"), i("f"), par(row(omega("i"), o(","), omega("o"))), cos(theta("i")), d(omega("i")))),
    source: "Heitz 2014, section 5.3 (the weak furnace); Kulla and Conty 2017",
    handles: [],
    usesMaterial: true,
    diagram: draw.furnace,
  },
];
