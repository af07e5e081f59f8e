"""The picture of the page of `sdfc watch --serve`, made anew: python docs/images/page.py"""

from __future__ import annotations

import sys
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "tests" / "page"))

from devtools import Browser  # noqa: E402
from servers import Watch  # noqa: E402


def main() -> None:
    text = (ROOT / "scenes" / "die.sdf").read_text()
    with (
        TemporaryDirectory() as folder,
        closing(Watch(Path(folder), "die.sdf", text)) as watch,
        closing(Browser()) as browser,
    ):
        tab = browser.open(size=(1280, 720))
        tab.go(watch.url)
        tab.until("document.querySelector('#waiting')?.hidden")
        tab.rest()
        Image.fromarray(tab.seen()).save(ROOT / "docs" / "images" / "page.png", optimize=True)


if __name__ == "__main__":
    main()
