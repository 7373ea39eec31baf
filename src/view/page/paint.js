// WebGL 2: buffers of triangles, light in a texture that grows by what changed, one draw for each object.

import { FRAGMENT, VERTEX } from './shaders.js';

const WIDTH = 2048;
const UNIFORMS = ['view', 'light', 'heat', 'picture', 'textured', 'unlit', 'selected', 'base', 'emitted', 'mean', 'exposure',
  'opacity', 'cutoff', 'most', 'curve', 'overlay', 'object'];

export class Paint {
  constructor(canvas) {
    this.gl = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: true });
    if (!this.gl) throw new Error('this browser has no WebGL 2');
    this.program = this.link();
    this.uniform = Object.fromEntries(UNIFORMS.map((name) => [name, this.gl.getUniformLocation(this.program, name)]));
    this.pictures = [];
    this.mean = [0, 0, 0];
  }

  link() {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }

  /** A buffer of an attribute; whole numbers stay whole in the shader if `whole`. */
  attribute(name, data, width, kind, { whole = false, use = this.gl.STATIC_DRAW } = {}) {
    const { gl } = this;
    const at = gl.getAttribLocation(this.program, name);
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, use);
    if (at < 0) return buffer;
    gl.enableVertexAttribArray(at);
    if (whole) gl.vertexAttribIPointer(at, width, kind, 0, 0);
    else gl.vertexAttribPointer(at, width, kind, kind === gl.UNSIGNED_BYTE, 0, 0);
    return buffer;
  }

  takeMesh(mesh) {
    const { gl } = this;
    this.vertices = gl.createVertexArray();
    gl.bindVertexArray(this.vertices);
    const thrice = (from, width, Kind) => {
      const to = new Kind(3 * width * mesh.count);
      for (let k = 0; k < 3 * mesh.count; k++) {
        const source = Math.floor(k / 3) * width;
        for (let n = 0; n < width; n++) to[k * width + n] = from[source + n];
      }
      return to;
    };
    this.positions = this.attribute('position', new Float32Array(9 * mesh.count), 3, gl.FLOAT, { use: gl.DYNAMIC_DRAW });
    this.attribute('vertex', mesh.vertex, 1, gl.UNSIGNED_INT, { whole: true });
    this.attribute('side', thrice(mesh.side, 1, Uint32Array), 1, gl.UNSIGNED_INT, { whole: true });
    this.attribute('texcoord', mesh.texcoord, 2, gl.FLOAT);
    this.attribute('tint', mesh.tint, 4, gl.UNSIGNED_BYTE);
    this.attribute('glow', thrice(mesh.glow, 4, Uint8Array), 4, gl.UNSIGNED_BYTE);
    this.light = this.table(mesh.vertices, gl.RGBA16F, gl.RGBA, gl.HALF_FLOAT, Uint16Array, 4);
    this.heat = this.table(mesh.sides, gl.R8, gl.RED, gl.UNSIGNED_BYTE, Uint8Array, 1);
  }

  /** A texture that is read as a list. */
  table(count, inner, format, kind, Kind, width) {
    const { gl } = this;
    const rows = Math.max(1, Math.ceil(count / WIDTH));
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    const data = new Kind(WIDTH * rows * width);
    gl.texImage2D(gl.TEXTURE_2D, 0, inner, WIDTH, rows, 0, format, kind, data);
    return { texture, data, width, format, kind };
  }

  /** Puts runs into a table; only rows that changed go to the graphics card. */
  fill(table, runs) {
    const { gl } = this;
    const rows = new Set();
    for (const { first, values } of runs) {
      table.data.set(values, first * table.width);
      const last = first + values.length / table.width - 1;
      for (let row = Math.floor(first / WIDTH); row <= Math.floor(last / WIDTH); row++) rows.add(row);
    }
    gl.bindTexture(gl.TEXTURE_2D, table.texture);
    const length = WIDTH * table.width;
    for (const row of rows) {
      const part = table.data.subarray(row * length, (row + 1) * length);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, row, WIDTH, 1, table.format, table.kind, part);
    }
  }

  takeState(state) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.positions);
    for (const { first, values } of state.corners) gl.bufferSubData(gl.ARRAY_BUFFER, 36 * first, values);
    this.fill(this.light, state.light);
    this.fill(this.heat, state.heat);
    if (state.light.length) this.average();
  }

  /** Geometric mean and largest irradiance, from a thousand vertices: for what has no radiosity, and for the overlay. */
  average() {
    const { data } = this.light;
    const logs = [0, 0, 0];
    let [most, count] = [1e-6, 0];
    const step = 4 * Math.max(1, Math.floor(data.length / 4000));
    for (let k = 0; k < data.length; k += step) {
      if (!data[k + 3]) continue;
      const values = [0, 1, 2].map((n) => half(data[k + n]));
      values.forEach((value, n) => { logs[n] += Math.log(Math.max(value, 1e-6)); });
      most = Math.max(most, 0.2126 * values[0] + 0.7152 * values[1] + 0.0722 * values[2]);
      count += 1;
    }
    this.mean = logs.map((log) => (count ? Math.exp(log / count) : 0));
    this.most = most;
  }

  async takePictures(textures) {
    const { gl } = this;
    this.pictures = await Promise.all(textures.map(async (about, k) => {
      const answer = await fetch(`/texture/${k}${location.search}`);
      if (!answer.ok) return null;
      const picture = await createImageBitmap(await answer.blob(), { premultiplyAlpha: 'none' });
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.SRGB8_ALPHA8, gl.RGBA, gl.UNSIGNED_BYTE, picture);
      gl.generateMipmap(gl.TEXTURE_2D);
      const wraps = { repeat: gl.REPEAT, mirror: gl.MIRRORED_REPEAT, clamp: gl.CLAMP_TO_EDGE };
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, wraps[about.wrap[0]]);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, wraps[about.wrap[1]]);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, about.nearest ? gl.NEAREST : gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
      return texture;
    }));
  }

  /** Draws the scene; glass comes last. */
  draw(scene, matrix, look) {
    const { gl, uniform } = this;
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    gl.clearColor(0.02, 0.02, 0.025, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.vertices || !scene.values) return;
    gl.useProgram(this.program);
    gl.bindVertexArray(this.vertices);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.uniformMatrix4fv(uniform.view, false, matrix);
    for (const [unit, name, texture] of [[0, 'light', this.light.texture], [1, 'heat', this.heat.texture]]) {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform1i(uniform[name], unit);
    }
    gl.activeTexture(gl.TEXTURE2);
    gl.uniform1i(uniform.picture, 2);
    gl.uniform1f(uniform.exposure, 2 ** look.stops);
    gl.uniform1i(uniform.curve, ['none', 'neutral', 'agx'].indexOf(look.curve));
    gl.uniform1i(uniform.overlay, ['light', 'recomputed', 'mesh', 'objects', 'irradiance'].indexOf(look.overlay));
    gl.uniform3fv(uniform.mean, this.mean);
    gl.uniform1f(uniform.most, this.most || 1);
    const { objects, materials } = scene.about;
    const isGlass = (object) => materials[object.material].glass;
    const draw = (object) => this.object(scene, object, objects.indexOf(object), look);
    objects.filter((object) => !isGlass(object)).forEach(draw);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    objects.filter(isGlass).forEach(draw);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    gl.activeTexture(gl.TEXTURE0);
  }

  object(scene, object, number, look) {
    const { gl, uniform } = this;
    if (!scene.isVisible(object) || !object.count) return;
    const material = scene.about.materials[object.material];
    const picture = material.texture === null ? null : this.pictures[material.texture];
    gl.bindTexture(gl.TEXTURE_2D, picture ?? null);
    gl.uniform1i(uniform.textured, picture ? 1 : 0);
    gl.uniform1f(uniform.cutoff, picture && material.cutoff !== null && !material.glass ? material.cutoff : 0);
    gl.uniform1i(uniform.unlit, material.unlit ? 1 : 0);
    gl.uniform1i(uniform.selected, look.selected.has(object) ? 1 : 0);
    gl.uniform3fv(uniform.base, scene.values.materials[object.material][0]);
    gl.uniform3fv(uniform.emitted, scene.values.emitted[number]);
    gl.uniform1f(uniform.opacity, material.glass ? 0.15 : 1);
    gl.uniform1i(uniform.object, object.node);
    gl.drawArrays(gl.TRIANGLES, 3 * object.first, 3 * object.count);
  }
}

/** A 16-bit float from its bits. */
function half(bits) {
  const [e, m] = [(bits >> 10) & 31, bits & 1023];
  return e === 0 ? m * 2 ** -24 : (1 + m / 1024) * 2 ** (e - 15);
}
