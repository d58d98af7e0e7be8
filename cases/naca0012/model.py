"""The slab about the NACA 0012 as a STEP file: upper and lower side are B-spline surfaces, everything else is plane."""

import airfoil

# Corners of the square, counterclockwise from below on the right, in units of FAR.
CORNERS = [(1, -1), (1, 1), (-1, 1), (-1, -1)]
HEADER = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('NACA 0012 in a slab'),'2;1');
FILE_NAME('naca0012','2000-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""


class Writer:
    """Entities of a STEP file, numbered as they come."""

    def __init__(self):
        self.lines = []

    def add(self, text):
        """An entity; its name #n."""
        self.lines.append(f"#{len(self.lines) + 1} = {text};")
        return f"#{len(self.lines)}"

    def point(self, place):
        return self.add(f"CARTESIAN_POINT('',{numbers(place)})")

    def direction(self, vector):
        return self.add(f"DIRECTION('',{numbers(vector)})")

    def edge(self, ends, curve):
        """An edge between two (place, VERTEX_POINT)."""
        return self.add(f"EDGE_CURVE('',{ends[0][1]},{ends[1][1]},{curve},.T.)")

    def straight(self, begin, end):
        vector = self.add(f"VECTOR('',{self.direction([b - a for a, b in zip(begin[0], end[0], strict=True)])},1.)")
        return self.edge((begin, end), self.add(f"LINE('',{self.point(begin[0])},{vector})"))

    def bezier(self, ends, places):
        poles = ",".join(map(self.point, places))
        n = len(places) - 1
        curve = f"B_SPLINE_CURVE_WITH_KNOTS('',{n},({poles}),.UNSPECIFIED.,.F.,.F.,({n + 1},{n + 1}),(0.,1.),.UNSPECIFIED.)"
        return self.edge(ends, self.add(curve))

    def bezier_surface(self, rows):
        """Along the rows of degree len(rows) - 1, across them of degree 1."""
        n = len(rows) - 1
        poles = ",".join("(" + ",".join(map(self.point, row)) + ")" for row in rows)
        knots = f"({n + 1},{n + 1}),(2,2),(0.,1.),(0.,1.)"
        return self.add(f"B_SPLINE_SURFACE_WITH_KNOTS('',{n},1,({poles}),.UNSPECIFIED.,.F.,.F.,.F.,{knots},.UNSPECIFIED.)")

    def placement(self, place, axis, along):
        return self.add(f"AXIS2_PLACEMENT_3D('',{self.point(place)},{self.direction(axis)},{self.direction(along)})")

    def plane(self, place, normal, along):
        return self.add(f"PLANE('',{self.placement(place, normal, along)})")

    def face(self, name, surface, loops, same=True):
        """A face within loops of (edge, whether it goes forwards), the outer one first, counterclockwise as seen from outside."""
        bounds = []
        for kind, loop in zip(["FACE_OUTER_BOUND"] + ["FACE_BOUND"] * len(loops), loops):
            edges = ",".join(self.add(f"ORIENTED_EDGE('',*,*,{edge},{flag(forwards)})") for edge, forwards in loop)
            whole = self.add(f"EDGE_LOOP('',({edges}))")
            bounds.append(self.add(f"{kind}('',{whole},.T.)"))
        return self.add(f"ADVANCED_FACE('{name}',({','.join(bounds)}),{surface},{flag(same)})")


def numbers(values):
    """Reals as STEP has them, with a point in each."""
    return "(" + ",".join(f"{float(value):.17E}" for value in values) + ")"


def flag(value):
    return ".T." if value else ".F."


def faces(step):
    """The faces of the slab: first those that airfoil.NAMES has first."""
    # Every point twice, on the side y = WIDTH and on the side y = 0: seen from the latter x is to the right and z is up.
    sides = (airfoil.WIDTH, 0.0)

    def twice(x, z):
        places = [(x, y, z) for y in sides]
        return [(place, step.add(f"VERTEX_POINT('',{step.point(place)})")) for place in places]

    def across(pair):
        return step.straight(*pair)

    nose, tail = twice(0.0, 0.0), twice(1.0, 0.0)
    corners = [twice(airfoil.MIDDLE + airfoil.FAR * x, airfoil.FAR * z) for x, z in CORNERS]
    at_nose, at_tail, at_corners = across(nose), across(tail), [across(corner) for corner in corners]
    profile, skins = {}, {}
    for name, sign in (("upper", 1), ("lower", -1)):
        poles = [(x, sign * z) for x, z in airfoil.poles()]
        profile[name] = [step.bezier((nose[i], tail[i]), [(x, y, z) for x, z in poles]) for i, y in enumerate(sides)]
        skins[name] = step.bezier_surface([[(x, y, z) for y in sides] for x, z in poles])
    turns = [(k, (k + 1) % 4) for k in range(4)]
    around = [[step.straight(corners[a][i], corners[b][i]) for a, b in turns] for i in range(2)]
    upper, lower = profile["upper"], profile["lower"]
    made = [
        step.face("upper", skins["upper"], [[(upper[0], True), (at_tail, True), (upper[1], False), (at_nose, False)]]),
        step.face("lower", skins["lower"], [[(at_nose, True), (lower[1], True), (at_tail, False), (lower[0], False)]], same=False),
        step.face("side0", step.plane((0, sides[1], 0), (0, -1, 0), (1, 0, 0)),
                  [[(edge, True) for edge in around[1]], [(upper[1], True), (lower[1], False)]]),
        step.face("side1", step.plane((0, sides[0], 0), (0, 1, 0), (1, 0, 0)),
                  [[(edge, False) for edge in reversed(around[0])], [(upper[0], False), (lower[0], True)]]),
    ]
    for k, (a, b) in enumerate(turns):
        x, z = [(1, 0), (0, 1), (-1, 0), (0, -1)][k]
        plane = step.plane(corners[a][0][0], (x, 0, z), (0, 1, 0))
        loop = [(around[0][k], True), (at_corners[b], True), (around[1][k], False), (at_corners[a], False)]
        made.append(step.face("farfield", plane, [loop]))
    return made


def write(path):
    """Writes the model."""
    step = Writer()
    shell = step.add(f"CLOSED_SHELL('',({','.join(faces(step))}))")
    solid = step.add(f"MANIFOLD_SOLID_BREP('',{shell})")
    length = step.add("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )")
    angle = step.add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )")
    solid_angle = step.add("( NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT() )")
    close = step.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length},'distance_accuracy_value','')")
    context = step.add(f"( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({close})) "
                       f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle})) REPRESENTATION_CONTEXT('','') )")
    shape = step.add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({step.placement((0, 0, 0), (0, 0, 1), (1, 0, 0))},{solid}),{context})")
    application = step.add("APPLICATION_CONTEXT('automotive design')")
    step.add(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})")
    discipline = step.add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
    product = step.add(f"PRODUCT('naca0012','naca0012','',({discipline}))")
    formation = step.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    stage = step.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = step.add(f"PRODUCT_DEFINITION('design','',{formation},{stage})")
    whole = step.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    step.add(f"SHAPE_DEFINITION_REPRESENTATION({whole},{shape})")
    path.write_text(HEADER + "\n".join(step.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n")
