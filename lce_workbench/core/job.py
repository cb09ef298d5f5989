"""The job: one frozen tree of parameters, declared once. TOML, command line, help and FreeCAD properties come from it.

Names carry the unit the user writes (`width_um`); the properties without a unit are the same lengths in mm.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from lce_workbench.core.units import UM


def param(
    default: Any,
    doc: str,
    *,
    unit: str = "",
    above: float | None = None,
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
    advice: str = "",
) -> Any:
    """Declare a parameter: default, help text, unit, limits (``above`` is exclusive) or choices."""
    meta = {
        "doc": doc,
        "unit": unit,
        "above": above,
        "low": low,
        "high": high,
        "choices": choices,
        "advice": advice,
    }
    return field(default=default, metadata=meta)


@dataclass(frozen=True)
class Target:
    """The surface that the heated sheet takes. Its length unit does not matter: the sheet's width fixes the size."""

    mesh: str = param("", "mesh file: STL, OBJ, PLY or OFF, relative to the job file")
    surface: str = param("", "a shipped surface instead of a mesh: dome, saddle, leaf, cone, sphere-zone, face")
    subdivision: str = param(
        "loop",
        "how a mesh coarser than the domains is refined: loop for smooth surfaces, midpoint for faceted ones",
        choices=("loop", "midpoint"),
    )
    remesh: bool = param(
        True, "mesh the target anew, with even triangles of the domains' size; false keeps the triangles of the input"
    )
    cuts: bool = param(
        False, "cut the target open where it is closed, has handles or is too curved; the sheet then has seams"
    )
    flip: bool = param(False, "turn the surface over, so that its other side becomes the top of the sheet")


@dataclass(frozen=True)
class MaterialSpec:
    """A preset, or numbers, or a measured curve."""

    preset: str = param("", "name of a preset in resources/materials.toml (rm82-pdt-1to1 when nothing is given)")
    lambda_: float | None = param(None, "stretch along the director at the target temperature", above=0.0)
    nu: float | None = param(None, "stretch across the director is lambda^-nu; 0.5 conserves volume")
    curve: str = param("", "CSV file T_C, lambda_parallel, lambda_perpendicular, relative to the job file")
    temperature_C: float | None = param(None, "temperature at which the curve is read", unit="degC")


@dataclass(frozen=True)
class Sheet:
    """The flat film."""

    width_mm: float = param(20.0, "longest side of the flat sheet", unit="mm", above=0.0, high=200.0)
    gap_um: float = param(100.0, "film thickness = spacer thickness", unit="um", above=0.0, low=0.01, high=5000.0)
    twist_gain: float = param(1.0, "multiplies the twist; 2 reproduces the paper's S5 as printed", low=-10.0, high=10.0)
    twist_limit_deg: float = param(
        5.0, "largest twist through the thickness; what is beyond is cut off", unit="deg", above=0.0, high=90.0
    )
    edge_overdrive: bool = param(False, "multiply the twist by 1 + 5 exp(-d / 2 mm), d = distance to the edge")

    @property
    def twist_limit(self) -> float:
        """Largest twist [rad]."""
        return math.radians(self.twist_limit_deg)

    @property
    def thickness(self) -> float:
        """Prepared film thickness [mm]."""
        return self.gap_um * UM

    @property
    def twist(self) -> dict[str, Any]:
        """All that the twist depends on and the metric does not, as the solver names it."""
        return {
            "thickness": self.thickness,
            "twist_gain": self.twist_gain,
            "edge_overdrive": self.edge_overdrive,
            "twist_limit": self.twist_limit,
        }


@dataclass(frozen=True)
class DomainSpec:
    """Monolithic domains: one channel direction each."""

    kind: str = param(
        "triangles",
        "shape of the domains: the design's triangles, hexagons, or the cells of a centroidal Voronoi tessellation",
        choices=("triangles", "hexagons", "voronoi"),
    )
    size_um: float = param(
        350.0, "mean edge of a triangle, or between the centres of neighbours", unit="um", above=0.0, high=10000.0
    )

    @property
    def size(self) -> float:
        """Mean edge of a triangle, or between centres [mm]."""
        return self.size_um * UM


@dataclass(frozen=True)
class ChannelSpec:
    """The alignment channels."""

    width_um: float = param(1.0, "channel width", unit="um", above=0.0, high=100.0)
    spacing_um: float = param(1.0, "land between two channels", unit="um", above=0.0, high=100.0)
    depth_um: float = param(0.6, "channel depth", unit="um", above=0.0, low=0.001, high=100.0)
    guard_um: float = param(
        0.5,
        "channels end this far inside their domain, so that neighbours stay two guards apart",
        unit="um",
        above=0.0,
        high=100.0,
    )

    align_phase: bool = param(
        False,
        "shift each domain's channels so that they meet a neighbour's, where the directions differ by under 5 deg",
    )

    @property
    def width(self) -> float:
        """Channel width [mm]."""
        return self.width_um * UM

    @property
    def pitch(self) -> float:
        """Channel width + spacing [mm]."""
        return (self.width_um + self.spacing_um) * UM

    @property
    def depth(self) -> float:
        """Channel depth [mm]."""
        return self.depth_um * UM

    @property
    def guard(self) -> float:
        """Inset of the channels from the domain's border [mm]."""
        return self.guard_um * UM

    @property
    def duty(self) -> float:
        """Fraction of the patterned area that is channel."""
        return self.width_um / (self.width_um + self.spacing_um)


@dataclass(frozen=True)
class Plates:
    """The two epoxy plates on their glass carriers."""

    carrier: str = param(
        "auto",
        "standard glass, width x height in mm; auto: the smallest that fits, or width_mm and height_mm",
        choices=("auto", "25x25", "25x75", "75x25", "50x50"),
    )
    width_mm: float | None = param(
        None, "glass width (x); default: smallest standard glass", unit="mm", above=0.0, high=200.0
    )
    height_mm: float | None = param(None, "glass height (y)", unit="mm", above=0.0, high=200.0)
    glass_mm: float = param(1.0, "glass thickness", unit="mm", above=0.0, low=0.001, high=20.0)
    replications: int = param(
        2,
        "casts from master to plate: PDMS, epoxy; an odd number turns handedness and relief",
        low=0,
        high=9,
    )
    epoxy_um: float = param(50.0, "epoxy layer under the channels", unit="um", above=0.0, low=0.001, high=5000.0)
    chamfer_mm: float = param(0.0, "chamfer of the glass's outer edges, at 45 deg", unit="mm", low=0.0, high=5.0)
    release_deg: float = param(
        0.0, "release taper of the epoxy's sides, narrower at the film", unit="deg", low=0.0, high=45.0
    )
    notch_mm: float = param(
        0.0,
        "handling notch: what is cut from a lower corner, the bottom plate's left and the top plate's right one",
        unit="mm",
        low=0.0,
        high=50.0,
    )
    engraving_um: float = param(
        0.0, "depth of BOTTOM or TOP and the design's code in the glass's outer face", unit="um", low=0.0, high=1000.0
    )
    frame_mm: float = param(
        0.0, "wall of an alignment frame around both plates; 0: no frame", unit="mm", low=0.0, high=50.0
    )
    frame_clearance_um: float = param(
        50.0, "between the plates and the alignment frame", unit="um", low=0.0, high=1000.0
    )


@dataclass(frozen=True)
class Marks:
    """Alignment marks at the corners and the middles of the sides, outside the sheet."""

    clearance_mm: float = param(2.0, "from the sheet's bounding box to the marks", unit="mm", low=0.1, high=50.0)
    tolerance_um: float = param(10.0, "largest accepted mismatch of the plates", unit="um", above=0.0, high=100.0)
    grating: bool = param(True, "fill the marks with the channels' grating, so that they are dark in the microscope")
    fields: tuple[str, ...] = param(
        ("directors", "dose", "depth", "resolution", "pitch"), "test fields outside the sheet; leave out any"
    )
    label: str = param("", "your own words beside the design's code: capital letters, digits, space, + - . /")


@dataclass(frozen=True)
class Spacer:
    """Mylar strips on the two glue edges (left and right); the other two edges stay open for filling."""

    strip_mm: float = param(3.0, "width of a strip", unit="mm", above=0.0, high=50.0)
    clearance_mm: float = param(1.0, "between strips and sheet, and strips and marks", unit="mm", low=0.0, high=50.0)
    glue_mm: float = param(2.0, "free glass outside each strip for the glue", unit="mm", low=0.0, high=50.0)
    bead_mm: float = param(
        1.0, "width of the glue beads there, at most glue_mm; 0: none", unit="mm", low=0.0, high=50.0
    )


@dataclass(frozen=True)
class SolverSpec:
    """The inverse solver."""

    starts: int = param(12, "number of stretch directions that compete", low=1, high=360)
    tolerance: float = param(1e-8, "relative energy decrease at which the solver stops", unit="", above=0.0, high=1e-2)
    max_iterations: int = param(5000, "iteration limit of one start", low=1, high=1000000)
    smoothing: float = param(
        0.002,
        "weight of the director's jumps between triangles; 0 meets the stretches best, 0.02 halves the jumps",
        low=0.0,
        high=100.0,
    )


@dataclass(frozen=True)
class PredictionSpec:
    """The simulated heating of the flat sheet."""

    correct: str = param(
        "full",
        "let the simulation correct the design: director and twist (full), the twist alone (dtheta), nothing (off)",
        choices=("full", "dtheta", "off"),
    )
    seed: int = param(1, "seed of the imperfection that the sheet starts with", low=0, high=2**31 - 1)
    imperfection: float = param(0.02, "deviation of that imperfection, in thicknesses", low=0.0, high=1.0)
    steps: int = param(10, "steps of the heating", low=1, high=1000)
    plate: bool = param(
        False, "the sheet has weight and lies on the hot plate, which it can leave upwards; without friction"
    )
    density_kg_m3: float = param(1200.0, "density of the film", unit="kg/m3", above=0.0, high=1e5)
    modulus_MPa: float = param(
        1.0, "Young's modulus of the hot film, which resists its weight", unit="MPa", low=1e-4, high=1e6
    )
    film: bool = param(False, "write the heating as an animation, prediction_film.glb")


RELIEF_UM = 30.0
"""Side of the relief's window where none is given."""


@dataclass(frozen=True)
class Output:
    """What is written."""

    masks: tuple[str, ...] = param(
        ("gds", "oas", "dxf"), "mask formats: gds, oas, dxf (R2000, for CAD), r12.dxf (for the writer, um), cif"
    )
    pictures: bool = param(True, "pictures of the masks, mask/*.png")
    overlay_x_um: float = param(5.0, "shift of the top plate in the picture overlay.png", unit="um")
    overlay_y_um: float = param(-3.0, "the same along y", unit="um")
    writer_um: float = param(0.8, "smallest line and land of the laser writer's mode", unit="um", above=0.0, high=100.0)
    freecad: bool = param(True, "write the FreeCAD document cad/cell.FCStd (needs freecadcmd)")
    cad: tuple[str, ...] = param(
        ("domains", "sheet", "stl", "3mf", "svg", "dxf"),
        "further CAD files: domains (outlines named with their angles), sheet (flat, and as predicted when heated), "
        "stl, 3mf (plates, patterned face up, for a microprinter), svg, dxf (outlines of all parts, true mm)",
    )
    drawings: bool = param(True, "fabrication drawings, drawings/*.pdf, .svg, .dxf (needs freecadcmd)")
    author: str = param("", "who drew it, for the drawings' title block")
    date: str = param("", "date for the drawings' title block, as it shall stand there")
    step_domains: tuple[int, ...] = param((), "domains whose channels become solids; default: the most central")
    step_window_um: tuple[int, ...] = param(
        (), "x0, y0, x1, y1 [um] of a window: the domains that it touches become solids too"
    )
    step: str = param(
        "chosen",
        "channel solids in cad/channels_*.step: of the chosen domains; all (some 250 MB a plate of 20 mm); or exact, "
        "each a solid of its own with its ends along the domain's border (some 6 GB, in files of 64 domains)",
        choices=("chosen", "all", "exact"),
    )
    step_instances: str = param(
        "mapped",
        "how channels of one length share a solid: mapped items, or assembly components (3 times larger) for "
        "programs that lose mapped items",
        choices=("mapped", "assembly"),
    )
    relief: bool = param(
        False, "height map and mesh of a window (step_window_um, or 30 um) as the laser writes it: cad/relief_*"
    )
    relief_spot_um: float = param(
        0.8, "1/e2 diameter of the writing spot in the relief", unit="um", above=0.0, high=100.0
    )
    relief_contrast: float = param(
        1.0, "contrast of the resist in the relief: 1 linear, large: a threshold", low=0.1, high=100.0
    )
    relief_pixel_nm: float = param(50.0, "pixel of the relief", unit="nm", low=1.0, high=10000.0)
    step_gzip: bool = param(False, "compress cad/channels_*.step to .step.gz")


@dataclass(frozen=True)
class Job:
    """One job as resolved: every default written out."""

    target: Target = field(default_factory=Target)
    material: MaterialSpec = field(default_factory=MaterialSpec)
    sheet: Sheet = field(default_factory=Sheet)
    domains: DomainSpec = field(default_factory=DomainSpec)
    channels: ChannelSpec = field(default_factory=ChannelSpec)
    plates: Plates = field(default_factory=Plates)
    marks: Marks = field(default_factory=Marks)
    spacer: Spacer = field(default_factory=Spacer)
    solver: SolverSpec = field(default_factory=SolverSpec)
    prediction: PredictionSpec = field(default_factory=PredictionSpec)
    output: Output = field(default_factory=Output)
