// The hand: pointers turn the view, pick objects, and drag what is picked over the floor.

import { add, cross, onPlane, ray, scale, sub, unit } from './maths.js';

const CLICK = 5;

export class Hand {
  constructor(canvas, scene, eye, on) {
    Object.assign(this, { canvas, scene, eye, on });
    this.pointers = new Map();
    this.selected = null;
    this.gesture = Math.floor(Math.random() * 2 ** 40);
    const listen = (name, act) => canvas.addEventListener(name, (event) => act.call(this, event), { passive: false });
    listen('pointerdown', this.down);
    listen('pointermove', this.move);
    listen('pointerup', this.up);
    listen('pointercancel', this.up);
    listen('wheel', this.wheel);
    listen('contextmenu', (event) => event.preventDefault());
  }

  /** The direction under a pointer. */
  direction({ clientX, clientY }) {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const [x, y] = [(2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height];
    return ray(this.eye.forward, this.eye.yfov, width / height, x, y);
  }

  pick(event) {
    return this.scene.about && this.scene.values ? this.scene.pick(this.eye.eye, this.direction(event)) : null;
  }

  select(node) {
    this.selected = node;
    this.on.selected(node);
  }

  down(event) {
    event.preventDefault();
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, event);
    if (this.pointers.size > 1) {
      this.drag = null;
      return;
    }
    const hit = this.pick(event);
    const isHeld = hit && this.selected !== null && this.scene.above(hit.object.node).includes(this.selected);
    this.start = { event, hit, far: 0 };
    const slides = event.button !== 0 || event.shiftKey;
    this.drag = isHeld && !slides ? { place: hit.place, gesture: ++this.gesture } : null;
    this.start.slides = slides;
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    this.pointers.set(event.pointerId, event);
    const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
    if (this.pointers.size > 1) {
      this.pinch(event, before);
    } else {
      this.start.far += Math.abs(x) + Math.abs(y);
      if (this.drag) this.carry(event);
      else if (this.start.slides) this.eye.slide(x / this.canvas.clientHeight, y / this.canvas.clientHeight);
      else this.eye.turn((x * (this.eye.walks ? -1 : 1)) / 250, (y * (this.eye.walks ? 1 : -1)) / 250);
    }
    this.on.moved();
  }

  /** Two fingers: nearer as they part, across as they go together. */
  pinch(event, before) {
    const other = [...this.pointers.values()].find((pointer) => pointer.pointerId !== event.pointerId);
    const apart = (a) => Math.hypot(a.clientX - other.clientX, a.clientY - other.clientY) || 1;
    this.eye.zoom(apart(before) / apart(event));
    const height = 2 * this.canvas.clientHeight;
    this.eye.slide((event.clientX - before.clientX) / height, (event.clientY - before.clientY) / height);
  }

  /** Where the hand has taken what it holds: level with where it took it, or across the view where that is seen edge on. */
  carry(event) {
    if (this.start.far < CLICK) return;
    const direction = this.direction(event);
    let at = onPlane(this.eye.eye, direction, this.drag.place[1]);
    if (!at || Math.abs(direction[1]) < 0.03) {
      const right = unit(cross(this.eye.forward, [0, 1, 0]));
      const { clientWidth: width } = this.canvas;
      at = add(this.drag.place, scale(right, (event.clientX - this.start.event.clientX) / width * 4));
    }
    const by = sub(at, this.drag.place);
    this.on.carried(this.selected, [by[0], 0, by[2]], this.drag.gesture);
  }

  up(event) {
    if (!this.pointers.delete(event.pointerId) || !this.start) return;
    if (event.type === 'pointerup' && this.start.far < CLICK && !this.start.slides && !this.pointers.size) {
      const { hit } = this.start;
      this.select(hit ? this.scene.meant(hit.object) : null);
    }
    this.drag = null;
    this.on.moved();
  }

  wheel(event) {
    event.preventDefault();
    this.eye.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 500))));
    this.on.moved();
  }
}
