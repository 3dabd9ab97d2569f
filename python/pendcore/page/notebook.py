"""The page of a run inside a notebook: in a frame, or as a widget whose state Python reads."""

from __future__ import annotations

import tomllib
from html import escape
from typing import Any

_WIDGET = """
function render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.srcdoc = model.get("page");
  frame.style = `width: 100%; height: ${model.get("height")}px; border: 0`;
  el.append(frame);
  const take = ({ data, source }) => {
    if (source !== frame.contentWindow || data?.pendcore === undefined) return;
    model.set("text", data.pendcore);
    model.save_changes();
  };
  window.addEventListener("message", take);
  return () => window.removeEventListener("message", take);
}
export default { render };
"""


class NotebookPage:
    """A page of a run, as a notebook shows it; `pendcore.Solution.page` makes it.

    ``text`` is the page, as `Solution.to_html` writes it, and ``height`` its height in pixels.
    """

    def __init__(self, text: str, height: int) -> None:
        self.text, self.height = text, height

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.text)}" '
            f'style="width: 100%; height: {self.height}px; border: 0" title="A run"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<a page of {len(self.text)} characters, for a notebook>"


def widget_of(text: str, height: int) -> Any:
    """Return an anywidget that holds the page; its ``case`` is what the page shows now."""
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise ImportError(
            "widget: anywidget is missing (pip: anywidget); sol.page() needs nothing"
        ) from None

    class PageWidget(anywidget.AnyWidget):
        """A page of a run; ``case`` is the case that it shows, named as in a case file."""

        _esm = _WIDGET
        page = traitlets.Unicode("").tag(sync=True)
        height = traitlets.Int().tag(sync=True)
        text = traitlets.Unicode("").tag(sync=True)

        @property
        def case(self) -> dict[str, Any] | None:
            return {"effect": [], **tomllib.loads(self.text)} if self.text else None

    return PageWidget(page=text, height=height)
