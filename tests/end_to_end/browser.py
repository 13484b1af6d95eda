"""A report page in a headless Chromium.

What a person would do is done by a script that is appended to the page; what the page then shows, pixels included,
comes back in the page's text.
"""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

BEFORE = """
<script>
const said = { errors: [] };
window.addEventListener("error", (event) => said.errors.push(event.message));
const wait = (seconds) => new Promise((done) => setTimeout(done, 1000 * seconds));
HTMLCanvasElement.prototype.setPointerCapture = () => {};

// Middle of all pixels of a colour, in CSS pixels.
function middle(canvas, [red, green, blue]) {
  const { data, width } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let x = 0, y = 0, count = 0;
  for (let k = 0; k < data.length; k += 4) {
    if (data[k] !== red || data[k + 1] !== green || data[k + 2] !== blue || data[k + 3] !== 255) continue;
    x += (k / 4) % width + 0.5;
    y += Math.floor(k / 4 / width) + 0.5;
    count++;
  }
  const ratio = window.devicePixelRatio;
  return [x / count / ratio, y / count / ratio];
}

function point(type, canvas, share) {
  const box = canvas.getBoundingClientRect();
  const clientX = box.left + MARGIN.left + share * (box.width - MARGIN.left - MARGIN.right);
  canvas.dispatchEvent(new PointerEvent(type, { clientX, clientY: box.top + 50, pointerId: 1, bubbles: true }));
}

function legend(chart, curve) {
  return document.querySelectorAll(".chart")[chart].querySelectorAll(".legend button")[curve].textContent;
}
"""
AFTER = """
use().catch((error) => said.errors.push(String(error))).finally(() => {
  create("pre", document.body, "", JSON.stringify(said)).id = "said";
});
</script>
"""


def used(page: str, script: str, folder: Path) -> dict[str, Any]:
    """What a script noted in `said`: it defines `async function use()`. Skips the test without a browser."""
    if BROWSER is None:
        pytest.skip("no Chromium on this machine (on Debian: apt-get install chromium)")
    path = folder / "report.html"
    path.write_text(page.replace("</body>", BEFORE + script + AFTER + "</body>"), encoding="utf-8")
    options = ("--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'profile'}")
    size = ("--window-size=1200,900", "--virtual-time-budget=10000")
    done = subprocess.run(
        [BROWSER, *options, *size, "--dump-dom", path.as_uri()], capture_output=True, text=True, timeout=300
    )
    found = re.search(r'<pre class="" id="said">(.*?)</pre>', done.stdout)
    assert found, done.stderr[-2000:]
    return json.loads(html.unescape(found[1]))
