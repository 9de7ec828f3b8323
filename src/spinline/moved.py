"""Where the modules of version 0.1 live now: their old names still import, and give the very same modules."""

import sys
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType

__all__ = ["MOVED", "install"]

MOVED = {
    "absorber": "radiography.absorber",
    "air": "setup.air",
    "attributes": "solve.attributes",
    "blur_check": "xray.frame.still",
    "build": "setup.build",
    "checkpoint": "base.checkpoint",
    "checks": "base.checks",
    "cli_fit": "cli.fit",
    "cli_images": "cli.images",
    "cli_options": "cli.options",
    "cli_simulate": "cli.simulate",
    "cli_sweep": "cli.sweep",
    "cli_trade": "cli.trade",
    "compare": "study.compare",
    "difference": "study.difference",
    "doubt": "radiography.given_quantities",
    "draws": "solve.bands",
    "drying_run": "drying.along_jet",
    "effects": "plan.switches",
    "errors": "base.errors",
    "estimates": "plan.estimates",
    "examine": "plan.remarks",
    "experiment": "radiography.experiment",
    "exposure": "radiography.exposure",
    "extra": "solve.moments",
    "fields": "images.photons",
    "figures": "report.figures",
    "figures_drying": "report.drying_figure",
    "figures_images": "report.images_figure",
    "fit_checks": "fit.diagnostics",
    "fit_figure": "report.fit_figure",
    "fit_file": "fit.fit_file",
    "fit_model": "fit.model",
    "fit_output": "fit.output",
    "fit_problem": "fit.problem",
    "fit_scene": "fit.scene_model",
    "follow": "solve.element",
    "frames": "images.frames",
    "inference": "fit.least_squares",
    "lazy": "base.lazy",
    "material": "setup.material",
    "methods": "radiography.methods",
    "network.chain_coarse": "network.chain.coarse",
    "network.chain_model": "network.chain.model",
    "network.chain_profile": "network.chain.profile",
    "network.chain_reference": "network.chain.reference",
    "network.chain_state": "network.chain.state",
    "network.chain_step": "network.chain.step",
    "network.flow": "network.chain.flow",
    "network.walk_estimate": "network.walk.estimate",
    "network.walk_exact": "network.walk.exact",
    "network.walk_flow": "network.walk.flow",
    "network.walk_law": "network.walk.law",
    "network.walk_strand": "network.walk.strand",
    "numbers": "plan.governing_numbers",
    "observations": "fit.observations",
    "observed_map": "fit.observed_map",
    "outputs": "base.files",
    "posterior": "fit.posterior",
    "preview": "radiography.preview",
    "radial_map": "drying.radial_map",
    "reduce": "radiography.reduce",
    "reduction": "radiography.reduction_dataset",
    "report_parts": "report.page_parts",
    "results": "solve.results",
    "rungs": "network_models.variables",
    "scene_fields": "scene.quantities",
    "scene_rheology": "scene.air_and_rheology",
    "sensitivity": "study.sensitivity",
    "simulate": "radiography.simulate",
    "stretching": "network_models.conformation",
    "structure": "solve.frozen_structure",
    "summary": "solve.summary",
    "sweep": "study.sweep",
    "sweep_affine": "study.closed_forms",
    "sweep_axes": "study.axes",
    "sweep_densities": "setup.densities",
    "sweep_design": "study.design",
    "sweep_file": "study.sweep_file",
    "sweep_keys": "scene.keys",
    "sweep_rows": "study.rows",
    "sweep_store": "study.store",
    "sweep_table": "study.table",
    "theory_overlay": "report.overlay_figure",
    "trade": "study.trade",
    "trade_figure": "report.trade_figure",
    "uncertainty": "solve.uncertainty",
    "units": "base.units",
    "window": "study.window",
    "window_figure": "report.window_figure",
    "xray.absorption": "xray.matter.absorption",
    "xray.attenuation": "xray.matter.attenuation",
    "xray.block": "xray.row.block",
    "xray.chord": "xray.row.chord",
    "xray.chords": "xray.row.chords",
    "xray.edges": "xray.row.edges",
    "xray.energy": "xray.matter.energy",
    "xray.forward": "xray.row.forward",
    "xray.fresnel": "xray.phase.fresnel",
    "xray.fringe_frame": "xray.phase.fringe_frame",
    "xray.fringes": "xray.phase.fringes",
    "xray.image": "xray.frame.image",
    "xray.limit": "xray.row.limit",
    "xray.map_band": "xray.map.band",
    "xray.map_basis": "xray.map.basis",
    "xray.map_data": "xray.map.data",
    "xray.map_fit": "xray.map.fit",
    "xray.map_report": "xray.map.report",
    "xray.map_result": "xray.map.result",
    "xray.map_rows": "xray.map.rows",
    "xray.map_scoring": "xray.map.scoring",
    "xray.map_smoothing": "xray.map.smoothing",
    "xray.medium": "xray.matter.medium",
    "xray.model": "xray.row.model",
    "xray.outcome": "xray.row.outcome",
    "xray.phase_fit": "xray.phase.fit",
    "xray.phase_frame": "xray.phase.frame",
    "xray.phase_retrieval": "xray.phase.retrieval",
    "xray.phase_start": "xray.phase.start",
    "xray.profiles": "xray.phase.profiles",
    "xray.quick": "xray.frame.quick",
    "xray.refraction": "xray.matter.refraction",
    "xray.row_kernel": "xray.row.kernel",
    "xray.scoring": "xray.row.scoring",
    "xray.several_jets": "xray.frame.several_jets",
    "xray.solution": "xray.matter.solution",
    "xray.spectral": "xray.row.spectral",
    "xray.spectrum": "xray.matter.spectrum",
    "xray.start": "xray.row.start",
    "xray.track": "xray.frame.track",
}


class _Moved:  # a finder and loader by its methods: their base classes cost more to import than all of this package
    """Finds a module under its old name; what it loads is the module of the new one."""

    def find_spec(self, fullname: str, path: object = None, target: ModuleType | None = None) -> ModuleSpec | None:
        if not fullname.startswith("spinline.") or fullname[9:] not in MOVED:
            return None
        return ModuleSpec(fullname, self)  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> None:
        """The usual empty module, which `exec_module` replaces."""

    def exec_module(self, module: ModuleType) -> None:
        sys.modules[module.__name__] = import_module(f"spinline.{MOVED[module.__name__[9:]]}")


def install() -> None:
    """Let the old names be imported."""
    if not any(isinstance(finder, _Moved) for finder in sys.meta_path):
        sys.meta_path.append(_Moved())
