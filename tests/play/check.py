"""The page of `edof play` in Chromium: check.py EDOF [FOLDER]. Screens are kept in FOLDER.

Every slider changes what it should, figures are those of the commands that the page names, keyboard and screen reader reach everything, two widths, light and dark,
a short training, and a wrong token.
"""

import base64
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from browser import Browser

EDOF = sys.argv[1]
SCREENS = Path(sys.argv[2]) if len(sys.argv) > 2 else None

# Which figures and plots a slider changes, by the key that moves it: dB of the demosaiced picture, of the network, of the clear lens; PSFs, MTF, contrast over depth.
PICTURES = ["db-demosaiced", "db-network", "db-clear"]
PLOTS = ["psfs", "mtf", "contrast"]
MASK = ["db-demosaiced", "db-network", *PLOTS]
SLIDERS = {
    "psi": [*PICTURES, *PLOTS],
    "focus": MASK,
    "stops": MASK,
    "electrons": PICTURES,
    "read-noise": PICTURES,
    "ring-1-inner": MASK,
    "ring-1-outer": MASK,
    "ring-1-phase": MASK,
    "cubic": MASK,
    "mixed": MASK,
    "layers": ["db-network"],
    "stride": ["db-network", "db-clear"],
}
# A pixel step of a radius moves too little to be seen in two digits.
STEPS = {"ring-1-inner": 40, "ring-1-outer": -40, "ring-1-phase": 60, "psi": 8, "focus": 80, "layers": -1, "stride": -1, "cubic": 10, "mixed": 10, "electrons": 12, "read-noise": 30}

SHOWN = """Object.fromEntries([...["db-demosaiced", "db-network", "db-clear"].map((id) => [id, document.getElementById(id).textContent]),
  ["psfs", [...document.querySelectorAll("#psfs canvas")].map((canvas) => canvas.toDataURL()).join()],
  ...["mtf", "contrast", "depths"].map((id) => [id, document.getElementById(id).innerHTML])])"""


def settled(browser):
    """Everything that the page computes is there."""
    browser.value("new Promise((done) => setTimeout(done, 50))")
    browser.until("document.querySelector('main').getAttribute('aria-busy') === 'false'")


def check(condition, what):
    if not condition:
        sys.exit(f"check.py: {what}")


def errors(browser):
    found = [e["params"] for e in browser.events if e["method"] in ("Runtime.exceptionThrown", "Log.entryAdded")]
    return [e for e in found if "exceptionDetails" in e or e["entry"]["level"] == "error"]


def sliders(browser):
    """Moves each slider by the keyboard, and back."""
    for name, changes in SLIDERS.items():
        print(f"slider {name}", flush=True)
        before = browser.value(SHOWN)
        browser.value(f"document.getElementById('{name}').focus()")
        value, words = browser.value(f"[document.getElementById('{name}').value, document.getElementById('{name}').getAttribute('aria-valuetext')]")
        steps = STEPS.get(name, 4)
        browser.key("ArrowRight" if steps > 0 else "ArrowLeft", abs(steps))
        settled(browser)
        moved = browser.value(SHOWN)
        found = [key for key in [*PICTURES, *PLOTS] if moved[key] != before[key]]
        check(sorted(found) == sorted(changes), f"{name} changed {found}, expected {changes}")
        check(browser.value(f"document.getElementById('{name}').getAttribute('aria-valuetext')") != words, f"{name}: aria-valuetext stays {words}")
        warned = browser.value("document.getElementById('warning').textContent")
        is_moved = changes == MASK
        check(bool(warned) == is_moved, f"{name}: the warning says '{warned}'")
        check(not browser.value("document.getElementById('error').textContent"), f"{name}: an error")
        set_slider(browser, name, value)
        back = browser.value(SHOWN)
        if name not in ("electrons", "read-noise"):
            different = [key for key in [*PICTURES, *PLOTS] if back[key] != before[key]]
            check(not different, f"{name} moved back: {different} differ")


def by_commands(browser, place):
    """The figures of the page are those of the commands that it names."""
    lines = browser.value("document.getElementById('commands').textContent").splitlines()
    camera = browser.value("decodeURIComponent(document.getElementById('camera-file').href.split(',').slice(1).join(','))")
    (place / "page.json").write_text(camera)
    own = browser.value("document.getElementById('network-place').hidden ? '' : document.getElementById('network-file').download")
    if own:
        bytes_of = "fetch(document.getElementById('network-file').href).then((r) => r.arrayBuffer()).then((b) => btoa(Array.from(new Uint8Array(b), (c) => String.fromCharCode(c)).join('')))"
        (place / own).write_bytes(base64.b64decode(browser.value(bytes_of)))
    said = {}
    for line in lines:
        words = line.split("#")[0].split()
        check(words[0] == "edof", line)
        done = subprocess.run([EDOF, *words[1:], "--json"], cwd=place, capture_output=True, text=True)
        check(done.returncode == 0, f"{line}: {done.stderr}")
        said[words[1]] = json.loads(done.stdout)
    shown = browser.value("document.getElementById('db-network').textContent")
    check(abs(float(shown) - said["compare"]["psnr_db"]) < 0.0075, f"{shown} dB on the page, {said['compare']['psnr_db']} by the commands")
    contrast = [float(word) for word in browser.value("document.querySelector('main').dataset.contrast").split()]
    check(contrast == said["optics"]["depths"][0]["contrast_quarter_cutoff"], f"contrast {contrast}")


def advice(browser):
    done = subprocess.run([EDOF, "optics", "advise", "--electrons", "3000"], cwd=tempfile.mkdtemp(), capture_output=True, text=True, check=True)
    shown = browser.value("document.getElementById('advice').textContent")
    for line in done.stdout.splitlines()[:-2]:
        check(line.strip() in shown, f"the advice has no '{line.strip()}'")


def set_slider(browser, name, value):
    browser.value(f"((one) => {{ one.value = '{value}'; one.dispatchEvent(new Event('input')); }})(document.getElementById('{name}'))")
    settled(browser)


def opened(browser, *options):
    """A program with its page, which is there; and its address."""
    program = subprocess.Popen([EDOF, "play", *options], stdout=subprocess.PIPE, text=True)
    address = program.stdout.readline().split()[0]
    try:
        browser.open(address)
        settled(browser)
    except BaseException:
        program.kill()
        raise
    return program, address


BUTTON = "(document.getElementById('train')?.textContent ?? '')"
WARNING = "document.getElementById('warning').textContent"
SAID = "document.getElementById('training').textContent"
LOOKED = "document.getElementById('db-network').nextElementSibling.textContent"


def another_lens(browser):
    """A lens that no network was trained for; its blur is small, so that small photographs are large enough."""
    check(not browser.value(BUTTON), "a training is offered for a lens that has a network")
    browser.value("((one) => { one.value = 'clear-mid'; one.dispatchEvent(new Event('change')); })(document.getElementById('camera'))")
    set_slider(browser, "stops", 3)
    check(browser.value(BUTTON) == "Train a network for this lens", f"the button says '{browser.value(BUTTON)}'")


def cancelled(browser, photos):
    """A training that would take days, begun and cancelled by the keyboard."""
    program, _ = opened(browser, "--images", photos, "--photos", "all", "--steps", "1000000")
    try:
        another_lens(browser)
        browser.value("document.getElementById('train').focus()")
        browser.key("Enter")
        browser.until(f"{BUTTON} === 'Cancel' && document.getElementById('training-bar').max === 1000000")
        browser.key("Enter")
        browser.until(f"{SAID}.includes('was cancelled')")
        check("page-" not in browser.value(LOOKED), "a cancelled training gave a network")
        check(not errors(browser), f"errors of the page: {errors(browser)}")
        # Of another address than the rest.
        browser.events.clear()
    finally:
        program.terminate()
        program.wait()


def training(browser, place):
    """A training to its end: its network is looked through, and its figures are those of the commands."""
    another_lens(browser)
    before = browser.value(SHOWN)
    browser.value("document.getElementById('train').click()")
    browser.until(f"{LOOKED}.includes('page-1; trained for this lens')")
    settled(browser)
    check(not browser.value(WARNING), "the warning stays")
    said = browser.value(SAID)
    check(said.startswith("page-1 is the network for this lens now: ") and "The same by: edof train --from" in said, f"it says '{said}'")
    check(browser.value(SHOWN)["db-network"] != before["db-network"], "the network changed nothing")
    by_commands(browser, place)
    # The lens is moved while a network for it is trained.
    set_slider(browser, "stops", 2)
    found = (bool(browser.value(WARNING)), "page-1" in browser.value(LOOKED), browser.value(SAID) == said)
    check(found == (True, False, False), f"the lens that was moved again has {found}")
    browser.value("((one) => { document.getElementById('train').click(); one.value = 1; one.dispatchEvent(new Event('input')); })(document.getElementById('stops'))")
    browser.until(f"{BUTTON} === 'Back to that lens'")
    check("page-" not in browser.value(LOOKED), f"looks through {browser.value(LOOKED)} behind another lens")
    browser.value("document.getElementById('train').click()")
    settled(browser)
    found = ["page-2" in browser.value(LOOKED), browser.value("document.getElementById('stops').value"), browser.value(WARNING)]
    check(found == [True, "2", ""], f"back at {found}")
    # Each lens has its own.
    set_slider(browser, "stops", 3)
    found = ["page-1" in browser.value(LOOKED), browser.value(WARNING), browser.value(SAID)]
    check(found == [True, "", said], f"at the first lens again {found}")


def by_keyboard(browser):
    """Tab reaches every control in turn, and each has a name for screen readers."""
    wanted = browser.value("[...document.querySelectorAll('input, select, button, canvas[tabindex], summary')].map((one) => one.id || one.tagName)")
    browser.value("document.activeElement.blur()")
    reached = []
    for _ in range(len(wanted) + 12):
        browser.key("Tab")
        reached.append(browser.value("document.activeElement.id || document.activeElement.tagName"))
    missing = [name for name in wanted if name not in reached]
    check(not missing, f"Tab does not reach {missing}")
    tree = browser.call("Accessibility.getFullAXTree")["nodes"]
    roles = ("slider", "combobox", "button", "image", "img", "table", "form")
    nameless = [n["role"]["value"] for n in tree if not n.get("ignored") and n["role"]["value"] in roles and not n.get("name", {}).get("value")]
    check(not nameless, f"without a name: {nameless}")
    names = [n["name"]["value"] for n in tree if not n.get("ignored") and n["role"]["value"] == "slider"]
    check("Depth of the object" in names and len(names) >= 14, f"sliders: {names}")
    # The picture: arrows move the split, + and - zoom, then arrows move the picture.
    browser.value("document.getElementById('view').focus()")
    browser.key("ArrowRight", 5)
    check(browser.value("document.getElementById('split').value") == "60", "arrows do not move the split")
    browser.key("+", 4)
    check(browser.value("document.getElementById('zoom').value") == "3", "+ does not zoom")
    before = browser.value("document.getElementById('view').toDataURL()")
    browser.key("ArrowDown", 2)
    check(browser.value("document.getElementById('view').toDataURL()") != before, "arrows do not move the picture")
    browser.key("-", 4)
    browser.key("ArrowLeft", 5)


def by_pointer(browser):
    """A drag moves the split."""
    browser.value("document.getElementById('view').scrollIntoView()")
    box = browser.value("(({ left, top, width, height }) => [left, top, width, height])(document.getElementById('view').getBoundingClientRect())")
    left, top, width, height = box
    at = lambda share: (left + share * width, top + 0.5 * height)
    browser.drag(at(0.5), at(0.25))
    check(abs(float(browser.value("document.getElementById('split').value")) - 25) <= 1, "a drag does not move the split")
    browser.drag(at(0.25), at(0.5))


def screens(browser):
    """No width scrolls sideways, and dark is dark."""
    shades = {}
    for width, height in [(390, 844), (1400, 900)]:
        for scheme in ["light", "dark"]:
            browser.screen(width, height, scheme)
            browser.value("new Promise((done) => setTimeout(done, 300))")
            wide = browser.value("document.documentElement.scrollWidth")
            check(wide <= width, f"{wide} pixels wide on a screen of {width}")
            outside = browser.value(f"[...document.querySelectorAll('main *')].filter((one) => one.getBoundingClientRect().right > {width} + 1).map((one) => one.id || one.tagName)")
            check(not outside, f"outside of {width} pixels: {outside}")
            shades[scheme] = browser.value("getComputedStyle(document.documentElement).backgroundColor")
            if SCREENS:
                browser.photograph(SCREENS / f"play-{width}-{scheme}.png")
    light, dark = (sum(map(int, re.findall(r"\d+", shades[scheme])[:3])) for scheme in ("light", "dark"))
    check(light > 600 and dark < 150, f"backgrounds {shades}")
    browser.screen(1400, 900, "light")


def refused(browser, address):
    """Without the token there is no page; what the page loads comes from its own address."""
    origin = "/".join(address.split("/")[:3])
    asked = [e["params"]["request"]["url"] for e in browser.events if e["method"] == "Network.requestWillBeSent"]
    strange = [url for url in asked if not url.startswith((address, "data:", "blob:", "about:"))]
    check(asked and not strange, f"asked elsewhere: {strange}")
    for path in ["/", f"/{'0' * 32}/", f"/{'0' * 32}/setup"]:
        browser.open(origin + path)
        text = browser.value("document.body.textContent")
        check("token: missing or wrong" in text, f"{path}: {text}")


def main():
    photos = Path(tempfile.mkdtemp())
    for name in ["chart", "leaves"]:
        capture = f"capture {name} --size 256x192 --camera clear --psi 0 --no-measure --out raw.png --sharp {name}1.png"
        subprocess.run([EDOF, *capture.split()], cwd=photos, capture_output=True, check=True)
    (photos / "raw.png").unlink()
    browser = Browser()
    program = None
    try:
        browser.screen(1400, 900, "light")
        cancelled(browser, photos)
        program, address = opened(browser, "--images", photos, "--photos", "all", "--steps", "20")
        check(not browser.value("document.getElementById('error').textContent"), "an error at the start")
        with tempfile.TemporaryDirectory() as place:
            by_commands(browser, Path(place))
            advice(browser)
            screens(browser)
            by_keyboard(browser)
            by_pointer(browser)
            sliders(browser)
            # Another lens: the commands of the page still say its figures.
            set_slider(browser, "stops", 1)
            by_commands(browser, Path(place))
            set_slider(browser, "stops", 0)
            training(browser, Path(place))
        check(not errors(browser), f"errors of the page: {errors(browser)}")
        refused(browser, address)
    finally:
        browser.close()
        if program:
            program.terminate()
            program.wait()
    print(f"edof play: {len(SLIDERS)} sliders, commands, keyboard, two widths, light and dark, a training, tokens: all as they should be")


main()
