"""Types of the package ivory; tests/python/stubs.py holds them to the module's own signatures."""

from os import PathLike
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

Path = Union[str, PathLike[str]]
Vector = Tuple[float, float, float]
Box = Tuple[Vector, Vector]
Progress = Optional[Callable[[str, float], Any]]
Metadata = Dict[str, Union[int, float, str]]
Asset = Union["Grid", "Sh9", "DifMap", "FivTable", "CubeMap", "LobeTable", "SphereSet"]

class Error(RuntimeError): ...
class ParameterError(Error, ValueError): ...
class Warning(UserWarning): ...

def read(path: Path) -> Asset: ...
def bake_lobes(
    *,
    exponent_nodes: int = 33,
    angle_nodes: int = 65,
    error_samples: int = 100000,
    seed: int = 1,
    threads: int = 0,
    progress: Progress = None,
) -> LobeTable: ...
def write_image(path: Path, pixels: ArrayLike, *, exposure: Optional[float] = None, force: bool = False) -> None: ...
def read_image(path: Path) -> NDArray[np.float32]: ...
def display(pixels: ArrayLike, *, exposure: Optional[float] = None) -> NDArray[np.float32]: ...

class Camera:
    def __init__(self, position: Vector, target: Vector, fov: float = 45.0, up: Vector = (0, 1, 0)) -> None: ...

class Scene:
    def __init__(
        self,
        path: Path,
        environment: Optional[Path] = None,
        *,
        layout: str = "",
        scale: float = 1.0,
        time: Optional[float] = None,
        animation: str = "",
        without: Sequence[str] = (),
        portable: bool = False,
    ) -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def origin(self) -> Metadata: ...
    @property
    def bounds(self) -> Optional[Box]: ...
    @property
    def triangles(self) -> int: ...
    @property
    def cameras(self) -> List[str]: ...
    def irradiance(
        self,
        p: ArrayLike,
        n: ArrayLike,
        *,
        samples: int = 1024,
        seed: int = 1,
        indirect_only: bool = False,
        bounces: int = 1000,
        threads: int = 0,
        progress: Progress = None,
    ) -> Tuple[NDArray[np.float32], NDArray[np.float32]]: ...
    def render(
        self,
        method: str = "path",
        *,
        width: int = 640,
        height: int = 480,
        samples: int = 64,
        seed: int = 1,
        camera: Union[None, str, int, Camera] = None,
        grid: Optional[Grid] = None,
        gather: int = 16,
        guard: Optional[str] = None,
        interpolation: str = "trilinear",
        reconstruction: str = "optimal",
        bounces: int = 1000,
        indirect_only: bool = False,
        threads: int = 0,
        progress: Progress = None,
    ) -> NDArray[np.float32]: ...
    def bake_grid(
        self,
        *,
        bounds: Optional[Box] = None,
        rotate_y: float = 0.0,
        resolution: Union[None, int, Tuple[int, int, int]] = None,
        voxel_size: Optional[float] = None,
        levels: int = 1,
        dynamic: Optional[Sequence[Box]] = None,
        photons: int = 0,
        bounces: int = 1000,
        groups: Union[None, str, Mapping[str, Union[str, Sequence[str]]]] = None,
        direct: Union[bool, Sequence[str]] = False,
        emission: str = "guided",
        basis: str = "vectors",
        estimator: str = "track",
        guard: str = "rays",
        seed: int = 1,
        max_memory: int = 0,
        target_error: Optional[float] = None,
        max_time: Optional[float] = None,
        error_domain: str = "both",
        error_points: Optional[Tuple[ArrayLike, ...]] = None,
        threads: int = 0,
        progress: Progress = None,
    ) -> Grid: ...
    def bake_cubemap(
        self,
        at: Vector,
        *,
        size: int = 4,
        capture: int = 256,
        samples: int = 8,
        seed: int = 1,
        grid: Optional[Grid] = None,
        guard: Optional[str] = None,
        interpolation: str = "trilinear",
        reconstruction: str = "optimal",
        shell: str = "fitted",
        threads: int = 0,
        progress: Progress = None,
    ) -> CubeMap: ...

class Mesh:
    def __init__(
        self,
        path: Path,
        *,
        scale: float = 1.0,
        time: Optional[float] = None,
        animation: str = "",
        without: Sequence[str] = (),
        portable: bool = False,
    ) -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def bounds(self) -> Optional[Box]: ...
    @property
    def triangles(self) -> int: ...
    def bake_fiv(
        self,
        environment: Environment,
        *,
        samples: Tuple[int, int, int] = (128, 65, 30),
        hemispheres: int = 1,
        env_size: int = 32,
        parts: int = 4096,
        farthest: float = 8.0,
        silhouette: int = 128,
        threads: int = 0,
        progress: Progress = None,
    ) -> FivTable: ...
    def bake_spheres(
        self, *, count: int = 64, resolution: int = 0, threads: int = 0, progress: Progress = None
    ) -> SphereSet: ...

class Environment:
    def __init__(self, path: Path, *, layout: str = "") -> None: ...
    @property
    def path(self) -> str: ...
    @property
    def layout(self) -> str: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def total_radiance(self) -> Vector: ...
    def irradiance(self, n: ArrayLike, *, exact: bool = False) -> NDArray[np.float32]: ...
    def bake_sh9(
        self,
        *,
        order: Union[str, int] = "auto",
        max_error: float = 0.01,
        window: Union[str, float] = "none",
        threads: int = 0,
        progress: Progress = None,
    ) -> Sh9: ...
    def bake_difmap(self, *, size: int = 64, threads: int = 0, progress: Progress = None) -> DifMap: ...

class Grid:
    @staticmethod
    def read(path: Path) -> Grid: ...
    def write(self, path: Path, *, force: bool = False) -> None: ...
    def irradiance(
        self,
        p: ArrayLike,
        n: ArrayLike,
        *,
        scene: Optional[Scene] = None,
        guard: Optional[str] = None,
        interpolation: str = "trilinear",
        reconstruction: str = "optimal",
        nudge: float = 0.25,
    ) -> NDArray[np.float32]: ...
    def standard_error(
        self,
        p: ArrayLike,
        n: ArrayLike,
        *,
        scene: Optional[Scene] = None,
        guard: Optional[str] = None,
        interpolation: str = "trilinear",
        nudge: float = 0.25,
    ) -> NDArray[np.float32]: ...
    def mix(self, factors: Mapping[str, Union[float, Vector]]) -> Grid: ...
    def vertex_positions(self) -> NDArray[np.float64]: ...
    @property
    def name(self) -> str: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def metadata(self) -> Metadata: ...
    @property
    def certificate(self) -> Optional[Dict[str, Any]]: ...
    @property
    def basis(self) -> str: ...
    @property
    def light(self) -> str: ...
    @property
    def has_planes(self) -> bool: ...
    @property
    def levels(self) -> int: ...
    @property
    def vertices(self) -> int: ...
    @property
    def resolution(self) -> Tuple[int, int, int]: ...
    @property
    def spacing(self) -> Vector: ...
    @property
    def groups(self) -> List[str]: ...
    @property
    def moments(self) -> NDArray[np.float32]: ...
    @property
    def variance(self) -> NDArray[np.float32]: ...
    @property
    def visible_fraction(self) -> NDArray[np.float32]: ...

class Sh9:
    @staticmethod
    def read(path: Path) -> Sh9: ...
    def write(self, path: Path, *, dialect: str = "ivory", force: bool = False) -> None: ...
    def irradiance(self, n: ArrayLike) -> NDArray[np.float32]: ...
    @property
    def name(self) -> str: ...
    @property
    def metadata(self) -> Metadata: ...
    @property
    def order(self) -> int: ...
    @property
    def average_error(self) -> float: ...
    @property
    def maximum_error(self) -> float: ...
    @property
    def coefficients(self) -> NDArray[np.float64]: ...

class DifMap:
    @staticmethod
    def read(path: Path) -> DifMap: ...
    def write(self, path: Path, *, force: bool = False) -> None: ...
    def irradiance(self, n: ArrayLike) -> NDArray[np.float32]: ...
    @property
    def name(self) -> str: ...
    @property
    def metadata(self) -> Metadata: ...
    @property
    def size(self) -> int: ...
    @property
    def texels(self) -> NDArray[np.float32]: ...

class FivTable:
    @staticmethod
    def read(path: Path) -> FivTable: ...
    def write(self, path: Path, *, precision: str = "float32", force: bool = False) -> None: ...
    def hidden_irradiance(self, p: ArrayLike, n: ArrayLike, *, straddling: str = "bound") -> NDArray[np.float32]: ...
    @property
    def name(self) -> str: ...
    @property
    def metadata(self) -> Metadata: ...
    @property
    def hemispheres(self) -> int: ...
    @property
    def radius(self) -> float: ...
    @property
    def center(self) -> Vector: ...
    @property
    def radii(self) -> List[float]: ...
    @property
    def values(self) -> NDArray[np.float32]: ...

class CubeMap:
    @staticmethod
    def read(path: Path) -> CubeMap: ...
    def write(self, path: Path, *, force: bool = False) -> None: ...
    def irradiance(self, p: ArrayLike, n: ArrayLike, *, method: str = "polygon") -> NDArray[np.float32]: ...
    @property
    def name(self) -> str: ...
    @property
    def warnings(self) -> List[str]: ...
    @property
    def metadata(self) -> Metadata: ...
    @property
    def size(self) -> int: ...
    @property
    def position(self) -> Vector: ...
    @property
    def radiance(self) -> NDArray[np.float32]: ...

class LobeTable:
    @staticmethod
    def read(path: Path) -> LobeTable: ...
    def write(self, path: Path, *, force: bool = False) -> None: ...
    def product_integral(self, exponent1: float, exponent2: float, angle: float) -> float: ...
    @property
    def name(self) -> str: ...
    @property
    def metadata(self) -> Metadata: ...
    @property
    def values(self) -> NDArray[np.float32]: ...

class SphereSet:
    @staticmethod
    def read(path: Path) -> SphereSet: ...
    def write(self, path: Path, *, force: bool = False) -> None: ...
    def __len__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def metadata(self) -> Metadata: ...
    @property
    def spheres(self) -> NDArray[np.float64]: ...
