// ---- The report of a sweep: speed against error, every point named.

const markShapes = [(x, y, r) => `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`,
  (x, y, r) => `M${x - r} ${y - r}h${2 * r}v${2 * r}h${-2 * r}z`, (x, y, r) => `M${x} ${y - 1.3 * r}l${1.3 * r} ${1.3 * r}l${-1.3 * r} ${1.3 * r}l${-1.3 * r} ${-1.3 * r}z`,
  (x, y, r) => `M${x} ${y - 1.2 * r}l${1.25 * r} ${2.2 * r}h${-2.5 * r}z`, (x, y, r) => `M${x} ${y + 1.2 * r}l${1.25 * r} ${-2.2 * r}h${-2.5 * r}z`];

function svgElement(tag, attributes = {}, ...children) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) name.startsWith('on') ? made.addEventListener(name.slice(2), value) : made.setAttribute(name, value);
  made.append(...children);
  return made;
}

// Error across, wall time per simulated second up, both in decades: near the lower left corner is best.
function errorChart(points, groups, pick) {
  const narrow = innerWidth < 700, [W, H] = narrow ? [460, 440] : [1000, 560], left = 86, right = 24, top = 22, bottom = 58, good = points.filter(p => !p.failure && p.rms > 0 && p.wall_s > 0);
  const svg = svgElement('svg', {viewBox: `0 0 ${W} ${H}`, role: 'group', id: 'chart', 'aria-label': 'Speed against error. The table below has the same points.', 'font-size': 14, style: 'width:100%;height:auto'});
  if (!good.length) return element('p', {class: 'soft'}, 'No run came to its end with an error to show.');
  const range = values => {
    const [low, high] = [Math.log10(Math.min(...values)), Math.log10(Math.max(...values))], room = Math.max(.08 * (high - low), .25);
    return [low - room, high + room];
  };
  const xs = range(good.map(p => p.rms)), ys = range(good.map(p => p.per_second));
  const x = v => left + (W - left - right) * (Math.log10(v) - xs[0]) / (xs[1] - xs[0]);
  const y = v => H - bottom - (H - top - bottom) * (Math.log10(v) - ys[0]) / (ys[1] - ys[0]);
  const text = (content, attributes) => svgElement('text', {fill: 'var(--soft)', ...attributes}, content);
  for (const [span, along] of [[xs, true], [ys, false]]) {
    const every = Math.ceil((span[1] - span[0]) / (narrow && along ? 4 : 10)), values = [];
    for (let k = Math.ceil(span[0]) - 1; k <= span[1]; k += every)
      for (const f of span[1] - span[0] < 2 ? [1, 2, 5] : [1]) values.push(f * 10 ** k);
    for (const v of values.filter(v => Math.log10(v) >= span[0] && Math.log10(v) <= span[1])) {
      svg.append(along ? svgElement('path', {d: `M${x(v)} ${top}V${H - bottom}`, stroke: 'var(--line)'}) : svgElement('path', {d: `M${left} ${y(v)}H${W - right}`, stroke: 'var(--line)'}),
        along ? text(quantity(v, 'm', 1), {x: x(v), y: H - bottom + 22, 'text-anchor': 'middle'}) : text(quantity(v, 's', 1), {x: left - 10, y: y(v) + 5, 'text-anchor': 'end'}));
    }
  }
  if (ys[0] < 0 && ys[1] > 0)
    svg.append(svgElement('path', {d: `M${left} ${y(1)}H${W - right}`, stroke: 'var(--strong-line)', 'stroke-dasharray': '6 4'}),
      text('real time', {x: W - right - 4, y: y(1) - 6, 'text-anchor': 'end'}));
  svg.append(text('error: rms distance to the converged reference', {x: (left + W - right) / 2, y: H - 12, 'text-anchor': 'middle'}),
    text('wall time per simulated second', {transform: `translate(18 ${(top + H - bottom) / 2}) rotate(-90)`, 'text-anchor': 'middle'}));
  groups.forEach((label, i) => {
    const own = good.filter(p => p.label === label), colour = theme.series(i), dash = seriesDashes[i % 8].join(' ');
    svg.append(svgElement('path', {d: own.map((p, k) => `${k ? 'L' : 'M'}${x(p.rms).toFixed(1)} ${y(p.per_second).toFixed(1)}`).join(''), fill: 'none', stroke: colour, 'stroke-width': 1.6, 'stroke-dasharray': dash, opacity: .75}));
    for (const p of own) {
      const name = `${label}, ${p.setting_text}: ${quantity(p.rms, 'm', 3)}, ${quantity(p.per_second, 's', 3)} per simulated second${p.front ? ', on the front' : ''}`;
      svg.append(svgElement('path', {d: markShapes[i % 5](x(p.rms), y(p.per_second), p.front ? 6.5 : 5), fill: p.front ? colour : 'var(--surface)', stroke: colour, 'stroke-width': 2,
        class: 'point', role: 'button', tabindex: 0, 'aria-label': name, style: 'cursor:pointer', onclick: () => pick(p), onkeydown: e => { if (e.key === 'Enter' || e.key === ' ') { e.preventDefault(); pick(p); } }},
      svgElement('title', {}, name)));
    }
  });
  // Names of the points on the front, each where no other stands.
  const taken = [];
  for (const p of good.filter(q => q.front).sort((a, b) => a.rms - b.rms)) {
    const label = `${p.label} ${p.setting_text}`, width = 7.2 * label.length;
    const spots = [[12, -10], [12, 20], [-12 - width, -10], [-12 - width, 20]].map(([dx, dy]) => [x(p.rms) + dx, y(p.per_second) + dy]);
    const free = spots.find(([a, b]) => a > left && a + width < W && b > top + 8 && b < H - bottom && !taken.some(([c, d, w]) => a < c + w && c < a + width && Math.abs(b - d) < 16));
    if (!free) continue;
    taken.push([...free, width]);
    svg.append(svgElement('text', {x: free[0], y: free[1], fill: 'var(--text)', 'font-size': 13}, label));
  }
  return svg;
}

function sweepPage() {
  const points = data.points.map((p, i) => ({...p, place: i, per_second: p.wall_s / data.simulated_s,
    setting_text: p.engine === 'simbody' ? number(p.setting, 2) : quantity(p.setting, 's', 2)}));
  const groups = [...new Set(points.map(p => p.label))], failed = points.filter(p => p.failure);
  header(data.title, ['Speed against error', `${number(data.simulated_s, 6)} s simulated`, `${points.length} settings`, ...data.interrupted ? ['interrupted'] : []].join(' · '),
    element('span', {class: `pill ${failed.length ? 'bad' : 'good'}`}, failed.length ? `✗ ${failed.length} of ${points.length} settings failed` : `✓ all ${points.length} settings came to the end`));
  const columns = [
    {title: 'Contender', text: p => p.label, value: p => p.label},
    {title: 'Setting', number: true, value: p => p.setting, text: p => p.setting_text},
    {title: 'Error (rms)', number: true, value: p => p.failure ? null : p.rms, text: p => p.failure ? '' : quantity(p.rms, 'm', 3)},
    {title: 'Error (largest)', number: true, value: p => p.failure ? null : p.max, text: p => p.failure ? '' : quantity(p.max, 'm', 3)},
    {title: 'Took', number: true, value: p => p.wall_s, text: p => quantity(p.wall_s, 's', 3)},
    {title: 'Real time', number: true, value: p => p.failure ? null : data.simulated_s / p.wall_s, text: p => p.failure ? '' : `${number(data.simulated_s / p.wall_s, 3)} ×`},
    {title: 'Steps', number: true, value: p => p.steps, text: p => number(p.steps, 8)},
    {title: 'Evaluations', number: true, value: p => p.evaluations, text: p => number(p.evaluations, 8)},
    {title: 'Result', value: p => p.failure ? 0 : p.front ? 1 : 2, text: p => p.failure ? element('span', {class: 'verdict bad'}, '✗ failed: ', element('span', {style: 'font-weight:400;white-space:normal'}, p.failure)) : p.front ? element('span', {class: 'verdict good'}, '● front') : ''},
  ];
  const order = points.slice().sort((a, b) => (a.failure ? 0 : 1) - (b.failure ? 0 : 1) || a.place - b.place);
  const all = table(columns, order, {label: 'All settings'});
  all.id = 'points';
  const pick = p => {
    for (const row of all.querySelectorAll('tr.current')) row.classList.remove('current');
    const row = all.rowOf.get(p);
    row.classList.add('current');
    row.scrollIntoView({block: 'center'});
  };
  const holder = element('div'), keys = element('div', {class: 'legend'});
  const draw = () => {
    holder.replaceChildren(errorChart(points, groups, pick));
    keys.replaceChildren(...groups.map((label, i) => {
      const svg = svgElement('svg', {width: 34, height: 14, 'aria-hidden': 'true', style: 'vertical-align:middle;margin-right:.35em'},
        svgElement('path', {d: 'M0 7H34', stroke: theme.series(i), 'stroke-dasharray': seriesDashes[i % 8].join(' '), 'stroke-width': 1.6}),
        svgElement('path', {d: markShapes[i % 5](17, 7, 4.5), fill: 'var(--surface)', stroke: theme.series(i), 'stroke-width': 2}));
      return element('span', {}, svg, label);
    }));
  };
  theme.listeners.push(draw);
  draw();
  document.getElementById('main').append(card('Speed against error', 'speed-error', holder, keys,
    element('p', {class: 'soft'}, 'Filled: on the front, no other setting is both faster and nearer to the reference. ', data.references)),
  card('All settings, failures first', 'settings', all), originCard({versions: data.versions, command: data.command, case: {file: data.file}}));
  document.documentElement.dataset.ready = 'true';
}
