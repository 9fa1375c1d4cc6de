// ---- The report of a run.

// The distance of two engines, from the vertices of both.
function distanceCurve(frame, a, b) {
  const parts = ['x', 'y', 'z'].map(c => [a.get(`${frame}.position.${c}`), b.get(`${frame}.position.${c}`)]);
  if (parts.some(p => !p[0] || !p[1])) return null;
  const end = Math.min(...parts.flat().map(curve => curve.end));
  const times = Float64Array.from(new Set(parts.flat().flatMap(curve => [...curve.times]))).sort().filter(t => t <= end);
  return new Curve('distance', 'm', () => [times, Float32Array.from(times, t => Math.hypot(...parts.map(([p, q]) => p.at(t) - q.at(t))))]);
}

function shifted(curve, by) { return new Curve(curve.name, curve.unit, () => [curve.times, curve.values.map(v => v + by)]); }

// Plots worth a first look; every other signal is one choice away.
function firstPlots(group, engines, scene) {
  const names = [...engines.keys()], first = engines.get(names[0]), focus = scene.scene.focus;
  const ofEngines = signal => names.map((engine, i) => ({label: engineName(engine), curve: engines.get(engine).get(signal), style: i})).filter(s => s.curve);
  const moves = signal => ofEngines(signal).some(({curve}) => { const [low, high] = curve.range(); return high - low > 0.002 * scene.size; });
  const plot = (title, unitName, series, options) => { if (series.length) group.add(new Plot(group, title, unitName, series, options)); };

  for (const [axis, title] of [['z', 'Height'], ['y', 'Position along the boom'], ['x', 'Position along the quay']])
    if (axis === 'z' || moves(`${focus}.position.${axis}`)) plot(`${title} of ${focus}`, 'm', ofEngines(`${focus}.position.${axis}`));
  plot(`Vertical speed of ${focus}`, 'm/s', ofEngines(`${focus}.velocity.z`));

  const tensions = [...first.keys()].filter(name => name.endsWith('.tension'));
  plot('Rope tension', 'N', tensions.slice(0, 8).map((name, i) => ({label: name.replace(/^rope\.|\.tension$/g, '').replace(/_/g, ' '), curve: first.get(name), style: i})),
    {note: names.length > 1 ? `${engineName(names[0])}.` : ''});
  const forces = [...first.keys()].filter(name => /^contact\..*\.force$/.test(name) && first.get(name).range()[1] > 0)
    .sort((a, b) => first.get(b).range()[1] - first.get(a).range()[1]);
  plot('Contact force', 'N', forces.slice(0, 6).map((name, i) => ({label: name.slice('contact.'.length, -'.force'.length).replace('.', '/'), curve: first.get(name), style: i})),
    {note: [names.length > 1 ? `${engineName(names[0])}.` : '', forces.length > 6 ? `The six hardest of ${forces.length} contacts.` : ''].join(' ').trim()});
  if (names.length > 1) {
    const apart = names.slice(1).map((engine, i) => ({label: engineName(engine), curve: distanceCurve(focus, engines.get(engine), first), style: i + 1})).filter(s => s.curve);
    plot(`Distance of ${focus} to ${engineName(names[0])}`, 'm', apart, {log: true,
      note: `Positions on this page are within ${quantity(data.curves.tolerance.m, 'm', 2)} of the recorded ones: smaller distances are not to be read here, but in the table below.`});
  }
  if (first.has('energy.kinetic')) {
    const start = first.get('energy.potential').values[0];
    const ledger = [['kinetic', 0], ['potential', -start], ['work_in', 0], ['dissipated', 0]];
    plot('Energy', 'J', ledger.map(([name, by], i) => ({label: name === 'potential' ? 'potential, from its start' : name.replace('_', ' '), curve: shifted(first.get('energy.' + name), by), style: i})),
      {note: names.length > 1 ? `${engineName(names[0])}.` : ''});
    plot('Energy residual', 'J', ofEngines('energy.residual'), {note: 'What the balance of energies misses.'});
  }
  plot("Integrator's mean step", 's', ofEngines('solver.mean_step'), {log: true, note: 'Per output interval.'});
  plot('Wall time', 's', ofEngines('solver.wall_time'), {log: true, note: 'Per output interval.'});
}

function plotTools(group, engines) {
  const names = [...engines.keys()], all = [...new Set(names.flatMap(engine => [...engines.get(engine).keys()]))]
    .filter(name => !/^machine\.|^contact\..*\.(point|direction)\.[xyz]$/.test(name));
  const input = element('input', {type: 'text', list: 'signals', id: 'add-signal', placeholder: 'Plot another signal …', 'aria-label': 'Plot another signal', autocomplete: 'off',
    onchange: () => {
      const series = names.map((engine, i) => ({label: engineName(engine), curve: engines.get(engine).get(input.value), style: i})).filter(s => s.curve);
      if (!series.length) return;
      const plot = new Plot(group, input.value, series[0].curve.unit, series, {removable: true});
      group.add(plot, true);
      input.value = '';
    }});
  return element('div', {class: 'plot-tools'}, input, element('datalist', {id: 'signals'}, all.map(name => element('option', {value: name}))),
    element('button', {'aria-label': 'Zoom in on the time', onclick: () => group.zoomBy(.5)}, '+'),
    element('button', {'aria-label': 'Zoom out', onclick: () => group.zoomBy(2)}, '−'),
    element('button', {id: 'show-all', onclick: () => group.showAll()}, 'All'));
}

function helpDialog() {
  const keys = [['Space', 'play, pause'], ['← →', 'one output interval back, on; with Shift a second'], ['Home End', 'to the start, to the end'],
    ['[ ]', 'previous, next event'], ['< >', 'slower, faster'], ['1 – 5', 'cameras'], ['F', 'follow the load'], ['G', 'the other engine as a ghost'],
    ['+ − 0', 'on a plot: zoom in, out, all'], ['?', 'this help']];
  const dialog = element('dialog', {'aria-label': 'Keys'}, element('h2', {}, 'Keys'),
    element('dl', {class: 'pairs'}, keys.flatMap(([key, text]) => [element('dt', {}, key.split(' ').map(k => element('kbd', {}, k))), element('dd', {}, text)])),
    element('p', {class: 'soft'}, 'Drag the picture to turn it, with Shift to move it; wheel or pinch to zoom. Drag across a plot to zoom into it, double-click to see all.'),
    element('form', {method: 'dialog'}, element('button', {}, 'Close')));
  document.body.append(dialog);
  return dialog;
}

function bindKeys(clock, player, dialog, interval) {
  const presets = ['overview', 'load', 'side', 'front', 'top'];
  const faster = way => {
    const {speed} = player, i = Math.min(Math.max(speed.selectedIndex + way, 0), speed.options.length - 1);
    speed.selectedIndex = i;
    clock.speed = Number(speed.value);
  };
  const seek = t => { clock.pause(); clock.seek(t); };
  addEventListener('keydown', e => {
    const {tagName, type} = e.target;
    if (e.ctrlKey || e.metaKey || e.altKey || dialog.open) return;
    if (tagName === 'SELECT' || (tagName === 'INPUT' && type === 'text')) return;
    if (e.key === ' ' && ['BUTTON', 'SUMMARY', 'A'].includes(tagName)) return;
    const step = e.shiftKey ? 1 : interval;
    const actions = {
      ' ': () => clock.toggle(), ArrowLeft: () => seek(clock.time - step), ArrowRight: () => seek(clock.time + step),
      Home: () => seek(0), End: () => seek(clock.duration), '[': () => player.step(-1), ']': () => player.step(1),
      '<': () => faster(-1), '>': () => faster(1), f: () => player.setFollow(!player.follow), '?': () => dialog.showModal(),
      g: () => {
        const other = document.getElementById('other');
        if (!other) return;
        other.value = other.value ? '' : player.engines.find(engine => engine !== player.engine);
        other.dispatchEvent(new Event('change'));
      },
    };
    presets.forEach((key, i) => { actions[i + 1] = () => player.preset(key); });
    const action = actions[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  });
}

function runPage() {
  const {summary} = data, {expectations} = summary;
  const count = verdict => expectations.filter(e => e.verdict === verdict).length;
  const failures = Object.values(summary.engines).filter(e => e.failure).length;
  const state = failures || count('failed') ? 'bad' : count('passed') ? 'good' : 'unknown';
  const verdict = failures ? `✗ ${failures} of ${Object.keys(summary.engines).length} engines stopped early`
    : count('failed') ? `✗ ${count('failed')} of ${expectations.length} expectations fail`
    : expectations.length === 0 ? 'No expectations'
    : `✓ ${count('passed')} of ${expectations.length} expectations hold${count('not checked') ? `, ${count('not checked')} not checked` : ''}`;
  const dialog = helpDialog();
  header(summary.case.title, [summary.case.name, `${number(summary.case.duration, 6)} s`, ...Object.keys(summary.engines).map(engineName), ...summary.interrupted ? ['interrupted'] : []].join(' · '),
    element('a', {class: `pill ${state}`, href: '#expectations', id: 'verdict'}, verdict),
    element('button', {class: 'quiet wordy', onclick: () => dialog.showModal()}, 'Keys'));

  const engines = unpackCurves(data.curves), names = [...engines.keys()].filter(name => (engines.get(name).get('energy.kinetic')?.times.length || 0) > 0);
  const main = document.getElementById('main');
  for (const [name, e] of Object.entries(summary.engines)) if (e.failure) main.append(element('p', {class: 'message'}, `${engineName(name)} stopped: ${e.failure}`));
  let player = null, group = null, plots = null;
  const events = data.events;
  if (names.length) {
    for (const name of [...engines.keys()]) if (!names.includes(name)) engines.delete(name);
    const clock = new Clock(data.curves.duration), interval = summary.case.output_interval;
    player = new Player(clock, new SceneView(data.scene, engines), names, events, interval);
    group = new PlotGroup(clock);
    plots = element('div', {class: 'plots', role: 'region', 'aria-label': 'Plots'});
    main.append(element('div', {class: 'workspace'}, player.element, plots));
    bindKeys(clock, player, dialog, interval);
    theme.listeners.push(() => player.drawMarks());
    player.engineListeners.push(() => player.drawMarks());
    (player.pickListeners ||= []).push(event => { group.picked = event; group.redraw(); });
    // Paper takes what is painted by the time this returns, of 2D canvases alone.
    addEventListener('beforeprint', () => {
      for (const plot of group.plots) { plot.stale = true; plot.redraw(); }
      player.draw();
      const {canvas} = player, paper = element('canvas', {class: 'paper', width: canvas.width, height: canvas.height});
      paper.getContext('2d').drawImage(canvas, 0, 0);
      canvas.before(paper);
    });
    addEventListener('afterprint', () => player.view.querySelector('.paper')?.remove());
    clock.notify();
    player.resize();
    performance.mark('first picture');
  }
  // The picture is on the screen before the rest is made.
  requestAnimationFrame(() => setTimeout(() => {
    if (player) {
      plots.append(plotTools(group, engines), group.element);
      firstPlots(group, engines, player.scene);
    }
    addCards(summary, events, player);
    performance.mark('complete');
    document.documentElement.dataset.ready = 'true';
  }));
}

function addCards(summary, events, player) {
  const wide = made => { made?.classList.add('wide', 'long'); return made; };
  document.getElementById('main').append(element('div', {class: 'columns'}, ...[
    wide(expectationsCard(summary)), wide(enginesCard(summary)), wide(budgetCard(summary)),
    player ? eventsCard(events, player) : null, comparisonCard(summary), sceneCard(summary), originCard(summary)].filter(Boolean)));
  const tolerances = Object.entries(data.curves.tolerance).filter(([unit]) => ['m', 'm/s', 'N', 'J', 'rad'].includes(unit))
    .map(([unit, value]) => quantity(value, unit, 2)).join(', ');
  document.getElementById('footer').append(element('p', {}, `Curves are polylines within ${tolerances} of the recorded values; the trajectories beside this file hold these in full. `
    + 'Arrows have the recorded magnitude of the contact force; its direction and centre of pressure are those of the contact law at the recorded pose. Rails, legs and stays of a crane and the outline of the headblock are drawn to help the eye and are not simulated.'));
}
