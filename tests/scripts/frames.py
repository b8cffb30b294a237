"""How many frames a second the pages of scenes with many bodies show in a headless Chromium, which draws in software; and how soon the first one is there.

    python3 tests/scripts/frames.py target/release/mbd [BODIES …]

Nothing is asserted: what it prints depends on the machine and on what else that does.
"""

import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from browser import Browser  # noqa: E402

SHAPES = [
    "box [0.3, 0.2, 0.4] m", "cylinder { radius: 0.1 m, length: 0.4 m }", "sphere { radius: 0.15 m }",
    "tube { radius: 0.15 m, inner: 0.1 m, length: 0.3 m }", "capsule { radius: 0.1 m, length: 0.3 m }",
]
RUN = '[run]\nuntil = "2 s"\nevery = "20 ms"\ntolerance = 1e-4\n'


def flying(count):
    """Bodies of all shapes that fly."""
    bodies = "".join(
        f"    body b{i} {{ mass: 1 kg, shape: {SHAPES[i % 5]}, start at [{i % 10}.0, {i // 10 % 10}.0, {i // 100}.0] m "
        f"velocity [1.0, {i % 3 - 1}.0, 4.0] m/s angular_velocity [{i % 7 - 3}.0, {i % 5 - 2}.0, 1.0] rad/s }}\n"
        f"    joint f{i}: free from world to b{i}.com;\n" for i in range(count))
    return f"model Flying {{\n    gravity: [0.0, 0.0, -9.81] m/s^2;\n{bodies}}}\n\n{RUN}"


def hanging(count):
    """Pendulums on hinges, tied together by springs."""
    places = "".join(f"        frame h{i} at [{i % 25}.0, {i // 25}.0, 0.0] m,\n" for i in range(count))
    bodies = "".join(
        f"    body b{i} {{ mass: 1 kg, shape: {SHAPES[i % 2]}, frame top at [0.0, 0.0, 0.4] m, frame end at [0.0, 0.0, -0.4] m }}\n"
        f"    joint j{i}: hinge from world.h{i} to b{i}.top {{ axis: {'xy'[i % 2]}, start: {i % 11 * 7 + 5} deg }}\n" for i in range(count))
    springs = "".join(f"    spring s{i} from b{i}.end to b{i + 1}.end {{ free_length: 1 m, stiffness: 20 N/m }}\n" for i in range(0, count - 1, 2))
    return f"model Hanging {{\n    gravity: [0.0, 0.0, -9.81] m/s^2;\n    world {{\n{places}    }}\n{bodies}{springs}}}\n\n{RUN}"


def frames(browser, page, span=4.0):
    """Frames a second while the page plays, over a span of time [s], and when the first one came [ms]."""
    browser.open(page)
    browser.frames(3)
    first = browser.run("document.querySelector('canvas').dataset.first")
    count = browser.run(f"const span = {1000 * span};" + """new Promise((done) => {
        document.querySelector('[data-mbd=speed]').value = '0.1';
        document.querySelector('[data-mbd=play]').click();
        const canvas = document.querySelector('canvas');
        const [before, start] = [Number(canvas.dataset.frames), performance.now()];
        setTimeout(() => done((Number(canvas.dataset.frames) - before) / (performance.now() - start) * 1000), span);
    })""")
    return count, float(first)


def main():
    program, *counts = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser()
        try:
            for count in map(int, counts or ("50", "500")):
                for name, make in (("flying", flying), ("hanging", hanging)):
                    scene = os.path.join(folder, f"{name}.mbd")
                    with open(scene, "w", encoding="utf-8") as file:
                        file.write(make(count))
                    out = os.path.join(folder, f"{name}_{count}")
                    subprocess.run([os.path.abspath(program), "run", scene, "--no-estimate", "--out", out], check=True, stdout=subprocess.DEVNULL)
                    shown, first = frames(browser, os.path.join(out, "report.html"))
                    print(f"{count} bodies, {name}: {shown:.0f} frames a second, the first after {first:.0f} ms")
        finally:
            browser.close()


if __name__ == "__main__":
    main()
