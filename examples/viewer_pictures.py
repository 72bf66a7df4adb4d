"""The pictures of docs/viewer.md: real runs in a real browser.

A fluid vesicle of 1002 vertices with its spectrum, and the two vesicles of ``vesicle.toml``, each
run by ``openmm-helfrich run`` and shown by ``openmm-helfrich view``. It takes a minute, and needs
Playwright and Chromium: ``pip install playwright``, and ``playwright install chromium`` or Debian's
package ``chromium``.
"""

import argparse
import io
import os
import shutil
import sys
from pathlib import Path

from openmmhelfrich.simulation.runner import Run
from openmmhelfrich.viewer import view
from openmmhelfrich.viewer.views import View
from PIL import Image
from playwright.sync_api import sync_playwright

HERE = Path(__file__).resolve().parent

FLUID = """
[simulation]
name = "fluid-vesicle"
duration = 20000
seed = 1
minimise = true
[integrator]
time_step = 0.2
friction = 0.001
[output]
interval = 100
[[vesicle]]
name = "vesicle"
rigidity = "20 kT"
softness = 0.037
flips = 0.01
[vesicle.mesh]
random = 1002
radius = 1000
seed = 1
"""

PICTURES = {
    "fluid": ("light", "viewer.openRow('bending kJ/mol')"),
    "two": (
        "dark",
        "viewer.colour(1); viewer.choose(1); viewer.openRow('bending oblate kJ/mol');"
        "viewer.show(8); viewer.turn(0.7, 0); viewer.zoom(1.05)",
    ),
}
"""The scheme of colours, and what is done before the picture is taken."""


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Draw the pictures of docs/viewer.md.")
    parser.add_argument("--out", type=Path, default=Path("out/viewer"), help="folder of pictures")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "fluid.toml").write_text(FLUID)
    runs = {"fluid": options.out / "fluid.toml", "two": HERE / "vesicle.toml"}
    with sync_playwright() as playwright:
        browser = launched(playwright)
        for name, config in runs.items():
            found = shown(config, options.out / name)
            page = found.write(options.out / f"{name}.html")
            picture = taken(browser, page, *PICTURES[name])
            picture.save(options.out / f"{name}.png", optimize=True)
            print(f"wrote {options.out / name}.png, and {page}, {page.stat().st_size / 1e6:.2g} MB")
        browser.close()


def shown(config, folder) -> View:
    """The view of a run, which is made unless it is there."""
    run = Run(config, folder=folder, resume=folder.exists())
    try:
        run.advance(run.cfg.num_steps)
    finally:
        run.close()
    return view(folder, title=run.cfg.name)


def launched(playwright):
    own = playwright.chromium.executable_path
    path = own if Path(own).exists() else shutil.which("chromium")
    if path is None:
        sys.exit("viewer_pictures: there is no Chromium; apt-get install chromium")
    # Chromium's sandbox refuses root.
    return playwright.chromium.launch(
        executable_path=path,
        chromium_sandbox=os.getuid() != 0,
        args=["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
    )


def taken(browser, page, scheme, script) -> Image.Image:
    """A picture of a page in 256 colours, drawn with twice the points and made small again."""
    tab = browser.new_page(
        viewport={"width": 1100, "height": 760}, color_scheme=scheme, device_scale_factor=2
    )
    tab.goto(page.resolve().as_uri())
    tab.wait_for_selector("body[data-ready]")
    tab.evaluate(f"() => {{ {script} }}")
    tab.wait_for_timeout(1000)
    data = tab.screenshot()
    tab.close()
    picture = Image.open(io.BytesIO(data)).convert("RGB").resize((1100, 760), Image.LANCZOS)
    return picture.quantize(256, dither=Image.Dither.NONE)


if __name__ == "__main__":
    main()
