"""Opens the page of every ready scene in a real browser: nothing is complained about or fetched, the first frame comes soon, and the scrubber, the
drawing and all plots show one time.

    python3 tests/scripts/pages.py target/debug/mbd [SCENE …]
"""

import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402

# A page shows its first frame so soon after it is opened [ms].
FIRST = 1000
# Names and words of this scene try to leave their places: as markup, as script, as text that reads backwards.
TRICKS = '''/// </script><script>window.caught = 1</script> <img src=x onerror="window.caught = 2"> \u202egnp.exe\u2066
pub model Tricks {
    gravity: [0, 0, -9.81] m/s^2;
    /// <b onclick=window.caught=3>
    point stone { mass: 1 kg, start at [0, 0, 1] m }
    /// </td></table><script>window.caught = 4</script>
    output height = stone.position.z;
}

[run]
until = "0.5 s"

[run.figures]
"</script><script>window.caught = 5</script>" = ["height"]
'''


def scenes(program):
    """The names of the ready scenes, as `mbd list` prints them."""
    lines = subprocess.run([program, "list"], check=True, capture_output=True, text=True).stdout.splitlines()
    start = next(k for k, line in enumerate(lines) if line.strip().startswith("─")) + 1
    return [line.split()[0] for line in lines[start:] if line.startswith("  ") and line.strip()]


def check(browser, name, path):
    """Everything that is asked of a page; what fails."""
    failed = []
    browser.open(path)
    browser.frames(2)

    def expect(holds, what):
        if not holds:
            failed.append(f"{name}: {what}")

    first = float(browser.run("document.querySelector('.player canvas').dataset.first || 'NaN'"))
    expect(first < FIRST, f"the first frame came after {first} ms")
    expect(browser.run("document.documentElement.classList.contains('live')"), "the script does not run")
    # The scrubber moves the plots and the drawing.
    before = browser.run("(() => { const c = document.querySelector('canvas'); return c.toDataURL(); })()")
    times = browser.run("""(() => {
        const range = document.querySelector('[data-mbd=time]');
        range.value = 5000;
        range.dispatchEvent(new Event('input'));
        return [document.querySelector('[data-mbd=now]').textContent, ...[...document.querySelectorAll('[data-plot]')].map(plot => plot.dataset.time)];
    })()""")
    browser.frames(2)
    moved = browser.run("document.querySelector('canvas').toDataURL()") != before
    still = browser.run("document.querySelector('[data-mbd=time]').disabled")
    expect(moved or still, "the drawing does not move with the scrubber")
    expect(len(set(times[1:])) <= 1, f"plots show different times: {times[1:]}")
    if len(times) > 1:
        expect(abs(float(times[0].split()[0]) - float(times[1])) < 0.01, f"the scrubber says {times[0]}, the plots {times[1]}")
    # A click on a plot moves everything there.
    if len(times) > 1 and not still:
        place = browser.run("""(() => {
            const panel = document.querySelector('[data-plot] .panel');
            panel.scrollIntoView({ block: 'center' });
            const box = panel.getBoundingClientRect();
            return [box.left + 0.25 * box.width, box.top + 0.5 * box.height];
        })()""")
        browser.mouse("mousePressed", *place, button="left", buttons=1)
        browser.mouse("mouseReleased", *place, button="left")
        browser.frames(2)
        share = browser.run("document.querySelector('[data-mbd=time]').value / 10000")
        expect(abs(share - 0.25) < 0.05, f"a click at a quarter of a plot moved the scrubber to {share}")
        # A stretch that is dragged over is shown larger, and everything again after a double click.
        wide = browser.run("document.querySelector('[data-plot] .mbd-x').textContent")
        browser.mouse("mousePressed", *place, button="left", buttons=1)
        browser.mouse("mouseMoved", place[0] + 80, place[1], buttons=1)
        browser.mouse("mouseReleased", place[0] + 80, place[1], button="left")
        near = browser.run("document.querySelector('[data-plot] .mbd-x').textContent")
        browser.run("document.querySelector('[data-mbd=whole]').click()")
        again = browser.run("document.querySelector('[data-plot] .mbd-x').textContent")
        expect(near != wide, "dragging over a plot does not zoom")
        expect(again == wide, "the plot does not go back to everything")
    expect(not browser.run("window.caught"), "a name or a word of the scene became markup")
    expect(browser.run("document.documentElement.scrollWidth <= window.innerWidth"), "the page is wider than the window")
    failed += [f"{name}: {error}" for error in browser.errors]
    return first, failed


def main():
    program, *names = sys.argv[1:]
    program = os.path.abspath(program)
    started, failed = time.monotonic(), []
    with tempfile.TemporaryDirectory() as folder:
        pages = []
        for name in names or scenes(program):
            # Whether a run is accurate is no matter here.
            run = subprocess.run([program, "run", name, "--no-estimate", "--out", os.path.join(folder, name)], capture_output=True, text=True)
            page = os.path.join(folder, name, "report.html")
            if os.path.exists(page):
                pages.append((name, page))
            else:
                failed.append(f"{name}: no page: {run.stderr.strip()}")
        if not names:
            scene = os.path.join(folder, "tricks.mbd")
            with open(scene, "w", encoding="utf-8") as file:
                file.write(TRICKS)
            run = subprocess.run([program, "run", scene, "--no-estimate", "--out", os.path.join(folder, "tricks")], capture_output=True, text=True)
            page = os.path.join(folder, "tricks", "report.html")
            if os.path.exists(page):
                pages.append(("tricks", page))
            else:
                failed.append(f"tricks: no page: {run.stdout} {run.stderr}")
        browser = Browser()
        try:
            for name, page in pages:
                first, wrong = check(browser, name, page)
                failed += wrong
                print(f"{name}: first frame after {first:.0f} ms, {os.path.getsize(page) / 1e6:.2f} MB")
        finally:
            browser.close()
    print(f"{len(pages)} pages in {time.monotonic() - started:.1f} s")
    if failed:
        raise SystemExit("\n".join(failed))


if __name__ == "__main__":
    main()
