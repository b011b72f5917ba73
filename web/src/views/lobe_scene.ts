// The three.js scene of the 3-D lobes: surfaces, the light that can be dragged, the ground with its angles.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  CylinderGeometry,
  DirectionalLight,
  DoubleSide,
  LineBasicMaterial,
  LineLoop,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Sphere,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { orbitOffset } from "../ui/orbit";

const radians = Math.PI / 180;
export const lightDistance = 1.3;

export function direction(theta: number, phi: number): Vector3 {
  const s = Math.sin(theta * radians);
  return new Vector3(s * Math.cos(phi * radians), s * Math.sin(phi * radians), Math.cos(theta * radians));
}

export interface LobeShape {
  id: number;
  color: string;
  /// Radii [nTheta, nPhi] in [0, 1], both ends of both ranges included.
  radii: Float32Array;
  nTheta: number;
  nPhi: number;
  thetaMax: number;
}

export class LobeScene {
  readonly renderer: WebGLRenderer;
  private scene = new Scene();
  private camera = new PerspectiveCamera(32, 1, 0.05, 50);
  private lobes = new Map<number, { mesh: Mesh<BufferGeometry, MeshStandardMaterial>; key: string }>();
  private ground: LineSegments;
  private rings: LineLoop[] = [];
  private ray: Mesh<CylinderGeometry, MeshBasicMaterial>;
  private mirror: LineSegments;
  private viewer: LineSegments;
  private handle: Mesh<SphereGeometry, MeshBasicMaterial>;
  private raycaster = new Raycaster();

  constructor(canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.camera.up.set(0, 0, 1);
    const key = new DirectionalLight(0xffffff, 1.9);
    key.position.set(1, -2, 3);
    const fill = new DirectionalLight(0xffffff, 0.7);
    fill.position.set(-2, 1, 0.5);
    this.scene.add(new AmbientLight(0xffffff, 0.9), key, fill);
    const lines = (vertices: number[]) => {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(new Float32Array(vertices), 3));
      return new LineSegments(geometry, new LineBasicMaterial({ transparent: true }));
    };
    const spokes: number[] = [];
    for (let phi = 0; phi < 360; phi += 30) spokes.push(0, 0, 0, Math.cos(phi * radians), Math.sin(phi * radians), 0);
    this.ground = lines(spokes);
    this.scene.add(this.ground);
    const ring = (points: Vector3[]) => {
      const loop = new LineLoop(new BufferGeometry().setFromPoints(points), new LineBasicMaterial({ transparent: true }));
      this.rings.push(loop);
      this.scene.add(loop);
    };
    const steps = Array.from({ length: 96 }, (_, i) => (i / 96) * 360);
    for (const r of [0.5, 1]) ring(steps.map((phi) => direction(90, phi).multiplyScalar(r)));
    ring(steps.map((t) => direction(t, 0)));
    ring(steps.map((t) => direction(t, 90)));
    const rod = new CylinderGeometry(0.007, 0.007, lightDistance, 8);
    rod.translate(0, lightDistance / 2, 0);
    this.ray = new Mesh(rod, new MeshBasicMaterial());
    this.mirror = lines([0, 0, 0, 0, 0, 1]);
    this.viewer = lines([0, 0, 0, 0, 0, 1]);
    this.handle = new Mesh(new SphereGeometry(0.055, 20, 14), new MeshBasicMaterial());
    this.scene.add(this.ray, this.mirror, this.viewer, this.handle);
  }

  colors(grid: string, light: string, mark: string): void {
    for (const line of [this.ground, ...this.rings]) {
      const material = line.material as LineBasicMaterial;
      material.color.set(grid);
      material.opacity = 0.9;
    }
    (this.rings[2].material as LineBasicMaterial).opacity = 0.45;
    (this.rings[3].material as LineBasicMaterial).opacity = 0.45;
    this.ray.material.color.set(light);
    this.handle.material.color.set(light);
    (this.mirror.material as LineBasicMaterial).color.set(light);
    (this.mirror.material as LineBasicMaterial).opacity = 0.35;
    (this.viewer.material as LineBasicMaterial).color.set(mark);
  }

  directions(thetaI: number, phiI: number, thetaO: number, phiO: number): void {
    const put = (line: LineSegments, to: Vector3) => {
      const position = line.geometry.getAttribute("position") as BufferAttribute;
      position.setXYZ(1, to.x, to.y, to.z);
      position.needsUpdate = true;
      line.geometry.computeBoundingSphere();
    };
    const light = direction(thetaI, phiI).multiplyScalar(lightDistance);
    this.ray.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction(thetaI, phiI));
    this.handle.position.copy(light);
    put(this.mirror, direction(thetaI, phiI + 180).multiplyScalar(1.15));
    put(this.viewer, direction(thetaO, phiO).multiplyScalar(1.15));
  }

  show(shapes: LobeShape[]): void {
    const wanted = new Set(shapes.map((s) => s.id));
    for (const [id, { mesh }] of this.lobes)
      if (!wanted.has(id)) {
        this.scene.remove(mesh);
        mesh.geometry.dispose();
        mesh.material.dispose();
        this.lobes.delete(id);
      }
    for (const shape of shapes) this.place(shape, shapes.length);
  }

  private place(shape: LobeShape, count: number): void {
    const { nTheta, nPhi, thetaMax } = shape;
    const key = `${nTheta} ${nPhi} ${thetaMax}`;
    let lobe = this.lobes.get(shape.id);
    if (lobe && lobe.key !== key) {
      this.scene.remove(lobe.mesh);
      lobe.mesh.geometry.dispose();
      lobe = undefined;
    }
    if (!lobe) {
      const material = new MeshStandardMaterial({ roughness: 0.55, side: DoubleSide, transparent: true });
      lobe = { mesh: new Mesh(gridGeometry(nTheta, nPhi), material), key };
      this.lobes.set(shape.id, lobe);
      this.scene.add(lobe.mesh);
    }
    fillGrid(lobe.mesh.geometry, shape);
    lobe.mesh.material.color = new Color(shape.color);
    lobe.mesh.material.opacity = count > 1 ? 0.78 : 0.95;
  }

  look(camera: { azimuth: number; elevation: number; distance: number }): void {
    const narrow = Math.max(1, 1.05 / this.camera.aspect);
    this.camera.position.set(...orbitOffset({ ...camera, distance: camera.distance * narrow })).add(new Vector3(0, 0, 0.38));
    this.camera.lookAt(0, 0, 0.38);
  }

  size(width: number, height: number): void {
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  render(): void {
    this.renderer.render(this.scene, this.camera);
  }

  /// Does the point of the view (-1 to 1) lie on the light's handle?
  onHandle(x: number, y: number): boolean {
    this.raycaster.setFromCamera(new Vector2(x, y), this.camera);
    return this.raycaster.ray.distanceToPoint(this.handle.position) < 0.14;
  }

  /// The light's direction under a point of the view: on the hemisphere, else at its rim.
  lightAt(x: number, y: number): { theta_i: number; phi_i: number } {
    this.raycaster.setFromCamera(new Vector2(x, y), this.camera);
    const { ray } = this.raycaster;
    const origin = new Vector3();
    const hit = new Vector3();
    if (!ray.intersectSphere(new Sphere(origin, lightDistance), hit)) ray.closestPointToPoint(origin, hit);
    hit.z = Math.max(0, hit.z);
    const theta = Math.atan2(Math.hypot(hit.x, hit.y), hit.z) / radians;
    const phi = (Math.atan2(hit.y, hit.x) / radians + 360) % 360;
    return { theta_i: Math.round(theta * 10) / 10, phi_i: theta < 0.05 ? 0 : Math.round(phi * 10) / 10 };
  }

  dispose(): void {
    this.show([]);
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

function gridGeometry(nTheta: number, nPhi: number): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * nTheta * nPhi), 3));
  geometry.setAttribute("normal", new BufferAttribute(new Float32Array(3 * nTheta * nPhi), 3));
  const index: number[] = [];
  for (let t = 0; t + 1 < nTheta; ++t)
    for (let p = 0; p + 1 < nPhi; ++p) {
      const a = t * nPhi + p;
      index.push(a, a + nPhi, a + 1, a + 1, a + nPhi, a + nPhi + 1);
    }
  geometry.setIndex(index);
  geometry.boundingSphere = new Sphere(new Vector3(), 1.5);
  return geometry;
}

function fillGrid(geometry: BufferGeometry, { radii, nTheta, nPhi, thetaMax }: LobeShape): void {
  const position = geometry.getAttribute("position") as BufferAttribute;
  const normal = geometry.getAttribute("normal") as BufferAttribute;
  const p = position.array as Float32Array;
  const n = normal.array as Float32Array;
  for (let t = 0, o = 0; t < nTheta; ++t) {
    const theta = (thetaMax * radians * t) / (nTheta - 1);
    const sin = Math.sin(theta);
    const cos = Math.cos(theta);
    for (let f = 0; f < nPhi; ++f, o += 3) {
      const phi = (2 * Math.PI * f) / (nPhi - 1);
      const r = radii[t * nPhi + f] || 0;
      p[o] = r * sin * Math.cos(phi);
      p[o + 1] = r * sin * Math.sin(phi);
      p[o + 2] = r * cos;
    }
  }
  // Normals from the neighbours on the grid: its seam in phi closes upon itself.
  for (let t = 0, o = 0; t < nTheta; ++t) {
    const up = 3 * nPhi * (t > 0 ? -1 : 0);
    const down = 3 * nPhi * (t + 1 < nTheta ? 1 : 0);
    for (let f = 0; f < nPhi; ++f, o += 3) {
      const left = f > 0 ? -3 : 3 * (nPhi - 2);
      const right = f + 1 < nPhi ? 3 : -3 * (nPhi - 2);
      const ax = p[o + down] - p[o + up];
      const ay = p[o + down + 1] - p[o + up + 1];
      const az = p[o + down + 2] - p[o + up + 2];
      const bx = p[o + right] - p[o + left];
      const by = p[o + right + 1] - p[o + left + 1];
      const bz = p[o + right + 2] - p[o + left + 2];
      const x = ay * bz - az * by;
      const y = az * bx - ax * bz;
      const z = ax * by - ay * bx;
      const length = Math.hypot(x, y, z);
      if (length > 0) {
        n[o] = x / length;
        n[o + 1] = y / length;
        n[o + 2] = z / length;
      } else {
        n[o] = p[o];
        n[o + 1] = p[o + 1];
        n[o + 2] = 1;
      }
    }
  }
  position.needsUpdate = normal.needsUpdate = true;
}
