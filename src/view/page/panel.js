// The panels: what can be looked at, switched, painted, moved and taken back, and what each step cost.

const byId = (id) => document.getElementById(id);

/** An element with properties and children. */
function make(kind, properties = {}, ...children) {
  const element = Object.assign(document.createElement(kind), properties);
  element.append(...children);
  return element;
}

const toSrgb = (c) => (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055);
const toLinear = (c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
const byte = (c) => Math.round(255 * Math.max(0, Math.min(1, toSrgb(c)))).toString(16).padStart(2, '0');
export const hex = (color) => `#${color.map(byte).join('')}`;
export const linear = (text) => [1, 3, 5].map((k) => Number(toLinear(parseInt(text.slice(k, k + 2), 16) / 255).toFixed(5)));

export class Panel {
  constructor(scene, act) {
    Object.assign(this, { scene, act });
    this.former = new Map();
    this.gesture = Math.floor(Math.random() * 2 ** 40) + 2 ** 41;
    const on = (id, event, run) => byId(id).addEventListener(event, run);
    on('overlay', 'change', () => act.look({ overlay: byId('overlay').value }));
    on('curve', 'change', () => act.look({ curve: byId('curve').value }));
    on('stops', 'input', () => act.look({ stops: Number(byId('stops').value) }));
    on('camera', 'change', () => act.camera(byId('camera').value));
    on('walk', 'change', () => act.walk(byId('walk').checked));
    on('true', 'change', () => act.still(byId('true').checked));
    on('play', 'click', () => act.play(!this.scene.values?.plays));
    on('time', 'input', () => act.seek(Number(byId('time').value)));
    on('undo', 'click', () => act.undo());
    on('render', 'click', () => act.render());
    on('lines', 'click', () => act.lines());
    on('verify', 'click', () => act.verify());
    on('add', 'change', () => { act.add(byId('add').value); byId('add').value = ''; });
    on('fold', 'click', () => document.body.classList.toggle('folded'));
    on('close', 'click', () => { byId('picture').hidden = true; });
  }

  /** What stands still while nothing is added. */
  takeScene(about) {
    document.title = `${about.name} · sweeplight`;
    byId('name').textContent = about.name;
    byId('size').textContent = `${about.elements.toLocaleString('en')} elements`;
    byId('camera').replaceChildren(
      make('option', { value: '', textContent: 'free' }),
      ...about.cameras.map((name, k) => make('option', { value: String(k), textContent: name })),
    );
    byId('camera').value = about.cameras.length ? '0' : '';
    byId('time').max = String(about.seconds);
    byId('clip').hidden = about.seconds === 0;
    byId('stops').value = String(about.stops);
    byId('curve').value = about.curve;
    byId('add').replaceChildren(
      make('option', { value: '', textContent: 'add…' }),
      ...about.files.map((name) => make('option', { value: name, textContent: name })),
    );
    byId('lamps').replaceChildren();
    this.lamps = new Map();
  }

  /** The account of a step, and the values that widgets show. */
  takeAccount(account, bytes, rate) {
    const { step } = account;
    const lit = step.place_ms + step.trace_ms + step.solve_ms;
    const number = (value) => Math.round(value).toLocaleString('en');
    if (step.samples) {
      byId('asked').textContent = `${number(step.traced)} of ${number(step.samples)}`;
      byId('saved').textContent = `${(100 * (1 - step.traced / step.samples)).toFixed(1)} %`;
      byId('changed').textContent = number(step.changed);
      byId('ms').textContent = `${lit.toFixed(1)} ms: ${step.trace_ms.toFixed(1)} traced, ${step.solve_ms.toFixed(1)} solved`;
      byId('ratio').textContent = `${(step.scratch_ms / Math.max(lit, 0.01)).toFixed(1)}×`;
    }
    byId('sent').textContent = `${(bytes / 1024).toFixed(1)} kB${rate ? `, ${rate.toFixed(0)} a second` : ''}`;
    byId('error').textContent = `${(100 * account.residual).toFixed(2)} %${account.coarse ? ', refines' : ''}`;
    byId('undo').disabled = account.lines === 0;
    byId('undo').textContent = account.lines ? `undo (${account.lines})` : 'undo';
    byId('play').textContent = account.plays ? 'pause' : 'play';
    if (document.activeElement !== byId('time') || account.plays) byId('time').value = String(account.seconds);
    byId('now').textContent = `${account.seconds.toFixed(2)} s`;
    this.takeLamps(account);
    this.takeHidden(account);
    if (this.node !== undefined) this.refresh(account);
  }

  takeLamps(account) {
    const { materials, lights } = this.scene.about;
    const lamp = (key, name, value, edit) => {
      if (value > 0) this.former.set(key, value);
      if (!this.former.has(key)) return;
      if (!this.lamps.has(key)) this.addLamp(key, name, edit);
      const { toggle, range } = this.lamps.get(key);
      toggle.checked = value > 0;
      if (document.activeElement !== range) range.value = String(Math.log2(Math.max(value, 1e-3) / this.first(key, value)));
    };
    account.materials.forEach(([, emissive, strength], k) => {
      lamp(`m${k}`, materials[k].name, Math.max(...emissive) > 0 ? strength : 0,
        (value) => ({ emission: { material: k, strength: value } }));
    });
    account.lights.forEach(([, intensity], k) => {
      lamp(`l${k}`, lights[k].name, intensity, (value) => ({ light: { light: k, intensity: value } }));
    });
  }

  /** The value of a lamp when it was first seen. */
  first(key, value) {
    const at = `first ${key}`;
    if (!this.former.has(at)) this.former.set(at, value || 1);
    return this.former.get(at);
  }

  addLamp(key, name, edit) {
    const toggle = make('input', { type: 'checkbox' });
    const range = make('input', { type: 'range', min: '-5', max: '3', step: '0.05', title: `brightness of ${name}, in stops` });
    toggle.addEventListener('change', () => this.act.step([edit(toggle.checked ? this.former.get(key) : 0)]));
    let gesture = 0;
    range.addEventListener('pointerdown', () => { gesture = ++this.gesture; });
    range.addEventListener('input', () => this.act.step([edit(this.first(key, 1) * 2 ** range.value)], gesture || ++this.gesture));
    this.lamps.set(key, { toggle, range });
    byId('lamps').append(make('div', { className: 'row' }, make('label', {}, toggle, ` ${name}`), range));
  }

  takeHidden(account) {
    const { nodes } = this.scene.about;
    const isTop = (node, k) => !account.visible[k] && (node.parent === null || account.visible[node.parent]);
    const hidden = nodes.map((node, k) => [node, k]).filter(([node, k]) => isTop(node, k));
    const names = hidden.map(([, k]) => k).join();
    if (names === this.hidden) return;
    this.hidden = names;
    byId('hidden').replaceChildren(...hidden.slice(0, 20).map(([node]) => make('button', {
      textContent: `show ${node.name}`, onclick: () => this.act.step([{ show: { node: node.number } }]),
    })));
  }

  /** The panel of what is selected. */
  select(node) {
    this.node = node ?? undefined;
    const panel = byId('chosen');
    panel.hidden = node === null;
    if (node === null) return;
    const { about } = this.scene;
    const chain = this.scene.above(node).map((at) => make('button', {
      textContent: about.nodes[at].name, disabled: at === node, onclick: () => this.act.select(at),
    }));
    const parts = about.nodes.map((_, k) => k).filter((k) => about.nodes[k].parent === node);
    const below = parts.slice(0, 12).map((k) => make('button', {
      textContent: `› ${about.nodes[k].name}`, onclick: () => this.act.select(k),
    }));
    const turn = make('input', { type: 'range', min: '-180', max: '180', step: '1', value: '0', title: 'turn, in degrees' });
    let gesture = 0;
    turn.addEventListener('pointerdown', () => { gesture = ++this.gesture; turn.value = '0'; });
    turn.addEventListener('input', () => this.act.turn(node, Number(turn.value), gesture || (gesture = ++this.gesture)));
    this.colors = new Map();
    const number = { node: about.nodes[node].number };
    panel.replaceChildren(
      make('div', { className: 'chain' }, ...chain, ...below),
      make('label', { className: 'row' }, 'turn', turn),
      ...this.paints(node),
      make('div', { className: 'chain' },
        make('button', { textContent: 'hide', onclick: () => this.act.step([{ hide: number }]) }),
        make('button', { textContent: 'remove', onclick: () => { this.act.step([{ remove: number }]); this.act.select(null); } })),
    );
    if (this.scene.values) this.refresh(this.scene.values);
  }

  /** Rows for the materials at and below a node. */
  paints(node) {
    const used = [...new Set(this.scene.below(node).map((object) => object.material))].slice(0, 8);
    return used.map((k) => {
      const color = make('input', { type: 'color', title: 'base colour' });
      const glow = make('input', { type: 'color', title: 'colour that it emits' });
      const strength = make('input', { type: 'number', min: '0', step: '0.1', title: 'strength of its emission' });
      let gesture = 0;
      color.addEventListener('click', () => { gesture = ++this.gesture; });
      color.addEventListener('input', () => this.act.step([{ color: { material: k, to: linear(color.value) } }], gesture || ++this.gesture));
      const emit = () => this.act.step([{ emission: { material: k, color: linear(glow.value), strength: Number(strength.value) } }]);
      glow.addEventListener('change', emit);
      strength.addEventListener('change', emit);
      this.colors.set(k, { color, glow, strength });
      return make('div', { className: 'row paint' },
        make('span', { textContent: this.scene.about.materials[k].name }), color, 'emits', glow, strength);
    });
  }

  refresh(account) {
    for (const [k, { color, glow, strength }] of this.colors) {
      const [base, emissive, power] = account.materials[k];
      if (document.activeElement !== color) color.value = hex(base);
      if (document.activeElement !== glow) glow.value = hex(emissive);
      if (document.activeElement !== strength) strength.value = String(Number(power.toPrecision(4)));
    }
  }

  /** A line at the foot of the page. */
  tell(text, isError = false) {
    byId('told').textContent = text;
    byId('told').classList.toggle('wrong', isError);
  }

  /** A picture over the page. */
  show(address, name) {
    byId('shown').src = address;
    byId('save').href = address;
    byId('save').download = name;
    byId('picture').hidden = false;
  }
}
