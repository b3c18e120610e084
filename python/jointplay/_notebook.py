"""What a notebook shows of a run: the first screen and the picture, as `jointplay run` prints them."""

from __future__ import annotations

from html import escape


def html_of(screen: str, picture: str) -> str:
    """Both as HTML; the picture is SVG."""
    return (
        f'<pre style="line-height:1.25;overflow-x:auto">{escape(screen)}</pre>'
        f'<div style="max-width:62em;overflow-x:auto">{picture}</div>'
    )
