"""ivory bakes light: it traces photons through a glTF scene and leaves behind small assets to light it by.

World: right-handed, +Y up, metres. Radiance in nits, irradiance E in lux, linear Rec.709 colour. Arrays of points and
normals have the shape (..., 3); floats of 32 bits in C order are read in place. docs/python.md shows how it is used.
"""

from ._ivory import (
    Camera,
    CubeMap,
    DifMap,
    Environment,
    Error,
    FivTable,
    Grid,
    LobeTable,
    Mesh,
    ParameterError,
    Scene,
    Sh9,
    SphereSet,
    Warning,
    __version__,
    bake_lobes,
    display,
    read,
    read_image,
    write_image,
)

__all__ = [
    "Camera",
    "CubeMap",
    "DifMap",
    "Environment",
    "Error",
    "FivTable",
    "Grid",
    "LobeTable",
    "Mesh",
    "ParameterError",
    "Scene",
    "Sh9",
    "SphereSet",
    "Warning",
    "__version__",
    "bake_lobes",
    "display",
    "read",
    "read_image",
    "write_image",
]

# Tracebacks and help() name what users import.
for _name in __all__:
    if isinstance(globals()[_name], type):
        globals()[_name].__module__ = "ivory"
del _name
