"""How long a report takes to open in a headless Chromium: opening_time.py REPORT.html [REPEAT]. Not a test: times depend on the machine."""
import os
import sys
import time

sys.dont_write_bytecode = True  # nothing is left in the source folder
import browser as browsers

report, repeat = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
browser = browsers.Browser()
took = []
for _ in range(repeat):
    begin = time.monotonic()
    browser.open(report)
    browser.frames(1)
    took.append(time.monotonic() - begin)
browser.close()
took.sort()
print(f'{report}: {os.path.getsize(report) / 1e6:.2f} MB, first picture after {took[len(took) // 2]:.2f} s (median of {repeat}; {took[0]:.2f} to {took[-1]:.2f} s)')
