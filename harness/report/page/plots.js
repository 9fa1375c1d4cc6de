// ---- Plots: curves over the player's time, all with one zoom and one cursor.

const plotMargin = {left: 62, right: 10, top: 8, bottom: 22};

// Round numbers in [low, high], about `most` of them and two at least.
function ticks(low, high, most) {
  const raw = (high - low) / most, decade = 10 ** Math.floor(Math.log10(raw));
  const step = decade * ([1, 2, 5].find(f => f * decade >= raw) || 10), found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) found.push(k * step);
  if (found.length < 2 && most < 40) return ticks(low, high, 2 * most);
  return {found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

// The zoom and the cursor that plots share.
class PlotGroup {
  constructor(clock, events) {
    Object.assign(this, {clock, events, from: 0, to: clock.duration, hover: null, plots: [], element: element('div', {class: 'plots', id: 'plots'})});
    clock.onChange(() => this.redraw());
    theme.listeners.push(() => this.refresh());
    this.resizes = new ResizeObserver(entries => { for (const {target} of entries) target.plot.resize(); });
    this.sights = new IntersectionObserver(entries => {
      for (const {target, isIntersecting} of entries) { target.plot.visible = isIntersecting; if (isIntersecting) target.plot.redraw(); }
    }, {rootMargin: '200px'});
  }
  add(plot, first = false) {
    this.plots.push(plot);
    first ? this.element.prepend(plot.element) : this.element.append(plot.element);
    this.resizes.observe(plot.canvas);
    this.sights.observe(plot.canvas);
  }
  remove(plot) {
    this.plots.splice(this.plots.indexOf(plot), 1);
    plot.element.remove();
  }
  zoom(from, to) {
    const {duration} = this.clock, width = Math.min(Math.max(to - from, duration * 1e-6), duration);
    this.from = Math.min(Math.max(from, 0), duration - width);
    this.to = this.from + width;
    this.element.dataset.from = this.from;
    this.element.dataset.to = this.to;
    this.refresh();
  }
  zoomBy(factor, about = this.clock.time) {
    const middle = Math.min(Math.max(about, this.from), this.to);
    this.zoom(middle - (middle - this.from) * factor, middle + (this.to - middle) * factor);
  }
  showAll() { this.zoom(0, this.clock.duration); }
  refresh() { for (const plot of this.plots) plot.stale = true; this.redraw(); }
  redraw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      for (const plot of this.plots) if (plot.visible) plot.redraw();
    });
  }
}

class Plot {
  // series: [{label, curve, style}]; options: log, note, removable
  constructor(group, title, unitName, series, {log = false, note = '', removable = false} = {}) {
    Object.assign(this, {group, title, unit: unitName, series, log, stale: true, visible: false});
    this.canvas = element('canvas', {tabindex: 0, role: 'img', 'aria-label': title});
    this.canvas.plot = this;
    this.heading = element('h3', {}, title);
    this.keys = series.map(s => {
      const key = element('span', {class: 'key'});
      key.innerHTML = `<svg width="26" height="8" aria-hidden="true"><line x1="0" x2="26" y1="4" y2="4" stroke-width="2.4"/></svg>`;
      const value = element('b');
      key.append(s.label + ' ', value);
      return {key, line: key.querySelector('line'), value, s};
    });
    const close = removable ? element('button', {class: 'close quiet', 'aria-label': `Remove ${title}`, onclick: () => group.remove(this)}, '×') : null;
    this.element = element('div', {class: 'plot'}, element('header', {}, this.heading, element('div', {class: 'keys'}, this.keys.map(k => k.key)), close),
      this.canvas, note ? element('p', {class: 'soft'}, element('small', {}, note)) : null);
    this.bind();
  }

  summary() {
    return `${this.title}. ` + this.series.map(({label, curve}) => {
      const [low, high] = curve.range();
      return `${label}: from ${quantity(low, this.unit, 3)} to ${quantity(high, this.unit, 3)}`;
    }).join('; ');
  }

  resize() {
    const ratio = devicePixelRatio || 1;
    [this.width, this.height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.stale = true;
    if (this.visible) this.redraw();
  }

  x(t) { return plotMargin.left + (this.width - plotMargin.left - plotMargin.right) * (t - this.group.from) / (this.group.to - this.group.from); }
  time(x) { return this.group.from + (x - plotMargin.left) / (this.width - plotMargin.left - plotMargin.right) * (this.group.to - this.group.from); }
  y(v) { return this.height - plotMargin.bottom - (this.height - plotMargin.top - plotMargin.bottom) * ((this.log ? Math.log10(v) : v) - this.low) / (this.high - this.low); }

  setRange() {
    const {from, to} = this.group;
    let low = Infinity, high = -Infinity;
    for (const {curve} of this.series) {
      const [a, b] = curve.range(from, to);
      if (this.log) {
        // From what is drawn, not from zeros.
        for (let i = Math.max(curve.index(from), 0); i < curve.times.length && curve.times[i] <= to; ++i)
          if (curve.values[i] > 0) { low = Math.min(low, curve.values[i]); high = Math.max(high, curve.values[i]); }
      } else {
        low = Math.min(low, a);
        high = Math.max(high, b);
      }
    }
    if (!(low <= high)) [low, high] = this.log ? [1e-6, 1] : [0, 1];
    this.largest = Math.max(Math.abs(low), Math.abs(high));
    if (this.log) {
      [this.low, this.high] = [Math.log10(low), Math.log10(high)];
      const room = Math.max(.06 * (this.high - this.low), .15);
      this.low -= room;
      this.high += room;
      return;
    }
    // What lies within the error of the data is not blown up.
    const least = 20 * (data.curves.tolerance[this.unit] || 0) || 1e-9 * (this.largest || 1);
    if (high - low < least) [low, high] = [(low + high - least) / 2, (low + high + least) / 2];
    const room = .06 * (high - low);
    [this.low, this.high] = [low - room, high + room];
  }

  paint() {
    this.stale = false;
    this.canvas.setAttribute('aria-label', this.summary());
    this.setRange();
    const ratio = devicePixelRatio || 1, {width, height} = this, {left, right, top, bottom} = plotMargin;
    this.base ||= document.createElement('canvas');
    this.base.width = this.canvas.width;
    this.base.height = this.canvas.height;
    const c = this.base.getContext('2d');
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.font = '12px system-ui, sans-serif';
    const s = this.log ? {factor: 1, unit: this.unit} : scaled(this.largest, this.unit);
    this.heading.textContent = s.unit && s.unit !== '1' && !this.log ? `${this.title} [${s.unit}]` : this.title;
    this.decimals = Math.min(Math.max(3 - Math.floor(Math.log10((this.high - this.low) * s.factor)), 0), 9);
    const soft = theme.css('soft'), line = theme.css('line');
    c.strokeStyle = line;
    c.lineWidth = 1;
    c.fillStyle = soft;
    c.textAlign = 'right';
    c.textBaseline = 'middle';
    if (this.log) {
      const step = Math.max(1, Math.ceil((this.high - this.low) / 4));
      for (let k = Math.ceil(this.low / step) * step; k <= this.high; k += step) this.gridLine(c, this.y(10 ** k), quantity(10 ** k, this.unit, 1));
      if (this.high - this.low < 2)
        for (let k = Math.floor(this.low); k <= this.high; ++k)
          for (const f of [2, 5]) if (Math.log10(f) + k > this.low && Math.log10(f) + k < this.high) this.gridLine(c, this.y(f * 10 ** k), quantity(f * 10 ** k, this.unit, 1));
    } else {
      const {found, digits} = ticks(this.low * s.factor, this.high * s.factor, 4);
      for (const v of found) this.gridLine(c, this.y(v / s.factor), v.toFixed(digits).replace('-', '−').replace(/^−(0(\.0*)?)$/, '$1'));
    }
    c.textAlign = 'center';
    c.textBaseline = 'alphabetic';
    const {found, digits} = ticks(this.group.from, this.group.to, Math.max(2, (width - left) / 75));
    for (const t of found) {
      if (this.x(t) > width - 62) continue;  // there stands the unit
      c.fillText(t.toFixed(digits), this.x(t), height - 7);
      c.beginPath();
      c.moveTo(this.x(t), height - bottom);
      c.lineTo(this.x(t), height - bottom + 4);
      c.stroke();
    }
    c.textAlign = 'right';
    c.fillText('time [s]', width - 1, height - 7);

    c.save();
    c.beginPath();
    c.rect(left, top - 2, width - left - right, height - top - bottom + 4);
    c.clip();
    c.lineJoin = 'round';
    for (const {curve, style} of this.series) {
      c.beginPath();
      c.strokeStyle = theme.series(style);
      c.setLineDash(seriesDashes[style % 8]);
      c.lineWidth = 1.8;
      let down = false;
      const first = Math.max(curve.index(this.group.from), 0);
      for (let i = first; i < curve.times.length; ++i) {
        const v = curve.values[i], drawable = Number.isFinite(v) && (!this.log || v > 0);
        if (drawable) down ? c.lineTo(this.x(curve.times[i]), this.y(v)) : c.moveTo(this.x(curve.times[i]), this.y(v));
        down = drawable;
        if (curve.times[i] > this.group.to) break;
      }
      c.stroke();
    }
    c.restore();
    for (const {line: l, s: {style}} of this.keys) {
      l.setAttribute('stroke', theme.series(style));
      l.setAttribute('stroke-dasharray', seriesDashes[style % 8].join(' '));
    }
  }

  gridLine(c, y, label) {
    if (y < plotMargin.top - 1 || y > this.height - plotMargin.bottom + 1) return;
    c.beginPath();
    c.moveTo(plotMargin.left, Math.round(y) + .5);
    c.lineTo(this.width - plotMargin.right, Math.round(y) + .5);
    c.stroke();
    c.fillText(label, plotMargin.left - 7, y);
  }

  redraw() {
    if (!this.canvas.width || !this.canvas.height) return;
    if (this.stale) this.paint();
    const ratio = devicePixelRatio || 1, c = this.canvas.getContext('2d'), {top, bottom} = plotMargin, {height, group} = this;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    c.drawImage(this.base, 0, 0);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    const upright = (t, colour, width) => {
      if (t < group.from || t > group.to) return;
      c.beginPath();
      c.moveTo(this.x(t), top);
      c.lineTo(this.x(t), height - bottom);
      c.strokeStyle = colour;
      c.lineWidth = width;
      c.stroke();
    };
    if (group.picked) { c.setLineDash([3, 3]); upright(group.picked.time, theme.css('strong-line'), 1); c.setLineDash([]); }
    upright(group.clock.time, theme.css('text'), 1.4);
    if (this.selection) {
      c.fillStyle = theme.css('accent');
      c.globalAlpha = .18;
      c.fillRect(this.selection[0], top, this.selection[1] - this.selection[0], height - top - bottom);
      c.globalAlpha = 1;
    }
    const t = group.hover ?? group.clock.time;
    if (group.hover !== null) upright(group.hover, theme.css('strong-line'), 1);
    const s = this.log ? {factor: 1} : scaled(this.largest, this.unit);
    for (const {value, s: {curve, style}} of this.keys) {
      const v = curve.at(t);
      const text = Number.isFinite(v) ? this.log ? quantity(v, this.unit, 3) : (v * s.factor).toFixed(this.decimals).replace('-', '−') : '';
      if (value.textContent !== text) value.textContent = text;
      if (t < group.from || t > group.to || !Number.isFinite(v) || (this.log && !(v > 0))) continue;
      c.beginPath();
      c.arc(this.x(t), this.y(v), 3, 0, 7);
      c.fillStyle = theme.series(style);
      c.fill();
    }
  }

  bind() {
    const {canvas, group} = this;
    let begin = null;
    canvas.addEventListener('pointerdown', e => {
      begin = e.offsetX;
      try { canvas.setPointerCapture(e.pointerId); } catch { /* a pointer that has gone already */ }
    });
    canvas.addEventListener('pointermove', e => {
      if (begin !== null && e.pointerType === 'touch') {
        group.clock.pause();
        group.clock.seek(this.time(e.offsetX));
        return;
      }
      if (begin !== null && Math.abs(e.offsetX - begin) > 4) this.selection = [begin, e.offsetX];
      group.hover = Math.min(Math.max(this.time(e.offsetX), group.from), group.to);
      group.redraw();
    });
    const done = e => {
      const selection = this.selection;
      this.selection = null;
      if (begin === null) return;
      begin = null;
      if (selection) {
        const [a, b] = selection.map(x => this.time(x)).sort((p, q) => p - q);
        group.zoom(a, b);
      } else if (e.type === 'pointerup') {
        group.clock.pause();
        group.clock.seek(this.time(e.offsetX));
      }
    };
    canvas.addEventListener('pointerup', done);
    canvas.addEventListener('pointercancel', done);
    canvas.addEventListener('pointerleave', () => { group.hover = null; group.redraw(); });
    canvas.addEventListener('dblclick', () => group.showAll());
    canvas.addEventListener('wheel', e => {
      if (!e.ctrlKey && !e.metaKey) return;  // else the page scrolls
      e.preventDefault();
      group.zoomBy(Math.exp(e.deltaY * .004), this.time(e.offsetX));
    }, {passive: false});
    canvas.addEventListener('keydown', e => {
      if (e.key === '+' || e.key === '=') group.zoomBy(.5);
      else if (e.key === '-') group.zoomBy(2);
      else if (e.key === '0') group.showAll();
      else return;
      e.preventDefault();
      e.stopPropagation();
    });
  }
}
