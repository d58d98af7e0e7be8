"""Writes a labelled image of a ball in a ball: python ball.py FILE.nrrd"""

import sys

import numpy

x, y, z = numpy.mgrid[-20:20, -20:20, -20:20] + 0.5
r = (x * x + y * y + z * z) ** 0.5
labels = numpy.where(r < 8, 2, numpy.where(r < 16, 1, 0)).astype("uint8")
head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 40 40\nspacings: 0.5 0.5 0.5\nencoding: raw\n\n"
with open(sys.argv[1], "wb") as file:
    file.write(head.encode() + labels.tobytes(order="F"))
