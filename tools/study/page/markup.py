# SPDX-License-Identifier: BSD-3-Clause
"""Pieces of the page, as HTML."""
import base64
import html
import re

NOT_RUN = '<span class="faint">not run</span>'


def escaped(text):
    return html.escape(text, quote=False).replace('"', "&quot;")


def from_markdown(text):
    """A line of Markdown with `code` in it."""
    return re.sub("`([^`]*)`", r"<code>\1</code>", escaped(text))


def table(heads, rows):
    """Cells are HTML already."""
    def row(tag, cells):
        return "<tr>" + "".join(f"<{tag}>{cell}</{tag}>" for cell in cells) + "</tr>"
    return (f'<div class="table"><table><thead>{row("th", heads)}</thead><tbody>\n' +
            "".join(row("td", cells) + "\n" for cells in rows) + "</tbody></table></div>\n")


def picture(path, alternative):
    """A PNG file as part of the page."""
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<div class="picture"><img alt="{escaped(alternative)}" src="data:image/png;base64,{data}"></div>\n'


def named(controller):
    """A controller's name behind its colour."""
    red, green, blue = (f"{255 * part:.0f}" for part in controller.color)
    return f'<span class="key" style="background:rgb({red},{green},{blue})"></span>{controller.name}'
