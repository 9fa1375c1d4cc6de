"""The pictures of harness/report/README.md: screenshots.py REPORT.html FOLDER writes report_light.webp, report_dark.webp, report_phone.webp."""
import base64
import os
import sys

sys.dont_write_bytecode = True  # nothing is left in the source folder
import browser as browsers

QUALITY = 82  # of 100: letters stay crisp, and the three pictures take about 150 kB

AT_LANDING = '[...document.querySelectorAll("#event-table tbody tr")].find(r => r.children[1].textContent === "landed").querySelector("button").click()'
LOAD = 'document.querySelector("#camera-load").click()'
GHOST = '''(() => { for (const [id, value] of [["other", "mujoco"], ["factor", "100"]]) {
  const e = document.getElementById(id); e.value = value; e.dispatchEvent(new Event("change")); } })()'''

report, folder = sys.argv[1:3]
browser = browsers.Browser()
for name, scheme, width, height, scale, actions in [('light', 'light', 1440, 900, 1, [AT_LANDING, LOAD]),
                                                    ('dark', 'dark', 1440, 900, 1, [AT_LANDING, LOAD, GHOST]),
                                                    ('phone', 'light', 390, 844, 1.5, [AT_LANDING, LOAD])]:
    browser.resize(width, height, scale, mobile=width < 500)
    browser.prefer(scheme)
    browser.open(report)
    for action in actions:
        browser.evaluate(action)
    browser.evaluate('scrollTo({top: 0, behavior: "instant"})')
    browser.frames(5)
    with open(os.path.join(folder, f'report_{name}.webp'), 'wb') as stream:
        stream.write(base64.b64decode(browser.call('Page.captureScreenshot', format='webp', quality=QUALITY)['data']))
browser.close()
