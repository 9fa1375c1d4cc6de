"""report.html in a headless Chromium: report_test.py QUAYSIDE. Exit code 77: there is no Chromium here."""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True  # nothing is left in the source folder
import browser as browsers

FOLDER = os.path.dirname(os.path.abspath(__file__))
LIVE = {}  # the browser and the run's directory, shared by all tests


def setUpModule():
    LIVE['directory'] = tempfile.TemporaryDirectory(prefix='quayside_report_')
    LIVE['run'] = os.path.join(LIVE['directory'].name, 'run')
    done = subprocess.run([PROGRAM, 'run', os.path.join(FOLDER, 'short_landing.yaml'), '--engine', 'simbody,mujoco_same_law',
                           '--out', LIVE['run'], '--quiet'], capture_output=True, text=True)
    assert done.returncode == 1, done.stderr  # one expectation of the case cannot hold
    case = os.path.join(FOLDER, 'short_landing.yaml')
    refused = os.path.join(FOLDER, '../unit/cases/bad/unknown_key.yaml')
    LIVE['validation'] = os.path.join(LIVE['directory'].name, 'validation')
    done = subprocess.run([PROGRAM, 'validate', case, refused, '--engine', 'simbody', '--out', LIVE['validation']], capture_output=True, text=True)
    assert done.returncode == 2, done.stderr  # the worst of the two
    # At 0.1 s a step MuJoCo cannot hold the ropes: a setting that fails.
    done = subprocess.run([PROGRAM, 'sweep', case, '--integrators', 'bdf,rk4', '--engine', 'simbody,mujoco_same_law', '--tolerances', '1e-3,1e-5',
                           '--steps', '1e-1', '--repeat', '1', '--reference', '1e-7', '--second-reference', '1e-3', '--out', LIVE['directory'].name],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    LIVE['browser'] = browsers.Browser()


def tearDownModule():
    LIVE['browser'].close()
    LIVE['directory'].cleanup()


def rows(name):
    with open(os.path.join(LIVE['run'], name), newline='') as stream:
        return list(csv.reader(stream))


def first_event(event, engine='simbody'):
    return next(float(row[0]) for row in rows('events.csv') if row[1] == engine and row[2] == event)


# What of the picture is drawn: a number that changes with it.
PICTURE = '''(() => { const c = document.querySelector('#view'), k = document.createElement('canvas'); k.width = 160; k.height = 120;
  const g = k.getContext('2d'); g.drawImage(c, 0, 0, 160, 120); const d = g.getImageData(0, 0, 160, 120).data;
  let h = 0, drawn = 0; for (let i = 0; i < d.length; i += 4) { h = (h * 31 + d[i] + 7 * d[i + 1] + 13 * d[i + 2]) | 0; if (d[i + 3] > 0) ++drawn; }
  return {hash: h, drawn: drawn / (d.length / 4)}; })()'''
TIME = 'Number(document.querySelector("#time b").textContent)'

# Luminance contrast after WCAG 2; the background is that of the nearest ancestor that has one.
CONTRAST = r'''(() => {
  const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
  const colour = css => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = css; canvas.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = canvas.getImageData(0, 0, 1, 1).data; return {rgb: [r, g, b], a: a / 255}; };
  const luminance = rgb => rgb.map(v => v / 255).map(v => v <= .03928 ? v / 12.92 : ((v + .055) / 1.055) ** 2.4)
    .reduce((sum, v, i) => sum + v * [.2126, .7152, .0722][i], 0);
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; node = walker.nextNode();) {
    const e = node.parentElement, text = node.textContent.trim();
    if (!text || ['SCRIPT', 'STYLE', 'NOSCRIPT', 'OPTION', 'TITLE'].includes(e.tagName) || !e.checkVisibility() || e.closest('.view, .hidden-text, .skip')) continue;
    let back = null;
    for (let p = e; p && !back; p = p.parentElement) { const c = colour(getComputedStyle(p).backgroundColor); if (c.a > .99) back = c; }
    back ||= colour('#ffffff');
    const [a, b] = [luminance(colour(getComputedStyle(e).color).rgb), luminance(back.rgb)].sort((x, y) => y - x);
    const ratio = (a + .05) / (b + .05);
    if (ratio < 4.5) found.push(`${text.slice(0, 40)}: ${ratio.toFixed(2)}`);
  }
  return found; })()'''


class Report(unittest.TestCase):
    fragment = ''

    def file(self):
        return os.path.join(LIVE['run'], 'report.html')

    def setUp(self):
        self.browser = LIVE['browser']
        self.browser.resize(1280, 900)
        self.browser.prefer('light')
        self.browser.open(self.file(), self.fragment)

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

    def check_contrast(self):
        for scheme in ('light', 'dark'):
            self.browser.prefer(scheme)
            self.browser.frames()
            self.assertEqual(self.browser.evaluate(CONTRAST), [], scheme)

    def check_names(self):
        for node in self.browser.call('Accessibility.getFullAXTree')['nodes']:
            focusable = any(p['name'] == 'focusable' and p['value'].get('value') for p in node.get('properties', []))
            if focusable and node.get('role', {}).get('value') not in ('RootWebArea', 'main'):
                self.assertTrue(node.get('name', {}).get('value', '').strip(), node)

    def check_phone(self):
        for width in (390, 320):
            self.browser.resize(width, 800, mobile=True)
            self.browser.frames()
            self.assertLessEqual(self.browser.evaluate('document.documentElement.scrollWidth'), width)

    def time(self):
        return self.browser.evaluate(TIME)

    def picture(self):
        self.browser.frames()
        return self.browser.evaluate(PICTURE)

    def click(self, selector):
        x, y, width, height = self.browser.box(selector)
        self.browser.click(x + width / 2, y + height / 2)


class Player(Report):
    def test_plays_and_pauses(self):
        before = self.picture()
        self.assertGreater(before['drawn'], 0.05)
        self.click('#play')
        self.browser.wait_for(TIME + ' > 0.2')
        self.assertNotEqual(self.picture()['hash'], before['hash'])
        self.click('#play')
        stopped = self.time()
        self.browser.frames(5)
        self.assertEqual(self.time(), stopped)

    def test_scrubs_to_where_the_recording_says(self):
        x, y, width, height = self.browser.box('#scrub')
        self.browser.drag((x + 8, y + height / 2), (x + width / 2, y + height / 2))
        self.assertAlmostEqual(self.time(), 1.5, delta=0.05)  # half of 3 s, within a pixel or two
        # The plot's key reads what the trajectory holds: within the polyline's tolerance and the digits shown.
        self.browser.evaluate('document.querySelector("#time").scrollIntoView()')
        time = self.browser.evaluate('Number(document.querySelector("#scrub").value)')
        shown = self.browser.evaluate('(() => { const p = [...document.querySelectorAll(".plot")].find(p => p.querySelector("h3").textContent.startsWith("Height of load")); return Number(p.querySelector(".key b").textContent); })()')
        table = rows('trajectory_simbody.csv')
        column = table[0].index('load.position.z [m]')
        after = next(i for i in range(1, len(table)) if float(table[i][0]) >= time)
        (t0, z0), (t1, z1) = ((float(table[i][0]), float(table[i][column])) for i in (after - 1, after))
        self.assertAlmostEqual(shown, z0 + (z1 - z0) * (time - t0) / (t1 - t0), delta=1e-3)

    def test_picks_an_event_by_its_mark(self):
        landed = first_event('landed')
        x, y, width, height = self.browser.box('#marks')
        self.browser.click(x + 8 + (width - 16) * landed / 3, y + 6)
        self.assertAlmostEqual(self.time(), landed, delta=0.03)  # the nearest of the marks within a few pixels
        picked = self.browser.evaluate('document.querySelector("tr.current td").textContent')
        self.assertAlmostEqual(float(picked.split()[0]), self.time(), delta=1e-3)

    def test_picks_an_event_from_the_table(self):
        count = sum(1 for row in rows('events.csv') if row[1] == 'simbody' and row[2] != 'contact_open')
        self.assertEqual(self.browser.evaluate('document.querySelectorAll("#event-table tbody tr").length'), count)
        self.browser.evaluate('[...document.querySelectorAll("#event-table tbody tr")].find(r => r.children[1].textContent === "landed").querySelector("button").click()')
        self.assertAlmostEqual(self.time(), first_event('landed'), delta=1e-3)  # shown to milliseconds

    def test_obeys_the_keyboard(self):
        self.browser.key('End')
        self.assertEqual(self.time(), 3)
        self.browser.key('Home')
        self.assertEqual(self.time(), 0)
        self.browser.key('ArrowRight')
        self.assertAlmostEqual(self.time(), 0.01, delta=1e-9)  # an output interval
        self.browser.key('ArrowRight', shift=True)
        self.assertAlmostEqual(self.time(), 1.01, delta=1e-9)
        self.browser.key(']')
        self.assertAlmostEqual(self.time(), min(t for t in (first_event(e) for e in ('contact_made', 'landed', 'rope_slack')) if t > 1.01)
                               if first_event('contact_made') > 1.01 else self.time(), delta=1e-3)
        self.assertGreater(self.time(), 1.01)
        self.browser.key(' ')
        self.browser.wait_for('document.querySelector("#play").textContent === "Pause"')
        self.browser.key(' ')
        self.browser.wait_for('document.querySelector("#play").textContent === "Play"')
        before = self.picture()
        self.browser.key('2')
        self.assertEqual(self.browser.evaluate('document.querySelector("#camera-load").getAttribute("aria-pressed")'), 'true')
        self.assertNotEqual(self.picture()['hash'], before['hash'])

    def test_turns_with_the_pointer(self):
        before = self.picture()
        x, y, width, height = self.browser.box('#view')
        self.browser.drag((x + width / 2, y + height / 2), (x + width / 2 + 80, y + height / 2 + 30))
        self.assertNotEqual(self.picture()['hash'], before['hash'])

    def test_shows_a_second_engine(self):
        before = self.picture()
        self.assertFalse(self.browser.evaluate('document.querySelector("#mode").checkVisibility()'))
        self.browser.key('g')
        ghost = self.picture()
        self.assertNotEqual(ghost['hash'], before['hash'])
        self.browser.evaluate('(() => { const m = document.querySelector("#mode"); m.value = "beside"; m.dispatchEvent(new Event("change")); })()')
        self.assertNotEqual(self.picture()['hash'], ghost['hash'])


class PlayerWithoutWebgl(Report):
    fragment = '#canvas2d'

    def test_paints_the_scene_on_a_canvas(self):
        before = self.picture()
        self.assertGreater(before['drawn'], 0.05)
        self.browser.key('End')
        self.assertNotEqual(self.picture()['hash'], before['hash'])


class Page(Report):
    def test_zooms_plots_together(self):
        x, y, width, height = self.browser.box('.plot canvas')
        self.browser.drag((x + width * 0.4, y + 60), (x + width * 0.7, y + 60))
        zoomed = self.browser.evaluate('[Number(document.querySelector("#plots").dataset.from), Number(document.querySelector("#plots").dataset.to)]')
        self.assertGreater(zoomed[0], 0.5)
        self.assertLess(zoomed[1], 2.5)
        self.click('#show-all')
        self.assertEqual(self.browser.evaluate('document.querySelector("#plots").dataset.to'), '3')

    def test_shows_the_picture_before_the_rest(self):
        first, complete = (self.browser.evaluate(f'performance.getEntriesByName("{name}")[0].startTime') for name in ('first picture', 'complete'))
        self.assertLess(first, complete)
        # A plot is decoded and painted when it comes into sight; then its label tells more than its title.
        last = '[...document.querySelectorAll(".plot canvas")].pop()'
        title = self.browser.evaluate(last + '.getAttribute("aria-label")')
        self.assertNotIn('from', title)
        self.browser.evaluate(last + '.scrollIntoView({behavior: "instant"})')
        self.browser.wait_for(f'{last}.getAttribute("aria-label").startsWith("{title}. ")')

    def test_plots_any_signal(self):
        before = self.browser.evaluate('document.querySelectorAll(".plot").length')
        self.browser.evaluate('(() => { const i = document.querySelector("#add-signal"); i.value = "beside.position.z"; i.dispatchEvent(new Event("change")); })()')
        self.assertEqual(self.browser.evaluate('document.querySelectorAll(".plot").length'), before + 1)
        self.assertEqual(self.browser.evaluate('document.querySelectorAll(".plot .key").length > 0'), True)

    def test_tells_all_that_was_judged(self):
        with open(os.path.join(LIVE['run'], 'summary.json')) as stream:
            summary = json.load(stream)
        text = self.browser.evaluate('document.body.innerText')
        for wanted in [summary['case']['title'], summary['command'], '1 of 3 expectations fail', *(e['text'] for e in summary['expectations']),
                       *(e['reason'] for e in summary['scene']['left_out']), *summary['versions'].values()]:
            self.assertIn(wanted, text)
        self.assertTrue(self.browser.evaluate('document.querySelector("#expectations").parentElement.querySelector(".verdict").textContent.includes("fails")'),
                        'failures come first')

    def test_asks_for_nothing(self):
        self.assertEqual(self.browser.evaluate('performance.getEntriesByType("resource").filter(e => !e.name.startsWith("data:")).length'), 0)

    def test_has_enough_contrast(self):
        self.check_contrast()

    def test_every_control_is_named_and_reached_by_tab(self):
        self.check_names()
        controls = '[...document.querySelectorAll("a[href], button, input, select, canvas[tabindex], [tabindex=\\"0\\"]")].filter(e => e.checkVisibility({visibilityProperty: true}) && !e.closest("dialog"))'
        wanted = self.browser.evaluate(controls + '.length')
        self.browser.evaluate(f'window.controls = {controls}; window.reached = []; '
                              'addEventListener("focusin", e => reached.push(controls.indexOf(e.target))); document.activeElement.blur()')
        for _ in range(wanted):
            self.browser.key('Tab')
            self.assertTrue(self.browser.evaluate('document.activeElement.matches(":focus-visible")'))
        reached = self.browser.evaluate('reached')
        self.assertEqual(reached, list(range(wanted)))  # each of them, in the order of the page

    def test_fits_a_phone(self):
        self.check_phone()

    def test_prints(self):
        paper = self.browser.call('Page.printToPDF', printBackground=True)['data']
        self.assertGreater(len(paper), 50000)  # plots and picture are in it
        self.assertEqual(self.browser.evaluate('document.documentElement.dataset.theme ?? "auto"'), 'auto')


def column(selector, place):
    return f'[...document.querySelectorAll("{selector} tbody tr")].map(row => row.children[{place}].textContent)'


class SweepReport(Report):
    def file(self):
        return os.path.join(LIVE['directory'].name, 'short_landing_sweep.html')

    def test_names_points_and_shows_failures_first(self):
        with open(self.file().replace('.html', '.csv'), newline='') as stream:
            table = [row for row in csv.DictReader(stream) if row['front'] != 'reference']
        failed = [row for row in table if row['failure']]
        self.assertTrue(failed)
        self.assertEqual(len(self.browser.evaluate(column('#points', 0))), len(table))
        marks = self.browser.evaluate('[...document.querySelectorAll("#chart .point")].map(p => p.getAttribute("aria-label"))')
        self.assertEqual(len(marks), len(table) - len(failed))
        self.assertTrue(any('on the front' in mark for mark in marks))
        results = self.browser.evaluate(column('#points', 8))
        self.assertEqual(['failed' in result for result in results], sorted(('failed' in result for result in results), reverse=True))
        self.check_contrast()
        self.check_names()
        self.check_phone()

    def test_picks_points_and_sorts(self):
        self.browser.evaluate('document.querySelector("#chart .point").dispatchEvent(new KeyboardEvent("keydown", {key: "Enter"}))')
        self.assertEqual(self.browser.evaluate('document.querySelectorAll("#points tr.current").length'), 1)
        self.browser.evaluate('[...document.querySelectorAll("#points thead button")].find(b => b.textContent === "Steps").click()')
        steps = [float(text) for text in self.browser.evaluate(column('#points', 6))]
        self.assertEqual(steps, sorted(steps))
        self.assertEqual(self.browser.evaluate('document.querySelector("#points th[aria-sort]").textContent'), 'Steps')


class ValidationReport(Report):
    def file(self):
        return os.path.join(LIVE['validation'], 'report.html')

    def test_leads_to_its_runs_failures_first(self):
        self.assertEqual(self.browser.evaluate(column('#cases', 1)), ['short_landing', 'unknown_key'])
        text = self.browser.evaluate('document.body.innerText')
        for wanted in ('2 of 2 cases fail', "unknown key 'duraton'", 'load.position.z at the end < -1 m'):
            self.assertIn(wanted, text)
        link = self.browser.evaluate('document.querySelector("#cases a").href')
        self.assertTrue(os.path.exists(link.replace('file://', '')), link)
        self.check_contrast()
        self.check_names()
        self.check_phone()


if __name__ == '__main__':
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    if browsers.program() is None:
        print('no chromium: the page is not tested here (apt-get install chromium)')
        sys.exit(77)
    unittest.main()
