"""Writes the mesh files beside it, as Gmsh and meshio write them, and what Gmsh says they hold.

    pip install gmsh==4.15.2 meshio==5.3.5 && python make.py
"""

import json
import math

import gmsh
import meshio
import numpy as np

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMax", 30)
occ = gmsh.model.occ

# A disc of 50 mm radius: a hole, a piece of rim, an inner disc and an inner point; then tilted.
arcs = [occ.addCircle(0, 0, 0, 50, angle1=0.0, angle2=0.8), occ.addCircle(0, 0, 0, 50, angle1=0.8, angle2=2 * math.pi)]
hole = occ.addCircle(-20, 0, 0, 10)
occ.removeAllDuplicates()
rim = occ.addCurveLoop(arcs)
sheet = occ.addPlaneSurface([rim, occ.addCurveLoop([hole])])
inner = occ.addDisk(20, -15, 0, 8, 8)
pieces, _ = occ.fragment([(2, sheet)], [(2, inner)])
point = occ.addPoint(5, 25, 0)
occ.fragment(pieces, [(0, point)])
occ.rotate(occ.getEntities(), 0, 0, 0, 1, 0, 0, 0.5)
occ.synchronize()


def nearest(dimension, x, y):
    """The entity whose centre lies nearest to a place of the flat disc."""
    place = np.array([x, y * math.cos(0.5), y * math.sin(0.5)])
    centre = lambda it: np.array(occ.getCenterOfMass(*it)) if dimension else np.array(gmsh.model.getValue(*it, []))
    return min(gmsh.model.getEntities(dimension), key=lambda it: np.linalg.norm(centre(it) - place))[1]


surfaces = [tag for _, tag in gmsh.model.getEntities(2)]
groups = {
    "electrode_1": (0, [nearest(0, 5, 25)]),
    "electrode_2": (1, [nearest(1, 49 * math.cos(0.4), 49 * math.sin(0.4))]),
    "electrode_3": (2, [nearest(2, 20, -15)]),
    "skin": (2, surfaces),
}
for number, (name, (dimension, entities)) in enumerate(groups.items(), 1):
    gmsh.model.addPhysicalGroup(dimension, entities, number, name)
gmsh.model.mesh.generate(2)

for version in (2.2, 4.1):
    for binary in (0, 1):
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(f"gmsh-{version}-{'binary' if binary else 'text'}.msh")
gmsh.write("gmsh-binary.stl")
gmsh.write("gmsh.obj")

tags, coordinates, _ = gmsh.model.mesh.getNodes()
place = {tag: i for i, tag in enumerate(tags)}
points = coordinates.reshape(-1, 3)
triangles = np.concatenate([gmsh.model.mesh.getElements(2, s)[2][0] for s in surfaces]).reshape(-1, 3)
triangles = np.vectorize(place.get)(triangles)
# Gmsh keeps nodes that no triangle uses, such as the old point beneath a fragment.
used, triangles = np.unique(triangles, return_inverse=True)
mesh = meshio.Mesh(points[used], [("triangle", triangles.reshape(-1, 3).astype(np.int32))])
meshio.write("meshio-text.ply", mesh, binary=False)
meshio.write("meshio-binary.ply", mesh, binary=True)
meshio.write("meshio-text.stl", mesh, binary=False)
meshio.write("meshio-4.1-binary.msh", mesh, file_format="gmsh", binary=True)
meshio.write("meshio.obj", mesh)

corners = mesh.points[mesh.cells[0].data]
area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2


def members(name):
    """Number of points, lines or triangles in a group, as Gmsh counts them."""
    dimension, entities = groups[name]
    return sum(len(gmsh.model.mesh.getElements(dimension, entity)[1][0]) for entity in entities)


expected = {
    "nodes": len(mesh.points),
    "triangles": len(corners),
    "area": area,
    "boundary_loops": 2,
    "electrode_1": gmsh.model.mesh.getNodes(0, groups["electrode_1"][1][0])[1].tolist(),
    **{name: members(name) for name in ("electrode_2", "electrode_3", "skin")},
}
with open("expected.json", "w") as file:
    json.dump(expected, file, indent=1)
    file.write("\n")
