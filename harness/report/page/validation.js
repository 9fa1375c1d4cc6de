// ---- The report of a validation: all cases, failing ones first.

function validationPage() {
  const states = {0: ['good', '✓ holds', 3], 1: ['bad', '✗ fails', 0], 2: ['bad', '✗ refused', 1], 3: ['bad', '✗ not completed', 2]};
  const stateOf = c => states[c.exit_code] || ['unknown', '– not finished', 2.5];
  const cases = data.cases.map((c, place) => ({...c, place, expectations: c.summary?.expectations || []})).sort((a, b) => stateOf(a)[2] - stateOf(b)[2] || a.place - b.place);
  const good = cases.filter(c => c.exit_code === 0).length, held = cases.flatMap(c => c.expectations).filter(e => e.verdict === 'passed').length, all = cases.flatMap(c => c.expectations).length;
  header('Validation', [`${cases.length} cases`, `${held} of ${all} expectations hold`].join(' · '),
    element('span', {class: `pill ${good === cases.length ? 'good' : 'bad'}`}, good === cases.length ? `✓ all ${cases.length} cases hold` : `✗ ${cases.length - good} of ${cases.length} cases fail`));
  const engines = [...new Set(cases.flatMap(c => Object.keys(c.summary?.engines || {})))];
  const apart = (c, engine) => {
    const rms = Object.entries(c.summary?.comparison?.[engine]?.signals || {}).filter(([name]) => name.endsWith('.position')).map(([, s]) => s.rms);
    return rms.length ? Math.max(...rms) : null;
  };
  const factor = (c, engine) => c.summary?.engines[engine]?.real_time_factor ?? null;
  const columns = [
    {title: 'Result', value: c => stateOf(c)[2], text: c => element('span', {class: `verdict ${stateOf(c)[0]}`}, stateOf(c)[1])},
    {title: 'Case', value: c => c.name, text: c => c.summary ? element('a', {href: `${encodeURIComponent(c.name)}/report.html`}, c.name) : c.name},
    {title: 'Title', value: c => c.summary?.case.title, text: c => c.summary?.case.title || element('span', {class: 'verdict bad', style: 'white-space:normal;font-weight:400'}, c.message)},
    {title: 'Hold', number: true, value: c => c.expectations.filter(e => e.verdict === 'passed').length, text: c => `${c.expectations.filter(e => e.verdict === 'passed').length} of ${c.expectations.length}`},
    ...engines.map(engine => ({title: `${engineName(engine)}, × real time`, number: true, value: c => factor(c, engine), text: c => factor(c, engine) === null ? '' : number(factor(c, engine), 3)})),
    ...engines.filter(engine => cases.some(c => apart(c, engine) !== null)).map(engine => ({title: `${engineName(engine)}, rms apart`, number: true, value: c => apart(c, engine), text: c => apart(c, engine) === null ? '' : quantity(apart(c, engine), 'm', 3)})),
  ];
  const list = table(columns, cases, {label: 'Cases'});
  list.id = 'cases';
  const main = document.getElementById('main');
  main.append(card('Cases, failures first', 'case-list', list));
  const failing = cases.flatMap(c => c.expectations.filter(e => e.verdict !== 'passed').map(e => ({...e, name: c.name})));
  const broken = cases.flatMap(c => Object.entries(c.summary?.engines || {}).filter(([, e]) => e.failure).map(([engine, e]) => ({name: c.name, engine, failure: e.failure})));
  if (broken.length) main.append(card('Engines that stopped early', 'stopped', table([{title: 'Case', text: r => r.name}, {title: 'Engine', text: r => engineName(r.engine)}, {title: 'Reason', text: r => r.failure}], broken, {label: 'Stopped early'})));
  if (failing.length) main.append(card('Expectations that do not hold, or were not checked', 'failing', table([
    {title: 'Case', text: e => e.name}, {title: '', text: e => element('span', {class: `verdict ${verdictMark[e.verdict][0]}`}, verdictMark[e.verdict][1])},
    {title: 'Expected', text: e => e.text}, {title: 'Found', text: e => e.finding}, {title: 'Why', text: e => element('span', {class: 'soft'}, e.why || '')},
  ], failing, {label: 'Expectations that do not hold'})));
  main.append(originCard({versions: data.versions, command: data.command, case: {}}));
  document.documentElement.dataset.ready = 'true';
}
