"""Opens pages of `quadmosaic` in a browser without a window, draws on them with the mouse, and meshes with what was drawn."""

import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import websocket

# The browser's picture, in pixels.
SIZE = (1280, 800)
# The surfaces and the numbers of vertices of the pages whose frame times are printed. The large one has nearly as many triangles as a
# page shows.
PAGES = [("example:m6", 6000)]
if os.environ.get("QUADMOSAIC_LARGE_PAGES"):
    PAGES.append(("example:m6:190000", 60000))
# Pages of 60,000 points are smaller than this, in bytes.
MOST_BYTES = 15_000_000


def expect(condition, what):
    if not condition:
        sys.exit(f"FAILED: {what}")


class Browser:
    """Chromium, driven over its DevTools protocol."""

    def __init__(self, program, folder):
        sandbox = ["--no-sandbox"] if os.geteuid() == 0 else []
        command = [program, "--headless=new", *sandbox, "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        command += ["--remote-debugging-port=0", f"--user-data-dir={folder}", f"--window-size={SIZE[0]},{SIZE[1]}", "--no-first-run"]
        command += ["--disable-background-networking", "--disable-component-update", "--disable-sync", "about:blank"]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        port_file = pathlib.Path(folder) / "DevToolsActivePort"
        for _ in range(300):
            if port_file.exists() and len(port_file.read_text().split()) == 2:
                break
            time.sleep(0.1)
        else:
            sys.exit("FAILED: the browser does not start")
        port, path = port_file.read_text().split()
        self.socket = websocket.create_connection(f"ws://127.0.0.1:{port}{path}", suppress_origin=True, timeout=120)
        self.number, self.session, self.events = 0, None, []
        targets = self.call("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in targets if target["type"] == "page")
        self.session = self.call("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        for domain in ["Page", "Runtime", "Log", "Network"]:
            self.call(f"{domain}.enable")

    def close(self):
        self.socket.close()
        self.process.terminate()
        self.process.wait()

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        self.socket.send(json.dumps(message | ({"sessionId": self.session} if self.session else {})))
        while True:
            answer = json.loads(self.socket.recv())
            if answer.get("id") == self.number:
                expect("error" not in answer, f"{method}: {answer.get('error')}")
                return answer["result"]
            self.events.append(answer)

    def open(self, path):
        self.visit(path.resolve().as_uri())

    def visit(self, address):
        self.events = []
        self.call("Page.navigate", url=address)
        while self.run("document.readyState") != "complete":
            time.sleep(0.05)

    def run(self, script):
        """The value of a script."""
        answer = self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        expect("exceptionDetails" not in answer, f"{script}: {answer.get('exceptionDetails')}")
        return answer["result"].get("value")

    def complaints(self):
        """Errors and warnings of the page."""
        kinds = {"Runtime.exceptionThrown", "Log.entryAdded", "Runtime.consoleAPICalled"}
        return [event["params"] for event in self.events if event.get("method") in kinds]

    def requests(self):
        """The addresses that the page asked for."""
        asked = [event["params"]["request"]["url"] for event in self.events if event.get("method") == "Network.requestWillBeSent"]
        return [url for url in asked if not url.startswith("data:")]

    def mouse(self, kind, at, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], **more)

    def drag(self, places):
        """Moves the mouse over places with its button pressed."""
        self.mouse("mouseMoved", places[0])
        self.mouse("mousePressed", places[0], button="left", buttons=1, clickCount=1)
        for place in places[1:]:
            self.mouse("mouseMoved", place, button="left", buttons=1)
        self.mouse("mouseReleased", places[-1], button="left", buttons=0, clickCount=1)

    def click(self, selector):
        """Clicks the middle of an element with the mouse."""
        self.run(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{block: 'center'}})")
        at = self.run(f"(() => {{ const box = document.querySelector({json.dumps(selector)}).getBoundingClientRect();"
                      " return [box.x + box.width / 2, box.y + box.height / 2]; })()")
        self.mouse("mousePressed", at, button="left", buttons=1, clickCount=1)
        self.mouse("mouseReleased", at, button="left", buttons=0, clickCount=1)


def quadmosaic(*arguments):
    subprocess.run([sys.argv[1], *map(str, arguments)], check=True)


def mesh(surface, output, *options):
    quadmosaic("mesh", surface, "-o", output, "--backend", "cpu", "--quiet", *options)


def edges_of(path):
    """The edges of an OBJ file, each as two places."""
    points, edges = [], set()
    for words in map(str.split, path.read_text().splitlines()):
        if words[:1] == ["v"]:
            points.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            face = [int(word) - 1 for word in words[1:]]
            edges |= {tuple(sorted(pair)) for pair in zip(face, face[1:] + face[:1])}
    return [(points[a], points[b]) for a, b in edges]


def middle_of(edge):
    return [(a + b) / 2 for a, b in zip(*edge)]


def turned(path):
    """The mean angle in degrees between edges near the stroke and the stroke or what is across it."""
    near = [edge for edge in edges_of(path) if all(0.35 < x < 0.65 for x in middle_of(edge)[:2])]
    near = [edge for edge in near if abs(middle_of(edge)[0] - middle_of(edge)[1]) < 0.1]
    angles = [math.degrees(math.atan2(b[1] - a[1], b[0] - a[0])) % 90 for a, b in near]
    return sum(abs(angle - 45) for angle in angles) / len(angles)


def ratio(path):
    """The mean edge length where sizes were painted, over that far from there."""
    edges = [(middle_of(edge), math.dist(*edge)) for edge in edges_of(path)]
    inner = [length for (x, y, _), length in edges if 0.25 < x < 0.75 and abs(y - 0.5) < 0.08]
    outer = [length for (x, y, _), length in edges if abs(y - 0.5) > 0.35]
    return sum(inner) / len(inner) / (sum(outer) / len(outer))


def plate(path):
    """A square of side 1."""
    side = 20
    lines = [f"v {x / side} {y / side} 0" for y in range(side + 1) for x in range(side + 1)]
    at = lambda x, y: y * (side + 1) + x + 1
    for y in range(side):
        for x in range(side):
            lines += [f"f {at(x, y)} {at(x + 1, y)} {at(x + 1, y + 1)}", f"f {at(x, y)} {at(x + 1, y + 1)} {at(x, y + 1)}"]
    path.write_text("\n".join(lines) + "\n")


def along(start, end, count):
    return [[a + (b - a) * k / count for a, b in zip(start, end)] for k in range(count + 1)]


def seen(browser, places):
    """The pixels at which places in model units are seen."""
    return [browser.run(f"quadmosaic.project({json.dumps(place)})") for place in places]


def press(browser, text):
    """Presses a button by its text, as the keyboard does."""
    browser.run(f"[...document.querySelectorAll('button')].find((button) => button.textContent === {json.dumps(text)}).focus()")
    for kind in ["keyDown", "keyUp"]:
        browser.call("Input.dispatchKeyEvent", type=kind, key="Enter", code="Enter", text="\r" if kind == "keyDown" else "",
                     windowsVirtualKeyCode=13)


def downloaded(browser, folder, selector, name):
    """The text of the file that a button saves."""
    browser.click(selector)
    for _ in range(100):
        if (folder / name).exists():
            return (folder / name).read_text()
        time.sleep(0.05)
    sys.exit(f"FAILED: {name} is not saved")


def is_quiet(browser, path):
    expect(browser.complaints() == [], f"{path.name}: {browser.complaints()}")
    expect(browser.requests() == [path.resolve().as_uri()], f"{path.name} asks for {browser.requests()}")


def test_pages_load_and_turn(browser, folder):
    for surface, points in PAGES:
        page = folder / f"m6-{points}.html"
        mesh(surface, folder / "m6.obj", "--points", points, "--html", page)
        expect(page.stat().st_size < MOST_BYTES, f"{page.name} has {page.stat().st_size} bytes")
        browser.open(page)
        time = browser.run("quadmosaic.frameTime(5)")
        print(f"{points} points: {page.stat().st_size / 1e6:.1f} MB, {time:.0f} ms a frame on the software renderer")
        before = seen(browser, [[0.5, 0.5, 0]])
        browser.drag([[300, 300], [350, 320], [400, 340]])
        expect(seen(browser, [[0.5, 0.5, 0]]) != before, "a drag turns the mesh")
        expect(json.loads(browser.run("quadmosaic.guides()"))["strokes"] == [], "a drag that turns draws nothing")
        is_quiet(browser, page)


def test_rows_turn_towards_a_stroke(browser, folder):
    surface, page = folder / "plate.obj", folder / "plate.html"
    plate(surface)
    mesh(surface, folder / "before.obj", "--points", 900, "--html", page)
    browser.open(page)
    press(browser, "top")
    browser.click("[data-mode=stroke]")
    start, end = [0.3, 0.3, 0], [0.7, 0.7, 0]
    browser.drag(seen(browser, along(start, end, 20)))
    browser.drag(seen(browser, along([0.2, 0.8, 0], [0.3, 0.7, 0], 5)))
    expect(len(json.loads(browser.run("quadmosaic.guides()"))["strokes"]) == 2, "two strokes are drawn")
    browser.click("#undo")
    strokes = json.loads(browser.run("quadmosaic.guides()"))["strokes"]
    expect(len(strokes) == 1, "the second one is undone")
    points = strokes[0]["points"]
    pixel = math.dist(*browser.run("[quadmosaic.pick(500, 400), quadmosaic.pick(501, 400)]"))
    ends = max(math.dist(points[0], start), math.dist(points[-1], end))
    expect(len(points) > 5 and ends < 0.04, f"a stroke of {len(points)} points is where it was drawn, within {ends:.3f}")
    off = max(abs(x - y) / math.sqrt(2) + abs(z) for x, y, z in points)
    expect(off < 2 * pixel, f"and straight: {off / pixel:.2f} pixels off")

    browser.run("quadmosaic.show(JSON.parse(document.getElementById('data').textContent))")
    expect(json.loads(browser.run("quadmosaic.guides()"))["strokes"] == strokes, "strokes stay where another mesh is shown")

    text = downloaded(browser, folder, "#save-guides", "guides.json")
    expect(text == browser.run("quadmosaic.guides()"), "what is saved is what scripts get")
    mesh(surface, folder / "after.obj", "--points", 900, "--guides", folder / "guides.json")

    before, after = turned(folder / "before.obj"), turned(folder / "after.obj")
    print(f"rows near the stroke: {before:.1f} degrees from it without it, {after:.1f} with it")
    expect(before > 35, "without the stroke rows follow the borders")
    expect(after < 10, "with the stroke they follow it")
    is_quiet(browser, page)


def test_edges_are_shorter_where_sizes_are_painted(browser, folder):
    surface, page = folder / "plate.obj", folder / "plate.html"
    browser.open(page)
    press(browser, "top")
    press(browser, "Paint sizes")
    browser.drag(seen(browser, along([0.2, 0.5, 0], [0.8, 0.5, 0], 8)))
    (folder / "sizes.csv").write_text(browser.run("quadmosaic.sizes()"))
    mesh(surface, folder / "painted.obj", "--points", 900, "--size-field", folder / "sizes.csv")

    before, after = ratio(folder / "before.obj"), ratio(folder / "painted.obj")
    print(f"edges painted half as long: {before:.2f} times as long as others without the sizes, {after:.2f} with them")
    expect(before > 0.9, "without the sizes edges are alike")
    expect(after < 0.7, "with them they are shorter where that was painted")
    browser.click("#undo")
    sizes = {line.rsplit(",", 1)[1] for line in browser.run("quadmosaic.sizes()").splitlines()[1:]}
    expect(len(sizes) == 1, "one undo takes a whole drag back")
    is_quiet(browser, page)


def test_strokes_lie_on_the_surface_and_end_where_it_does(browser, folder):
    page = folder / "sphere.html"
    mesh("example:sphere", folder / "sphere.obj", "--points", 1000, "--html", page)
    radius = math.dist([0, 0, 0], edges_of(folder / "sphere.obj")[0][0])
    browser.open(page)
    press(browser, "Draw strokes")
    # From outside of the sphere over it, and out again.
    [middle] = seen(browser, [[0, 0, 0]])
    browser.drag([[5 + (2 * middle[0] - 10) * k / 40, middle[1] + 60] for k in range(41)])
    strokes = json.loads(browser.run("quadmosaic.guides()"))["strokes"]
    expect(len(strokes) == 1, f"{len(strokes)} strokes are drawn")
    off = max(abs(math.dist([0, 0, 0], point) / radius - 1) for point in strokes[0]["points"])
    expect(off < 0.005, f"the stroke is on the sphere, within {off:.4f} of its radius")
    front = browser.run(f"quadmosaic.pick({middle[0]}, {middle[1]})")
    browser.run("(() => { const axis = document.getElementById('slice-axis'); axis.value = 'eye';"
                " axis.dispatchEvent(new Event('input')); })()")
    back = browser.run(f"quadmosaic.pick({middle[0]}, {middle[1]})")
    expect(math.dist(front, back) > 1.9 * radius, "a slice opens the view on the back")
    is_quiet(browser, page)


class Server:
    """`quadmosaic serve`, and the address that it prints."""

    def __init__(self, surface, *options):
        command = [sys.argv[1], "serve", str(surface), "--backend", "cpu", *map(str, options)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()

    def close(self):
        self.process.terminate()
        expect(self.process.wait() == 143, "the server is ended by a signal")


def waits_for(browser, script, part):
    """Waits until the text that a script gives has a part."""
    for _ in range(600):
        text = browser.run(script)
        if part in text:
            return
        time.sleep(0.05)
    sys.exit(f"FAILED: {script} gives {text!r}, not {part!r}")


TOLD = "document.getElementById('run').textContent"


def meshed(browser, points, told="Meshed."):
    """Asks the served page for a mesh, and waits until it tells this."""
    browser.run(f"document.getElementById('points').value = '{points}'; {TOLD} = ''")
    press(browser, "Mesh")
    waits_for(browser, TOLD, told)


def test_the_served_page_meshes_what_is_drawn(browser, folder):
    surface, output = folder / "plate.obj", folder / "served.obj"
    plate(surface)
    server = Server(surface, "--points", 900, "-o", output)
    try:
        browser.visit(server.address)
        waits_for(browser, "document.getElementById('points').value", "900")
        expect(turned(output) > 35, "the first mesh is without strokes")
        press(browser, "top")
        browser.click("[data-mode=stroke]")
        browser.drag(seen(browser, along([0.3, 0.3, 0], [0.7, 0.7, 0], 20)))
        guides = browser.run("quadmosaic.guides()")
        where = seen(browser, [[0.5, 0.5, 0]])
        meshed(browser, 1200)
        print(f"rows near the stroke on the served page: {turned(output):.1f} degrees from it")
        expect(turned(output) < 10, "rows follow the stroke")
        (folder / "drawn.json").write_text(guides)
        mesh(surface, folder / "same.obj", "--points", 1200, "--guides", folder / "drawn.json")
        expect(output.read_bytes() == (folder / "same.obj").read_bytes(), "it is the mesh of the command line")
        vertices = sum(line.startswith("v ") for line in output.read_text().splitlines())
        expect(vertices > 1100, f"the form's number of vertices counts: {vertices}")
        expect(browser.run("quadmosaic.sizes().trim().split('\\n').length") == vertices + 1, "and the page shows that mesh")
        expect(len(json.loads(browser.run("quadmosaic.guides()"))["strokes"]) == 1, "the stroke stays")
        expect(math.dist(where[0], seen(browser, [[0.5, 0.5, 0]])[0]) < 2, "and so does the view")

        press(browser, "Undo")
        press(browser, "Paint sizes")
        browser.drag(seen(browser, along([0.2, 0.5, 0], [0.8, 0.5, 0], 8)))
        # The second run has the sizes that were carried to the mesh of the first.
        for run in ["first", "second"]:
            meshed(browser, 900)
            print(f"edges painted half as long on the served page: {ratio(output):.2f} times as long as others, {run} run")
            expect(ratio(output) < 0.7, "edges are shorter where that was painted")
        expect(ratio(folder / "same.obj") > 0.9, "without the sizes edges are alike")
        text = downloaded(browser, folder, "#save-mesh", "mesh.obj")
        expect(text == output.read_text(), "the page saves the mesh")
        expect(browser.complaints() == [], f"{browser.complaints()}")
        asked = browser.requests()
        expect(len(asked) > 5 and all(url.startswith(server.address) for url in asked), f"the page asks for {asked}")

        meshed(browser, 400000, "%")
        press(browser, "Cancel")
        waits_for(browser, TOLD, "Cancelled.")
        meshed(browser, 3, "ask for 4 to 50000000 vertices")
        expect(output.read_text() == text, "the mesh before stays")
    finally:
        server.close()


def main():
    # Children of the browser may write to its profile for a moment after its end.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        (folder / "profile").mkdir()
        browser = Browser(sys.argv[2], folder / "profile")
        try:
            browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
            for test in [
                test_pages_load_and_turn,
                test_rows_turn_towards_a_stroke,
                test_edges_are_shorter_where_sizes_are_painted,
                test_strokes_lie_on_the_surface_and_end_where_it_does,
                test_the_served_page_meshes_what_is_drawn,
            ]:
                test(browser, folder)
        finally:
            browser.close()


if __name__ == "__main__":
    main()
