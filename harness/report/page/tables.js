// ---- Tables and cards: what was judged, counted and left out.

const verdictMark = {passed: ['good', '✓ holds'], failed: ['bad', '✗ fails'], 'not checked': ['unknown', '– not checked']};

function card(title, id, ...content) {
  return element('section', {class: 'card', 'aria-labelledby': id}, element('h2', {id}, title), ...content.filter(Boolean));
}

// columns: [{title, text(row), value(row): what it sorts by, number, wide}]; options: pick(row), first order given by `rows`.
function table(columns, rows, {pick = null, label = null, stack = true, sortable = rows.length > 2} = {}) {
  const body = element('tbody'), heads = [];
  let order = null, down = false;
  const made = rows.map(row => {
    const tr = element('tr', pick ? {class: 'pick', onclick: () => pick(row)} : {});
    columns.forEach((column, i) => {
      const content = column.text(row);
      const inner = pick && i === 0 ? element('button', {class: 'link'}, content) : content;
      tr.append(element('td', {class: column.number ? 'number' : null, 'data-title': column.title || null}, inner ?? ''));
    });
    return {row, tr};
  });
  const fill = () => {
    const sorted = made.slice();
    if (order) {
      const key = ({row}) => order.value ? order.value(row) : order.text(row);
      sorted.sort((a, b) => {
        const [x, y] = [key(a), key(b)];
        if (x === y) return 0;
        if (x === null || x === undefined) return 1;
        if (y === null || y === undefined) return -1;
        return (x < y ? -1 : 1) * (down ? -1 : 1);
      });
    }
    body.replaceChildren(...sorted.map(({tr}) => tr));
  };
  const head = element('tr', {}, columns.map(column => {
    const th = element('th', {scope: 'col', class: column.number ? 'number' : null});
    if (!sortable || !column.title) th.append(column.title);
    else th.append(element('button', {class: 'quiet', onclick: () => {
      down = order === column ? !down : !!column.number && false;
      order = column;
      for (const other of heads) other.removeAttribute('aria-sort');
      th.setAttribute('aria-sort', down ? 'descending' : 'ascending');
      fill();
    }}, column.title));
    heads.push(th);
    return th;
  }));
  fill();
  const whole = element('table', {class: stack ? 'stack' : null, 'aria-label': label}, element('thead', {}, head), body);
  whole.rowOf = new Map(made.map(({row, tr}) => [row, tr]));
  return whole;
}

function pairs(entries) {
  return element('dl', {class: 'pairs'}, entries.filter(([, value]) => value !== null && value !== undefined && value !== '')
    .flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]));
}

const failuresFirst = list => list.slice().sort((a, b) => ['failed', 'not checked', 'passed'].indexOf(a.verdict) - ['failed', 'not checked', 'passed'].indexOf(b.verdict));

function expectationsCard({expectations}) {
  if (!expectations.length) return card('Expectations', 'expectations', element('p', {class: 'soft'}, 'The case states none.'));
  const sign = e => element('span', {class: `verdict ${verdictMark[e.verdict][0]}`}, verdictMark[e.verdict][1]);
  return card('Expectations', 'expectations', table([
    {title: '', text: sign},
    {title: 'Expected', text: e => e.text},
    {title: 'Found', text: e => e.finding},
    {title: 'Why', text: e => element('span', {class: 'soft'}, e.why || '')},
  ], failuresFirst(expectations), {label: 'Expectations', sortable: false}));
}

function enginesCard({engines, real_time: pacing}) {
  const rows = Object.entries(engines).map(([name, e]) => ({name, ...e}));
  const share = e => e.energy.largest_exchange > 0 ? e.energy.residual / e.energy.largest_exchange : null;
  return card('Engines', 'engines', table([
    {title: 'Engine', text: e => engineName(e.name)},
    {title: 'Simulated', number: true, text: e => `${number(e.simulated_s, 5)} s`},
    {title: 'Took', number: true, text: e => quantity(e.wall_s, 's', 3)},
    {title: 'Real time', number: true, text: e => e.real_time_factor === null ? '–' : `${number(e.real_time_factor, 3)} ×`},
    {title: 'Steps', number: true, text: e => number(e.steps, 7)},
    {title: 'Evaluations', number: true, text: e => number(e.rhs_evaluations, 7)},
    {title: 'Contacts asked', number: true, text: e => number(e.contact_queries, 7)},
    {title: 'Fall-backs', number: true, text: e => number(e.contact_fallbacks, 7)},
    {title: 'Energy residual', number: true, text: e => `${quantity(e.energy.residual, 'J', 3)}${share(e) === null ? '' : ` (${number(share(e), 2)} of the exchange)`}`},
  ], rows, {label: 'Engines', sortable: false}),
  pacing ? element('p', {class: 'soft'}, `Paced by the clock: ${number(pacing.late, 8)} of ${number(pacing.frames, 8)} frames late (${number(100 * pacing.late / pacing.frames, 2)} %), by ${quantity(Math.max(pacing.latest_s, 0), 's', 3)} at most.`) : null,
  ...rows.filter(e => e.failure).map(e => element('p', {class: 'message', role: 'note'}, `${engineName(e.name)} stopped: ${e.failure}`)));
}

function comparisonCard({comparison}) {
  const parts = Object.entries(comparison).map(([engine, c]) => {
    const rows = Object.entries(c.signals).filter(([name]) => /\.(position|orientation|tension)$/.test(name)).map(([name, s]) => ({name, ...s}))
      .sort((a, b) => a.unit === b.unit ? b.rms - a.rms : a.unit < b.unit ? 1 : -1).slice(0, 12);
    return [element('h3', {}, `${engineName(engine)} against ${engineName(c.reference)}`),
      table([
        {title: 'Signal', text: s => s.name},
        {title: 'rms', number: true, value: s => s.rms, text: s => quantity(s.rms, s.unit, 3)},
        {title: 'Largest', number: true, value: s => s.max, text: s => quantity(s.max, s.unit, 3)},
        {title: 'at', number: true, value: s => s.max_time, text: s => `${number(s.max_time, 4)} s`},
        {title: 'At the end', number: true, value: s => s.end, text: s => quantity(s.end, s.unit, 3)},
      ], rows, {label: `Distance of ${engineName(engine)} to ${engineName(c.reference)}`}),
      element('p', {class: 'soft'}, `Events: ${c.events.matched.length} in both, ${c.events.only_first.length} only in ${engineName(c.reference)}, ${c.events.only_second.length} only in ${engineName(engine)}.`)];
  });
  return parts.length ? card('Engines apart', 'comparison', ...parts) : null;
}

function eventsCard(events, player) {
  const holder = element('div');
  const show = engine => {
    const list = events[engine] || [];
    const made = table([
      {title: 'Time', text: e => `${e.time.toFixed(4)} s`, value: e => e.time},
      {title: 'Event', text: e => eventTexts[e.event] || e.event},
      {title: 'Subject', text: e => e.subject},
      {title: 'Impulse', number: true, value: e => e.impulse, text: e => e.impulse ? quantity(e.impulse, 'N s', 4) : ''},
      {title: 'Peak force', number: true, value: e => e.peak_force, text: e => e.peak_force ? quantity(e.peak_force, 'N', 4) : ''},
      {title: 'Duration', number: true, value: e => e.duration, text: e => e.duration ? quantity(e.duration, 's', 3) : ''},
    ], list, {label: `Events in ${engineName(engine)}`, pick: e => player.goTo(e)});
    made.id = 'event-table';
    holder.replaceChildren(list.length ? element('div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Events'}, made) : element('p', {class: 'soft'}, 'Nothing happened.'));
    holder.rowOf = made.rowOf;
  };
  show(player.engine);
  player.engineListeners.push(show);
  (player.pickListeners ||= []).push(event => {
    for (const row of holder.querySelectorAll('tr.current')) row.classList.remove('current');
    const row = holder.rowOf.get(event);
    if (!row) return;
    row.classList.add('current');
    const box = row.closest('.scroll');
    if (box) box.scrollTop = row.offsetTop - box.clientHeight / 2;
  });
  return card('Events', 'events', holder);
}

function sceneCard({scene, contact, solver}) {
  const change = (now, before) => now === before ? number(now, 7) : `${number(now, 7)} of ${number(before, 7)}`;
  const before = scene.before_reduction;
  return card('Scene, and what was left out', 'scene',
    pairs([['Bodies', change(scene.bodies, before.bodies)], ['Degrees of freedom', change(scene.degrees_of_freedom, before.degrees_of_freedom)],
      ['Contact pairs', change(scene.contact_pairs, before.contact_pairs)],
      ['Contact', `${contact.law} law, ${contact.model} model, stiffness ${number(contact.stiffness)} N/m, restitution ${number(contact.restitution)} at ${number(contact.reference_speed)} m/s, friction ${number(contact.friction)}`],
      ['Solver', `relative tolerance ${number(solver.relative_tolerance)}${solver.mujoco_step ? `, MuJoCo's step ${quantity(solver.mujoco_step, 's')}` : ''}`]]),
    element('h3', {}, 'Left out, merged or held still'),
    scene.left_out.length ? table([{title: 'What', text: e => e.what}, {title: 'Reason', text: e => e.reason}], scene.left_out, {label: 'Left out', sortable: false})
      : element('p', {class: 'soft'}, 'Nothing: the scene was simulated in full.'));
}

function budgetCard({error_budget: budget}) {
  if (!budget?.length) return null;
  return card('Error budget', 'budget', table([
    {title: 'Share of', text: r => r.share},
    {title: 'Found by comparing', text: r => r.failure ? element('span', {class: 'verdict bad'}, r.failure) : element('span', {class: 'soft'}, r.comparison)},
    {title: 'Position, rms', number: true, value: r => r.position?.rms, text: r => r.position ? quantity(r.position.rms, 'm', 3) : ''},
    {title: 'Largest', number: true, value: r => r.position?.max, text: r => r.position ? quantity(r.position.max, 'm', 3) : ''},
    {title: 'At the end', number: true, value: r => r.position?.end, text: r => r.position ? quantity(r.position.end, 'm', 3) : ''},
    {title: 'Impulse', number: true, value: r => r.impulse?.largest_difference, text: r => r.impulse ? `${quantity(r.impulse.largest_difference, 'N s', 3)} of ${quantity(r.impulse.largest, 'N s', 3)}` : ''},
    {title: 'Peak force', number: true, value: r => r.peak_force?.largest_difference, text: r => r.peak_force ? quantity(r.peak_force.largest_difference, 'N', 3) : ''},
    {title: 'Impacts unmatched', number: true, value: r => r.impacts_unmatched, text: r => r.impacts_unmatched ?? ''},
  ], budget, {label: 'Error budget'}));
}

function originCard({versions, command, case: description}) {
  return card('How to make this again', 'origin', element('pre', {class: 'command'}, command),
    element('h3', {}, 'Made with'), pairs([['Case', description.file], ...Object.entries(versions)]));
}

function header(title, facts, ...more) {
  document.getElementById('header').append(element('div', {}, element('h1', {}, title), element('p', {class: 'facts'}, facts)),
    element('div', {class: 'actions'}, ...more, themeButton()));
}
