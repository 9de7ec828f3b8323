"""Parts of the report that are made from attributes of a result: the plan, and the trade where one was measured."""

import base64
import json
from collections.abc import Mapping
from html import escape
from typing import Any

__all__ = ["planned", "traded"]


def planned(attrs: Mapping[Any, Any]) -> str:
    """What every effect would change, from the attribute ``plan``: HTML, empty without it."""
    if "plan" not in attrs:
        return ""
    plan = json.loads(str(attrs["plan"]))
    rows = "".join(
        f"<tr><td>{state}</td><td>{escape(effect['name'])}</td><td>{escape(effect['symbol'])}</td>"
        f"<td class='number'>{_short(effect['number'])}</td><td class='number'>{_short(effect['estimated_error'])}</td>"
        f"<td>{escape(effect['reason'])}</td></tr>"
        for state, key in (("in", "effects_used"), ("left out", "effects_left_out"))
        for effect in plan[key]
    )
    head = "<tr><th></th><th>effect</th><th>number</th><th></th><th>error without it</th><th>why</th></tr>"
    return f"<h2>Plan</h2>\n<p>{escape(plan['reason'])}</p>\n<table>{head}{rows}</table>"


def traded(attrs: Mapping[Any, Any]) -> str:
    """Error against cost of every model, from the attribute ``trade``: HTML; without it, how to have it."""
    if "trade" not in attrs:
        return (
            "<h2>Trade</h2>\n<p>Not measured. <code>spinline run SCENE --report FILE --trade</code> runs every model on "
            "this scene and compares it with the finest; <code>--quick</code> only the next.</p>"
        )
    from spinline.report.trade_figure import trade_png
    from spinline.study.trade import Trade

    measured = Trade.from_json(str(attrs["trade"]))
    branches = list(measured.rungs[0].errors)
    head = "<tr><th>model</th><th>setting</th><th>processor time, ms</th>"
    head += "".join(f"<th>error, {escape(branch)}</th>" for branch in branches) + "<th>worst in</th></tr>"
    rows = ""
    for rung in measured.rungs:
        rows += f"<tr><td>{escape(rung.model)}</td><td>{escape(rung.setting)}</td>"
        if rung.refused:
            rows += f"<td colspan='{len(branches) + 2}'>refused: {escape(rung.refused)}</td></tr>"
            continue
        rows += f"<td class='number'>{1e3 * rung.seconds:.3g}</td>"
        rows += "".join(f"<td class='number'>{rung.errors[branch]:.2g}</td>" for branch in branches)
        worst = dict.fromkeys(rung.worst[branch] for branch in branches if rung.errors[branch] > 0)
        rows += f"<td>{escape(', '.join(worst))}</td></tr>"
    against = "".join(
        f"<p>Reference of the {escape(branch)} branch: {escape(words)}.</p>"
        for branch, words in measured.references.items()
    )
    picture = base64.b64encode(trade_png(measured)).decode("ascii")
    return f"""<h2>Trade</h2>
<p>{escape(measured.recommendation)}</p>
<p>Measured on this scene when the report was made. Errors are the largest of the reported quantities against the finest model
of a branch: relative, of the orientation absolute. Times are of the processor that measured, and vary by tens of percent.</p>
<img alt="Error against processor time of every model" src="data:image/png;base64,{picture}">
<table>{head}{rows}</table>
{against}"""


def _short(value: float | None) -> str:
    return "—" if value is None else f"{value:.2g}"
