// ---- Canvas renderer for browsers without WebGL: the same pictures, faces painted from the farthest to the nearest.

class CanvasRenderer {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.light = unit([.42, -.55, 1.15]);
  }

  draw(views, camera, scene, {groundHeight, reach}) {
    const {context, canvas} = this, width = canvas.width / views.length;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    views.forEach((view, i) => {
      context.save();
      context.beginPath();
      context.rect(i * width, 0, width, canvas.height);
      context.clip();
      context.translate(i * width, 0);
      this.drawOne(view, camera, scene, [width, canvas.height], groundHeight, reach);
      context.restore();
    });
  }

  drawOne({picture, ghost}, camera, scene, size, groundHeight, reach) {
    const {context} = this, colours = theme.boxes, view = camera.matrix(size[0] / size[1]), pixel = devicePixelRatio || 1;
    const at = p => {
      const [x, y, , w] = project(view, p);
      return w > 0 ? [(x + 1) / 2 * size[0], (1 - y) / 2 * size[1]] : null;
    };
    const polygon = (points, fill, stroke, width = 1) => {
      const places = points.map(at);
      if (places.includes(null)) return;
      context.beginPath();
      places.forEach(([x, y], i) => i ? context.lineTo(x, y) : context.moveTo(x, y));
      if (fill) { context.closePath(); context.fillStyle = fill; context.fill(); }
      if (stroke) { context.strokeStyle = stroke; context.lineWidth = width * pixel; context.stroke(); }
    };
    const css = c => typeof c === 'string' ? c : `rgb(${c.map(v => Math.round(255 * v))})`;
    if (groundHeight !== null) {
      const step = reach > 40 ? 10 : 5, [cx, cy] = camera.target.map(v => Math.round(v / step) * step), n = Math.ceil(reach * 1.2 / step);
      for (let i = -n; i <= n; ++i) {
        polygon([[cx + i * step, cy - n * step, groundHeight], [cx + i * step, cy + n * step, groundHeight]], null, colours.grid);
        polygon([[cx - n * step, cy + i * step, groundHeight], [cx + n * step, cy + i * step, groundHeight]], null, colours.grid);
      }
    }
    const things = [];
    for (const box of picture.boxes)
      for (const {corners, normal} of cubeFaces) {
        const n = rotate(box.X.q, normal), points = corners.map(i => transform(box.X, cubeCorners[i].map((v, k) => v * box.half[k])));
        const middle = scale(points.reduce(add), .25);
        if (dot(n, sub(middle, camera.eye)) >= 0) continue;
        const light = .62 + .36 * Math.max(dot(n, this.light), 0) + .06 * n[2];
        const fill = css(rgb(box.colour).map(v => v * light));
        things.push({depth: norm(sub(middle, camera.eye)), draw: () => {
          context.globalAlpha = box.kind === 'left_out' ? .3 : 1;
          polygon([...points, points[0]], fill, colours.edge, .8);
          context.globalAlpha = 1;
        }});
      }
    for (const l of picture.lines)
      things.push({depth: norm(sub(scale(add(l.a, l.b), .5), camera.eye)), draw: () => polygon([l.a, l.b], null, css(l.colour), l.width)});
    for (const thing of things.sort((a, b) => b.depth - a.depth)) thing.draw();
    if (ghost)
      for (const box of ghost.boxes)
        for (const [i, j] of cubeEdges)
          polygon([i, j].map(k => transform(box.X, cubeCorners[k].map((v, axis) => v * box.half[axis]))), null, box.colour, 2);
    for (const arrow of picture.arrows) {
      polygon([arrow.p, arrow.tip], null, colours.force, 3);
      const a = at(arrow.p), b = at(arrow.tip);
      if (!a || !b) continue;
      const angle = Math.atan2(b[1] - a[1], b[0] - a[0]);
      context.beginPath();
      context.moveTo(b[0], b[1]);
      for (const side of [-1, 1]) context.lineTo(b[0] - 14 * pixel * Math.cos(angle + side * .4), b[1] - 14 * pixel * Math.sin(angle + side * .4));
      context.fillStyle = colours.force;
      context.fill();
    }
  }
}
