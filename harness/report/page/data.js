// ---- Data: what the page was made of, and its curves as functions of time.

const data = JSON.parse(document.getElementById('data').textContent);

// A polyline over time. Outside of its span it keeps its first and last value. Most are never looked at: `unpack` gives the
// vertices, [times, values], when they are first asked for.
class Curve {
  constructor(name, unit, unpack) { Object.assign(this, {name, unit, unpack, last: 0}); }

  vertices(which) {
    const [times, values] = this.unpack();
    Object.defineProperties(this, {times: {value: times}, values: {value: values}});
    return this[which];
  }
  get times() { return this.vertices('times'); }
  get values() { return this.vertices('values'); }

  // Index of the last vertex at or before t; remembers where it was, since players ask for the next moment.
  index(t) {
    const {times} = this;
    let i = this.last;
    if (!(times[i] <= t && (i + 1 >= times.length || t < times[i + 1]))) {
      let low = 0, high = times.length - 1;
      while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (times[middle] <= t) low = middle; else high = middle - 1;
      }
      i = low;
    }
    this.last = i;
    return i;
  }

  at(t) {
    const {times, values} = this, n = times.length;
    if (n === 0) return NaN;
    const i = this.index(t);
    if (i + 1 >= n || t <= times[i]) return values[i];
    const part = (t - times[i]) / (times[i + 1] - times[i]);
    return values[i] + part * (values[i + 1] - values[i]);
  }

  get start() { return this.times[0]; }
  get end() { return this.times[this.times.length - 1]; }

  range(from = -Infinity, to = Infinity) {
    let low = Infinity, high = -Infinity;
    const take = v => { if (v < low) low = v; if (v > high) high = v; };
    if (from > this.start) take(this.at(from));
    if (to < this.end) take(this.at(to));
    for (let i = from > this.start ? this.index(from) : 0; i < this.times.length && this.times[i] <= to; ++i)
      if (this.times[i] >= from) take(this.values[i]);
    return [low, high];
  }
}

// Bytes [from, to) of what the text encodes; only their part of it is decoded.
function bytesOf(base64, from, to) {
  const skip = from % 3, text = atob(base64.slice((from - skip) / 3 * 4, Math.ceil(to / 3) * 4)), bytes = new Uint8Array(to - from);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = text.charCodeAt(skip + i);
  return bytes;
}

// Engine name -> Map of curve name -> Curve.
function unpackCurves(packed) {
  const engines = new Map(), tick = packed.duration / 2 ** 32;
  for (const [engine, table] of Object.entries(packed.engines)) {
    const curves = new Map();
    let end = 0;
    table.names.forEach((name, i) => {
      const count = table.counts[i], first = end;
      end += 8 * count;
      curves.set(name, new Curve(name, table.units[i], () => {
        const {buffer} = bytesOf(table.data, first, first + 8 * count), ticks = new Uint32Array(buffer, 0, count), times = new Float64Array(count);
        for (let k = 0; k < count; ++k) times[k] = ticks[k] * tick;
        // The end itself is one tick beyond what 32 bits hold.
        if (count && times[count - 1] > packed.duration - 2 * tick) times[count - 1] = packed.duration;
        return [times, new Float32Array(buffer, 4 * count, count)];
      }));
    });
    engines.set(engine, curves);
  }
  return engines;
}

// Numbers as people read them: up to `digits` significant ones, no "1e+3", a true minus sign.
function number(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  let text;
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
    const superscript = String(Number(exponent)).replace(/[-\d]/g, c => c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[c]);
    const short = mantissa.includes('.') ? mantissa.replace(/\.?0+$/, '') : mantissa;
    text = (short === '1' ? '' : short === '-1' ? '-' : short + '·') + '10' + superscript;
  } else {
    text = value.toPrecision(Math.max(digits, Math.ceil(Math.log10(size + 1))));
    if (text.includes('.')) text = text.replace(/\.?0+$/, '');
  }
  return text.replace(/^-/, '−');
}

// A prefix that brings values of this size to handy numbers: {factor: 1e-3, unit: 'kN'}.
function scaled(size, unit) {
  if (!['N', 'J', 'N s', 's', 'W', 'm'].includes(unit) || !(size > 0)) return {factor: 1, unit: unit === '1' ? '' : unit};
  const prefixes = {m: [[1, ''], [1e3, 'm'], [1e6, 'µ'], [1e9, 'n']], s: [[1, ''], [1e3, 'm'], [1e6, 'µ'], [1e9, 'n']]}[unit]
    || [[1e-6, 'M'], [1e-3, 'k'], [1, ''], [1e3, 'm'], [1e6, 'µ']];
  const [factor, prefix] = prefixes.find(([f]) => size * f >= 1) || prefixes[prefixes.length - 1];
  return {factor, unit: prefix + unit};
}

function quantity(value, unit, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return '–';
  const s = scaled(Math.abs(value), unit);
  return number(value * s.factor, digits) + (s.unit ? ' ' + s.unit : '');
}

// element('td', {class: 'number', onclick: f}, 'text', child, ...); nothing comes of null.
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat()) if (child !== null && child !== undefined) made.append(child);
  return made;
}
