"""The legend of a picture as an image: title, number of channels, colour bar with its numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from lce_workbench.app.colours import Scale
from lce_workbench.app.pictures import Picture
from lce_workbench.gui.qt import QtCore, QtGui, tr

WIDTH, EDGE, LINE, BAR, TALL = 190, 12, 18, 22, 180
"""Of the image at least, its margin, a line of text, the bar and its length [pixels]."""

THIN = "\u202f"
"""The space between thousands."""

STEPS = 6
"""Numbers beside the bar, at most."""


@dataclass(frozen=True)
class Legend:
    """An image that the scene graph takes."""

    pixels: bytes
    """Rows from below, red, green, blue and opacity."""
    size: tuple[int, int]


def ticks(low: float, high: float) -> list[float]:
    """Round numbers from ``low`` to ``high``, both of which are among them: a legend tells the range of the data."""
    span = high - low
    if not span > 0:
        return [low]
    raw = span / (STEPS - 1)
    power = 10 ** np.floor(np.log10(raw))
    step = power * next(nice for nice in (1, 2, 3, 5, 10) if nice * power >= raw * (1 - 1e-9))
    inner = np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step
    clear = inner[(inner > low + 0.35 * step) & (inner < high - 0.35 * step)]
    return [low, *clear.tolist(), high]


def legend(picture: Picture) -> Legend:
    """Draw the legend of a picture."""
    words = texts(picture)
    bold = fonts()[0]
    wide = max(WIDTH, 2 * EDGE + max(QtGui.QFontMetrics(bold).boundingRect(line).width() for line in words))
    size = wide, 3 * EDGE + len(words) * LINE + TALL + LINE // 2
    image = QtGui.QImage(*size, QtGui.QImage.Format_RGBA8888)
    image.fill(QtGui.QColor(255, 255, 255, 235))
    painter = QtGui.QPainter(image)
    for number, line in enumerate(words):
        painter.setFont(fonts()[min(number, 1)])
        painter.drawText(QtCore.QRect(EDGE, EDGE + number * LINE, wide, LINE), 0, line)
    bar(painter, picture.scale, 2 * EDGE + len(words) * LINE)
    painter.end()
    return Legend(bytes(image.mirrored().constBits()), size)


def texts(picture: Picture) -> list[str]:
    """The lines above the bar."""
    scale, words = picture.scale, [tr(picture.title)]
    if picture.count:
        words.append(f"{picture.count:,} ".replace(",", THIN) + tr("channels"))
    if picture.stale:
        words.append(tr("stale: parameters changed"))
    return [*words, f"{tr(scale.title)} [{scale.unit}]"]


def fonts() -> tuple[Any, Any]:
    """Of the title and of the rest."""
    bold, plain = QtGui.QFont(), QtGui.QFont()
    for font in (bold, plain):
        font.setPixelSize(13)
    bold.setBold(True)
    return bold, plain


def bar(painter: Any, scale: Scale, top: int) -> None:
    """Draw the colours with their numbers, ``top`` pixels below the upper border."""
    values = np.linspace(scale.high, scale.low, TALL)
    for row, (red, green, blue) in enumerate(np.round(255 * scale.colours(values)).astype(int).tolist()):
        painter.fillRect(EDGE, top + row, BAR, 1, QtGui.QColor(red, green, blue))
    painter.setPen(QtGui.QColor(60, 60, 60))
    painter.drawRect(EDGE, top, BAR, TALL)
    for value in ticks(scale.low, scale.high):
        y = top + round(TALL * (scale.high - value) / ((scale.high - scale.low) or 1.0))
        painter.drawLine(EDGE + BAR, y, EDGE + BAR + 5, y)
        painter.drawText(QtCore.QRect(EDGE + BAR + 9, y - LINE // 2, WIDTH, LINE), VERTICAL, f"{value:.4g}")


VERTICAL = QtCore.Qt.AlignVCenter
"""Numbers stand beside their tick."""
