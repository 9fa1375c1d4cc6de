// ---- Scene: what there is to see of an engine's run at a moment, as boxes, lines and arrows for a renderer.

const identity = {p: [0, 0, 0], q: [1, 0, 0, 0]};

class SceneView {
  // scene: as written by scene_view; curves: engine name -> Map of curves.
  constructor(scene, engines) {
    this.scene = scene;
    this.engines = engines;
    this.frames = new Map();  // engine -> frame -> its seven curves
    for (const [engine, curves] of engines) {
      const frames = new Map();
      for (const name of curves.keys())
        if (name.endsWith('.position.x')) {
          const frame = name.slice(0, -'.position.x'.length);
          frames.set(frame, ['position.x', 'position.y', 'position.z', 'orientation.w', 'orientation.x', 'orientation.y', 'orientation.z']
            .map(part => curves.get(`${frame}.${part}`)));
        }
      this.frames.set(engine, frames);
    }
    this.boxes = scene.bodies.flatMap(body => body.boxes.map(box => ({...box, frame: body.frame, X: {p: box.p, q: box.q}})));
    let shade = 0;
    for (const box of this.boxes) box.shade = box.kind === 'container' && box.name !== scene.focus ? shade++ : 0;
    this.ground = this.boxes.find(box => box.kind === 'ground');
    this.solid = this.boxes.filter(box => box.kind !== 'ground');
    this.largestTension = this.largest(/\.tension$/);
    this.contacts = this.findContacts();
    const focusBox = this.solid.find(box => box.name === scene.focus) || this.solid[0];
    this.size = focusBox ? 2 * Math.max(...focusBox.half) : 1;
    // Arrows: the heaviest lasting force is this long.
    this.usualForce = Math.max(0, ...this.contacts.map(contact => contact.usual));
    this.usualLength = 0.3 * this.size;
  }

  largest(pattern) {
    let most = 0;
    for (const curves of this.engines.values())
      for (const [name, curve] of curves) if (pattern.test(name)) most = Math.max(most, curve.range()[1]);
    return most;
  }

  findContacts() {
    const contacts = new Map();
    for (const curves of this.engines.values())
      for (const name of curves.keys()) {
        if (!name.startsWith('contact.') || !name.endsWith('.point.x')) continue;
        const stem = name.slice(0, -'.point.x'.length), force = curves.get(stem + '.force');
        const sample = Array.from({length: 200}, (_, i) => force.at(force.start + (force.end - force.start) * (i + .5) / 200)).filter(f => f > 0);
        const usual = sample.sort((a, b) => a - b)[sample.length >> 1] || 0;
        contacts.set(stem, {stem, usual: Math.max(usual, contacts.get(stem)?.usual || 0)});
      }
    return [...contacts.values()];
  }

  pose(engine, frame, t) {
    if (frame === null) return identity;
    const curves = this.frames.get(engine)?.get(frame);
    if (!curves) return identity;
    const v = curves.map(curve => curve.at(t));
    return {p: v.slice(0, 3), q: unitQuaternion(v.slice(3))};
  }

  colourOf(box) {
    const colours = theme.boxes;
    if (box.name === this.scene.focus) return colours.focus;
    if (box.kind === 'container') return colours.container[box.shade % colours.container.length];
    return colours[box.name] || colours[box.kind] || colours.body;
  }

  // All of an engine's run at time t. With `difference` = {engine, factor} everything stands off from that other engine's
  // picture by `factor` times its true distance.
  picture(engine, t, {outlines = false, colour = null, difference = null} = {}) {
    const posed = new Map();
    const pose = frame => {
      if (!posed.has(frame)) {
        const X = this.pose(engine, frame, t);
        if (difference && frame !== null) {
          const reference = this.pose(difference.engine, frame, t);
          X.p = add(reference.p, scale(sub(X.p, reference.p), difference.factor));
        }
        posed.set(frame, X);
      }
      return posed.get(frame);
    };
    const colours = theme.boxes, boxes = [], lines = [];
    for (const box of this.solid) {
      if (outlines && box.frame === null) continue;
      const X = compose(pose(box.frame), box.X);
      boxes.push({name: box.name, kind: box.kind, frame: box.frame, X, half: box.half, colour: colour || this.colourOf(box), outlines});
    }
    for (const rope of this.scene.ropes) {
      const a = transform(pose(rope.upper.frame), rope.upper.p), b = transform(pose(rope.lower.frame), rope.lower.p);
      const tension = this.engines.get(engine).get(rope.name + '.tension')?.at(t) ?? 0;
      const slack = tension <= 0;
      lines.push({a, b, width: outlines ? 1.2 : slack ? 1.3 : 3.2, colour: colour ? rgb(colour) : slack ? rgb(colours.rail) : ramp(tension / this.largestTension),
        casing: !outlines && !slack});
    }
    if (!outlines) {
      this.addHangers(pose, lines);
      for (const rail of this.scene.rails) this.addCrane(rail, pose(rail.frame), lines);
      for (const {frame, struts} of this.scene.bodies)
        for (const {from, to} of struts || []) lines.push({a: transform(pose(frame), from), b: transform(pose(frame), to), width: 5, colour: rgb(colours.machine)});
    }
    return {boxes, lines, arrows: outlines ? [] : this.arrows(engine, t)};
  }

  // Where ropes meet a body above its boxes there is a headblock that the scene does not model: an outline joins them.
  addHangers(pose, lines) {
    const ends = new Map();
    for (const rope of this.scene.ropes) {
      if (!ends.has(rope.lower.frame)) ends.set(rope.lower.frame, []);
      ends.get(rope.lower.frame).push(rope.lower.p);
    }
    for (const [frame, points] of ends) {
      if (frame === null || points.length < 3) continue;
      const X = pose(frame), middle = scale(points.reduce(add), 1 / points.length), top = this.topOf(frame);
      const around = points.slice().sort((a, b) => Math.atan2(a[1] - middle[1], a[0] - middle[0]) - Math.atan2(b[1] - middle[1], b[0] - middle[0]));
      const colour = rgb(theme.boxes.edge);
      around.forEach((p, i) => {
        lines.push({a: transform(X, p), b: transform(X, around[(i + 1) % around.length]), width: 3, colour});
        if (top !== null && p[2] > top) lines.push({a: transform(X, p), b: transform(X, [p[0], p[1], top]), width: 2, colour});
      });
    }
  }

  topOf(frame) {
    const boxes = this.solid.filter(box => box.frame === frame && Math.abs(box.q[0]) > .999);
    return boxes.length ? Math.max(...boxes.map(box => box.p[2] + box.half[2])) : null;
  }

  // Contact forces on whichever of the two is pushed up, from their centre of pressure.
  arrows(engine, t) {
    const curves = this.engines.get(engine), arrows = [];
    for (const {stem} of this.contacts) {
      const force = curves.get(stem + '.force')?.at(t);
      if (!(force > 0) || !curves.has(stem + '.point.x')) continue;
      const vector = part => ['x', 'y', 'z'].map(c => curves.get(`${stem}.${part}.${c}`).at(t));
      const p = vector('point');
      let direction = unit(vector('direction'));
      if (direction[2] < 0) direction = scale(direction, -1);
      const length = Math.min(this.usualLength * force / this.usualForce, 4 * this.usualLength);
      arrows.push({p, tip: add(p, scale(direction, length)), force, name: stem.slice('contact.'.length)});
    }
    return arrows;
  }

  // What a trolley runs on, as lines: its rails, legs down to the ground, and stays of a boom that reaches out beyond them.
  addCrane(rail, X, lines) {
    const colour = rgb(theme.boxes.rail), side = unit(cross(rail.axis, [0, 0, 1])), carriage = this.boxes.find(box => box.name === rail.body);
    const gauge = carriage ? .9 * Math.max(...carriage.half.slice(0, 2)) : 2, drop = carriage ? carriage.half[2] : 0;
    const at = (q, s, up = -drop) => transform(X, add(add(rail.p, scale(rail.axis, q)), add(scale(side, s * gauge), [0, 0, up])));
    const line = (a, b, width) => lines.push({a, b, width, colour});
    for (const s of [-1, 1]) line(at(rail.from, s), at(rail.to, s), 3);
    const stance = rail.boom ? 9 / gauge : 1;  // containers pass between the legs behind a boom [m]
    for (const q of rail.legs) {
      line(at(q, -stance), at(q, stance), 2);
      if (this.ground)
        for (const s of [-stance, stance]) line(at(q, s), [...at(q, s).slice(0, 2), this.ground.p[2] + this.ground.half[2]], 2);
    }
    if (!rail.boom) return;
    const [front] = rail.legs, top = .3 * (rail.to - rail.from);
    for (const s of [-1, 1]) {
      line(at(front, s), at(front, s, top), 2);
      for (const q of [rail.from, rail.to]) line(at(front, s, top), at(q, s), 1.2);
    }
  }

  // What all boxes take up from start to end.
  extent(engine) {
    let low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const [start, end] = [0, data.curves.duration];
    for (const box of this.solid) {
      for (let i = 0; i <= (box.frame === null ? 0 : 8); ++i) {
        const X = compose(this.pose(engine, box.frame, start + (end - start) * i / 8), box.X);
        for (const corner of cubeCorners) {
          const p = transform(X, corner.map((c, k) => c * box.half[k]));
          low = low.map((v, k) => Math.min(v, p[k]));
          high = high.map((v, k) => Math.max(v, p[k]));
        }
      }
    }
    if (!(low[0] <= high[0])) [low, high] = [[-3, -3, -3], [3, 3, 3]];
    return {low, high, radius: norm(sub(high, low)) / 2};
  }
}

// The eye: around a target, by angles.
class Camera {
  constructor() { Object.assign(this, {target: [0, 0, 0], yaw: -.9, pitch: .3, distance: 30, field: 35 * Math.PI / 180}); }
  get outward() { return [Math.cos(this.pitch) * Math.cos(this.yaw), Math.cos(this.pitch) * Math.sin(this.yaw), Math.sin(this.pitch)]; }
  get eye() { return add(this.target, scale(this.outward, this.distance)); }
  matrix(aspect) {
    const up = Math.abs(this.pitch) > 1.55 ? [-Math.cos(this.yaw), -Math.sin(this.yaw), 0] : [0, 0, 1];
    const view = lookAt(this.eye, this.target, up), far = Math.max(400, 8 * this.distance);
    return multiply(perspective(this.field, aspect, this.distance * .02, far), view);
  }
  axes() {
    const z = this.outward, x = unit(Math.abs(this.pitch) > 1.55 ? [-Math.sin(this.yaw), Math.cos(this.yaw), 0] : cross([0, 0, 1], z));
    return {x, y: cross(z, x), z};
  }
  // All of an upright box into the picture.
  fit({low, high}, aspect) {
    this.target = scale(add(low, high), .5);
    const {x, y, z} = this.axes(), t = Math.tan(this.field / 2);
    this.distance = 1.06 * Math.max(...cubeCorners.map(corner => {
      const p = corner.map((c, k) => c * (high[k] - low[k]) / 2);
      return dot(p, z) + Math.max(Math.abs(dot(p, y)) / t, Math.abs(dot(p, x)) / (t * aspect));
    }));
  }
  // Through a point of the picture, in device coordinates (-1 to 1).
  ray(x, y, aspect) {
    const {x: right, y: up, z} = this.axes(), t = Math.tan(this.field / 2);
    return unit(add(add(scale(right, x * t * aspect), scale(up, y * t)), scale(z, -1)));
  }
}
