// ---- Player: the clock of the page, the view of the scene, and what drives them.

const engineNames = {simbody: 'Simbody', mujoco_same_law: 'MuJoCo (same laws)', mujoco: 'MuJoCo'};
const engineName = engine => engineNames[engine] || engine;

const eventTexts = {contact_made: 'contact made', contact_broken: 'contact broken', rope_slack: 'rope slack', rope_taut: 'rope taut',
  landed: 'landed', lifted: 'lifted', lock_closed: 'locks closed', lock_opened: 'locks opened', lock_refused: 'locks refused', tripped: 'limit tripped', stopped: 'stopped'};
const eventText = event => `${eventTexts[event.event] || event.event}${['landed', 'lifted'].includes(event.event) ? '' : ': ' + event.subject}`;

// The time that player, plots and tables share.
class Clock {
  constructor(duration) {
    Object.assign(this, {duration, time: 0, speed: 1, playing: false, listeners: []});
  }
  onChange(listener) { this.listeners.push(listener); }
  notify() { for (const listener of this.listeners) listener(this); }
  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    this.notify();
  }
  play() {
    if (this.playing) return;
    if (this.time >= this.duration) this.time = 0;
    this.playing = true;
    let last = performance.now();
    const frame = now => {
      if (!this.playing) return;
      const step = Math.min(Math.max(now - last, 0), 200) / 1000;
      last = now;
      this.time = Math.min(this.time + step * this.speed, this.duration);
      if (this.time >= this.duration) this.playing = false;
      this.notify();
      if (this.playing) requestAnimationFrame(frame);
    };
    this.notify();
    requestAnimationFrame(frame);
  }
  pause() {
    this.playing = false;
    this.notify();
  }
  toggle() { this.playing ? this.pause() : this.play(); }
}

// Marks of events: a shape and a colour for each kind.
const markStyles = {contact_made: ['▲', 0], contact_broken: ['△', 0], rope_slack: ['◇', 1], rope_taut: ['◆', 1], landed: ['●', 2],
  lifted: ['○', 2], lock_opened: ['□', 3], lock_closed: ['■', 3], lock_refused: ['⊠', 3], tripped: ['✖', 7], stopped: ['✖', 7]};

class Player {
  constructor(clock, scene, engines, events, interval) {
    Object.assign(this, {clock, scene, events, interval, engine: engines[0], other: null, mode: 'ghost', factor: 1, follow: false, engines});
    this.camera = new Camera();
    this.build();
    this.preset('overview');
    clock.onChange(() => this.tick());
    theme.listeners.push(() => this.redraw());
    new ResizeObserver(() => this.resize()).observe(this.view);
  }

  build() {
    this.canvas = element('canvas', {tabindex: 0, role: 'img', id: 'view', 'aria-describedby': 'view-help',
      'aria-label': 'The scene in three dimensions at the time shown. Drag to turn, keys 1 to 5 choose a camera.'});
    try {
      if (location.hash !== '#canvas2d') this.renderer = WebglRenderer.make(this.canvas);
    } catch (error) {
      this.canvas = this.canvas.cloneNode();
    }
    this.renderer ||= new CanvasRenderer(this.canvas);
    this.names = element('div', {class: 'overlay names'});
    this.legend = element('div', {class: 'legend'});
    this.tooltip = element('div', {class: 'overlay tooltip', hidden: true});
    this.forceTexts = element('div');
    this.view = element('div', {class: 'view'}, this.canvas, this.forceTexts, this.names, this.tooltip);

    this.playButton = element('button', {class: 'play', id: 'play', onclick: () => this.clock.toggle()}, 'Play');
    this.timeText = element('span', {class: 'time', id: 'time'});
    this.slider = element('input', {type: 'range', id: 'scrub', min: 0, max: this.clock.duration, step: 'any', value: 0, 'aria-label': 'Time',
      oninput: () => { const time = Number(this.slider.value); this.clock.pause(); this.clock.seek(time); }});
    this.marks = element('canvas', {id: 'marks', role: 'img', 'aria-label': 'Events along the time; the table of events lists them, the keys [ and ] go from one to the next',
      onclick: e => { const event = this.markAt(e); if (event) this.goTo(event); },
      onpointermove: e => { const event = this.markAt(e); this.marks.title = event ? `${eventText(event)}, ${number(event.time, 5)} s` : ''; }});
    this.live = element('div', {class: 'hidden-text', role: 'status', 'aria-live': 'polite'});
    const speed = element('select', {id: 'speed', 'aria-label': 'Speed', onchange: () => { this.clock.speed = Number(speed.value); }},
      [.05, .1, .25, .5, 1, 2, 5, 10].map(s => element('option', {value: s, selected: s === 1}, `${number(s)} ×`)));
    this.speed = speed;
    this.cameras = element('div', {class: 'group', role: 'group', 'aria-label': 'Camera'},
      [['overview', 'Overview'], ['load', 'Load'], ['side', 'Side'], ['front', 'Front'], ['top', 'Top']].map(([key, text], i) =>
        element('button', {id: `camera-${key}`, title: `Key ${i + 1}`, onclick: () => this.preset(key)}, text)));
    this.followButton = element('button', {'aria-pressed': 'false', title: 'Key F', onclick: () => this.setFollow(!this.follow)}, 'Follow');
    const choice = (id, label, options, onchange) => {
      const select = element('select', {id, onchange: () => onchange(select.value)}, options.map(([value, text]) => element('option', {value}, text)));
      return element('label', {class: 'choice'}, label, select);
    };
    const several = this.engines.length > 1;
    const compare = several ? [
      choice('engine', 'Engine', this.engines.map(e => [e, engineName(e)]), value => { this.engine = value; this.showComparison(); this.notifyEngine(); }),
      choice('other', 'with', [['', '–'], ...this.engines.map(e => [e, engineName(e)])], value => { this.other = value || null; this.showComparison(); }),
      choice('mode', 'as', [['ghost', 'ghost'], ['beside', 'side by side']], value => { this.mode = value; this.showComparison(); }),
      choice('factor', 'differences', [[1, '× 1'], [10, '× 10'], [100, '× 100'], [1000, '× 1000'], [10000, '× 10 000']], value => { this.factor = Number(value); this.redraw(); }),
    ] : [];
    this.compare = compare;
    this.engineListeners = [];
    for (const label of compare.slice(2)) label.hidden = true;

    this.element = element('div', {class: 'stage', role: 'region', 'aria-label': 'Player'}, this.view, this.legend,
      element('div', {class: 'transport'},
        element('div', {class: 'scrub'}, this.marks, this.slider),
        element('div', {class: 'row controls'}, this.playButton,
          element('button', {title: 'Key [', 'aria-label': 'Previous event', onclick: () => this.step(-1)}, '‹', element('span', {class: 'wordy'}, ' event')),
          element('button', {title: 'Key ]', 'aria-label': 'Next event', onclick: () => this.step(1)}, element('span', {class: 'wordy'}, 'event '), '›'),
          this.timeText, element('span', {class: 'spring'}), speed),
        element('div', {class: 'row controls'}, this.cameras, this.followButton),
        several ? element('div', {class: 'row controls'}, compare) : null,
        element('span', {class: 'hidden-text', id: 'view-help'}, 'Arrow keys turn the view while it has the focus; plus and minus bring it nearer and farther.'),
        this.live));
    this.bindPointer();
    this.canvas.addEventListener('keydown', e => this.viewKey(e));
  }

  notifyEngine() { for (const listener of this.engineListeners) listener(this.engine); }

  get against() { return this.other && this.other !== this.engine ? this.other : null; }

  showComparison() {
    for (const label of this.compare.slice(2)) label.hidden = !this.against;
    if (this.presetKey && !this.touched) this.preset(this.presetKey);
    this.redraw();
  }

  get aspect() { return Math.max(this.view.clientWidth, 1) / Math.max(this.view.clientHeight, 1) / (this.against && this.mode === 'beside' ? 2 : 1); }

  preset(key) {
    const {camera, scene} = this, angles = {overview: [-.85, .24], load: [-.95, .28], side: [0, .06], front: [-Math.PI / 2, .06], top: [-Math.PI / 2, Math.PI / 2]};
    [camera.yaw, camera.pitch] = angles[key];
    this.setFollow(key === 'load');
    if (key === 'load') {
      const half = [1, 1, 1].map(() => scene.size * .4);
      camera.fit({low: sub(this.focusPoint(), half), high: add(this.focusPoint(), half)}, this.aspect);
    } else {
      camera.fit(scene.extent(this.engine), this.aspect);
    }
    this.presetKey = key;
    for (const button of this.cameras.children) button.setAttribute('aria-pressed', String(button.id === `camera-${key}`));
    this.redraw();
  }

  focusPoint() {
    const focus = this.scene.scene.focus, box = this.scene.solid.find(b => b.name === focus) || this.scene.solid[0];
    return box ? compose(this.scene.pose(this.engine, box.frame, this.clock.time), box.X).p : [0, 0, 0];
  }

  setFollow(follow) {
    this.follow = follow;
    this.followButton.setAttribute('aria-pressed', String(follow));
    if (follow) this.camera.target = this.focusPoint();
    this.redraw();
  }

  // Once a change of the time or the view, at the next frame.
  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }

  resize() {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [this.view.clientWidth, this.view.clientHeight].map(size => Math.round(size * ratio));
    if (this.canvas.width === width && this.canvas.height === height) return;
    [this.canvas.width, this.canvas.height] = [width, height];
    if (this.presetKey && !this.touched) this.preset(this.presetKey);
    this.draw();
    this.drawMarks();
  }

  draw() {
    if (!this.canvas.width || !this.canvas.height) return;
    const {scene, clock, engine, camera} = this;
    if (this.follow) camera.target = this.focusPoint();
    const picture = scene.picture(engine, clock.time);
    const colourOf = e => theme.series(this.engines.indexOf(e));
    const {against} = this, difference = this.factor === 1 || !against ? null : {engine, factor: this.factor};
    let views = [{picture}];
    if (against && this.mode === 'ghost') views[0].ghost = scene.picture(against, clock.time, {outlines: true, colour: colourOf(against), difference});
    else if (against) views.push({picture: scene.picture(against, clock.time, {difference})});
    const ground = scene.ground, extent = this.extent ||= scene.extent(engine);
    this.renderer.draw(views, camera, scene, {groundHeight: ground ? ground.p[2] + ground.half[2] : null, reach: Math.max(extent.radius, camera.distance * .35)});
    this.drawForceTexts(picture, views.length);
    this.drawLegend(picture, against);
  }

  // The largest forces as numbers beside their arrows; in the left picture where there are two.
  drawForceTexts({arrows}, columns) {
    const matrix = this.camera.matrix(this.view.clientWidth / columns / this.view.clientHeight), texts = [], taken = [];
    for (const arrow of arrows.slice().sort((a, b) => b.force - a.force).slice(0, 8)) {
      const [x, y, , w] = project(matrix, arrow.tip);
      if (w <= 0 || Math.abs(x) > 1 || Math.abs(y) > 1 || arrow.force < .02 * this.scene.usualForce) continue;
      const [left, top] = [(x + 1) / 2 * this.view.clientWidth / columns, (1 - y) / 2 * this.view.clientHeight];
      if (taken.some(([a, b]) => Math.abs(a - left) < 72 && Math.abs(b - top) < 17)) continue;  // the larger one is told
      taken.push([left, top]);
      const made = element('span', {class: 'overlay force'}, quantity(arrow.force, 'N', 3));
      made.style.left = left + 'px';
      made.style.top = top + 'px';
      texts.push(made);
    }
    this.forceTexts.replaceChildren(...texts);
  }

  drawLegend(picture, against) {
    const {scene} = this, parts = [];
    if (scene.largestTension > 0)
      parts.push(`<span>Rope tension <span class="ramp" style="background:${rampCss()}"></span>0 to ${quantity(scene.largestTension, 'N', 3)}, thin: slack</span>`);
    if (scene.usualForce > 0)
      parts.push(`<span><span style="color:${theme.boxes.force}">➜</span> Contact force, ${number(scene.usualLength, 2)} m for ${quantity(scene.usualForce, 'N', 3)}</span>`);
    const legend = parts.join('');
    if (legend !== this.legendText) this.legend.innerHTML = this.legendText = legend;
    this.legend.hidden = !legend;
    const name = (e, text) => `<span><i class="swatch" style="border-color:${text === 'ghost' ? theme.series(this.engines.indexOf(e)) : 'transparent'};${text === 'ghost' ? '' : 'display:none'}"></i>${engineName(e)}${text === 'ghost' ? ' (outline)' : ''}</span>`;
    const names = name(this.engine) + (against ? name(against, this.mode) : '') + (against && this.factor !== 1 ? `<span>differences × ${number(this.factor, 5)}</span>` : '');
    if (names !== this.namesText) this.names.innerHTML = this.namesText = names;
    this.names.style.justifyContent = against && this.mode === 'beside' ? 'space-around' : '';
  }

  tick() {
    const {clock} = this;
    this.slider.value = clock.time;
    const text = clock.time.toFixed(3);
    this.slider.setAttribute('aria-valuetext', `${text} seconds`);
    this.timeText.innerHTML = `<b>${text}</b> <span class="wordy">of ${number(clock.duration, 5)}</span> s`;
    if (this.playButton.textContent !== (clock.playing ? 'Pause' : 'Play')) this.playButton.textContent = clock.playing ? 'Pause' : 'Play';
    this.element.dataset.playing = clock.playing;
    this.redraw();
  }

  currentEvents() { return this.events[this.engine] || []; }

  markX(time) { return 8 + (this.marks.clientWidth - 16) * time / this.clock.duration; }

  drawMarks() {
    const {marks} = this, ratio = devicePixelRatio || 1, context = marks.getContext('2d');
    marks.width = marks.clientWidth * ratio;
    marks.height = marks.clientHeight * ratio;
    context.scale(ratio, ratio);
    context.font = '11px system-ui, sans-serif';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    let free = {};
    for (const event of this.currentEvents()) {
      const [shape, colour] = markStyles[event.event] || ['•', 6], x = this.markX(event.time);
      const row = event.event.startsWith('contact') ? 2 : event.event.startsWith('rope') ? 1 : 0;
      if (x < (free[shape] ?? -9)) continue;  // a bounce has dozens in one place
      free[shape] = x + 7;
      context.fillStyle = theme.series(colour);
      context.fillText(shape, x, 6 + 12 * row);
    }
  }

  markAt({offsetX}) {
    let best = null, nearest = 9;
    for (const event of this.currentEvents()) {
      const distance = Math.abs(this.markX(event.time) - offsetX) - (event.event === 'landed' ? 2 : 0);
      if (distance < nearest) [best, nearest] = [event, distance];
    }
    return best;
  }

  goTo(event) {
    this.clock.pause();
    this.clock.seek(event.time);
    this.picked = event;
    this.live.textContent = `${number(event.time, 5)} s: ${eventText(event)}`;
    this.element.dataset.event = event.event;
    for (const listener of this.pickListeners || []) listener(event);
  }

  // To the next moment with an event, one way or the other.
  step(direction) {
    const {time} = this.clock, small = 1e-6;
    const events = this.currentEvents();
    const found = direction > 0 ? events.find(e => e.time > time + small) : events.filter(e => e.time < time - small).pop();
    if (found) this.goTo(found);
  }

  bindPointer() {
    const pointers = new Map(), {canvas, camera} = this;
    let pinch = 0;
    canvas.addEventListener('contextmenu', e => e.preventDefault());
    canvas.addEventListener('pointerdown', e => {
      try { canvas.setPointerCapture(e.pointerId); } catch { /* a pointer that has gone already */ }
      pointers.set(e.pointerId, e);
    });
    const release = e => { pointers.delete(e.pointerId); pinch = 0; };
    canvas.addEventListener('pointerup', release);
    canvas.addEventListener('pointercancel', release);
    canvas.addEventListener('pointerleave', () => { this.tooltip.hidden = true; });
    canvas.addEventListener('pointermove', e => {
      const before = pointers.get(e.pointerId);
      if (!before) return this.hover(e);
      const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
      pointers.set(e.pointerId, e);
      this.tooltip.hidden = true;
      if (pointers.size === 2) {
        const [a, b] = [...pointers.values()], distance = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        if (pinch) camera.distance *= pinch / Math.max(distance, 1);
        pinch = distance;
        this.pan(dx / 2, dy / 2);
      } else if (e.shiftKey || e.buttons & 6) {
        this.pan(dx, dy);
      } else {
        this.turn(-dx * .006, dy * .006);
      }
    });
    canvas.addEventListener('wheel', e => {
      e.preventDefault();
      this.zoom(Math.exp(e.deltaY * .0012));
    }, {passive: false});
  }

  moved() {
    this.touched = true;
    for (const button of this.cameras.children) button.setAttribute('aria-pressed', 'false');
    this.redraw();
  }
  turn(yaw, pitch) {
    this.camera.yaw += yaw;
    this.camera.pitch = Math.min(Math.max(this.camera.pitch + pitch, .015), Math.PI / 2);
    this.moved();
  }
  zoom(factor) {
    this.camera.distance = Math.min(Math.max(this.camera.distance * factor, this.scene.size * .05), 5000);
    this.moved();
  }
  pan(dx, dy) {
    const {camera} = this, {x, y} = camera.axes(), step = 2 * camera.distance * Math.tan(camera.field / 2) / this.view.clientHeight;
    this.follow = false;
    this.followButton.setAttribute('aria-pressed', 'false');
    camera.target = add(camera.target, add(scale(x, -dx * step), scale(y, dy * step)));
    this.moved();
  }
  viewKey(e) {
    const turns = {ArrowLeft: [-.1, 0], ArrowRight: [.1, 0], ArrowUp: [0, .07], ArrowDown: [0, -.07]}[e.key];
    if (turns) this.turn(...turns);
    else if (e.key === '+' || e.key === '=') this.zoom(.88);
    else if (e.key === '-') this.zoom(1.14);
    else return;
    e.preventDefault();
    e.stopPropagation();
  }

  // What is under the pointer, where it is and how fast it moves.
  hover(e) {
    const rect = this.view.getBoundingClientRect(), columns = this.against && this.mode === 'beside' ? 2 : 1;
    const width = rect.width / columns, column = Math.floor((e.clientX - rect.left) / width);
    const x = 2 * ((e.clientX - rect.left) - column * width) / width - 1, y = 1 - 2 * (e.clientY - rect.top) / rect.height;
    const engine = column > 0 ? this.against : this.engine, direction = this.camera.ray(x, y, width / rect.height);
    let nearest = Infinity, box = null;
    for (const candidate of this.scene.picture(engine, this.clock.time).boxes) {
      const distance = hitBox(this.camera.eye, direction, candidate.X, candidate.half);
      if (distance < nearest) [nearest, box] = [distance, candidate];
    }
    this.tooltip.hidden = !box;
    if (!box) return;
    const curves = data.curves && this.scene.engines.get(engine), frame = curves.has(box.name + '.position.x') ? box.name : box.frame;
    let text = `<b>${box.name.replace(/[<&]/g, '')}</b>`;
    if (box.kind === 'left_out') text += '<br>left out of the simulation';
    else if (box.frame === null) text += '<br>does not move';
    else {
      const at = part => ['x', 'y', 'z'].map(c => curves.get(`${frame}.${part}.${c}`)?.at(this.clock.time) ?? NaN);
      text += `<br>position ${at('position').map(v => v.toFixed(3)).join(', ')} m<br>speed ${quantity(norm(at('velocity')), 'm/s', 3)}`;
    }
    this.tooltip.innerHTML = text;
    this.tooltip.style.left = Math.min(e.clientX - rect.left, rect.width - this.tooltip.offsetWidth - 20) + 'px';
    this.tooltip.style.top = Math.min(e.clientY - rect.top, rect.height - this.tooltip.offsetHeight - 20) + 'px';
  }
}
