"""Bodies in a flow and the domains about them; a plane of symmetry cuts each."""

import math

from zoo.polyhedra import polyhedron


def half_ball(radius, centre, normal):
    """The half of a ball on the side of `normal` of the plane through its centre."""
    import cadquery

    x, y, z = centre
    return cadquery.Workplane().add(cadquery.Solid.makeSphere(radius, cadquery.Vector(x, y, z), cadquery.Vector(*normal), 0, 90))


def swept_wing_domain():
    """geometry/wing.py's wing, from y = 0 on, in a half-ball of radius 5: a sharp trailing edge, a flat tip."""
    import cadquery
    import wing

    return half_ball(5, (0.5, 0, 0), (0, 1, 0)).cut(cadquery.Workplane().add(wing.build().val()))


def hemisphere_cylinder():
    """A cylinder of radius 0.5 and length 9.5 with a half-sphere as its nose at the origin's side; x is its axis."""
    import cadquery

    nose = cadquery.Workplane().moveTo(0, 0).threePointArc((0.5 - 0.5 * 0.5**0.5, 0.5 * 0.5**0.5), (0.5, 0.5))
    return nose.lineTo(10, 0.5).lineTo(10, 0).close().revolve(360, (0, 0, 0), (1, 0, 0))


def hemisphere_cylinder_domain():
    """Half of the flow about the hemisphere-cylinder, y > 0, in a quarter-ball of radius 30 whose flat side is the body's end x = 10."""
    import cadquery

    ball = cadquery.Workplane().sphere(30).translate((10, 0, 0))
    quarter = ball.intersect(cadquery.Workplane().box(40, 40, 80, centered=(False, False, True)).translate((-30, 0, 0)))
    return quarter.cut(hemisphere_cylinder())


def delta_wing_domain():
    """The UGAWG delta wing, half of it, in a box: flat faces alone, a bevelled leading edge swept by 75°.

    The numbers are those of the workshop's model: chord 1, half-span tan 15°, thickness 0.0244161 reached 0.1578284 behind the leading
    edge, and the box about it.
    """
    span, thick, bevel = 0.267949223518371582, 0.0244161374866962433, 0.157828390598297119
    far, side = 6.36942720413208008, 5.30785608291625977
    import cadquery

    top = [(0, 0, 0), (1, 0, 0), (1, span, 0)]
    bottom = [(bevel, 0, -thick), (1, 0, -thick), (1, (1 - bevel) * span, -thick)]
    # top, bottom, bevel, base, plane of symmetry
    wing = polyhedron(top + bottom, [(0, 1, 2), (3, 5, 4), (0, 2, 5, 3), (1, 4, 5, 2), (0, 3, 4, 1)])
    box = cadquery.Workplane().box(2 * far, side, 2 * side, centered=False).translate((-far, 0, -side))
    return box.cut(wing)


# ONERA M6, section D in the stream direction: (x/c, z/c) of the upper side, after Schmitt and Charpin, "Pressure distributions on the
# ONERA-M6-wing at transonic Mach numbers", AGARD AR-138, 1979, as NASA's NPARC Alliance Validation Archive tabulates it
# (www.grc.nasa.gov/www/wind/valid/m6wing). The model of the wind tunnel has a trailing edge of finite thickness.
M6_SECTION = """
0.0000165 0.0006914  0.0000696 0.0014416  0.0001675 0.0022554  0.0003232 0.0031382  0.0005508 0.0040959  0.0008657 0.0051343
0.0012868 0.0062598  0.0018364 0.0074784  0.0025441 0.0087958  0.0034428 0.0102163  0.0045704 0.0117419  0.0059751 0.0133708
0.0077112 0.0150951  0.0098413 0.0168984  0.0124479 0.0187537  0.0156171 0.0206220  0.0194609 0.0224545  0.0241067 0.0242004
0.0297008 0.0258245  0.0364261 0.0273317  0.0444852 0.0287912  0.0541248 0.0303278  0.0656303 0.0320138  0.0793366 0.0338372
0.0956354 0.0357742  0.1149796 0.0377923  0.1378963 0.0398522  0.1649976 0.0419089  0.1919327 0.0436214  0.2187096 0.0450507
0.2453310 0.0462358  0.2717978 0.0471987  0.2981113 0.0479494  0.3242726 0.0484902  0.3502830 0.0488183  0.3761446 0.0489296
0.4018567 0.0488202  0.4274223 0.0484833  0.4528441 0.0479351  0.4781197 0.0471661  0.5032514 0.0461903  0.5282426 0.0450209
0.5530937 0.0436741  0.5778043 0.0421684  0.6023757 0.0405241  0.6268104 0.0387613  0.6511093 0.0368990  0.6752726 0.0349542
0.6993027 0.0329402  0.7231995 0.0308662  0.7469658 0.0287365  0.7705998 0.0265505  0.7941055 0.0243027  0.8174828 0.0219842
0.8407324 0.0195838  0.8638564 0.0170915  0.8868235 0.0145051  0.9061905 0.0122389  0.9225336 0.0102727  0.9363346 0.0085827
0.9479946 0.0071423  0.9578511 0.0059224  0.9661860 0.0048907  0.9732361 0.0040180  0.9792020 0.0032796  0.9842508 0.0026547
0.9885252 0.0021257  0.9921438 0.0016778  0.9952080 0.0012985  0.9978030 0.0009773  1.0000000 0.0007052
"""
# Root and tip chord, half-span up to the round tip, sweep of the leading edge (m, degrees).
M6_ROOT, M6_TAPER, M6_SPAN, M6_SWEEP = 0.8059, 0.562, 1.1963, 30.0


def m6_section():
    """The upper side from the nose to a sharp trailing edge: the last slope goes on until the thickness is nothing."""
    numbers = [float(word) for word in M6_SECTION.split()]
    points = [(0.0, 0.0), *zip(numbers[::2], numbers[1::2])]
    (x0, z0), (x1, z1) = points[-2:]
    return [*points, (x1 + z1 * (x1 - x0) / (z0 - z1), 0.0)]


def m6_upper(chord, y):
    """The upper side as one spline at the station y, upright at the nose."""
    import cadquery

    nose = y * math.tan(math.radians(M6_SWEEP))
    points = [cadquery.Vector(nose + chord * x, y, chord * z) for x, z in m6_section()]
    (x0, z0), (x1, z1) = m6_section()[-2:]
    # Of length 1, since the parameter is the length of the chords; OCCT's own scaling makes a loop at the trailing edge.
    tangents = [cadquery.Vector(0, 0, 1), cadquery.Vector(x1 - x0, 0, z1 - z0).normalized()]
    return cadquery.Edge.makeSpline(points, tangents=tangents, scale=False)


def m6_wing():
    """The half-wing: two ruled B-splines with straight generators, and the tip section turned about its chord."""
    import cadquery

    tip = M6_ROOT * M6_TAPER
    nose = M6_SPAN * math.tan(math.radians(M6_SWEEP))
    sections = []
    for chord, y in [(M6_ROOT, 0.0), (tip, M6_SPAN)]:
        upper = m6_upper(chord, y)
        sections.append(cadquery.Wire.assembleEdges([upper, upper.mirror("XY")]))
    wing = cadquery.Solid.makeLoft(sections, True)
    end = nose + tip * m6_section()[-1][0]
    axis = cadquery.Vector(end, M6_SPAN, 0), cadquery.Vector(nose, M6_SPAN, 0)
    half = cadquery.Wire.assembleEdges([m6_upper(tip, M6_SPAN), cadquery.Edge.makeLine(*axis)])
    cap = cadquery.Solid.revolve(half, [], 180, *axis)
    return cadquery.Workplane().add(wing), cadquery.Workplane().add(cap)


def onera_m6():
    """The half-wing in a half-ball of radius 12: published coordinates, a sharp trailing edge, a round tip that ends in a point."""
    wing, cap = m6_wing()
    return half_ball(12, (M6_ROOT, 0, 0), (0, 1, 0)).cut(wing.union(cap))


MODELS = {
    "swept-wing-domain": swept_wing_domain,
    "hemisphere-cylinder": hemisphere_cylinder,
    "hemisphere-cylinder-domain": hemisphere_cylinder_domain,
    "delta-wing-domain": delta_wing_domain,
    "onera-m6": onera_m6,
}
