"""Writes cadquery-names.step: a body with names and colours on its faces, as cadquery 2.8 exports them."""
import cadquery as cq

body = cq.Workplane().box(2, 1, 1).faces(">Z").workplane().hole(0.4)
parts = cq.Assembly()
parts.add(body, name="body", color=cq.Color("blue"))
parts.addSubshape(body.faces("<X").val(), name="inlet", color=cq.Color("red"))
parts.addSubshape(body.faces(">X").val(), name="outlet")
parts.addSubshape(body.faces("<Y").val(), color=cq.Color(0.0, 1.0, 0.0))
parts.export("tests/data/cadquery-names.step")
