"""A typeface of our own with the letters A, D and P, so that a text is the same on every machine, whatever fonts are installed."""

import tempfile
from functools import cache
from pathlib import Path

UNITS = 1000
# Contours of a letter: on-curve points, and in threes with a control point between two (TrueType's quadratic curves). The outer contour
# goes clockwise, holes the other way.
LETTERS = {
    "A": (700, [[(0, 0), (270, 700), (430, 700), (700, 0), (560, 0), (500, 160), (200, 160), (140, 0)],
                [(245, 280), (455, 280), (350, 560)]]),
    "D": (680, [[(0, 0), (0, 700), (300, 700), "c", (640, 700), (640, 350), "c", (640, 0), (300, 0)],
                [(140, 130), (290, 130), "c", (500, 130), (500, 350), "c", (500, 570), (290, 570), (140, 570)]]),
    "P": (600, [[(0, 0), (0, 700), (320, 700), "c", (560, 700), (560, 480), "c", (560, 260), (320, 260), (140, 260), (140, 0)],
                [(140, 390), (310, 390), "c", (420, 390), (420, 480), "c", (420, 570), (310, 570), (140, 570)]]),
}


def draw(contours):
    """The outline as TrueType has it."""
    from fontTools.pens.ttGlyphPen import TTGlyphPen

    pen = TTGlyphPen(None)
    for contour in contours:
        points = iter(contour)
        pen.moveTo(next(points))
        for point in points:
            if point == "c":
                pen.qCurveTo(next(points), next(points))
            else:
                pen.lineTo(point)
        pen.closePath()
    return pen.glyph()


@cache
def path():
    """The font file, written anew for this process."""
    from fontTools.fontBuilder import FontBuilder

    names = [".notdef", "space", *LETTERS]
    font = FontBuilder(UNITS, isTTF=True)
    font.setupGlyphOrder(names)
    font.setupCharacterMap({32: "space"} | {ord(name): name for name in LETTERS})
    font.setupGlyf({".notdef": draw([]), "space": draw([])} | {name: draw(contours) for name, (_, contours) in LETTERS.items()})
    font.setupHorizontalMetrics({name: (LETTERS.get(name, (300, []))[0] + 100, 0) for name in names})
    font.setupHorizontalHeader(ascent=800, descent=-200)
    font.setupNameTable({"familyName": "Geo Adapt", "styleName": "Regular"})
    font.setupOS2(sTypoAscender=800, sTypoDescender=-200, usWinAscent=800, usWinDescent=200)
    font.setupPost()
    file = Path(tempfile.mkdtemp(prefix="geo-adapt-font-")) / "geo-adapt.ttf"
    font.save(file)
    return str(file)
