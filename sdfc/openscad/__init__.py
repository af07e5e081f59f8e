"""A second way in: the flattened CSG that OpenSCAD writes.

text -> calls (parse) -> parts, children first (load, one row of modules.py for each name) -> the shape graph.

What OpenSCAD 2021.01 does is what is meant here (checked against its meshes: tests/openscad/make_truth.py):

- `$fn` from 1 to 49 is the polygonal solid with OpenSCAD's corners; 0, or 50 and more, is the true curve. Arcs of
  `offset` are always true. A `hull` or `minkowski` of more than 96 faces is of true curves, with a warning.
- The outermost colour rules; an alpha below 1 lets light through unbent. What has no colour is OpenSCAD's yellow.
- `difference` takes from its first child; if that is nothing, so is the result. `intersection` with nothing is nothing.
- 2D and 3D do not mix: what is not as the first child is left out (warned of). A file that is all 2D is shown 1 thick.
- `%` and `*` leave a part out, `#` changes nothing, `!` shows that part alone.
- z is up, and no camera or light is said.
"""
