"""How long a report takes to open in a headless Chromium, in time and in work: opening_time.py REPORT.html [REPEAT].

Not a test: times depend on the machine. Work does so less: processor time of the page's main thread, and of all of the browser's processes
(WebGL is computed in software there), each up to the moment when the page is complete.
"""
import os
import sys
import time

sys.dont_write_bytecode = True  # nothing is left in the source folder
import browser as browsers

TICK = os.sysconf('SC_CLK_TCK')


def stat(process):
    with open(f'/proc/{process}/stat') as stream:
        return stream.read().rsplit(')', 1)[1].split()


def processor_time(root):
    """Of a process and all below it [s]."""
    parents, used = {}, {}
    for name in filter(str.isdigit, os.listdir('/proc')):
        try:
            fields = stat(name)
        except OSError:  # gone meanwhile
            continue
        parents[int(name)] = int(fields[1])
        used[int(name)] = (int(fields[11]) + int(fields[12])) / TICK
    def below(process):
        while process in parents and process != root:
            process = parents[process]
        return process == root
    return sum(seconds for process, seconds in used.items() if below(process))


def marks(browser):
    return browser.evaluate('Object.fromEntries(performance.getEntriesByType("mark").map(m => [m.name, m.startTime / 1000]))')


report, repeat = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
browser = browsers.Browser()
browser.call('Performance.enable', timeDomain='threadTicks')
runs = []
for _ in range(repeat):
    browser.call('Page.navigate', url='about:blank')
    before, begin = processor_time(browser.process.pid), time.monotonic()
    browser.open(report)
    browser.frames(1)
    run = {'asked to drawn [s]': time.monotonic() - begin}
    for name, moment in marks(browser).items():
        run[f'{name} [s]'] = moment
    run['work of all processes [s]'] = processor_time(browser.process.pid) - before
    metrics = {m['name']: m['value'] for m in browser.call('Performance.getMetrics')['metrics']}
    run['work of the main thread [s]'] = metrics['TaskDuration']
    run['of it scripts [s]'] = metrics['ScriptDuration']
    run['of it layout and style [s]'] = metrics['LayoutDuration'] + metrics['RecalcStyleDuration']
    runs.append(run)
browser.close()
print(f'{report}: {os.path.getsize(report) / 1e6:.2f} MB, {repeat} times')
for name in runs[0]:
    values = sorted(run[name] for run in runs)
    print(f'  {name:32} {values[len(values) // 2]:.2f}   ({values[0]:.2f} to {values[-1]:.2f})')
