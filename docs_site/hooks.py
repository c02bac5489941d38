"""What mkdocs calls while it builds the site; `mkdocs.yml` names this module."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from docs_site.links import without_outside_links
from docs_site.order import with_further_pages
from docs_site.reference import PAGES

STYLE = Path(__file__).with_name("site.css")


def on_files(files: Files, /, *, config: MkDocsConfig) -> Files:
    """Add the generated pages, the style, and pages that the navigation does not name."""
    for path, text in PAGES.items():
        files.append(File.generated(config, path, content=text()))
    files.append(File.generated(config, STYLE.name, content=STYLE.read_text(encoding="utf-8")))
    config.nav = with_further_pages(config.nav or [], [file.src_uri for file in files.documentation_pages()])
    return files


def on_page_markdown(markdown: str, /, *, page: Page, **_: Any) -> str:
    """Turn links out of docs/ into plain paths: the site does not hold what they lead to."""
    return without_outside_links(markdown, page.file.src_uri)
