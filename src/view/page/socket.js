// The protocol: JSON texts both ways, binary messages with the mesh and with what changed of a state.

const MESH = 1;
const STATE = 2;
const PICTURE = 3;

/** A connection to the program; `on` has a function for each kind of message. */
export class Socket {
  constructor(on) {
    this.on = on;
    this.next = 1;
    this.answers = new Map();
    this.bytes = 0;
    const address = new URL('/socket', location.href);
    address.protocol = 'ws:';
    address.search = location.search;
    this.socket = new WebSocket(address);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onmessage = ({ data }) => this.hear(data);
    this.socket.onclose = () => on.closed();
  }

  /** Sends a message, and gives its number. */
  send(message) {
    const id = this.next++;
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ ...message, id }));
    return id;
  }

  /** Sends a message, and waits for its answer. */
  ask(message) {
    return new Promise((resolve, reject) => this.answers.set(this.send(message), { resolve, reject }));
  }

  settle(id, how, value) {
    const waiting = this.answers.get(id);
    this.answers.delete(id);
    if (waiting) waiting[how](value);
    return Boolean(waiting);
  }

  hear(data) {
    if (typeof data === 'string') return this.hearText(JSON.parse(data));
    const words = new DataView(data);
    const kind = words.getUint32(0, true);
    if (kind === MESH) this.on.mesh(readMesh(data));
    if (kind === PICTURE) this.settle(words.getUint32(4, true), 'resolve', data.slice(8));
    if (kind === STATE) {
      this.bytes = data.byteLength;
      this.on.state(readState(data));
    }
    return undefined;
  }

  hearText(text) {
    if (text.scene) return this.on.scene(text.scene);
    if (text.opening) return this.on.opening(text.opening);
    if (text.error) return this.settle(text.id, 'reject', new Error(text.error)) || this.on.error(text.error);
    if (text.rendered) return this.on.rendered(text.rendered);
    if (text.revision) return this.on.account(text, this.bytes);
    return this.settle(text.id, 'resolve', text);
  }
}

/** The triangles: welded vertices and texture coordinates of corners, sides, colours of corners, and glow. */
function readMesh(data) {
  const [, epoch, count, vertices, sides] = new Uint32Array(data, 0, 5);
  let at = 20;
  const take = (Kind, length) => {
    const array = new Kind(data, at, length);
    at += array.byteLength;
    return array;
  };
  return {
    epoch, count, vertices, sides,
    vertex: take(Uint32Array, 3 * count), side: take(Uint32Array, count),
    texcoord: take(Float32Array, 6 * count), tint: take(Uint8Array, 12 * count), glow: take(Uint8Array, 4 * count),
  };
}

/** Runs of corners, of light and of heat that differ from what was sent before. */
function readState(data) {
  let at = 12;
  const list = (Kind, width) => {
    const [runs] = new Uint32Array(data, at, 1);
    const places = new Uint32Array(data, at + 4, 2 * runs);
    at += 4 + 8 * runs;
    const found = [];
    for (let k = 0; k < runs; k++) {
      const values = new Kind(data, at, places[2 * k + 1] * width);
      at += values.byteLength;
      found.push({ first: places[2 * k], values });
    }
    at = Math.ceil(at / 4) * 4;
    return found;
  };
  return { corners: list(Float32Array, 9), light: list(Uint16Array, 4), heat: list(Uint8Array, 1) };
}
