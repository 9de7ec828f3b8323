"""Reference tables made from the code at build time, so that they cannot differ from it."""

# ruff: noqa: D102

import json
import os
import re
import sys
from pathlib import Path

import click
import typer.main
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

import spinline
from spinline.base.units import QUANTITIES
from spinline.cli import app as command_line
from spinline.radiography.reduction_dataset import REDUCTION_VARIABLES
from spinline.rheology import POLYMERS, SOLVENTS, property_source
from spinline.scene import bundled_scenes, json_schema
from spinline.solve.results import VARIABLES
from spinline.xray import FRAME_FLAGS

logger = logging.getLogger(__name__)
os.environ.update(COLUMNS="96", TERM="dumb", NO_COLOR="1")

PACKAGES = [
    "spinline",
    "spinline.network",
    "spinline.jetprofile",
    "spinline.jetprofile.jetspin",
    "spinline.jetprofile.readers",
    "spinline.jetprofile.ehd",
    "spinline.jetprofile.spun",
    "spinline.rheology",
    "spinline.recipe",
    "spinline.recipe.predict",
    "spinline.recipe.believe",
    "spinline.recipe.model",
    "spinline.recipe.regime",
    "spinline.recipe.table",
    "spinline.recipe.library",
    "spinline.xray",
    "spinline.deposit",
    "spinline.jetprofile.blown",
    "spinline.scene",
    "spinline.solve",
    "spinline.solve.results",
    "spinline.report.figures",
    "spinline.report",
    "spinline.base.units",
    "spinline.base.errors",
    "spinline.study.sweep",
    "spinline.study.sensitivity",
    "spinline.study.window",
    "spinline.report.window_figure",
    "spinline.study.compare",
    "spinline.fit.observations",
    "spinline.fit.observed_map",
    "spinline.fit.model",
    "spinline.fit.scene_model",
    "spinline.fit.problem",
    "spinline.fit.fit_file",
    "spinline.fit.least_squares",
    "spinline.fit.diagnostics",
    "spinline.fit.posterior",
    "spinline.fit.output",
    "spinline.report.fit_figure",
    "spinline.fit.overlay",
    "spinline.images",
    "spinline.radiography.reduce",
    "spinline.radiography.reduction_dataset",
    "spinline.radiography.preview",
    "spinline.radiography.exposure",
    "spinline.radiography.experiment",
    "spinline.images.photons",
    "spinline.images.flat_and_dark",
    "spinline.images.noise",
    "spinline.images.odd_frames",
    "spinline.images.sums",
    "spinline.images.stacks",
    "spinline.images.formats",
    "spinline.images.formats.base",
    "spinline.images.metadata",
    "spinline.images.geometry",
    "spinline.radiography.calibration",
    "spinline.radiography.detector",
    "spinline.radiography.looks",
    "spinline.radiography.positions",
    "spinline.radiography.stitched",
    "spinline.base.checkpoint",
    "spinline.report.images_figure",
    "spinline.radiography.methods",
]


class Generated(SphinxDirective):
    """A directive that writes Markdown and has it parsed."""

    def parse(self, lines):
        holder = nodes.container()
        self.state.nested_parse(StringList(lines, source=self.get_source_info()[0]), 0, holder)
        return holder.children


class SceneKeys(Generated):
    """Keys of one section of the scene file, by the name of its model in the JSON Schema."""

    required_arguments = 1

    def run(self):
        schema = json_schema()
        section = schema if self.arguments[0] == "Scene" else schema["$defs"][self.arguments[0]]
        required = section.get("required", [])
        rows = []
        for key, field in section["properties"].items():
            if "const" in field and key == "profile":
                rows.append((f"`{key}`", f"`{_toml(field['const'])}`", "required", ""))
                continue
            if key in required:
                default = "required"
            elif _default(field) is None:
                default = ""
            else:
                default = f"`{_toml(_default(field))}`"
            kind = _kind(field, schema)
            if self.arguments[0] == "Scene" and kind != "text":
                kind = "section, below"
            rows.append((f"`{key}`", kind, default, "" if default.startswith("`") else _example(field)))
        return self.parse(_table(("key", "what it holds", "default", "example"), rows))


class SpindbTable(Generated):
    """What `benchmarks/spindb.py` found, from its committed result."""

    def run(self):
        found = json.loads((Path(__file__).parents[2] / "benchmarks" / "spindb.json").read_text(encoding="utf-8"))

        def row(words, r):
            inside = f"{100 * r['coverage_68']:.0f} / {100 * r['coverage_95']:.0f} %" if "coverage_68" in r else ""
            numbers = (f"{r[name]:.2f}" if name in r else "" for name in ("factor", "mean", "bias", "offset"))
            return words, *numbers, inside

        side = json.loads((Path(__file__).parents[2] / "benchmarks" / "spindb_rungs.json").read_text(encoding="utf-8"))
        rows = [row(f"rung `{name}`", r) for name, r in side["rungs"].items()]
        beads = side["by beads"]
        if beads:
            of = f"on the {beads['spun']} experiments that the chain of beads could spin"
            rows += [row(f"rung `{name}`, {of}", r) for name, r in beads.items() if isinstance(r, dict)]
        rows.append(row("rung `race`, the papers left out by tenths", found["leaving out tenths"]))
        rows += [row(name, r) for name, r in found["plain statistics"].items()]
        one = found["one known"]["rows"]
        known = {"factor": one["chain"], "coverage_68": one["coverage_68"], "coverage_95": one["coverage_95"]}
        rows.append(row("one fibre of the paper measured, rung `race`", known))
        rows.append(row("one fibre of the paper measured, the others said equal", {"factor": one["equal"]}))
        low = found["floor"]["factor of the best prediction from these columns"]
        rows.append(row("floor by pairs of papers with nearly equal recipes, mostly PVDF", {"factor": low}))
        return self.parse(
            _table(
                (
                    "prediction, the paper left out",
                    "factor, median paper",
                    "mean paper",
                    "bias",
                    "factor after one offset",
                    "68 / 95 % intervals hold",
                ),
                rows,
            )
        )


class SpindbText(Generated):
    """Elasticities, failures, shares and floor of `benchmarks/spindb.py`, in words."""

    def run(self):
        found = json.loads((Path(__file__).parents[2] / "benchmarks" / "spindb.json").read_text(encoding="utf-8"))
        rows = [
            (
                name,
                f"{e['predicted']:.2f}",
                f"{e['measured'][1]:.2f} ({e['measured'][0]:.2f} to {e['measured'][2]:.2f})",
                f"{e['papers']}",
            )
            for name, e in found["elasticities"].items()
        ]
        table = self.parse(
            _table(("d ln d/d ln of", "predicted, median", "measured, median (quartiles)", "papers"), rows)
        )
        low, bad = found["floor"], found["failures"]
        shares = sorted(found["variance shares"].items(), key=lambda item: -item[1])[:5]
        least, most = found["rungs"]["race"]["factor_68"]
        side = json.loads((Path(__file__).parents[2] / "benchmarks" / "spindb_rungs.json").read_text(encoding="utf-8"))
        one, ratio = found["one known"]["rows"], side["envelope over race, 5 25 50 75 95 %"]
        known = one["over papers, 68 and 95 %"]
        under = json.loads((Path(__file__).parents[2] / "benchmarks" / "spindb_floor.json").read_text(encoding="utf-8"))
        own, ideal = under["measured"]["a fit of its own"], under["drawn from the model"]
        perfect = ideal["no answers of a laboratory beyond the laws"]
        words = (
            f"Other papers of the same kind would give factors from {least:.2f} to {most:.2f} (68 %, papers drawn anew). "
            f"{low['pairs of papers']} pairs of papers with nearly equal recipes differ by a median factor of "
            f"{low['factor between them']:.2f}; mats of one setting by a standard deviation of {low['repeat_sd']:.2f} of ln d "
            f"(median of {low['papers with repeats']} papers). Of the {bad['failed']} experiments that gave no fibres, "
            f"a failure is said to be likelier to fail than a fibre in {100 * bad['area']:.0f} % of pairs (50 is chance; "
            f"{100 * bad['area_68'][0]:.0f} to {100 * bad['area_68'][1]:.0f}), within the papers that have both in "
            f"{100 * bad['area within papers that have both']:.0f} %. The intervals are made of: "
            + ", ".join(f"{name.replace('_', ' ')} {100 * share:.0f} %" for name, share in shares)
            + f". With one fibre of the paper known the factor is {one['chain']:.3f}; other papers of the same kind would give "
            f"{known[0]:.2f} to {known[1]:.2f} (68 %) or {known[2]:.2f} to {known[3]:.2f} (95 %). Were the laws and the "
            f"spreads exactly right and nothing wrong in the arithmetic, it would be {ideal['as calibrated']['50']:.3f} "
            f"({ideal['as calibrated']['16']:.3f} to {ideal['as calibrated']['84']:.3f}, papers drawn from the model itself); "
            f"if besides every laboratory answered its settings by the laws, {perfect['50']:.3f} ({perfect['16']:.3f} to "
            f"{perfect['84']:.3f}); each paper fitted afterwards with exponents of its own leaves {own['factor']:.2f} "
            "(`spindb_floor.py`). The envelope's "
            f"fibres are {ratio[0]:.2f} to {ratio[4]:.2f} of the race's (5 to 95 % of the settings)."
        )
        return [*table, *self.parse([words])]


class CommandHelp(SphinxDirective):
    """What ``spinline COMMAND --help`` prints."""

    optional_arguments = 1

    def run(self):
        name = self.arguments[0] if self.arguments else None
        group = typer.main.get_command(command_line)
        parent = group.make_context("spinline", [], resilient_parsing=True)
        if name is None:
            text = group.get_help(parent)
        else:
            command = group.get_command(parent, name)
            with type(parent)(command, info_name=name, parent=parent) as context:
                text = command.get_help(context)
        return [nodes.literal_block(click.unstyle(text), click.unstyle(text), language="text")]


class Variables(Generated):
    """Names in a result."""

    def run(self):
        rows = [(f"`{name}`", unit or "flag", words) for name, (unit, words) in VARIABLES.items()]
        return self.parse(_table(("name", "unit", "what it is"), rows))


class ReductionVariables(Generated):
    """Names in a reduction of images."""

    def run(self):
        rows = [(f"`{name}`", unit or "flag", words) for name, (unit, words) in REDUCTION_VARIABLES.items()]
        return self.parse(_table(("name", "unit", "what it is"), rows))


class ReductionFlags(Generated):
    """Flags of a block of rows."""

    def run(self):
        return self.parse(
            _table(("flag", "what it says"), [(f"`{name}`", words) for name, words in FRAME_FLAGS.items()])
        )


class Quantities(Generated):
    """Kinds of quantity and how they are written."""

    def run(self):
        rows = [(q.name, q.unit or "none", f"`{q.example}`") for q in QUANTITIES.values()]
        return self.parse(_table(("kind", "SI unit", "as text"), rows))


class Materials(Generated):
    """Built-in polymers and solvents."""

    def run(self):
        polymers = [
            (
                p.name,
                f"{p.density:g}",
                p.repeat_unit,
                f"{1e3 * p.repeat_unit_molar_mass:g}",
                str(p.backbone_bonds),
                p.source,
            )
            for p in POLYMERS.values()
        ]
        chains = [
            (
                p.name,
                *(
                    f"{scale * getattr(p, name):.3g}: {property_source(p, name)}"
                    if getattr(p, name) > 0
                    else "not built in"
                    for name, scale in (
                        ("kuhn_length", 1e9),
                        ("entanglement_molar_mass", 1.0),
                        ("glass_transition", 1.0),
                    )
                ),
            )
            for p in POLYMERS.values()
        ]
        solvents = [(name, cas, f"{low:g} to {high:g}") for name, (cas, low, high) in SOLVENTS.items()]
        heads = ("polymer", "density, kg/m³", "repeat unit", "its molar mass, g/mol", "backbone bonds", "source")
        more = ("polymer", "Kuhn length, nm", "entanglement molar mass, kg/mol", "glass transition, K")
        tables = [*_table(heads, polymers), "", *_table(more, chains), ""]
        return self.parse([*tables, *_table(("solvent", "CAS number", "range, K"), solvents)])


class Scenes(Generated):
    """Bundled scenes."""

    def run(self):
        rows = []
        for name, path in bundled_scenes().items():
            text = path.read_text(encoding="utf-8")
            title = re.search(r'^title = "(.*)"$', text, re.MULTILINE)
            rows.append((f"`{name}`", title.group(1) if title else ""))
        return self.parse(_table(("name", "what it is"), rows))


def _table(heads, rows):
    lines = [heads, ["---"] * len(heads), *rows]
    return ["| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines]


def _toml(value):
    if isinstance(value, dict) and "text" in value:
        value = value["text"]
        return value if re.fullmatch(r"[\d.e+-]+", value) else f'"{value}"'
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value)


def _default(field):
    value = field.get("default")
    return None if isinstance(value, dict) and "text" not in value else value


def _kind(field, schema):
    branches = field.get("anyOf") or field.get("oneOf")
    if branches:
        words = [_kind(branch, schema) for branch in branches if branch.get("type") != "null"]
        return " or ".join(dict.fromkeys(words))
    if "$ref" in field:
        name = field["$ref"].rpartition("/")[2]
        section = schema["$defs"][name]
        return f"a table ({', '.join(f'`{key}`' for key in section['properties'])})"
    if "enum" in field:
        return ", ".join(f"`{_toml(value)}`" for value in field["enum"])
    if "const" in field:
        return f"`{_toml(field['const'])}`"
    if "description" in field:
        return field["description"].replace("*", "\\*")
    words = {
        "string": "text",
        "integer": "whole number",
        "object": "a table of name = share",
        "boolean": "true or false",
    }
    text = words.get(field.get("type", ""), field.get("type", ""))
    bounds = [f"{sign} {field[name]:g}" for name, sign in _BOUNDS.items() if name in field]
    return f"{text}, {', '.join(bounds)}" if bounds else text


_BOUNDS = {"exclusiveMinimum": ">", "minimum": "≥", "exclusiveMaximum": "<", "maximum": "≤"}


def _example(field):
    for candidate in (field, *field.get("anyOf", ())):
        if "examples" in candidate:
            number = candidate["description"].startswith("number")
            return "" if number else f'`"{candidate["examples"][0]}"`'
    return ""


def _thing(name):
    """What stands under a documented name; None where that is a field of a class."""
    module, _, attribute = name.rpartition(".")
    if name in sys.modules:
        return sys.modules[name]
    return getattr(sys.modules.get(module), attribute, None)


def check_complete(_app, env):
    """Warn of every public name that no page documents."""
    documented = set(env.domaindata["py"]["objects"])
    things = {id(thing) for thing in map(_thing, documented) if not isinstance(thing, (str, float, int, type(None)))}
    for package in PACKAGES:
        module = spinline if package == "spinline" else __import__(package, fromlist=["_"])
        for name in module.__all__:
            if name == "__version__" or f"{package}.{name}" in documented or f"{package}.{name}" in PACKAGES:
                continue
            thing = getattr(module, name)
            if id(thing) not in things:
                logger.warning("%s.%s is public and not in the API reference", package, name)


def setup(app):
    """Register the directives."""
    app.add_directive("scene-keys", SceneKeys)
    app.add_directive("spindb-table", SpindbTable)
    app.add_directive("spindb-text", SpindbText)
    app.add_directive("command-help", CommandHelp)
    app.add_directive("result-variables", Variables)
    app.add_directive("reduction-variables", ReductionVariables)
    app.add_directive("reduction-flags", ReductionFlags)
    app.add_directive("quantity-kinds", Quantities)
    app.add_directive("materials", Materials)
    app.add_directive("bundled-scenes", Scenes)
    app.connect("env-check-consistency", check_complete)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
