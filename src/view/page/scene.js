// The scene as the page knows it: triangles in world coordinates, what is picked in them, and the state's values.

import { add, cross, dot, scale, sub } from './maths.js';

export class Scene {
  constructor() {
    this.about = null;
    this.mesh = null;
    this.values = null;
    this.corners = new Float32Array(0);
  }

  take(about) {
    this.about = about;
  }

  takeMesh(mesh) {
    this.mesh = mesh;
    this.corners = new Float32Array(9 * mesh.count);
  }

  takeCorners(runs) {
    for (const { first, values } of runs) this.corners.set(values, 9 * first);
  }

  /** The nearest triangle on a ray that faces the eye: its object, its place, and how far it is. */
  pick(eye, direction, only = () => true) {
    let best = null;
    this.about.objects.forEach((object, index) => {
      if (!this.isVisible(object) || !only(object)) return;
      const end = object.first + object.count;
      for (let k = object.first; k < end; k++) {
        const way = this.meet(k, eye, direction);
        if (way !== null && (!best || way < best.way)) best = { way, object, index };
      }
    });
    return best && { ...best, place: add(eye, scale(direction, best.way)) };
  }

  isVisible(object) {
    return !this.values || this.values.visible[object.node];
  }

  /** How far away a ray meets the front of a triangle; null if it does not. */
  meet(k, eye, direction) {
    const c = this.corners;
    const corner = (n) => [c[9 * k + 3 * n], c[9 * k + 3 * n + 1], c[9 * k + 3 * n + 2]];
    const a = corner(0);
    const [ab, ac] = [sub(corner(1), a), sub(corner(2), a)];
    const across = cross(direction, ac);
    const area = dot(ab, across);
    if (area <= 0) return null;
    const from = sub(eye, a);
    const u = dot(from, across) / area;
    if (u < 0 || u > 1) return null;
    const other = cross(from, ab);
    const v = dot(direction, other) / area;
    if (v < 0 || u + v > 1) return null;
    const way = dot(ac, other) / area;
    return way > 1e-4 ? way : null;
  }

  /** A node with all above it, the outermost first. */
  above(node) {
    const chain = [];
    for (let at = node; at !== null && at !== undefined; at = this.about.nodes[at].parent) chain.unshift(at);
    return chain;
  }

  /** The objects at and below a node. */
  below(node) {
    return this.about.objects.filter((object) => this.above(object.node).includes(node));
  }

  /** What a click means: the outermost node that holds less than half of all objects, else the object's own. */
  meant(object) {
    const all = this.about.objects.length;
    const chain = this.above(object.node);
    return chain.find((node) => 2 * this.below(node).length <= Math.max(all, 2)) ?? object.node;
  }

  /** The middle of a node's objects, on the floor that they stand on. */
  middle(node) {
    const [lo, hi] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const object of this.below(node)) {
      for (let k = 9 * object.first; k < 9 * (object.first + object.count); k++) {
        lo[k % 3] = Math.min(lo[k % 3], this.corners[k]);
        hi[k % 3] = Math.max(hi[k % 3], this.corners[k]);
      }
    }
    return Number.isFinite(lo[0]) ? [(lo[0] + hi[0]) / 2, lo[1], (lo[2] + hi[2]) / 2] : [0, 0, 0];
  }
}
