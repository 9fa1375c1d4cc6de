"""A headless Chromium, driven over its DevTools protocol through a pipe: no port, no further package."""
import base64
import json
import os
import shutil
import subprocess
import tempfile
import time

# --no-sandbox: tests may run as root, on pages that Quayside wrote itself. WebGL is computed in software.
FLAGS = ['--headless=new', '--no-sandbox', '--remote-debugging-pipe', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
         '--disable-gpu-sandbox', '--disable-dev-shm-usage', '--no-first-run', '--disable-extensions', '--disable-background-networking',
         '--disable-component-update', '--disable-sync', '--hide-scrollbars', '--mute-audio', '--force-color-profile=srgb']

ANSWER_WITHIN = 30  # s; a loaded machine computes its pictures slowly


def program():
    return shutil.which('chromium') or shutil.which('chromium-headless-shell')


class Browser:
    def __init__(self):
        self.profile = tempfile.mkdtemp(prefix='quayside_browser_')
        to_browser, self.commands = os.pipe()
        self.answers, from_browser = os.pipe()
        ends = [os.dup(to_browser), os.dup(from_browser)]  # out of the way of 3 and 4

        def give_ends():
            safe = [os.dup(end) if end in (3, 4) else end for end in ends]
            os.dup2(safe[0], 3)
            os.dup2(safe[1], 4)

        self.process = subprocess.Popen([program(), *FLAGS, f'--user-data-dir={self.profile}', 'about:blank'], preexec_fn=give_ends,
                                        pass_fds=(3, 4, *ends), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in (to_browser, from_browser, *ends):
            os.close(end)
        self.pending = b''
        self.number = 0
        self.events = []
        target = self.call('Target.createTarget', url='about:blank')['targetId']
        self.session = None
        self.session = self.call('Target.attachToTarget', targetId=target, flatten=True)['sessionId']
        for domain in ('Page', 'Runtime', 'Log'):
            self.call(domain + '.enable')

    def close(self):
        os.close(self.commands)
        self.process.terminate()
        self.process.wait(10)
        os.close(self.answers)
        shutil.rmtree(self.profile, ignore_errors=True)

    def call(self, method, **parameters):
        self.number += 1
        message = {'id': self.number, 'method': method, 'params': parameters}
        if getattr(self, 'session', None):
            message['sessionId'] = self.session
        os.write(self.commands, json.dumps(message).encode() + b'\0')
        while True:
            answer = self.read()
            if answer.get('id') != self.number:
                self.events.append(answer)
                continue
            if 'error' in answer:
                raise RuntimeError(f'{method}: {answer["error"]}')
            return answer['result']

    def read(self):
        while b'\0' not in self.pending:
            block = os.read(self.answers, 1 << 20)
            if not block:
                raise RuntimeError('the browser has gone')
            self.pending += block
        message, self.pending = self.pending.split(b'\0', 1)
        return json.loads(message)

    def evaluate(self, expression):
        """Value of a JavaScript expression, awaited where it is a promise."""
        result = self.call('Runtime.evaluate', expression=expression, awaitPromise=True, returnByValue=True)
        if 'exceptionDetails' in result:
            details = result['exceptionDetails']
            raise RuntimeError(details.get('exception', {}).get('description', details['text']))
        return result['result'].get('value')

    def wait_for(self, expression):
        end = time.monotonic() + ANSWER_WITHIN
        while not self.evaluate(expression):
            if time.monotonic() > end:
                raise AssertionError(f'waited {ANSWER_WITHIN} s in vain for: {expression}')
            time.sleep(0.02)

    def open(self, file, fragment=''):
        self.events.clear()
        self.call('Page.navigate', url='about:blank')
        self.call('Page.navigate', url='file://' + os.path.abspath(file) + fragment)
        self.wait_for('document.documentElement?.dataset.ready === "true"')

    def resize(self, width, height, scale=1, mobile=False):
        self.call('Emulation.setDeviceMetricsOverride', width=width, height=height, deviceScaleFactor=scale, mobile=mobile)

    def prefer(self, scheme):
        self.call('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': scheme}])

    def frames(self, count=3):
        """Lets the page draw itself."""
        self.evaluate(f'new Promise(done => {{ let n = {count}; const f = () => n-- ? requestAnimationFrame(f) : done(true); f(); }})')

    def key(self, key, shift=False):
        text = key if len(key) == 1 else None
        codes = {' ': 32, 'Tab': 9, 'Enter': 13, 'ArrowLeft': 37, 'ArrowRight': 39, 'Home': 36, 'End': 35, 'Escape': 27}
        common = dict(key=key, windowsVirtualKeyCode=codes.get(key, ord(key[0].upper())), modifiers=8 if shift else 0)
        if key == 'Enter':
            text = '\r'
        self.call('Input.dispatchKeyEvent', type='keyDown', **common, **({'text': text} if text else {}))
        self.call('Input.dispatchKeyEvent', type='keyUp', **common)

    def mouse(self, kind, x, y, **more):
        self.call('Input.dispatchMouseEvent', type=kind, x=x, y=y, **more)

    def click(self, x, y):
        self.mouse('mousePressed', x, y, button='left', buttons=1, clickCount=1)
        self.mouse('mouseReleased', x, y, button='left', clickCount=1)

    def drag(self, start, end):
        self.mouse('mousePressed', *start, button='left', buttons=1, clickCount=1)
        for part in (0.3, 0.7, 1):
            self.mouse('mouseMoved', *(a + part * (b - a) for a, b in zip(start, end)), button='left', buttons=1)
        self.mouse('mouseReleased', *end, button='left', clickCount=1)

    def box(self, selector):
        """x, y, width, height of an element in the window, scrolled into view."""
        return self.evaluate(f'''(() => {{ const e = document.querySelector({json.dumps(selector)}); e.scrollIntoView({{block: 'center', behavior: 'instant'}});
            const r = e.getBoundingClientRect(); return [r.x, r.y, r.width, r.height]; }})()''')

    def screenshot(self, file, full=False):
        with open(file, 'wb') as stream:
            stream.write(base64.b64decode(self.call('Page.captureScreenshot', format='png', captureBeyondViewport=full)['data']))

    def complaints(self):
        """Everything the page said that it should not: exceptions, errors and warnings on the console, failed loads."""
        self.evaluate('1')  # so that what is on its way has come
        found = []
        for event in self.events:
            method, parameters = event.get('method'), event.get('params', {})
            if method == 'Runtime.exceptionThrown':
                details = parameters['exceptionDetails']
                found.append(details.get('exception', {}).get('description', details['text']))
            if method == 'Runtime.consoleAPICalled' and parameters['type'] in ('error', 'warning', 'assert'):
                found.append(' '.join(str(a.get('value', a.get('description'))) for a in parameters['args']))
            if method == 'Log.entryAdded' and parameters['entry']['level'] in ('error', 'warning'):
                found.append(parameters['entry']['text'])
        # Chromium's own remark on pictures that are read back from a software renderer.
        return [text for text in found if 'GPU stall' not in text]
