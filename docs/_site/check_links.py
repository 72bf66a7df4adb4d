"""Check the links of the finished site: every file and every anchor within it is there.

check_links.py FOLDER
"""

from __future__ import annotations

import sys
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class _Page(HTMLParser):
    """The links and anchors of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: set[str] = set()
        self.anchors: set[str] = set()

    def handle_starttag(self, tag, attributes) -> None:
        for name, value in attributes:
            if name in ("id", "name"):
                self.anchors.add(value)
            elif name in ("href", "src") and value:
                self.links.add(value)


@cache
def _read(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def _broken(site: Path, path: Path) -> list[str]:
    found = []
    for link in sorted(_read(path).links):
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        anchor = unquote(parts.fragment)
        if not target.is_file() or site not in target.parents:
            found.append(f"{path.relative_to(site)}: there is no {link}")
        elif anchor and target.suffix == ".html" and anchor not in _read(target).anchors:
            found.append(f"{path.relative_to(site)}: there is no place {link}")
    return found


def main(folder: str) -> int:
    """Print what leads nowhere; the number of these is the exit status, 1 at most."""
    site = Path(folder).resolve()
    # Rustdoc checks its own links.
    pages = [p for p in sorted(site.rglob("*.html")) if "rust" not in p.relative_to(site).parts[:1]]
    broken = [line for page in pages for line in _broken(site, page)]
    print("\n".join([*broken, f"{len(pages)} pages, {len(broken)} broken links"]))
    return bool(broken) or not pages


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
