"""Opens the page of every ready scene, of those that newcomers wrote as text, of 50 and 500 bodies and of a comparison in a real browser: nothing is complained about
or fetched, the first frame comes soon, the scrubber, the drawing and all plots show one time, the drawing turns, moves and zooms, no table and no page is wider
than a desk or a phone, text keeps its size, names in backticks are code; paper, and pages without a script, have the drawings that stand still; 50 bodies
move at 30 frames a second; and `mbd watch` shows what is saved.

    python3 tests/scripts/pages.py [--keep FOLDER] [--page FILE] target/debug/mbd [SCENE …]

`--keep`: the runs stay in this folder, with their `motion.glb`. `--page`: this page is opened, too.
"""

import argparse

import glob
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402
from frames import flying, frames, hanging  # noqa: E402

# A page shows its first frame so soon after it is opened [ms]. What is measured is measured so often at most, so long apart [s], until it is so once: the
# machine does other work, too.
FIRST, MEASUREMENTS, PAUSE = 1000, 8, 2.0
# 50 bodies play at so many frames a second, drawn in software, over so long a time [s].
FRAMES, MEASURED = 30, 0.7
# The least height of letters, wherever they stand [px].
LETTERS = 9
# What is wider than the window leaves for it.
CLIPPED = "[...document.querySelectorAll('.scroll')].filter(table => table.scrollWidth > table.clientWidth + 1).map(table => table.innerText.slice(0, 40))"
# Scenes written from the documentation alone.
NEWCOMERS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "newcomers", "*.mbd")
# A scene that takes in a robot.
WATCHED = 'model Arm { urdf: "arm.urdf" { angle: { damping: 0.1 N*m*s } } output turn = pin.angle; }\n[run]\nuntil = "0.2 s"\n'
ROBOT = """<robot name="arm"><link name="base"/><link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="MASS"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pin" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"""
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


def pause_before(number):
    """Lets other work of the machine go by before a measurement is made again."""
    if number:
        time.sleep(PAUSE)


def check(browser, name, path, by_hand):
    """Everything that is asked of a page; what fails. `by_hand`: the drawing is turned, moved and zoomed, too."""
    failed = []

    def expect(holds, what):
        if not holds:
            failed.append(f"{name}: {what}")

    for number in range(MEASUREMENTS):
        pause_before(number)
        browser.open(path)
        browser.frames()
        first = float(browser.run("document.querySelector('.player canvas').dataset.first || 'NaN'"))
        if first < FIRST:
            break
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
    browser.frames()
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
        browser.frames()
        low, high, time, now = browser.run("""[
            ...JSON.parse(document.getElementById('mbd-data').textContent).plots[0].x, Number(document.querySelector('[data-plot]').dataset.time),
            parseFloat(document.querySelector('[data-mbd=now]').textContent),
        ]""")
        expect(abs((time - low) / (high - low) - 0.25) < 0.05, f"a click at a quarter of a plot from {low} to {high} moved it to {time}")
        expect(abs(now - time) < 0.01, f"the plot was moved to {time}, the drawing to {now}")
        # So does the mouse that points at it.
        browser.mouse("mouseMoved", place[0] + 100, place[1])
        pointed = browser.run("Number(document.querySelector('[data-plot]').dataset.time)")
        expect(pointed > time, f"pointing at a plot behind {time} moved it to {pointed}")
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
    if by_hand:
        turned(browser, expect)
    expect(not browser.run("window.caught"), "a name or a word of the scene became markup")
    expect(not browser.run("document.body.innerText.includes('`')"), "there are literal backticks")
    for width, height in ((1280, 900), *(((768, 1024),) if by_hand else ()), (390, 844)):
        browser.size(width, height)
        expect(browser.run("document.documentElement.scrollWidth <= window.innerWidth"), f"the page is wider than {width} px")
        clipped = browser.run(CLIPPED)
        expect(not clipped, f"tables are wider than {width} px leave for them: {clipped}")
        small = browser.run("Math.min(...[...document.querySelectorAll('main svg text')].map(text => text.getBoundingClientRect().height).filter(Boolean), 99)")
        expect(small >= LETTERS, f"letters of {small:.1f} px at {width} px")
    browser.page("Emulation.setEmulatedMedia", media="print")
    stands(browser, expect, "on paper")
    failed += [f"{name}: {error}" for error in browser.errors]
    return first, failed


def stands(browser, expect, where):
    """The drawings that stand still take the place of the player."""
    shown = "[...document.querySelectorAll('%s')].filter(part => part.getClientRects().length).length"
    expect(browser.run(shown % ".player, .dock") == 0, f"the player is {where}")
    expect(browser.run(shown % ".still svg") > 0, f"no drawing is {where}")


def without_script(browser, name, path):
    """What fails where no script runs."""
    failed = []
    browser.open(path, script=False)
    stands(browser, lambda holds, what: None if holds else failed.append(f"{name}: {what}"), "where no script runs")
    browser.page("Emulation.setScriptExecutionDisabled", value=False)
    return failed


def turned(browser, expect):
    """Turns, moves and zooms the drawing; `see all` takes the zoom back."""
    x, y = browser.run("""(() => {
        const view = document.querySelector('.player canvas');
        view.scrollIntoView({ block: 'center' });
        const box = view.getBoundingClientRect();
        return [box.left + box.width / 2, box.top + box.height / 2];
    })()""")

    def picture():
        browser.frames()
        return browser.run("document.querySelector('canvas').toDataURL()")

    def drag(**more):
        browser.mouse("mousePressed", x, y, button="left", buttons=1, **more)
        browser.mouse("mouseMoved", x + 60, y + 20, buttons=1, **more)
        browser.mouse("mouseReleased", x + 60, y + 20, button="left", **more)

    # The names of what is under the mouse stand beside the canvas, not on it.
    seen = [picture()]
    for what, act in (
        ("drag", drag),
        ("drag with shift", lambda: drag(modifiers=8)),
        ("turn of the wheel", lambda: browser.mouse("mouseWheel", x, y, deltaX=0, deltaY=-200)),
        ("click on `see all`", lambda: browser.run("document.querySelector('[data-mbd=fit]').click()")),
    ):
        act()
        seen.append(picture())
        expect(seen[-1] != seen[-2], f"a {what} does not change the drawing")


def chosen(browser, path):
    """What can be chosen beside the drawing changes it, names come under the mouse, and it plays and pauses. What fails. The scene is the crane."""
    failed = []
    browser.open(path)
    find = "document.querySelector('[data-mbd=%s]')"
    browser.run("(() => { const range = %s; range.value = 5000; range.dispatchEvent(new Event('input')); })()" % (find % "time"))

    def picture():
        browser.frames()
        return browser.run("document.querySelector('canvas').toDataURL()")

    for word in ("forces", "axes", "trails", "ground", "names"):
        before = picture()
        browser.run((find % word) + ".click()")
        if picture() == before:
            failed.append(f"crane: `{word}` changes nothing")
    before = picture()
    browser.run("(() => { const list = %s; list.selectedIndex = 2; list.dispatchEvent(new Event('change')); })()" % (find % "follow"))
    if picture() == before:
        failed.append("crane: `follow` changes nothing")
    # What is followed is in the middle of the drawing.
    middle = browser.run("(() => { const box = document.querySelector('canvas').getBoundingClientRect(); return [box.left + box.width / 2, box.top + box.height / 2]; })()")
    browser.mouse("mouseMoved", *middle)
    if not browser.run("!%s.hidden && %s.textContent === %s.selectedOptions[0].text" % (find % "tip", find % "tip", find % "follow")):
        failed.append("crane: the name of what is under the mouse is not shown")
    if "gradient" not in browser.run((find % "tension") + ".style.background"):
        failed.append("crane: the colours of lines have no bar")
    now = "Number(%s.value)" % (find % "time")
    times = []
    for _ in range(2):
        browser.run((find % "play") + ".click()")
        browser.frames(6)
        times.append(browser.run(now))
    browser.frames(6)
    times.append(browser.run(now))
    if not 5000 < times[0] <= times[1] == times[2]:
        failed.append(f"crane: play and pause moved the time from 5000 to {times}")
    return failed + [f"crane: {error}" for error in browser.errors]


def watched(browser, program, folder):
    """`mbd watch`: the page follows what is saved, a URDF, too; a mistake stands above it and goes. What fails."""
    scene, robot = os.path.join(folder, "watched.mbd"), os.path.join(folder, "arm.urdf")

    def save(file, text):
        with open(file + ".part", "w", encoding="utf-8") as part:
            part.write(text)
        os.replace(file + ".part", file)

    def until(expression):
        for _ in range(100):
            if browser.run(expression):
                return True
            time.sleep(0.1)
        return False

    save(scene, WATCHED)
    save(robot, ROBOT.replace("MASS", "1.25"))
    server = subprocess.Popen([program, "watch", scene, "--no-estimate", "--out", os.path.join(folder, "watched")], stderr=subprocess.PIPE, text=True)
    failed = []
    try:
        address = server.stderr.readline().split()[1]
        browser.open(address)
        says = "document.getElementById('says')"
        page = "(document.getElementById('page').contentDocument?.body?.textContent || '')"
        for what, act, wanted in (
            ("the page of the run", lambda: None, f"{page}.includes('1.25')"),
            ("the page of the saved URDF", lambda: save(robot, ROBOT.replace("MASS", "7.75")), f"{page}.includes('7.75')"),
            ("the mistake", lambda: save(robot, ROBOT.replace("MASS", "heavy")), f"!{says}.hidden && {says}.textContent.includes('heavy')"),
            ("the mended page", lambda: save(robot, ROBOT.replace("MASS", "2.5")), f"{says}.hidden && {page}.includes('2.5')"),
        ):
            act()
            if not until(wanted):
                failed.append(f"watch: {what} does not come")
        failed += [f"watch: {error}" for error in browser.errors]
    finally:
        # Otherwise it asks in vain for the next page, which is told of the one that is opened then.
        browser.open("about:blank")
        server.terminate()
        server.wait(10)
    return failed


def made(program, folder, scene, name):
    """Runs a scene. Its page, and what went wrong."""
    out = os.path.join(folder, name)
    # Whether a run is accurate is no matter here.
    run = subprocess.run([program, "run", scene, "--no-estimate", "--gltf", "--out", out], capture_output=True, text=True)
    page = os.path.join(out, "report.html")
    return page, None if os.path.exists(page) else run.stderr.strip()


def summaries(program, folder):
    """The pages of many runs, on which one of them moves."""
    cases, many, trade = (os.path.join(folder, name) for name in ("cases.toml", "campaign", "trade"))
    with open(cases, "w", encoding="utf-8") as to:
        to.write('cases = 20\n[start]\nbob.vx = { dist = "uniform", low = "-1 m/s", high = "1 m/s" }\n[envelopes]\ncolumns = ["height"]\n')
    for line in (["campaign", "swing", cases, "--out", many], ["report", many], ["trade", "swing", "--output", "height", "--out", trade]):
        subprocess.run([program, *line], check=True, capture_output=True)
    return [("campaign", os.path.join(many, "report.html")), ("trade", os.path.join(trade, "trade.html"))]


def looked_at(browser, pages):
    """What fails of pages that are looked at one by one, as their runs end."""
    failed = []
    for name, by_hand, page in pages:
        page, error = page.result()
        if error is not None:
            failed.append(f"{name}: no page: {error}")
            continue
        first, wrong = check(browser, name, page, by_hand)
        failed += wrong
        print(f"{name}: first frame after {first:.0f} ms, {os.path.getsize(page) / 1e6:.2f} MB")
    return failed


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--keep")
    arguments.add_argument("--page")
    arguments.add_argument("program")
    arguments.add_argument("scenes", nargs="*")
    arguments = arguments.parse_args()
    program = os.path.abspath(arguments.program)
    started, failed = time.monotonic(), []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(1) as runs:

        def written(name, text):
            file = os.path.join(folder, f"{name}.mbd")
            with open(file, "w", encoding="utf-8") as to:
                to.write(text)
            return file

        tricks = written("tricks", TRICKS)
        many = [written("fifty", hanging(50)), written("five_hundred", flying(500).replace("2 s", "0.4 s"))]
        everything = arguments.scenes or [*scenes(program), *sorted(glob.glob(NEWCOMERS)), tricks, *many]
        keep = arguments.keep or folder
        # The next scenes run while the page of one is looked at.
        pages = []
        for scene in everything:
            name = os.path.splitext(os.path.basename(scene))[0]
            pages.append((name, os.path.isfile(scene) and scene not in many, runs.submit(made, program, keep, scene, name)))
        browser = Browser()
        try:
            failed += looked_at(browser, pages)
            if not arguments.scenes:
                by_name = {name: page.result()[0] for name, _, page in pages}
                for number in range(MEASUREMENTS):
                    pause_before(number)
                    shown, _ = frames(browser, by_name["fifty"], MEASURED)
                    if shown >= FRAMES:
                        break
                print(f"50 bodies: {shown:.0f} frames a second")
                if shown < FRAMES:
                    failed.append(f"50 bodies: {shown:.1f} frames a second")
                failed += chosen(browser, by_name["crane"])
                failed += without_script(browser, "swing", by_name["swing"])
                compared = os.path.join(folder, "compare")
                subprocess.run([program, "compare", "swing --tol 1e-3", "linkage", "--out", compared], check=True, capture_output=True)
                failed += check(browser, "compare", os.path.join(compared, "compare.html"), False)[1]
                for name, path in summaries(program, folder):
                    failed += check(browser, name, path, False)[1]
                failed += watched(browser, program, folder)
            if arguments.page:
                failed += check(browser, "page", arguments.page, False)[1]
        finally:
            browser.close()
    print(f"{len(pages)} pages in {time.monotonic() - started:.1f} s")
    if failed:
        raise SystemExit("\n".join(failed))


if __name__ == "__main__":
    main()
