// The eye: it goes around a point, or walks over the floor at the height of a standing person.

import { add, cross, length, scale, sub, unit } from './maths.js';

const EYE_HEIGHT = 1.6;
const STEEPEST = 1.54;

export class Eye {
  constructor() {
    this.eye = [0, 1, 5];
    this.at = [0, 1, 0];
    this.yfov = 0.8;
    this.walks = false;
    this.keys = new Set();
  }

  get forward() {
    return unit(sub(this.at, this.eye));
  }

  /** Looks as a camera does; `far` is how far away the point is that the eye then goes around. */
  look({ eye, forward, degrees }, far) {
    this.eye = eye;
    this.at = add(eye, scale(forward, far));
    this.yfov = (degrees * Math.PI) / 180;
  }

  angles() {
    const [x, y, z] = this.forward;
    return [Math.atan2(x, -z), Math.asin(Math.max(-1, Math.min(1, y)))];
  }

  /** Turns by angles, about the point in orbit and about the eye in a walk. */
  turn(yaw, pitch) {
    const [a, b] = this.angles();
    const [turn, rise] = [a + yaw, Math.max(-STEEPEST, Math.min(STEEPEST, b + pitch))];
    const forward = [Math.sin(turn) * Math.cos(rise), Math.sin(rise), -Math.cos(turn) * Math.cos(rise)];
    const far = length(sub(this.at, this.eye));
    if (this.walks) this.at = add(this.eye, scale(forward, far));
    else this.eye = sub(this.at, scale(forward, far));
  }

  /** Moves eye and point across the view, in heights of the picture. */
  slide(x, y) {
    const far = length(sub(this.at, this.eye));
    const right = unit(cross(this.forward, [0, 1, 0]));
    const up = cross(right, this.forward);
    const reach = 2 * far * Math.tan(this.yfov / 2);
    const way = add(scale(right, -x * reach), scale(up, y * reach));
    [this.eye, this.at] = [add(this.eye, way), add(this.at, way)];
  }

  /** Goes nearer, or, in a walk, forward. */
  zoom(factor) {
    const way = sub(this.at, this.eye);
    if (this.walks) {
      const step = scale(this.forward, (1 - factor) * 2);
      [this.eye, this.at] = [add(this.eye, step), add(this.at, step)];
    } else {
      this.eye = sub(this.at, scale(way, Math.max(factor, 0.02 / length(way))));
    }
  }

  /** Walks by the keys that are down; `floor` gives the height of the floor below a point. Tells whether the eye moved. */
  step(seconds, floor) {
    const key = (...names) => (names.some((name) => this.keys.has(name)) ? 1 : 0);
    const ahead = key('KeyW', 'ArrowUp') - key('KeyS', 'ArrowDown');
    const aside = key('KeyD', 'ArrowRight') - key('KeyA', 'ArrowLeft');
    if (!ahead && !aside) return false;
    const level = unit([this.forward[0], 0, this.forward[2]]);
    const right = cross(level, [0, 1, 0]);
    const speed = (this.keys.has('ShiftLeft') ? 4 : 1.6) * seconds;
    const way = add(scale(level, ahead * speed), scale(right, aside * speed));
    this.move(way);
    if (this.walks) this.stand(floor);
    return true;
  }

  move(way) {
    [this.eye, this.at] = [add(this.eye, way), add(this.at, way)];
  }

  /** Stands on the floor. */
  stand(floor) {
    const height = floor(this.eye);
    if (height !== null) this.move([0, height + EYE_HEIGHT - this.eye[1], 0]);
  }
}
