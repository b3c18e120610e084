"""What a notebook shows of a run: the first screen and the picture, as `jointplay run` prints them."""

from __future__ import annotations

from base64 import b64encode
from html import escape


def html_of(screen: str, picture: str) -> str:
    """Both as HTML; the picture is SVG.

    It is an image of its own: inline, its style sheet would restyle every other picture of the page.
    """
    data = b64encode(picture.encode()).decode()
    return (
        f'<pre style="line-height:1.25;overflow-x:auto">{escape(screen)}</pre>'
        f'<img style="max-width:62em;width:100%" alt="" src="data:image/svg+xml;base64,{data}">'
    )
